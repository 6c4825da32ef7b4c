"""The rows of the classification of full pairs: for each dimension d of g/h, their keys, names and spaces.

A key is (letter, d, s, e, centre, parameter). With rho the isotropy representation on V = g/h and S the derived algebra
of rho(h), s is the dimension of S and e the dimension of its commutant in gl(V). The centre of rho(h) is 0 (""), R, RJ,
C = R + RJ or R(J + c) with c > 0, for a complex structure J. The letter is A for affine spaces, B for |1|-graded g and
C for compact isotropy in a semisimple g. The parameter is c^2 for the centre R(J + c). For the letter C it is +1 or -1
for a compact or non-compact g. Otherwise it is None.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import isqrt
from typing import NamedTuple, final

from liehom.base.budget import MAX_PARAMETER_DIGITS
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.rational import QQ, ExactNumber, rational_number

SPIRAL = "J+c"
"""Centre of the rows that form families with the parameter c^2."""


class Key(NamedTuple):
    """The invariants of a full pair that determine its row.

    Attributes
    ----------
    letter : {'A', 'B', 'C'}
    d : int
        dim g/h.
    s, e : int
        Dimensions of S = [rho(h), rho(h)] and of the commutant of S.
    centre : {'', 'R', 'J', 'C', 'J+c'}
        The centre of rho(h).
    parameter : Scalar, int or None
        c^2 for the centre 'J+c', +1 (compact) or -1 for the letter C.
    """

    letter: str
    d: int
    s: int
    e: int
    centre: str
    parameter: Scalar | int | None = None


@final
@dataclass(frozen=True, slots=True)
class Row:
    """A row of the classification.

    Attributes
    ----------
    key : Key
        For a family of spirals without its parameter.
    name : str
        Name of the pair in the catalogue; in a family of spirals c stands for a number.
    space : str
        The homogeneous space.
    isotropy : str
        rho(h) as a linear Lie algebra.
    """

    key: Key
    name: str
    space: str
    isotropy: str

    @property
    def is_family(self) -> bool:
        """Whether the row is a family of spirals."""
        return self.key.centre == SPIRAL


class _Linear(NamedTuple):
    """S = [rho(h), rho(h)] on R^d with the dimensions s of S and e of its commutant."""

    name: str
    s: int
    e: int


@cache
def rows(d: int) -> tuple[Row, ...]:
    """All rows for dim g/h = d; every full pair is in exactly one, up to an ideal of g inside h."""
    require_size("d", d, 0)
    return (*_affine(d), *_graded(d), *_compact(d))


def row_of(key: Key) -> Row | None:
    """The row of a key, or None if the key is in no row."""
    plain = key._replace(parameter=None) if key.centre == SPIRAL else key
    return _by_key(key.d).get(plain)


def square_root(square: Scalar | int | None) -> str | None:
    """The positive root of a positive rational number, as catalogue names write it; None if no name can hold it."""
    number = square.rational() if isinstance(square, ExactNumber) else rational_number(square)
    if number is None:
        return None
    p, q = int(number.p), int(number.q)
    if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
        p, q = isqrt(p), isqrt(q)
        text = QQ.format(QQ.convert(p) / q)
    else:
        text = f"sqrt({QQ.format(number)})"
    return text if len(str(max(p, q))) <= MAX_PARAMETER_DIGITS else None


@cache
def _by_key(d: int) -> dict[Key, Row]:
    return {row.key: row for row in rows(d)}


def _linear(d: int) -> Iterator[_Linear]:
    """The S of Theorem L in dimension d."""
    m, q = d // 2, d // 4
    if d < 2:
        yield _Linear("", 0, d)
        return
    if d >= 3:
        yield _Linear(f"so({d})", d * (d - 1) // 2, 1)
    yield _Linear(f"sl({d},R)", d * d - 1, 1)
    if d == 2:
        yield _Linear("", 0, 4)
    if d % 2 == 0 and d >= 4:
        yield _Linear(f"sp({d},R)", d * (d + 1) // 2, 1)
        if d >= 6:
            yield _Linear(f"su({m})", m * m - 1, 2)
        yield _Linear(f"sl({m},C)", 2 * m * m - 2, 2)
    if d % 4 == 0 and d >= 8:
        yield _Linear(f"sp({q})+sp(1)", 2 * q * q + q + 3, 1)
        yield _Linear(f"sl({q},H)+sp(1)", 4 * q * q + 2, 1)
        yield _Linear(f"sp({m},C)", m * m + m, 2)
        yield _Linear(f"sl({q},H)", 4 * q * q - 1, 4)
    if d % 4 == 0:
        yield _Linear(f"sp({q})", 2 * q * q + q, 4)
    exceptional = {7: (("g2", 14),), 8: (("spin(7)", 21),), 16: (("spin(9)", 36), ("spin(9,1)", 45))}
    for name, s in exceptional.get(d, ()):
        yield _Linear(name, s, 1)


def _centres(linear: _Linear) -> tuple[str, ...]:
    if linear.e <= 1:
        return ("", "R")[: linear.e + 1]
    return ("", "R", "J", "C", SPIRAL) if linear.s else ("J", "C", SPIRAL)


_SCALARS = {"": "", "R": "R", "J": "u(1)", "C": "u(1)+R", SPIRAL: f"R({SPIRAL})"}


def _isotropy(linear: str, centre: str) -> str:
    """Name of the linear Lie algebra with this derived algebra and this centre."""
    if not linear:
        return {"": "0", "J": "so(2)", "C": "gl(1,C)"}.get(centre, _SCALARS[centre])
    return f"{linear}+{_SCALARS[centre]}" if centre else linear


def _affine(d: int) -> Iterator[Row]:
    for linear in _linear(d):
        for centre in _centres(linear):
            isotropy = _isotropy(linear.name, centre)
            name = f"affine({isotropy})".replace(f"sl({d},R)", f"sl({d})").replace(f"R({SPIRAL})", "spiral(c,1)")
            if d < 2:
                name = "0/0" if d == 0 else "aff(1)/R" if centre else "R/0"
            key = Key("A", d, linear.s, linear.e, centre)
            yield Row(key, name, "a point" if d == 0 else f"affine space R^{d} under {isotropy}", isotropy)


def _row(letter: str, linear: _Linear, centre: str, parameter: int | None, d: int, name: str, space: str) -> Row:
    isotropy = _isotropy(linear.name, centre)
    return Row(Key(letter, d, linear.s, linear.e, centre, parameter), name, space, isotropy)


def _graded(d: int) -> Iterator[Row]:
    """|1|-graded g: projective spaces, and the sphere under conformal maps."""
    m, q, parts = d // 2, d // 4, {linear.name: linear for linear in _linear(d)}
    if d == 0:
        return
    real = parts[f"sl({d},R)" if d > 1 else ""]
    yield _row("B", real, "R", None, d, f"sl({d + 1})/P1", f"RP^{d} = SL({d + 1},R)/P1")
    if d > 1:
        sphere = parts[f"so({d})" if d > 2 else ""]
        centre = "R" if d > 2 else "C"
        yield _row("B", sphere, centre, None, d, f"so({d + 1},1)/P", f"S^{d} = SO({d + 1},1)/P")
    if d % 2 == 0 and d >= 4:
        yield _row("B", parts[f"sl({m},C)"], "C", None, d, f"sl({m + 1},C)/P1", f"CP^{m} = SL({m + 1},C)/P1")
    if d % 4 == 0 and d >= 8:
        linear = parts[f"sl({q},H)+sp(1)"]
        yield _row("B", linear, "R", None, d, f"sl({q + 1},H)/P1", f"HP^{q} = SL({q + 1},H)/P1")
    if d == 16:
        yield _row("B", parts["spin(9,1)"], "R", None, d, "e6(-26)/P", "OP^2 = E6(-26)/P")


def _compact(d: int) -> Iterator[Row]:
    """Compact isotropy in a semisimple g: symmetric spaces of rank one and their duals, S^6 and S^7."""
    m, q, parts = d // 2, d // 4, {linear.name: linear for linear in _linear(d)}
    for sign in (1, -1) if d > 1 else ():
        n, p = (d + 1, "") if sign > 0 else (d, ",1")
        linear, centre = (parts[f"so({d})"], "") if d > 2 else (parts[""], "J")
        space = f"{'S' if sign > 0 else 'H'}^{d} = SO({n}{p})/SO({d})"
        yield _row("C", linear, centre, sign, d, f"so({n}{p})/so({d})", space)
        kind = "P" if sign > 0 else "H"
        if d % 2 == 0 and d >= 4:
            n, linear = (m + 1 if sign > 0 else m), parts["sp(1)" if d == 4 else f"su({m})"]
            yield _row("C", linear, "J", sign, d, f"su({n}{p})/u({m})", f"C{kind}^{m} = SU({n}{p})/U({m})")
        if d % 4 == 0 and d >= 8:
            n, linear = (q + 1 if sign > 0 else q), parts[f"sp({q})+sp(1)"]
            space = f"H{kind}^{q} = Sp({n}{p})/Sp({q})Sp(1)"
            yield _row("C", linear, "", sign, d, f"sp({n}{p})/sp({q})+sp(1)", space)
        if d == 16:
            form = "" if sign > 0 else "(-20)"
            space = f"O{kind}^2 = F4{form}/Spin(9)"
            yield _row("C", parts["spin(9)"], "", sign, d, f"f4{form}/spin(9)", space)
    if d == 6:
        yield _row("C", parts["su(3)"], "", 1, d, "g2/su(3)", "S^6 = G2/SU(3)")
    if d == 7:
        yield _row("C", parts["g2"], "", 1, d, "spin(7)/g2", "S^7 = Spin(7)/G2")
