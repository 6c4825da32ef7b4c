"""Symbols of a problem: coordinates, time, parameters and constraints, between sympy and a field of functions.

Expressions are read into elements (exactly: no floats), and elements are written as factorized expressions.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, final

from liehom.correctors.symbolic.exact_range import object_array
from liehom.errors import FieldError, InputError, ParseError, ShapeError
from liehom.homogeneous.maps import action_map
from liehom.representations import Representation
from liehom.scalars import QQ
from liehom.scalars.fields.grammar import evaluate, parse
from liehom.scalars.functions.function_field import FunctionField, RationalFunction
from liehom.typing import Expression, Number, Values

ExpressionLike: TypeAlias = str | Number | Expression
"""A sympy expression, a string of the grammar, or a rational number."""

FieldPolynomial: TypeAlias = Any
"""A polynomial of a `FunctionField`, by python-flint."""

MAX_TERMS_TO_FACTOR = 3000
_COORDINATE = re.compile(r"m[0-9]+", re.ASCII)
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*", re.ASCII)


@final
@dataclass(frozen=True, slots=True)
class Symbols:
    """Coordinates, time and parameters as sympy symbols and as elements of a field.

    Attributes
    ----------
    names : tuple of str
        m0, ..., m(N-1), t, and the parameters: the variables of the field.
    size : int
        N.
    symbols : dict of str to sympy symbol
        The symbols of the user's expressions, and new ones for names in strings.
    field : FunctionField
    constraints : tuple of sympy expressions

    Examples
    --------
    >>> import liehom as lh
    >>> symbols, psi = read_symbols(lh.defining(lh.so(2)), ["a*m0/2"], None, None)
    >>> symbols.names, psi[0], symbols.constraints
    (('m0', 'm1', 't', 'a'), a*m0/2, (m0**2 + m1**2 - 1,))
    """

    names: tuple[str, ...]
    size: int
    symbols: dict[str, Any]
    field: FunctionField
    constraints: tuple[Any, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Tuple of the names of the parameters."""
        return self.names[self.size + 1 :]

    @property
    def point(self) -> list[RationalFunction]:
        """List of the coordinates as elements of the field."""
        return list(self.field.variables[: self.size])

    @property
    def time(self) -> RationalFunction:
        """The time as an element of the field."""
        return self.field.variables[self.size]

    def depends_on_time(self, components: Sequence[Any]) -> bool:
        """Whether one of the expressions contains t."""
        return any("t" in {s.name for s in x.free_symbols} for x in components)

    def generator(self, components: Sequence[Any]) -> Callable[..., Any]:
        """Function (m) or (m, t) of the expressions, on arrays of elements and on Jets."""
        from_parameters = dict(zip(self.parameters, self.field.variables[self.size + 1 :], strict=True))

        def psi(m: Values, t: Values | RationalFunction) -> list[Any]:
            scope: dict[str, Any] = {**from_parameters, "t": t}
            scope.update({f"m{i}": m[..., i] for i in range(self.size)})
            zero = 0 * m[..., 0]
            return [zero + evaluated(x, scope, self.field) for x in components]

        return psi if self.depends_on_time(components) else lambda m: psi(m, self.time)

    def element(self, value: ExpressionLike) -> RationalFunction:
        """An expression in the symbols, a string or a number as an element of the field."""
        expression = read_expression(value, "the expression")
        unknown = sorted({s.name for s in expression.free_symbols} - set(self.names))
        if unknown:
            raise InputError(f"{value} has the symbols {unknown}; known are {', '.join(self.names)}")
        scope = dict(zip(self.names, self.field.variables, strict=True))
        made: RationalFunction = evaluated(expression, scope, self.field) + self.field.zero
        return made

    def chunks(self, p: FieldPolynomial, size: int) -> list[Any]:
        """List of expressions of at most `size` terms with the polynomial p as their sum."""
        terms = list(p.terms())
        ring = self.field.ring.context
        return [self._polynomial(ring.from_dict(dict(terms[i : i + size]))) for i in range(0, len(terms), size)]

    # -- back to sympy -----------------------------------------------------------------------------------
    def _polynomial(self, p: FieldPolynomial) -> Expression:
        import sympy

        symbols = [self.symbols[name] for name in self.names]
        terms = {tuple(map(int, e)): sympy.Rational(int(c.p), int(c.q)) for e, c in p.terms()}
        return sympy.Poly.from_dict(terms, *symbols).as_expr() if terms else sympy.Integer(0)

    def factors(self, element: RationalFunction, *, short: bool = False) -> tuple[Any, list[tuple[Any, int]]]:
        """(rational number, [(polynomial, exponent), ...]); `short` prefers few terms to homogeneous factors."""
        if not element:
            return QQ.zero, []
        if len(element.numerator) > MAX_TERMS_TO_FACTOR:
            content, factors = QQ.one, [(element.numerator, 1)]
            factors += [(self.field.atoms[i], -k) for i, k in element.powers]
        else:
            content, factors = element.factors()
        return QQ.convert(content), [(self.field.ring.shortest(p) if short else p, k) for p, k in factors]

    def expression(self, element: RationalFunction) -> Expression:
        """An element as a factorized sympy expression of few terms."""
        import sympy

        content, factors = self.factors(element, short=True)
        above = [self._polynomial(p) ** k for p, k in factors if k > 0]
        below = [self._polynomial(p) ** -k for p, k in factors if k < 0]
        number = sympy.Integer(int(content.p)), sympy.Integer(int(content.q))
        return sympy.Mul(number[0], *above) / sympy.Mul(number[1], *below)

    def nonvanishing(self, elements: Iterable[Any]) -> Expression:
        """Product of the different factors of the denominators of elements and lists of elements."""
        import sympy

        used: set[int] = set()
        for element in elements:
            for x in element if isinstance(element, list) else [element]:
                used |= {i for i, _ in x.powers}
        return sympy.Mul(*(self._polynomial(self.field.ring.shortest(self.field.atoms[i])) for i in sorted(used)))


