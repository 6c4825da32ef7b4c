"""The real Lie algebras of dimension at most 5, and the nilpotent ones of dimension 6, that are not direct sums.

The names A_{n,k} are those of Mubarakzyanov's and Morozov's classifications in the form of Patera, Sharp, Winternitz
and Zassenhaus ("Invariants of real low dimension Lie algebras", J. Math. Phys. 17 (1976) 986). The tests compare the
nilpotent rows with the list of Cicalò, de Graaf and Schneider ("Six-dimensional nilpotent Lie algebras", Linear Algebra
Appl. 436 (2012) 163). The numbers and normal forms of the rows A5,7 to A5,40 were not compared with the paper. They are
checked as algebras: the Jacobi identity holds for all parameters, and samples of pairs of rows are not isomorphic.
"""

from __future__ import annotations

import inspect
import operator
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import prod
from typing import final

from liehom.base.errors import InputError, displayed
from liehom.base.typing import ScalarLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.tables import field_of_values
from liehom.exact.scalars.field import Field, Scalar

TABLE = """
A1,1
A2,1          [e1,e2] = e2
A3,1          [e2,e3] = e1
A3,2          [e1,e3] = e1, [e2,e3] = e1 + e2
A3,3          [e1,e3] = e1, [e2,e3] = e2
A3,4          [e1,e3] = e1, [e2,e3] = -e2
A3,5(a)       [e1,e3] = e1, [e2,e3] = a e2;  0 < abs(a) < 1
A3,6          [e1,e3] = -e2, [e2,e3] = e1
A3,7(a)       [e1,e3] = a e1 - e2, [e2,e3] = e1 + a e2;  a > 0
A3,8          [e1,e2] = e1, [e2,e3] = e3, [e1,e3] = -2 e2
A3,9          [e1,e2] = e3, [e2,e3] = e1, [e1,e3] = -e2
A4,1          [e2,e4] = e1, [e3,e4] = e2
A4,2(a)       [e1,e4] = a e1, [e2,e4] = e2, [e3,e4] = e2 + e3;  a != 0
A4,3          [e1,e4] = e1, [e3,e4] = e2
A4,4          [e1,e4] = e1, [e2,e4] = e1 + e2, [e3,e4] = e2 + e3
A4,5(a,b)     [e1,e4] = e1, [e2,e4] = a e2, [e3,e4] = b e3;  -1 <= a <= b <= 1 and a*b != 0
A4,6(a,b)     [e1,e4] = a e1, [e2,e4] = b e2 - e3, [e3,e4] = e2 + b e3;  a != 0 and b >= 0
A4,7          [e2,e3] = e1, [e1,e4] = 2 e1, [e2,e4] = e2, [e3,e4] = e2 + e3
A4,8          [e2,e3] = e1, [e2,e4] = e2, [e3,e4] = -e3
A4,9(b)       [e2,e3] = e1, [e1,e4] = (1 + b) e1, [e2,e4] = e2, [e3,e4] = b e3;  -1 < b <= 1
A4,10         [e2,e3] = e1, [e2,e4] = -e3, [e3,e4] = e2
A4,11(a)      [e2,e3] = e1, [e1,e4] = 2a e1, [e2,e4] = a e2 - e3, [e3,e4] = e2 + a e3;  a > 0
A4,12         [e1,e3] = e1, [e2,e3] = e2, [e1,e4] = -e2, [e2,e4] = e1
A5,1          [e3,e5] = e1, [e4,e5] = e2
A5,2          [e2,e5] = e1, [e3,e5] = e2, [e4,e5] = e3
A5,3          [e3,e4] = e2, [e3,e5] = e1, [e4,e5] = e3
A5,4          [e2,e4] = e1, [e3,e5] = e1
A5,5          [e3,e4] = e1, [e2,e5] = e1, [e3,e5] = e2
A5,6          [e3,e4] = e1, [e2,e5] = e1, [e3,e5] = e2, [e4,e5] = e3
A5,7(a,b,c)   [e1,e5] = e1, [e2,e5] = a e2, [e3,e5] = b e3, [e4,e5] = c e4;  -1 <= c <= b <= a <= 1 and a*b*c != 0
A5,8(c)       [e2,e5] = e1, [e3,e5] = e3, [e4,e5] = c e4;  0 < abs(c) <= 1
A5,9(b,c)     [e1,e5] = e1, [e2,e5] = e1 + e2, [e3,e5] = b e3, [e4,e5] = c e4;  c <= b and b*c != 0
A5,10         [e2,e5] = e1, [e3,e5] = e2, [e4,e5] = e4
A5,11(c)      [e1,e5] = e1, [e2,e5] = e1 + e2, [e3,e5] = e2 + e3, [e4,e5] = c e4;  c != 0
A5,12         [e1,e5] = e1, [e2,e5] = e1 + e2, [e3,e5] = e2 + e3, [e4,e5] = e3 + e4
A5,13(a,p,q)  [e1,e5] = e1, [e2,e5] = a e2, [e3,e5] = p e3 - q e4, [e4,e5] = q e3 + p e4;  abs(a) <= 1 and a*q != 0
A5,14(p)      [e2,e5] = e1, [e3,e5] = p e3 - e4, [e4,e5] = e3 + p e4
A5,15(a)      [e1,e5] = e1, [e2,e5] = e1 + e2, [e3,e5] = a e3, [e4,e5] = e3 + a e4;  abs(a) <= 1
A5,16(p,q)    [e1,e5] = e1, [e2,e5] = e1 + e2, [e3,e5] = p e3 - q e4, [e4,e5] = q e3 + p e4;  q != 0
A5,17(s,p,q)  [e1,e5] = p e1 - e2, [e2,e5] = e1 + p e2, [e3,e5] = q e3 - s e4, [e4,e5] = s e3 + q e4;  s != 0
A5,18(p)      [e1,e5] = p e1 - e2, [e2,e5] = e1 + p e2, [e3,e5] = e1 + p e3 - e4, [e4,e5] = e2 + e3 + p e4;  p >= 0
A5,19(a,b)    [e2,e3] = e1, [e1,e5] = a e1, [e2,e5] = e2, [e3,e5] = (a - 1) e3, [e4,e5] = b e4;  b != 0
A5,20(a)      [e2,e3] = e1, [e1,e5] = a e1, [e2,e5] = e2, [e3,e5] = (a - 1) e3, [e4,e5] = e1 + a e4
A5,21         [e2,e3] = e1, [e1,e5] = 2 e1, [e2,e5] = e2 + e3, [e3,e5] = e3 + e4, [e4,e5] = e4
A5,22         [e2,e3] = e1, [e2,e5] = e3, [e4,e5] = e4
A5,23(b)      [e2,e3] = e1, [e1,e5] = 2 e1, [e2,e5] = e2 + e3, [e3,e5] = e3, [e4,e5] = b e4;  b != 0
A5,24(a)      [e2,e3] = e1, [e1,e5] = 2 e1, [e2,e5] = e2 + e3, [e3,e5] = e3, [e4,e5] = a e1 + 2 e4;  a*a == 1
A5,25(b,p)    [e2,e3] = e1, [e1,e5] = 2p e1, [e2,e5] = p e2 + e3, [e3,e5] = -e2 + p e3, [e4,e5] = b e4;  b != 0
A5,26(p,a)    [e2,e3] = e1, [e1,e5] = 2p e1, [e2,e5] = p e2 + e3, [e3,e5] = p e3 - e2, [e4,e5] = a e1 + 2p e4; a*a == 1
A5,27         [e2,e3] = e1, [e1,e5] = e1, [e3,e5] = e3 + e4, [e4,e5] = e1 + e4
A5,28(a)      [e2,e3] = e1, [e1,e5] = a e1, [e2,e5] = (a - 1) e2, [e3,e5] = e3 + e4, [e4,e5] = e4
A5,29         [e2,e3] = e1, [e1,e5] = e1, [e2,e5] = e2, [e3,e5] = e4
A5,30(a)      [e2,e4] = e1, [e3,e4] = e2, [e1,e5] = (a + 1) e1, [e2,e5] = a e2, [e3,e5] = (a - 1) e3, [e4,e5] = e4
A5,31         [e2,e4] = e1, [e3,e4] = e2, [e1,e5] = 3 e1, [e2,e5] = 2 e2, [e3,e5] = e3, [e4,e5] = e3 + e4
A5,32(a)      [e2,e4] = e1, [e3,e4] = e2, [e1,e5] = e1, [e2,e5] = e2, [e3,e5] = a e1 + e3;  a == 0 or abs(a) == 1
A5,33(a,b)    [e1,e4] = e1, [e3,e4] = b e3, [e2,e5] = e2, [e3,e5] = a e3;  a*b != 0
A5,34(a)      [e1,e4] = a e1, [e2,e4] = e2, [e3,e4] = e3, [e1,e5] = e1, [e3,e5] = e2
A5,35(a,b)    [e1,e4] = b e1, [e2,e4] = e2, [e3,e4] = e3, [e1,e5] = a e1, [e2,e5] = -e3, [e3,e5] = e2;  a != 0 or b != 0
A5,36         [e2,e3] = e1, [e1,e4] = e1, [e2,e4] = e2, [e2,e5] = -e2, [e3,e5] = e3
A5,37         [e2,e3] = e1, [e1,e4] = 2 e1, [e2,e4] = e2, [e3,e4] = e3, [e2,e5] = -e3, [e3,e5] = e2
A5,38         [e1,e4] = e1, [e2,e5] = e2, [e4,e5] = e3
A5,39         [e1,e4] = e1, [e2,e4] = e2, [e1,e5] = -e2, [e2,e5] = e1, [e4,e5] = e3
A5,40         [e1,e2] = 2 e1, [e1,e3] = -e2, [e2,e3] = 2 e3, [e1,e4] = e5, [e2,e4] = e4, [e2,e5] = -e5, [e3,e5] = e4
A6,1          [e1,e2] = e3, [e1,e3] = e4, [e1,e5] = e6
A6,2          [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e5, [e1,e5] = e6
A6,3          [e1,e2] = e6, [e1,e3] = e4, [e2,e3] = e5
A6,4          [e1,e2] = e5, [e1,e3] = e6, [e2,e4] = e6
A6,5(a)       [e1,e3] = e5, [e1,e4] = e6, [e2,e3] = a e6, [e2,e4] = e5;  a == -1
A6,6          [e1,e2] = e6, [e1,e3] = e4, [e1,e4] = e5, [e2,e3] = e5
A6,7          [e1,e3] = e4, [e1,e4] = e5, [e2,e3] = e6
A6,8          [e1,e2] = e3 + e5, [e1,e3] = e4, [e2,e5] = e6
A6,9          [e1,e2] = e3, [e1,e3] = e4, [e1,e5] = e6, [e2,e3] = e6
A6,10(a)      [e1,e2] = e3, [e1,e3] = e5, [e1,e4] = e6, [e2,e3] = a e6, [e2,e4] = e5;  a == -1
A6,11         [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e5, [e2,e3] = e6
A6,12         [e1,e3] = e4, [e1,e4] = e6, [e2,e5] = e6
A6,13         [e1,e2] = e5, [e1,e3] = e4, [e1,e4] = e6, [e2,e5] = e6
A6,14(a)      [e1,e3] = e4, [e1,e4] = e6, [e2,e3] = e5, [e2,e5] = a e6;  abs(a) == 1
A6,15         [e1,e2] = e3 + e5, [e1,e3] = e4, [e1,e4] = e6, [e2,e5] = e6
A6,16         [e1,e3] = e4, [e1,e4] = e5, [e1,e5] = e6, [e2,e3] = e5, [e2,e4] = e6
A6,17         [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e6, [e2,e5] = e6
A6,18(a)      [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e6, [e2,e3] = e5, [e2,e5] = a e6;  abs(a) == 1
A6,19         [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e5, [e1,e5] = e6, [e2,e3] = e6
A6,20         [e1,e2] = e3, [e1,e3] = e4, [e1,e4] = e5, [e1,e5] = e6, [e2,e3] = e5, [e2,e4] = e6
A6,21         [e1,e2] = e3, [e1,e5] = e6, [e2,e3] = e4, [e2,e4] = e5, [e3,e4] = e6
A6,22         [e1,e2] = e3, [e1,e3] = e5, [e1,e5] = e6, [e2,e3] = e4, [e2,e4] = e5, [e3,e4] = e6
"""
"""A row for each class: name with parameters, brackets of e1, ..., en, condition on the parameters."""

