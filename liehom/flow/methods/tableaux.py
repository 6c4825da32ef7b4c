"""Classical Runge-Kutta methods by name, and collocation methods."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from fractions import Fraction
from functools import cache
from math import comb
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, displayed
from liehom.base.typing import ScalarLike
from liehom.flow.door import QQ, RR, Field, Scalar, common_field
from liehom.flow.methods.runge_kutta import MAX_ORDER, Tableau

# Coefficients of classical Runge-Kutta methods as fractions, from which `tableau` makes each `Tableau`. Rows of a are
# separated by ``;``, entries by spaces. Explicit methods give the entries below the diagonal. The data is not trusted:
# each `Tableau` proves its order.


class ButcherData(NamedTuple):
    """Coefficients of one method, with the weights and order of an embedded method if it has one."""

    order: int
    a: str
    b: str
    embedded: str = ""
    embedded_order: int | None = None


EXPLICIT = {
    "euler": ButcherData(1, "", "1"),  # L. Euler 1768
    "midpoint": ButcherData(2, "; 1/2", "0 1"),  # C. Runge 1895
    "heun": ButcherData(2, "; 1", "1/2 1/2", "1 0", 1),  # the explicit trapezoidal rule, with Euler embedded
    "ralston": ButcherData(2, "; 2/3", "1/4 3/4"),  # A. Ralston 1962: least error bound of two stages
    "kutta3": ButcherData(3, "; 1/2; -1 2", "1/6 2/3 1/6"),  # W. Kutta 1901
    "heun3": ButcherData(3, "; 1/3; 0 2/3", "1/4 0 3/4"),  # K. Heun 1900
    "ssprk3": ButcherData(3, "; 1; 1/4 1/4", "1/6 1/6 2/3"),  # C.-W. Shu, S. Osher 1988
    "rk4": ButcherData(4, "; 1/2; 0 1/2; 0 0 1", "1/6 1/3 1/3 1/6"),  # W. Kutta 1901
    "3/8": ButcherData(4, "; 1/3; -1/3 1; 1 -1 1", "1/8 3/8 3/8 1/8"),  # W. Kutta 1901
    # P. Bogacki, L. F. Shampine 1989
    "rk23": ButcherData(3, "; 1/2; 0 3/4; 2/9 1/3 4/9", "2/9 1/3 4/9 0", "7/24 1/4 1/3 1/8", 2),
    # J. R. Dormand, P. J. Prince 1980
    "rk45": ButcherData(
        5,
        """; 1/5; 3/40 9/40; 44/45 -56/15 32/9; 19372/6561 -25360/2187 64448/6561 -212/729;
        9017/3168 -355/33 46732/5247 49/176 -5103/18656; 35/384 0 500/1113 125/192 -2187/6784 11/84""",
        "35/384 0 500/1113 125/192 -2187/6784 11/84 0",
        "5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40",
        4,
    ),
    # E. Fehlberg 1969; continued with the weights of order 5
    "rkf45": ButcherData(
        5,
        """; 1/4; 3/32 9/32; 1932/2197 -7200/2197 7296/2197; 439/216 -8 3680/513 -845/4104;
        -8/27 2 -3544/2565 1859/4104 -11/40""",
        "16/135 0 6656/12825 28561/56430 -9/50 2/55",
        "25/216 0 1408/2565 2197/4104 -1/5 0",
        4,
    ),
    # J. H. Verner 1978, the pair of DVERK
    "verner65": ButcherData(
        6,
        """; 1/6; 4/75 16/75; 5/6 -8/3 5/2; -165/64 55/6 -425/64 85/96;
        12/5 -8 4015/612 -11/36 88/255; -8263/15000 124/75 -643/680 -81/250 2484/10625 0;
        3501/1720 -300/43 297275/52632 -319/2322 24068/84065 0 3850/26703""",
        "3/40 0 875/2244 23/72 264/1955 0 125/11592 43/616",
        "13/160 0 2375/5984 5/16 12/85 3/44 0 0",
        5,
    ),
}

IMPLICIT = {
    # F. H. Chipman 1971
    "lobatto3c": ButcherData(4, "1/6 -1/3 1/6; 1/6 5/12 -1/12; 1/6 2/3 1/6", "1/6 2/3 1/6"),
    # E. Hairer, G. Wanner 1996, L-stable
    "sdirk4": ButcherData(
        4,
        """1/4 0 0 0 0; 1/2 1/4 0 0 0; 17/50 -1/25 1/4 0 0; 371/1360 -137/2720 15/544 1/4 0;
        25/24 -49/48 125/16 -85/12 1/4""",
        "25/24 -49/48 125/16 -85/12 1/4",
        "59/48 -17/96 225/32 -85/12 0",
        3,
    ),
    # R. Alexander 1977, L-stable
    "sdirk2": ButcherData(2, "1-sqrt(2)/2 0; sqrt(2)/2 1-sqrt(2)/2", "sqrt(2)/2 1-sqrt(2)/2"),
}

# orders and nodes
COLLOCATION = {
    "implicit euler": (1, "1"),
    "implicit midpoint": (2, "1/2"),
    "trapezoidal": (2, "0, 1"),  # Lobatto IIIA of two stages
    "radau2a": (3, "1/3, 1"),  # Radau IIA of two stages, B. L. Ehle 1969
    "radau2a3": (5, "2/5 - sqrt(6)/10, 2/5 + sqrt(6)/10, 1"),  # Radau IIA of three stages
}


# Collocation methods (Gauss, Radau IIA, the trapezoidal rule), computed from their nodes alone. The polynomial u of
# degree s with u(t) = y and u'(t + c_i h) = f(t + c_i h, u(t + c_i h)) for i = 1, ..., s gives the Runge-Kutta method
# with a_ij = int_0^{c_i} l_j and b_j = int_0^1 l_j, l_j the Lagrange polynomials of c (E. Hairer, C. Lubich, G. Wanner,
# Geometric Numerical Integration, theorem II.1.4). Written with the matrix W_ik = c_i^(k-1): a = (c_i^k / k) W^(-1), b
# = (1/k) W^(-1).

GAUSS_DIGITS = 60
"""Correct decimal digits of the nodes of Gauss methods with 4 and more stages, before they are rounded to float64."""


def collocation(name: str, nodes: Sequence[ScalarLike], order: int) -> Tableau:
    """The `Tableau` of the collocation method with given nodes.

    Parameters
    ----------
    name : str
    nodes : sequence of length s
        Different numbers: strings, integers, fractions.
    order : int
        The claimed order: s, or more if the nodes are those of a quadrature formula of higher order.

    Raises
    ------
    FieldError, ParseError
        If a node is not in an exact field.

    Examples
    --------
    >>> collocation("equal steps", [0, "1/2", 1], order=4)
    <tableau 'equal steps' of order 4, 3 stages, over QQ>
    """
    texts = [str(x) for x in nodes]
    numbers = common_field(texts)
    c: list[Scalar] = [numbers.convert(x) for x in texts]
    if len(set(c)) != len(c):
        raise InputError(f"the nodes of a collocation method are different numbers, got {', '.join(texts)}")
    *a, b = _coefficients(c, numbers)
    return Tableau(a, b, order, c=c, field=numbers, name=name)


def _coefficients(c: list[Scalar], field: Field) -> list[list[Scalar]]:
    """Rows of a, and b as a last row (the integrals to 1)."""
    powers = field.matrix([[x**k for k in range(len(c))] for x in c])
    integrals = field.matrix([[x ** (k + 1) / (k + 1) for k in range(len(c))] for x in [*c, field.one]])
    return (integrals @ powers.inverse()).to_rows()


def gauss(stages: int) -> Tableau:
    """The Gauss method with s stages, from 1 to 7, of order 2 s, up to 3 stages exact, else rounded to float64."""
    if isinstance(stages, bool) or not isinstance(stages, int) or not 1 <= stages <= MAX_ORDER // 2:
        raise InputError(f"a Gauss method has 1 to {MAX_ORDER // 2} stages here, got {stages!r}")
    exact = {
        1: ["1/2"],
        2: ["1/2 - sqrt(3)/6", "1/2 + sqrt(3)/6"],
        3: ["1/2 - sqrt(15)/10", "1/2", "1/2 + sqrt(15)/10"],
    }
    name = f"gauss{stages}"
    if stages in exact:
        return collocation(name, exact[stages], 2 * stages)
    return _in_floats(
        name, _refined(_legendre(stages), (1 + np.polynomial.legendre.leggauss(stages)[0]) / 2), 2 * stages
    )


def radau(stages: int) -> Tableau:
    """The Radau IIA method with s stages, from 2 to 7, of order 2 s - 1, in float64; it is L-stable."""
    if isinstance(stages, bool) or not isinstance(stages, int) or not 2 <= stages <= MAX_ORDER // 2:
        raise InputError(f"a Radau IIA method has 2 to {MAX_ORDER // 2} stages here, got {stages!r}")
    # the nodes are 1 and the zeros of P_s - P_(s-1), divided by x - 1
    high, low = _legendre(stages), [*_legendre(stages - 1), 0]
    difference = [a - b for a, b in zip(high, low, strict=True)]
    starts = np.sort(np.polynomial.polynomial.polyroots([float(c) for c in difference]).real)[:-1]
    return _in_floats(f"radau{2 * stages - 1}", [*_refined(difference, starts), QQ.one], 2 * stages - 1)


def _in_floats(name: str, c: list[Scalar], order: int) -> Tableau:
    *a, b = [[QQ.to_float(x) for x in row] for row in _coefficients(c, QQ)]
    return Tableau(a, b, order, c=[QQ.to_float(x) for x in c], field=RR, name=name)


def _legendre(n: int) -> list[int]:
    """Coefficients of the Legendre polynomial on [0, 1], with value 1 at 1, from the constant one on."""
    return [(-1) ** (n - k) * comb(n, k) * comb(n + k, k) for k in range(n + 1)]


def _refined(ascending: list[int], starts: npt.NDArray[np.float64]) -> list[Scalar]:
    """Zeros of a polynomial near the starts, as rational numbers with `GAUSS_DIGITS` correct digits."""
    scale = 10 ** (GAUSS_DIGITS + 5)
    zeros: list[Scalar] = []
    for start in starts:
        x = Fraction(float(start))
        for _ in range(4):  # Newton, from 8 digits on
            value = sum(c * x**k for k, c in enumerate(ascending))
            slope = sum(k * c * x ** (k - 1) for k, c in enumerate(ascending) if k)
            x = Fraction(round((x - value / slope) * scale), scale)
        zeros.append(QQ.convert(x))
    return zeros


_ALIASES = {
    "explicit euler": "euler",
    "forward euler": "euler",
    "backward euler": "implicit euler",
    "explicit midpoint": "midpoint",
    "gauss1": "implicit midpoint",
    "three eighths": "3/8",
    "crank nicolson": "trapezoidal",
    "bogacki shampine": "rk23",
    "dormand prince": "rk45",
    "fehlberg": "rkf45",
    "dverk": "verner65",
    "radau2a2": "radau2a",
    "radau3": "radau2a",
    "radau5": "radau2a3",
    "radau2a5": "radau9",
}
_GAUSS = re.compile(r"gauss([0-9]+)", re.ASCII)


def tableau(name: str | Tableau) -> Tableau:
    """A classical Runge-Kutta method by name; a `Tableau` is returned as it is.

    Case, spaces, hyphens and underscores do not matter. ``gauss4`` to ``gauss7``, ``radau9`` and ``dop853`` are in
    float64; all others are exact. ``radau3`` and ``radau5`` are other names of ``radau2a`` and ``radau2a3``.

    Parameters
    ----------
    name : str or Tableau
        One of `tableau_names`.

    Examples
    --------
    >>> tableau("rk45")
    <tableau 'rk45' of order 5, 7 stages, embedded order 4, over QQ>
    >>> print(tableau("RK4"))
    0   |
    1/2 | 1/2
    1/2 | 0    1/2
    1   | 0    0    1
    ----+-------------------
        | 1/6  1/3  1/3  1/6
    >>> tableau("Implicit-Midpoint") is tableau("implicit midpoint")
    True
    """
    if isinstance(name, Tableau):
        return name
    if not isinstance(name, str):
        raise InputError(f"expected the name of a tableau, or a Tableau, got {displayed(name)}")
    known = {key_of(x): x for x in tableau_names()} | {key_of(x): y for x, y in _ALIASES.items()}
    key = key_of(name)
    if key in known:
        return _made(known[key])
    near = get_close_matches(key, known, n=1)
    hint = f"did you mean {displayed(known[near[0]])}? " if near else ""
    raise InputError(
        f"no tableau is called {displayed(name)}; {hint}known: {', '.join(tableau_names())}; or make a Tableau"
    )


def tableau_names() -> tuple[str, ...]:
    """Names that `tableau` accepts, explicit methods first, a tuple of strings.

    Examples
    --------
    >>> tableau_names()[:4]
    ('euler', 'midpoint', 'heun', 'ralston')
    """
    return (*EXPLICIT, "dop853", *COLLOCATION, *(f"gauss{s}" for s in range(2, 8)), "radau9", *IMPLICIT)


def key_of(name: str) -> str:
    """A name without what does not matter in it: case, spaces, hyphens and underscores."""
    return re.sub(r"[\s_-]+", "", name.lower())


@cache
def _made(name: str) -> Tableau:
    if name == "dop853":
        return _dop853()
    if name == "radau9":
        return radau(5)
    if match := _GAUSS.fullmatch(name):
        return gauss(int(match[1]))
    if name in COLLOCATION:
        return collocation(name, COLLOCATION[name][1].split(","), COLLOCATION[name][0])
    data = EXPLICIT[name] if name in EXPLICIT else IMPLICIT[name]
    return Tableau(
        [row.split() for row in data.a.split(";")],
        data.b.split(),
        data.order,
        embedded_b=data.embedded.split() or None,
        embedded_order=data.embedded_order,
        name=name,
    )


def _dop853() -> Tableau:
    """The method of order 8 by Dormand and Prince; the embedded weights are those of its error estimate E5."""
    from scipy.integrate import DOP853

    stages = len(DOP853.B)
    return Tableau(
        DOP853.A, DOP853.B, 8, c=DOP853.C, embedded_b=DOP853.B - DOP853.E5[:stages], embedded_order=5, name="dop853"
    )
