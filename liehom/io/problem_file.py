"""Problem of a file: a representation, an initial point, a vector field and the options of an integration.

The vector field is X(m, t) = rho(psi(m, t)) m with psi from "generator", or X itself from "vector_field". Options are
checked when the file is read; the names among them (base, exponential, clock) are looked up at the integration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from liehom.errors import FieldError, FormatError, InputError, ParseError
from liehom.io.json_reader import as_list, shown
from liehom.io.number_lists import vector
from liehom.representations.core.pair import Pair
from liehom.representations.core.representation import Representation
from liehom.scalars import RR, Scalar
from liehom.scalars.fields.grammar import Node, parse
from liehom.typing import Array

if TYPE_CHECKING:
    from liehom.correctors import Step
    from liehom.homogeneous import GeneratorField
    from liehom.integrators import Solution

OPTIONS = ("t_span", "t_eval", "dt", "rtol", "atol", "base", "order", "exponential", "clock")
NUMERICAL = ("generator", "vector_field", *OPTIONS)
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh")
MAX_ORDER = 100
"""Largest order that a file may ask for."""
BASE = "lietaylor"


@final
@dataclass(frozen=True, slots=True)
class Problem:
    """Problem of a representation file: the representation, the initial point, the vector field and the options.

    Attributes
    ----------
    representation : Representation
    point : tuple or None
        The point as numbers of the representation's field; None if the file has no point or its numbers are not there.
    start : tuple of float or None
        The initial point: the point rounded to float64.
    generator : tuple of Node or None
        psi: one parsed coefficient per given matrix, in the names m0, m1, ..., t (`liehom.scalars.fields.grammar`).
    options : mapping
        The options of the file, from t_span, t_eval, dt, rtol, atol, base, order, exponential and clock.
    vector_field : tuple of Node or None
        X: one parsed component per coordinate of m, if the file has a vector field instead of a generator.

    Examples
    --------
    >>> import liehom as lh
    >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [1, 0], "generator": ["1 + m0**2"], "dt": 0.1}'
    >>> problem = lh.io.loads(text, problem=True)
    >>> problem.start, problem.options["dt"], problem.pair()
    ((1.0, 0.0), 0.1, <pair of dimensions 1/0 over QQ>)
    """

    representation: Representation
    point: tuple[Scalar, ...] | None
    start: tuple[float, ...] | None
    generator: tuple[Node, ...] | None
    options: Mapping[str, Any]
    vector_field: tuple[Node, ...] | None = None

    def pair(self) -> Pair:
        """Pair (algebra, isotropy subalgebra of the point); `FormatError` if no point of the field is given."""
        if self.point is None:
            why = "the file has no 'point'" if self.start is None else "the point has floats, the matrices are exact"
            raise FormatError(f"{why}, so it describes no pair")
        return self.representation.pair(self.point)

    def field(self) -> GeneratorField:
        """Vector field as a GeneratorField; a file's vector field gets the generator of minimal norm.

        Raises
        ------
        FormatError
            If the file states neither a generator nor a vector field.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "vector_field": ["-t*m1", "t*m0"]}'
        >>> lh.io.loads(text, problem=True).field()
        <time-dependent generator field of <representation of <Lie algebra of dimension 1 over QQ> on QQ^2>>
        """
        from liehom.homogeneous import GeneratorField

        if self.generator is not None:
            return GeneratorField(self.representation, self.generator)
        if self.vector_field is not None:
            return GeneratorField.from_vector_field(self.representation, self.vector_field)
        raise FormatError("the file has neither 'generator' nor 'vector_field', so there is no field to integrate")

    def step(self, base: str | None = None, order: int | None = None) -> Step:
        """Step with the given base and order; without them the options of the file, else "lietaylor".

        Raises
        ------
        InputError
            If the base is unknown; the message lists the names.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "base": "euler", "order": 3}'
        >>> problem = lh.io.loads(text, problem=True)
        >>> problem.step(), problem.step("heun"), problem.step(order=1)
        (Corrected(Euler(), order=3), Corrected(Heun(), order=3), Euler())
        """
        from liehom.integrators.named import step_named

        named = self.options.get("base", BASE) if base is None else base
        return step_named(named, self.options.get("order") if order is None else order)

    def integrate(self, *, base: str | None = None, order: int | None = None, **overrides: Any) -> Solution:
        """Solution from the initial point over t_span, with the options of the file.

        Parameters
        ----------
        base, order : optional
            As for `step`.
        **overrides
            Arguments of `liehom.integrate`; each overrides the option of the same name.

        Raises
        ------
        FormatError
            If the vector field, the point or t_span is missing.
        InputError
            If the vector field is not finite at the initial point, and as `liehom.integrate`.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [1, 0], "generator": ["1"], "t_span": [0, "1/2"]}'
        >>> solution = lh.io.loads(text, problem=True).integrate()
        >>> solution.y[:, -1].round(6).tolist()
        [0.877583, 0.479426]
        """
        from liehom.integrators import integrate

        field = self.field()
        options = {key: x for key, x in self.options.items() if key not in ("base", "order")} | overrides
        step = options.pop("step", None) or self.step(base, order)
        t_span = options.pop("t_span", None)
        if t_span is None:
            raise FormatError("the file has no 't_span': add \"t_span\": [start, end], or give one")
        start = options.pop("y0", None)
        if start is None:
            start = self.checked_start(float(t_span[0]))
        return integrate(field, t_span, start, step=step, **options)

    def checked_start(self, t: float) -> Array:
        """Initial point as an array of shape (N,), after a check that the vector field is finite there at time t.

        Raises
        ------
        FormatError
            If the file has no point.
        InputError
            If a component of the generator or vector field is not finite at the initial point.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [0, 1], "generator": ["1/m0"]}'
        >>> lh.io.loads(text, problem=True).checked_start(0.0)
        Traceback (most recent call last):
        ...
        liehom.errors.InputError: generator[0] is inf at the start m = (0.0, 1.0), t = 0.0; ...
        """
        import numpy as np

        if self.start is None:
            raise FormatError("the file has no 'point', so there is no start: add \"point\": [...]")
        for what, trees in (("generator", self.generator), ("vector_field", self.vector_field)):
            for i, tree in enumerate(trees or ()):
                value = _value(tree, np.array(self.start), t, f"{what}[{i}]")
                if not np.isfinite(value):
                    raise InputError(
                        f"{what}[{i}] is {value} at the start m = {shown_point(self.start)}, t = {t}; "
                        "take another point, or a field that is defined there"
                    )
        return np.array(self.start)


def _value(tree: Node, m: Array, t: float, what: str) -> float:
    """Value of one component at a point."""
    import numpy as np

    from liehom.homogeneous.fields.components import Components

    try:
        with np.errstate(all="ignore"):
            return float(Components([tree], len(m), (1,), what)(m, np.float64(t))[0])
    except ParseError as error:
        raise ParseError(f"{what}: {error}") from None
    except (FieldError, OverflowError):
        raise InputError(f"{what} has a number beyond the range of float64 (1.8e308)") from None


def shown_point(point: tuple[float, ...], most: int = 8) -> str:
    """String of a point for messages: all coordinates, or the first `most`."""
    return str(point) if len(point) <= most else f"({', '.join(map(repr, point[:most]))}, ...)"


# -- from JSON -------------------------------------------------------------------------------------------
def read_fields(data: Mapping[str, Any], count: int, size: int) -> dict[str, tuple[Node, ...]]:
    """Parsed "generator" (one string per given matrix) or "vector_field" (one string per coordinate)."""
    found = {key: data[key] for key in ("generator", "vector_field") if key in data}
    if len(found) == 2:
        raise FormatError("the file has a 'generator' and a 'vector_field', expected one of them")
    wanted = {"generator": (count, "given matrix"), "vector_field": (size, "coordinate")}
    return {key: _read_expressions(key, value, *wanted[key], size) for key, value in found.items()}


def _read_expressions(key: str, value: object, count: int, per: str, size: int) -> tuple[Node, ...]:
    expressions = as_list(value, key)
    if len(expressions) != count:
        raise FormatError(f"{key} has {len(expressions)} entries, expected one per {per}, {count}")
    names = frozenset([*(f"m{i}" for i in range(size)), "t"])
    trees = []
    for a, text in enumerate(expressions):
        if not isinstance(text, str):
            raise FormatError(f"{key}[{a}] is {shown(text)}, expected a string such as '1 + m0**2'")
        try:
            trees.append(parse(text, names, FUNCTIONS))
        except ParseError as error:
            raise ParseError(f"{key}[{a}]: {error}") from None
    return tuple(trees)


def read_options(data: Mapping[str, Any]) -> dict[str, Any]:
    """Checked options of a JSON object, from those in `OPTIONS`.

    Raises
    ------
    FormatError, ParseError
        If an option is not of its type; names the option.

    Examples
    --------
    >>> read_options({"t_span": [1, "1/2"], "dt": 0.1, "base": "heun"})
    {'t_span': (1.0, 0.5), 'dt': 0.1, 'base': 'heun'}
    """
    options: dict[str, Any] = {}
    for key in ("t_span", "t_eval"):
        if key in data:
            options[key] = tuple(vector(data[key], key, floats=True).numbers(RR))
    if "t_span" in options and len(options["t_span"]) != 2:
        raise FormatError(f"t_span has {len(options['t_span'])} entries, expected [start, end]")
    for key in ("dt", "rtol", "atol"):
        if key in data:
            (options[key],) = vector([data[key]], key, floats=True).numbers(RR)
            if options[key] <= 0:
                raise FormatError(f"{key} is {shown(data[key])}, expected a positive number")
    for key in ("base", "exponential", "clock"):
        if key in data:
            if not isinstance(data[key], str) or not data[key].isprintable() or not 0 < len(data[key]) <= 100:
                raise FormatError(f"{key} is {shown(data[key])}, expected a name")
            options[key] = data[key]
    if "order" in data:
        if type(data["order"]) is not int or not 1 <= data["order"] <= MAX_ORDER:
            raise FormatError(f"order is {shown(data['order'])}, expected an integer from 1 to {MAX_ORDER}")
        options["order"] = data["order"]
    return options