# -- reading ---------------------------------------------------------------------------------------------
def read_symbols(
    representation: Representation,
    psi: Sequence[ExpressionLike],
    constraints: Sequence[Any] | None,
    parameters: Sequence[Any] | None,
    others: Sequence[Any] = (),
) -> tuple[Symbols, list[Any]]:
    """(`Symbols` of a problem, components of psi as expressions).

    Parameters
    ----------
    representation, psi, constraints, parameters
        See `liehom.correctors.closed_form.closed_form`.
    others : sequence of expressions
        Further expressions whose symbols are used for the coordinates.

    Raises
    ------
    FieldError, InputError, ShapeError

    Examples
    --------
    >>> import liehom as lh
    >>> read_symbols(lh.defining(lh.so(2)), ["b*m0"], None, ["a"])
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: psi[0] has the unknown symbol b; known are m0, m1, t, a
    """
    if representation.field != QQ:
        raise FieldError(f"closed forms are computed over QQ, the representation is over {representation.field}")
    n, dimension = representation.size, representation.algebra.dimension
    if isinstance(psi, str | bytes) or not isinstance(psi, Iterable):
        raise InputError(f"psi is {psi!r}: expected a list of {dimension} expressions")
    given = list(psi)
    if len(given) not in (representation.given, dimension):
        raise ShapeError(f"psi has {len(given)} components, expected {dimension}")
    coordinates = [f"m{i}" for i in range(n)]
    base = [*coordinates, "t"]
    declared = None if parameters is None else [_declared(p, base) for p in parameters]
    components = [read_expression(x, f"psi[{i}]") for i, x in enumerate(given)]
    polynomials = _default_constraints(representation) if constraints is None else list(constraints)
    bounds = [read_expression(x, f"constraints[{i}]") for i, x in enumerate(polynomials)]
    symbols = {s.name: s for x in (*bounds, *components) for s in sorted(x.free_symbols, key=str)}
    for x in (*others, *polynomials, *given):  # the symbols of the user's expressions, before those in strings
        symbols |= {s.name: s for s in getattr(x, "free_symbols", ()) if s.name in base or s.name in symbols}
    named = [(f"psi[{i}]", x) for i, x in enumerate(components)] + [
        (f"constraints[{i}]", x) for i, x in enumerate(bounds)
    ]
    for what, x in named:
        for name in sorted(s.name for s in x.free_symbols):
            if name not in base and (name not in declared if declared is not None else _COORDINATE.fullmatch(name)):
                raise InputError(
                    f"{what} has the unknown symbol {name}; known are {', '.join([*base, *(declared or [])])}"
                )
    others = sorted(set(symbols) - set(base), key=_natural) if declared is None else declared
    names = (*base, *others)
    return _with_grading(representation, names, n, _filled(symbols, names, parameters), bounds, components), components


def _filled(symbols: dict[str, Any], names: Sequence[str], parameters: Sequence[Any] | None) -> dict[str, Any]:
    import sympy

    own = {p.name: p for p in parameters or [] if hasattr(p, "name")}
    return {name: symbols.get(name, own.get(name, sympy.Symbol(name))) for name in names}


def _declared(parameter: Expression | str, taken: Sequence[str]) -> str:
    name = getattr(parameter, "name", parameter)
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name in taken or _COORDINATE.fullmatch(name):
        raise InputError(f"{parameter!r} cannot be a parameter: names are words other than m0, m1, ..., and t")
    return name


def _natural(name: str) -> list[Any]:
    return [(0, int(x), "") if x.isdigit() else (1, 0, x) for x in re.findall(r"[0-9]+|[^0-9]+", name)]


def _default_constraints(representation: Representation) -> list[str]:
    """The constraint |m|^2 - 1 if the group is orthogonal, else no constraint."""
    if all((a + a.T).is_zero() for a in representation.matrices):
        return [" + ".join(f"m{i}**2" for i in range(representation.size)) + " - 1"]
    return []