_COMPARE = {
    "<=": operator.le, "<": operator.lt, ">=": operator.ge, ">": operator.gt, "!=": operator.ne, "==": operator.eq,
}  # fmt: skip


@final
@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """A class of the table, with coefficients {parameter or "": integer} that are affine in the parameters."""

    dimension: int
    number: int
    parameters: tuple[str, ...]
    brackets: tuple[tuple[int, int, int, Mapping[str, int]], ...]  # (i, j, m, c): [e_i, e_j] = c e_m + ..., from 0
    condition: str

    def holds(self, values: Sequence[Scalar]) -> bool:
        """Whether values of the parameters are in the range of the table."""
        known = dict(zip(self.parameters, values, strict=True))

        def side(text: str) -> Scalar | int:
            factors = re.findall(r"abs\((\w)\)|(-?\d+)|(\w)", text)
            return prod(abs(known[a]) if a else int(number) if number else known[x] for a, number, x in factors)

        def chain(text: str) -> bool:
            parts = re.split(r" (<=|<|>=|>|!=|==) ", text)
            steps = zip(parts[1::2], pairwise(map(side, parts[::2])), strict=True)
            return all(_COMPARE[sign](*two) for sign, two in steps)

        either = self.condition.split(" or ") if self.condition else []
        return not either or any(all(map(chain, text.split(" and "))) for text in either)

    def name(self, values: Sequence[Scalar], field: Field) -> str:
        """The name with parameters, such as 'A4,2(1/2)'."""
        shown = f"({','.join(map(field.show, values))})" if values else ""
        return f"A{self.dimension},{self.number}{shown}"

    def algebra(self, values: Sequence[Scalar], field: Field) -> LieAlgebra:
        """The algebra with given parameters in a field; `InputError` outside the range of the table."""
        head = f"A{self.dimension},{self.number}"
        if len(values) != len(self.parameters):
            wanted = f", {self.condition}" if self.condition else ""
            raise InputError(f"{head} has {len(self.parameters)} parameter(s){wanted}; got {len(values)}")
        name = self.name(values, field)
        if not self.holds(values):
            raise InputError(f"{name} is not in the table, which has {self.condition}; another name denotes it")
        known = dict(zip(self.parameters, values, strict=True)) | {"": field.one}
        brackets: dict[tuple[int, int], dict[int, Scalar]] = {}
        for i, j, m, c in self.brackets:
            brackets.setdefault((i, j), {})[m] = sum((known[x] * factor for x, factor in c.items()), field.zero)
        basis = [f"e{i + 1}" for i in range(self.dimension)]
        return LieAlgebra(brackets, field, dimension=self.dimension, basis=basis, name=name)


