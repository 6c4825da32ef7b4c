"""Classical Runge-Kutta methods by name; each proves its order at the first request.

The coefficients are in `tableaux_data`, except that those of collocation methods are computed from their nodes
(`collocation`) and dop853 is read from ``scipy.integrate.DOP853``.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from functools import cache

from liehom.errors import InputError, displayed
from liehom.integrators.tableaux.collocation import collocation, gauss, radau
from liehom.integrators.tableaux.tableau import Tableau
from liehom.integrators.tableaux.tableaux_data import COLLOCATION, EXPLICIT, IMPLICIT, ButcherData

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

    Raises
    ------
    InputError
        If the name is not known; the message lists the names.

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
    known = {_key(x): x for x in tableau_names()} | {_key(x): y for x, y in _ALIASES.items()}
    key = _key(name)
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


def _key(name: str) -> str:
    return re.sub(r"[\s_-]+", "", name.lower())


@cache
def _made(name: str) -> Tableau:
    if name == "dop853":
        return _dop853()
    if name == "radau9":
        return radau(5)
    if found := _GAUSS.fullmatch(name):
        return gauss(int(found[1]))
    if name in COLLOCATION:
        return collocation(name, COLLOCATION[name].nodes.split(","), COLLOCATION[name].order)
    return _from_data(name, EXPLICIT[name] if name in EXPLICIT else IMPLICIT[name])


def _from_data(name: str, data: ButcherData) -> Tableau:
    return Tableau(
        name,
        [row.split() for row in data.a.split(";")],
        data.b.split(),
        data.order,
        embedded_b=data.embedded.split() or None,
        embedded_order=data.embedded_order,
    )


def _dop853() -> Tableau:
    """The method of order 8 by Dormand and Prince; the embedded weights are those of its error estimate E5."""
    from scipy.integrate import DOP853

    stages = len(DOP853.B)
    return Tableau(
        "dop853", DOP853.A, DOP853.B, 8, c=DOP853.C, embedded_b=DOP853.B - DOP853.E5[:stages], embedded_order=5
    )
