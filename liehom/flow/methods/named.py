"""Steps by name, for files and the command line: "euler", "heun", "taylor", "lietaylor", "rk4", "cg3", ...

A name with an order above that of the method gives the corrected step, Corrected(step, order). For symplectic steps it
gives their composition, Composition(step, order).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from difflib import get_close_matches
from functools import partial

from liehom.base.errors import InputError, checked_integer, displayed
from liehom.flow.methods.composition import Composition, Splitting
from liehom.flow.methods.low_order import BackwardEuler, CommutatorFree4, CrouchGrossman3, Euler, Heun, LieTaylor
from liehom.flow.methods.midpoint import IsospectralMidpoint, MoserVeselov, SphericalMidpoint, VariationalMidpoint
from liehom.flow.methods.rkmk import RKMK
from liehom.flow.methods.stiff import METHODS as ROSENBROCK, ExponentialRosenbrock, Rosenbrock, StiffRKMK
from liehom.flow.methods.tableaux import key_of, tableau, tableau_names
from liehom.flow.methods.taylor import Taylor
from liehom.flow.steps.corrected import Corrected
from liehom.flow.steps.step import Step

DEFAULT_ORDER = 6
_SERIES: dict[str, type[Taylor | LieTaylor]] = {"taylor": Taylor, "lietaylor": LieTaylor}
_SYMPLECTIC: dict[str, Callable[[], Step]] = {
    "spherical midpoint": SphericalMidpoint,
    "isospectral midpoint": IsospectralMidpoint,
    "variational midpoint": VariationalMidpoint,
    "moser-veselov": MoserVeselov,
    "splitting": Splitting,
}
_STEPS: dict[str, Callable[[], Step]] = {
    "euler": Euler,
    "backward euler": BackwardEuler,
    "heun": Heun,
    **{name: partial(step, DEFAULT_ORDER) for name, step in _SERIES.items()},
    "cg3": CrouchGrossman3,
    "cf4": CommutatorFree4,
    **{name: partial(StiffRKMK, name) for name in ("radau3", "radau5", "radau9", "sdirk4")},
    **{name: partial(Rosenbrock, name) for name in ROSENBROCK},
    **{f"exprb{order}": partial(ExponentialRosenbrock, order) for order in (2, 3, 4)},
    **_SYMPLECTIC,
}
_OF_ORDER = re.compile(r"(taylor|lietaylor)([0-9]{1,3})", re.ASCII)
_ALIASES = {"impliciteuler": "backwardeuler", "expliciteuler": "euler", "forwardeuler": "euler"}


def step_named(base: str, order: int | None = None) -> Step:
    """The step with a name, corrected if the order is above its own.

    Parameters
    ----------
    base : str
        One of `step_names`; case, spaces, hyphens and underscores do not matter. "taylor" and
        "lietaylor" take any order themselves, 6 by default. "lietaylor4" is `LieTaylor(4)`, which a higher order
        corrects. Names of stiff methods ("radau5", "sdirk4", "rodas4", "exprb4") give the steps of docs/stiff.md, those
        of symplectic steps ("spherical midpoint", "splitting") the steps of docs/lie-poisson.md. The name of another
        tableau gives the Runge-Kutta-Munthe-Kaas step with that tableau.
    order : int, optional
        The order to reach. Above that of the base it gives `Corrected(step, order)`, for a symplectic step
        `Composition(step, order)`, else the base itself.

    Examples
    --------
    >>> step_named("euler", 4), step_named("Heun"), step_named("lietaylor", 8)
    (Corrected(Euler(), order=4), Heun(), LieTaylor(n=8))
    >>> step_named("backward euler", 1), step_named("splitting", 4)
    (BackwardEuler(), Composition(step=Splitting(), order=4, scheme='suzuki'))
    """
    if not isinstance(base, str):
        raise InputError(
            f"a base is a name such as 'euler' or 'rk4', got {displayed(base)}; known: {', '.join(step_names())}"
        )
    if order is not None:
        order = checked_integer(order, "the order")
    key = key_of(base)
    if key in _SERIES and order is not None:
        return _SERIES[key](order)
    step = _plain(_ALIASES.get(key, key), base)
    if order is None or order <= step.order:
        return step
    return Composition(step, order) if key in map(key_of, _SYMPLECTIC) else Corrected(step, order)


def step_names() -> tuple[str, ...]:
    """Names that `step_named` accepts, a tuple of strings.

    Examples
    --------
    >>> step_names()[:6]
    ('euler', 'backward euler', 'heun', 'taylor', 'lietaylor', 'cg3')
    >>> "rk4" in step_names()
    True
    """
    return (*_STEPS, *(name for name in tableau_names() if key_of(name) not in {*map(key_of, _STEPS), *_ALIASES}))


def _plain(key: str, base: str) -> Step:
    """The uncorrected step of a name without spaces."""
    own = {key_of(name): step for name, step in _STEPS.items()}
    if key in own:
        return own[key]()
    if match := _OF_ORDER.fullmatch(key):
        return _SERIES[match[1]](int(match[2]))
    try:
        return RKMK(tableau(base))
    except InputError:
        raise _unknown(base) from None


def _unknown(base: str) -> InputError:
    names = step_names()
    near = get_close_matches(base.lower(), names, n=1)
    hint = f"did you mean {displayed(near[0])}? " if near else ""
    if base.lower() in ("corrected", "conserving"):
        hint = f"liehom.{base.capitalize()} takes a step and is given as an object; "
    shown = repr(base) if len(base) <= 60 else repr(base[:57] + "...")
    return InputError(f"no step is called {shown}; {hint}known: {', '.join(names)}")
