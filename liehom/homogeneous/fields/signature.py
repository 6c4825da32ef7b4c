"""How a user's function of a point is called: f(m), f(m, t), f(m, t, args) or f(m, args), by its parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

from liehom.errors import InputError
from liehom.pytrees import unwrapped
from liehom.typing import Pytree

Evaluated: TypeAlias = Callable[[Any, Any], Any]
"""A function of (m, t)."""

TIMES = ("t", "time")
"""Names of a parameter that is the time, so that it cannot be the point."""


class CallForm(NamedTuple):
    """The parameters of a function of a point, besides the point.

    Attributes
    ----------
    time, args : str or None
        The names of the parameters for the time and for args; None if there are none.
    time_keyword, args_keyword : bool
        Whether they must be given by name.
    time_needed : bool
        Whether the time has no default.
    more : tuple of str
        Further parameters that are required.
    """

    time: str | None
    args: str | None
    time_keyword: bool
    args_keyword: bool
    time_needed: bool
    more: tuple[str, ...]


def call_form(function: Callable[..., Any], what: str) -> CallForm:
    """The `CallForm` of a function.

    A second parameter without a default, or a parameter named t, is the time. A third parameter without a default, or a
    parameter named args, is args.

    Parameters
    ----------
    function : callable
    what : str
        Its name in error messages.

    Raises
    ------
    InputError
        If its first parameter is named t, so that the point would be taken for the time.

    Examples
    --------
    >>> call_form(lambda m, t, args: m, "psi")[:2], call_form(lambda m, args: m, "psi")[:2]
    (('t', 'args'), (None, 'args'))
    >>> call_form(lambda t, m: m, "psi")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: psi has the parameters (t, m), expected the point first: (m, t). With (t, m) it would ...
    """
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return CallForm(None, None, False, False, False, ())
    parameters = list(signature.parameters.values())
    positional = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if positional and positional[0].name in TIMES:
        raise InputError(
            f"{what} has the parameters {signature}, expected the point first: (m, t). With {signature} it would get "
            "the point as the time"
        )
    keywords = {p.name: p for p in parameters if p.kind is p.KEYWORD_ONLY}
    needed = [p for p in positional if p.default is p.empty]
    named = {p.name: p for p in positional[1:]}
    args = named.get("args") or keywords.get("args") or next((p for p in needed[2:3] if p.name != "t"), None)
    time = next((p for p in needed[1:2] if p is not args), None) or named.get("t") or keywords.get("t")
    more = [p.name for p in needed[1:] if p is not args and p is not time]
    more += [p.name for p in keywords.values() if p.default is p.empty and p is not args and p is not time]
    if not positional and not any(p.kind is p.VAR_POSITIONAL for p in parameters):
        more.append("no m")
    return CallForm(
        None if time is None else time.name,
        None if args is None else args.name,
        time is not None and (time not in positional or positional.index(time) != 1),
        args is not None and (args not in positional or positional.index(args) != (1 if time is None else 2)),
        time is not None and time.default is time.empty,
        tuple(more),
    )


def called_as_event(function: Callable[..., Any], args: Pytree, what: str) -> Evaluated:
    """An event function as a function of (t, y), in whichever order its parameters are.

    The order is (t, y), as in scipy's solve_ivp. If the second parameter is named t, it is (m, t), as that of psi.
    A third parameter without a default, or a parameter named args, is args.

    Parameters
    ----------
    function : callable
    args : pytree
    what : str
        Its name in error messages.

    Raises
    ------
    InputError
        If it takes args, and there are none.

    Examples
    --------
    >>> [called_as_event(g, 3, "g")(1, 2) for g in (lambda t, y: t - y, lambda m, t: t - m, lambda t, y, args: args)]
    [-1, -1, 3]
    """
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        return function
    positional = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    keyword = any(p.name == "args" and p.kind is p.KEYWORD_ONLY for p in parameters)
    takes_args = keyword or any(p.name == "args" or p.default is p.empty for p in positional[2:])
    swapped = len(positional) > 1 and positional[1].name in TIMES and positional[0].name not in TIMES
    if not takes_args:
        return (lambda t, y: function(y, t)) if swapped else function
    if args is None:
        raise InputError(f"{what} takes args, but none were given: give args=...")
    given: dict[str, Any] = {"args": unwrapped(args)} if keyword else {}
    more = () if keyword else (unwrapped(args),)
    if swapped:
        return lambda t, y: function(y, t, *more, **given)
    return lambda t, y: function(t, y, *more, **given)


def takes_time(function: Callable[..., Any], what: str = "the function") -> bool:
    """Whether a function is called with (m, t), and not with m alone.

    Examples
    --------
    >>> takes_time(lambda m: m), takes_time(lambda m, t: m), takes_time(lambda m, scale=2.0: m)
    (False, True, False)
    """
    return call_form(function, what).time is not None


def checked_form(source: Callable[..., Any], what: str, time_dependent: bool | None) -> tuple[CallForm, bool]:
    """The `CallForm` of a user's function, and whether it depends on the time.

    Raises
    ------
    InputError
        If it has other parameters.

    Examples
    --------
    >>> checked_form(lambda m, t: m, "psi", None)[1]
    True
    """
    form = call_form(source, what)
    if form.more:
        raise InputError(
            f"{what} is a function with the parameters {inspect.signature(source)}: expected (m) or (m, t), "
            "or (m, t, args); bind others with functools.partial or a default"
        )
    timed = form.time is not None if time_dependent is None else bool(time_dependent)
    return form, timed


def called(source: Callable[..., Any], form: CallForm, timed: bool) -> Evaluated:
    """A function without args as a function of (m, t).

    Examples
    --------
    >>> f = lambda m, *, t: m + t
    >>> called(f, call_form(f, "f"), True)(1, 2)
    3
    """
    if not (timed or form.time_needed):
        return lambda m, t: source(m)
    if form.time_keyword:
        name = str(form.time)
        return lambda m, t: source(m, **{name: t})
    return source


def called_with(source: Callable[..., Any], form: CallForm, timed: bool, args: Pytree) -> Evaluated:
    """A function with args as a function of (m, t).

    Examples
    --------
    >>> f = lambda m, t, args: m + args["gain"] * t
    >>> called_with(f, call_form(f, "f"), True, {"gain": 10})(1, 2)
    21
    """
    timed = timed or form.time_needed
    if timed and not form.time_keyword and not form.args_keyword:
        return lambda m, t: source(m, t, args)
    if not timed and not form.args_keyword:
        return lambda m, t: source(m, args)
    fixed = {str(form.args): args}
    if not timed:
        return lambda m, t: source(m, **fixed)
    name = str(form.time)
    return lambda m, t: source(m, **{name: t}, **fixed)