@cache
def rows() -> dict[tuple[int, int], Row]:
    """The table by dimension and number."""
    return {(row.dimension, row.number): row for row in map(_row, TABLE.strip().splitlines())}


def _row(line: str) -> Row:
    text, _, condition = line.partition(";")
    head = re.match(r"A(\d),(\d+)(?:\(([\w,]+)\))?", text)
    names = head[3].split(",") if head and head[3] else []
    brackets = []
    for i, j, right in re.findall(r"\[e(\d),e(\d)\] = ([^\[]*)", text):
        for sign, inner, outer, m in re.findall(r"([+-]?) ?(?:\((.*?)\)|(\w*?)) ?e(\d)", right.replace(", ", "")):
            brackets.append((int(i) - 1, int(j) - 1, int(m) - 1, _affine(inner or outer or "1", sign == "-")))
    return Row(int(text[1]), int(head[2]) if head else 0, tuple(names), tuple(brackets), condition.strip())


def _affine(text: str, negative: bool) -> dict[str, int]:
    """The coefficients of an expression such as '2a' or 'a - 1'."""
    terms = re.findall(r"([+-]?) ?(\d*)([a-z]?)", text)
    read = {x: int(number or 1) * (-1 if (sign == "-") != negative else 1) for sign, number, x in terms if number or x}
    return read


