"""Coefficients of classical Runge-Kutta methods as fractions, from which `tableau` makes each `Tableau`.

Rows of a are separated by ``;``, entries by spaces. Explicit methods give the entries below the diagonal. The data is
not trusted: each `Tableau` proves its order.
"""

from __future__ import annotations

from typing import NamedTuple


class ButcherData(NamedTuple):
    """Coefficients of one method, with the weights and order of an embedded method if it has one, and the source."""

    order: int
    a: str
    b: str
    embedded: str = ""
    embedded_order: int | None = None
    source: str = ""


class CollocationData(NamedTuple):
    """One collocation method: its order, its nodes separated by commas, and its usual name."""

    order: int
    nodes: str
    source: str = ""


EXPLICIT = {
    "euler": ButcherData(1, "", "1", source="L. Euler 1768"),
    "midpoint": ButcherData(2, "; 1/2", "0 1", source="C. Runge 1895"),
    "heun": ButcherData(2, "; 1", "1/2 1/2", "1 0", 1, "the explicit trapezoidal rule, with Euler embedded"),
    "ralston": ButcherData(2, "; 2/3", "1/4 3/4", source="A. Ralston 1962: least error bound of two stages"),
    "kutta3": ButcherData(3, "; 1/2; -1 2", "1/6 2/3 1/6", source="W. Kutta 1901"),
    "heun3": ButcherData(3, "; 1/3; 0 2/3", "1/4 0 3/4", source="K. Heun 1900"),
    "ssprk3": ButcherData(3, "; 1; 1/4 1/4", "1/6 1/6 2/3", source="C.-W. Shu, S. Osher 1988"),
    "rk4": ButcherData(4, "; 1/2; 0 1/2; 0 0 1", "1/6 1/3 1/3 1/6", source="W. Kutta 1901"),
    "3/8": ButcherData(4, "; 1/3; -1/3 1; 1 -1 1", "1/8 3/8 3/8 1/8", source="W. Kutta 1901"),
    "rk23": ButcherData(
        3,
        "; 1/2; 0 3/4; 2/9 1/3 4/9",
        "2/9 1/3 4/9 0",
        "7/24 1/4 1/3 1/8",
        2,
        "P. Bogacki, L. F. Shampine 1989",
    ),
    "rk45": ButcherData(
        5,
        """; 1/5; 3/40 9/40; 44/45 -56/15 32/9; 19372/6561 -25360/2187 64448/6561 -212/729;
        9017/3168 -355/33 46732/5247 49/176 -5103/18656; 35/384 0 500/1113 125/192 -2187/6784 11/84""",
        "35/384 0 500/1113 125/192 -2187/6784 11/84 0",
        "5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40",
        4,
        "J. R. Dormand, P. J. Prince 1980",
    ),
    "rkf45": ButcherData(
        5,
        """; 1/4; 3/32 9/32; 1932/2197 -7200/2197 7296/2197; 439/216 -8 3680/513 -845/4104;
        -8/27 2 -3544/2565 1859/4104 -11/40""",
        "16/135 0 6656/12825 28561/56430 -9/50 2/55",
        "25/216 0 1408/2565 2197/4104 -1/5 0",
        4,
        "E. Fehlberg 1969; continued with the weights of order 5",
    ),
    "verner65": ButcherData(
        6,
        """; 1/6; 4/75 16/75; 5/6 -8/3 5/2; -165/64 55/6 -425/64 85/96;
        12/5 -8 4015/612 -11/36 88/255; -8263/15000 124/75 -643/680 -81/250 2484/10625 0;
        3501/1720 -300/43 297275/52632 -319/2322 24068/84065 0 3850/26703""",
        "3/40 0 875/2244 23/72 264/1955 0 125/11592 43/616",
        "13/160 0 2375/5984 5/16 12/85 3/44 0 0",
        5,
        "J. H. Verner 1978, the pair of DVERK",
    ),
}

IMPLICIT = {
    "lobatto3c": ButcherData(
        4, "1/6 -1/3 1/6; 1/6 5/12 -1/12; 1/6 2/3 1/6", "1/6 2/3 1/6", source="F. H. Chipman 1971"
    ),
    "sdirk4": ButcherData(
        4,
        """1/4 0 0 0 0; 1/2 1/4 0 0 0; 17/50 -1/25 1/4 0 0; 371/1360 -137/2720 15/544 1/4 0;
        25/24 -49/48 125/16 -85/12 1/4""",
        "25/24 -49/48 125/16 -85/12 1/4",
        "59/48 -17/96 225/32 -85/12 0",
        3,
        "E. Hairer, G. Wanner 1996, L-stable",
    ),
    "sdirk2": ButcherData(
        2, "1-sqrt(2)/2 0; sqrt(2)/2 1-sqrt(2)/2", "sqrt(2)/2 1-sqrt(2)/2", source="R. Alexander 1977, L-stable"
    ),
}

COLLOCATION = {
    "implicit euler": CollocationData(1, "1"),
    "implicit midpoint": CollocationData(2, "1/2"),
    "trapezoidal": CollocationData(2, "0, 1", "Lobatto IIIA of two stages"),
    "radau2a": CollocationData(3, "1/3, 1", "Radau IIA of two stages, B. L. Ehle 1969"),
    "radau2a3": CollocationData(5, "2/5 - sqrt(6)/10, 2/5 + sqrt(6)/10, 1", "Radau IIA of three stages"),
}
