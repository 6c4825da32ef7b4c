"""The numbers of a bracket table as integers over a common denominator, and as dense exact matrices."""

from __future__ import annotations

from collections.abc import Sequence
from math import lcm
from typing import Any

import numpy as np

from liehom.scalars import ExactField, ExactMatrix, Field, FloatField


def integers_of(field: Field, values: Sequence[Any]) -> tuple[tuple[Any, ...], int]:
    """Numerators (one sequence per coordinate over QQ) and their common denominator; floats as one array over 1.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> integers_of(QQ, [QQ.convert("1/2"), QQ.convert("2/3")])
    (([3, 4],), 6)
    """
    if isinstance(field, FloatField):
        return (np.array(values, dtype=np.float64),), 1
    exact = exactly(field)
    if exact.degree == 1:
        if all(v.q == 1 for v in values):
            return ([int(v.p) for v in values],), 1
        den = lcm(*(int(v.q) for v in values))
        return ([int(v.p) * (den // int(v.q)) for v in values],), den
    columns = [exact.coordinates(v) for v in values]
    den = lcm(*(int(c.q) for column in columns for c in column))
    integral = [[int(c.p) * (den // int(c.q)) for c in column] for column in columns]
    return tuple(list(part) for part in zip(*integral, strict=True)) or ([],) * exact.degree, den


def exactly(field: Field) -> ExactField:
    """The given field, typed as an `ExactField`; `TypeError` if it is not exact.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> exactly(QQ)
    QQ
    """
    if not isinstance(field, ExactField):
        raise TypeError(f"structure constants over {field} are not supported")
    return field


def dense_exact(
    field: ExactField,
    shape: tuple[int, int],
    forward: list[int],
    backward: list[int],
    parts: tuple[Sequence[int], ...],
    den: int,
) -> ExactMatrix:
    """The matrix with numerators `parts` at the flat indices `forward`, and their negatives at `backward`.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(dense_exact(QQ, (2, 2), [1], [2], ([3],), 2))
    [0, 3/2]
    [-3/2, 0]
    """
    made = []
    for part in parts:
        out = [0] * (shape[0] * shape[1])
        for f, b, v in zip(forward, backward, part, strict=True):
            out[f] = v
            out[b] = -v
        made.append(out)
    return field.from_parts(made, *shape, den)