def low_dimensional(n: int, k: int, *parameters: ScalarLike) -> LieAlgebra:
    """The Lie algebra A_{n,k} that is not a direct sum, of dimension n <= 5, or nilpotent of dimension 6.

    Parameters
    ----------
    n, k : int
        The dimension, and the number in the table.
    *parameters : number
        The parameters of a class that has them; they determine the field.

    Notes
    -----
    The algebra is in the basis e1, ..., en. Brackets that are not listed vanish; conditions on parameters follow a
    semicolon. Different parameters may still give isomorphic algebras, as A4,5(-1,1/2) and A4,5(-1,-1/2) are;
    `LieAlgebra.identify` chooses the largest ones in the order of the dictionary.

    The table is that of Patera, Sharp, Winternitz and Zassenhaus, J. Math. Phys. 17 (1976) 986. In A5,24 and A5,26
    both signs of a give isomorphic algebras. In A5,32 and in nilpotent algebras the sign is the only invariant of a
    over the reals, so a is 1, 0 or -1.

    ::

        TABLE

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
    if (n, k) not in rows():
        last = max((j for i, j in rows() if i == n), default=0)
        known = f"the classes of dimension {n} are A{n},1 to A{n},{last}" if last else "dimensions go up to 6"
        raise InputError(f"there is no Lie algebra A{displayed(n)},{displayed(k)} here: {known}")
    field = field_of_values(parameters)
    return rows()[n, k].algebra([field.convert(x) for x in parameters], field)


if low_dimensional.__doc__:  # python -OO leaves docstrings out
    shown = TABLE.strip().replace("\n", "\n    ")
    low_dimensional.__doc__ = inspect.cleandoc(low_dimensional.__doc__).replace("TABLE", shown)
