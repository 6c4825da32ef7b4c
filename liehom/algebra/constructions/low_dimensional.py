"""The real Lie algebras of dimension at most 4 that are not direct sums, by their names A_{n,k}.

The numbers k are those of Mubarakzyanov's classification in the form of Patera, Sharp, Winternitz and Zassenhaus
("Invariants of real low dimension Lie algebras", J. Math. Phys. 17 (1976) 986).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.tables import field_of_values
from liehom.errors import InputError, displayed
from liehom.scalars import Scalar
from liehom.typing import ScalarLike

Brackets = Mapping[tuple[int, int], Mapping[int, Any]]


@dataclass(frozen=True, slots=True)
class _Class:
    """Brackets of e1, ..., en by the parameters, and the condition on these."""

    brackets: Callable[..., Brackets]
    parameters: int = 0
    condition: str = ""
    holds: Callable[..., bool] = lambda *_: True


def low_dimensional(n: int, k: int, *parameters: ScalarLike) -> LieAlgebra:
    """The Lie algebra A_{n,k} of dimension n <= 4 that is not a direct sum, in the basis e1, ..., en.

    Parameters
    ----------
    n, k : int
        The dimension, and the number in the table.
    *parameters : number
        a, or a and b, of a class that has them; they determine the field.

    Raises
    ------
    InputError
        If there is no such algebra, or the parameters are not in their range.

    Notes
    -----
    The brackets [ei, ej] of all pairs that are not listed vanish.

    =========  ========================================================================  =======================
    A1,1       (abelian)
    A2,1       [e1,e2] = e2
    A3,1       [e2,e3] = e1
    A3,2       [e1,e3] = e1, [e2,e3] = e1 + e2
    A3,3       [e1,e3] = e1, [e2,e3] = e2
    A3,4       [e1,e3] = e1, [e2,e3] = -e2
    A3,5(a)    [e1,e3] = e1, [e2,e3] = a e2                                              0 < abs(a) < 1
    A3,6       [e1,e3] = -e2, [e2,e3] = e1
    A3,7(a)    [e1,e3] = a e1 - e2, [e2,e3] = e1 + a e2                                  a > 0
    A3,8       [e1,e2] = e1, [e2,e3] = e3, [e1,e3] = -2 e2
    A3,9       [e1,e2] = e3, [e2,e3] = e1, [e3,e1] = e2
    A4,1       [e2,e4] = e1, [e3,e4] = e2
    A4,2(a)    [e1,e4] = a e1, [e2,e4] = e2, [e3,e4] = e2 + e3                           a != 0
    A4,3       [e1,e4] = e1, [e3,e4] = e2
    A4,4       [e1,e4] = e1, [e2,e4] = e1 + e2, [e3,e4] = e2 + e3
    A4,5(a,b)  [e1,e4] = e1, [e2,e4] = a e2, [e3,e4] = b e3                              -1 <= a <= b <= 1, ab != 0
    A4,6(a,b)  [e1,e4] = a e1, [e2,e4] = b e2 - e3, [e3,e4] = e2 + b e3                  a != 0, b >= 0
    A4,7       [e2,e3] = e1, [e1,e4] = 2 e1, [e2,e4] = e2, [e3,e4] = e2 + e3
    A4,8       [e2,e3] = e1, [e2,e4] = e2, [e3,e4] = -e3
    A4,9(b)    [e2,e3] = e1, [e1,e4] = (1 + b) e1, [e2,e4] = e2, [e3,e4] = b e3          -1 < b <= 1
    A4,10      [e2,e3] = e1, [e2,e4] = -e3, [e3,e4] = e2
    A4,11(a)   [e2,e3] = e1, [e1,e4] = 2a e1, [e2,e4] = a e2 - e3, [e3,e4] = e2 + a e3   a > 0
    A4,12      [e1,e3] = e1, [e2,e3] = e2, [e1,e4] = -e2, [e2,e4] = e1
    =========  ========================================================================  =======================

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.low_dimensional(4, 2, "1/2"))
    Lie algebra A4,2(1/2) over QQ, dimension 4
      basis e1, e2, e3, e4
      [e1, e4] = 1/2*e1
      [e2, e4] = e2
      [e3, e4] = e2 + e3
    """
    if not (isinstance(n, int) and isinstance(k, int)):
        raise InputError(f"a class is A(n, k) with two integers, got {displayed(n)} and {displayed(k)}")
    if (n, k) not in _TABLE:
        known = sorted(j for i, j in _TABLE if i == n)
        found = f"the classes of dimension {n} are A{n},1 to A{n},{known[-1]}" if known else "dimensions go up to 4"
        raise InputError(f"there is no Lie algebra A{displayed(n)},{displayed(k)} here: {found}")
    kind = _TABLE[n, k]
    if len(parameters) != kind.parameters:
        wanted = f", {kind.condition}" if kind.condition else ""
        raise InputError(f"A{n},{k} has {kind.parameters} parameter(s){wanted}; got {len(parameters)}")
    field = field_of_values(parameters)
    values = [field.convert(x) for x in parameters]
    shown = ",".join(map(field.format, values))
    if not kind.holds(*values):
        raise InputError(f"A{n},{k}({shown}) is not in the table, which has {kind.condition}; another name denotes it")
    name = f"A{n},{k}" + (f"({shown})" if values else "")
    brackets = {(i - 1, j - 1): {m - 1: v for m, v in row.items()} for (i, j), row in kind.brackets(*values).items()}
    return LieAlgebra(brackets, field, dimension=n, basis=[f"e{i + 1}" for i in range(n)], name=name)


def _acting(rows: Sequence[Sequence[Scalar | int]], heisenberg: bool = False) -> Brackets:
    """[e_i, e_n] = sum_j rows[i][j] e_j on an abelian ideal of dimension n - 1, or on [e2, e3] = e1."""
    n = len(rows) + 1
    made = {(i, n): dict(enumerate(row, 1)) for i, row in enumerate(rows, 1)}
    return {(2, 3): {1: 1}, **made} if heisenberg else made


_TABLE: dict[tuple[int, int], _Class] = {
    (1, 1): _Class(dict),
    (2, 1): _Class(lambda: {(1, 2): {2: 1}}),
    (3, 1): _Class(lambda: {(2, 3): {1: 1}}),
    (3, 2): _Class(lambda: _acting([[1, 0], [1, 1]])),
    (3, 3): _Class(lambda: _acting([[1, 0], [0, 1]])),
    (3, 4): _Class(lambda: _acting([[1, 0], [0, -1]])),
    (3, 5): _Class(lambda a: _acting([[1, 0], [0, a]]), 1, "0 < abs(a) < 1", lambda a: 0 < abs(a) < 1),
    (3, 6): _Class(lambda: _acting([[0, -1], [1, 0]])),
    (3, 7): _Class(lambda a: _acting([[a, -1], [1, a]]), 1, "a > 0", lambda a: a > 0),
    (3, 8): _Class(lambda: {(1, 2): {1: 1}, (2, 3): {3: 1}, (1, 3): {2: -2}}),
    (3, 9): _Class(lambda: {(1, 2): {3: 1}, (2, 3): {1: 1}, (1, 3): {2: -1}}),
    (4, 1): _Class(lambda: _acting([[0, 0, 0], [1, 0, 0], [0, 1, 0]])),
    (4, 2): _Class(lambda a: _acting([[a, 0, 0], [0, 1, 0], [0, 1, 1]]), 1, "a != 0", lambda a: a != 0),
    (4, 3): _Class(lambda: _acting([[1, 0, 0], [0, 0, 0], [0, 1, 0]])),
    (4, 4): _Class(lambda: _acting([[1, 0, 0], [1, 1, 0], [0, 1, 1]])),
    (4, 5): _Class(
        lambda a, b: _acting([[1, 0, 0], [0, a, 0], [0, 0, b]]),
        2,
        "-1 <= a <= b <= 1 and a*b != 0",
        lambda a, b: -1 <= a <= b <= 1 and a * b != 0,
    ),
    (4, 6): _Class(
        lambda a, b: _acting([[a, 0, 0], [0, b, -1], [0, 1, b]]),
        2,
        "a != 0 and b >= 0",
        lambda a, b: a != 0 and b >= 0,
    ),
    (4, 7): _Class(lambda: _acting([[2, 0, 0], [0, 1, 0], [0, 1, 1]], heisenberg=True)),
    (4, 8): _Class(lambda: _acting([[0, 0, 0], [0, 1, 0], [0, 0, -1]], heisenberg=True)),
    (4, 9): _Class(
        lambda b: _acting([[1 + b, 0, 0], [0, 1, 0], [0, 0, b]], heisenberg=True),
        1,
        "-1 < b <= 1",
        lambda b: -1 < b <= 1,
    ),
    (4, 10): _Class(lambda: _acting([[0, 0, 0], [0, 0, -1], [0, 1, 0]], heisenberg=True)),
    (4, 11): _Class(
        lambda a: _acting([[2 * a, 0, 0], [0, a, -1], [0, 1, a]], heisenberg=True), 1, "a > 0", lambda a: a > 0
    ),
    (4, 12): _Class(lambda: {(1, 3): {1: 1}, (2, 3): {2: 1}, (1, 4): {2: -1}, (2, 4): {1: 1}}),
}