def _with_grading(
    representation: Representation,
    names: tuple[str, ...],
    n: int,
    symbols: dict[str, Any],
    constraints: list[Any],
    components: list[Any],
) -> Symbols:
    """`Symbols` whose field is graded so that the vector field has a parity, if possible."""
    made = _checked_constraints(names, constraints)
    plain = Symbols(names, n, symbols, FunctionField(names, made, names[:n]), tuple(constraints))
    _require_invariance(representation, plain, made)
    scope = dict(zip(names, plain.field.variables, strict=True))
    values = [evaluated(x, scope, plain.field) + plain.field.zero for x in components]
    full = values + [plain.field.zero] * (representation.algebra.dimension - len(values))
    vector = action_map(representation)(object_array(full), object_array(plain.point))
    extra = plain.field.ring.graded_weights((x.numerator for x in (*values, *vector)), names[n:]) if n else []
    if not extra:
        return plain
    return Symbols(names, n, symbols, FunctionField(names, made, [*names[:n], *extra]), tuple(constraints))


def _checked_constraints(names: tuple[str, ...], constraints: list[Any]) -> list[dict[tuple[int, ...], Any]]:
    ring = FunctionField(names)
    scope = dict(zip(names, ring.variables, strict=True))
    made = []
    for i, x in enumerate(constraints):
        value = evaluated(x, scope, ring) + ring.zero
        if value.powers:
            raise InputError(f"constraints[{i}], {x}, is not a polynomial")
        made.append({tuple(map(int, e)): c for e, c in value.numerator.terms()})
    return made


def _require_invariance(
    representation: Representation, symbols: Symbols, constraints: list[dict[tuple[int, ...], Any]]
) -> None:
    """Check that the derivative of each constraint along rho(e_i) m vanishes where the constraints hold."""
    field, n, dimension = symbols.field, symbols.size, representation.algebra.dimension
    action = action_map(representation)
    for a in range(dimension):
        unit = object_array([field.one if i == a else field.zero for i in range(dimension)])
        moved = action(unit, object_array(symbols.point))
        for number, terms in enumerate(constraints):
            p = field.ring.polynomial(terms)
            slopes = [RationalFunction(field, field.ring.reduce(p.derivative(i)), ()) for i in range(n)]
            if sum((slope * v for slope, v in zip(slopes, moved, strict=True)), field.zero) != 0:
                raise InputError(
                    f"constraints[{number}], {symbols.constraints[number]} = 0, is not kept by the group: "
                    "give polynomials that vanish on whole orbits"
                )


def read_expression(value: ExpressionLike, what: str) -> Expression:
    """A sympy expression, a string of the grammar or a rational number as a sympy expression.

    Parameters
    ----------
    value : sympy expression, str or number
    what : str
        Its name in error messages.

    Raises
    ------
    ParseError, FieldError

    Examples
    --------
    >>> read_expression("2*a - b**2/3", "x")
    2*a - b**2/3
    """
    import sympy

    if isinstance(value, str):
        known = frozenset(_NAME.findall(value))
        try:
            tree = parse(value, known, ())
            made = evaluate(tree, lambda k: sympy.Integer(int(k)), {name: sympy.Symbol(name) for name in known}, {})
            return sympy.sympify(made)
        except ParseError as error:
            raise ParseError(f"{what}: {error}") from None
    if hasattr(value, "free_symbols"):
        expression: Expression = value
        if expression.has(sympy.Float):
            raise FieldError(f"{what} has a float: {value}; write a fraction, or a symbol for it")
        return sympy.sympify(value)
    try:
        number = QQ.convert(value)
    except (FieldError, ParseError):
        raise FieldError(
            f"{what} is {value!r}: expected an expression or a rational number; write a fraction, or a symbol for it"
        ) from None
    return sympy.Rational(int(number.p), int(number.q))


def evaluated(expression: Expression, scope: Mapping[str, Any], field: FunctionField) -> Any:
    """Value of a rational expression whose symbols are elements, arrays of elements, or Jets.

    Raises
    ------
    InputError
        If the expression is not rational.

    Examples
    --------
    >>> field = FunctionField(["x"])
    >>> evaluated(read_expression("(1 + x)**2/2", "x"), {"x": field.variables[0]}, field)
    1/2*x^2 + x + 1/2
    """
    if expression.is_Symbol:
        return scope[expression.name]
    if expression.is_Rational:
        return field.convert(expression)
    parts = [evaluated(x, scope, field) for x in expression.args[: 1 if expression.is_Pow else None]]
    if expression.is_Pow and expression.exp.is_Integer:
        return _power(parts[0], int(expression.exp))
    if expression.is_Add or expression.is_Mul:
        made = parts[0]
        for x in parts[1:]:
            made = made + x if expression.is_Add else made * x
        return made
    raise InputError(
        f"{expression} is not a rational function of the symbols: use a parameter for a constant, and a rational "
        "parametrization, or new coordinates with constraints, for a function"
    )


def _power(x: Values, k: int) -> Any:
    made = x
    for _ in range(abs(k) - 1):
        made = made * x
    return made if k > 0 else 1 / made
