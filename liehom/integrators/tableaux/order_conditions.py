"""Order conditions of a Runge-Kutta method, checked order by order, exactly or with a stated tolerance.

The condition of a rooted tree t is Phi(t) = 1/gamma(t), see `rooted_trees`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.integrators.tableaux.rooted_trees import RootedTree, densities, elementary_weights, rooted_trees
from liehom.scalars import Field, Scalar


@final
@dataclass(frozen=True, slots=True)
class Violation:
    """An order condition that does not hold: `weight` is Phi(t), `expected` is 1/gamma(t).

    Examples
    --------
    >>> from liehom.integrators import tableau
    >>> print(tableau("heun").first_violation())
    tree [τ, τ] of order 3: weight 1/2, expected 1/3, defect 1/6
    """

    tree: RootedTree
    weight: Scalar
    expected: Fraction
    field: Field

    @property
    def order(self) -> int:
        """The number of vertices of the tree."""
        return self.tree.order

    @property
    def defect(self) -> Scalar:
        """Phi(t) - 1/gamma(t), a number of the field."""
        return self.weight - self.field.convert(self.expected)

    def __str__(self) -> str:
        weight, defect = self.field.format(self.weight), self.field.format(self.defect)
        return f"tree {self.tree} of order {self.order}: weight {weight}, expected {self.expected}, defect {defect}"


def order_checks(
    a: Sequence[Sequence[Scalar]], b: Sequence[Scalar], field: Field, tolerance: float
) -> Iterator[tuple[Violation | None, float]]:
    """Order by order, through `MAX_ORDER`: the first condition that fails, and the largest |Phi(t) - 1/gamma(t)|.

    Parameters
    ----------
    a, b : sequences of field elements, shapes (s, s) and (s,)
    field : Field
    tolerance : float
        In float64, the largest defect that is no failure.  Exact fields have no tolerance, and their second
        number is 0 (where a condition fails, the violation has the exact defect).

    Examples
    --------
    >>> from liehom.scalars import RR
    >>> for violation, largest in order_checks([[0.0, 0.0], [0.5, 0.0]], [0.0, 1.0], RR, 1e-13):
    ...     if violation is not None:
    ...         break
    ...
    >>> print(violation.tree, largest == 1 / 6)
    [τ, τ] True
    """
    by_order = elementary_weights(np.stack([_array(row, field) for row in a]), _array(b, field))
    for order, phi in enumerate(by_order, start=1):
        gamma = densities(order)
        if field.exact:  # multiplied out: division is what costs most in a number field
            wrong = [i for i, (x, g) in enumerate(zip(phi, gamma.tolist(), strict=True)) if x * g != 1]
            largest = 0.0
        else:
            defects = np.abs(phi - 1 / gamma)
            wrong, largest = np.flatnonzero(~(defects <= tolerance)).tolist(), float(defects.max())
        if not wrong:
            yield None, largest
            continue
        i = wrong[0]
        weight = phi[i] if field.exact else float(phi[i])
        yield Violation(rooted_trees(order)[i], weight, Fraction(1, int(gamma[i])), field), largest


def _array(values: Sequence[Scalar], field: Field) -> npt.NDArray[Any]:
    """A vector of floats, or of objects where the numbers are exact."""
    array = np.empty(len(values), dtype=object if field.exact else np.float64)
    array[:] = values
    return array
