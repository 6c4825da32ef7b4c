"""Symbols of a problem, and the linear system of Theorem 5 at exact and symbolic points."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add, mul
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import FieldError, InputError, ParseError, ShapeError
from liehom.base.typing import Expression, Number, ObjectArray, ScalarLike, Values, VectorLike
from liehom.flow.action.frames import exact_gram_matrix
from liehom.flow.action.maps import action_map
from liehom.flow.action.space import Action
from liehom.flow.door import QQ, FunctionField, Matrix, RationalFunction, Representation, Scalar, evaluate, parse

# The linear system of Theorem 5 at a point with exact coordinates, over QQ or a number field.
#     e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c in the field
# Solvability is decided by a rank. Of several solutions the one with the smallest |c| and, among those, the smallest
# |zeta| is taken; if there is none, the system is solved in least squares. No float is involved.


@final
@dataclass(frozen=True, slots=True)
class ExactSolution:
    """Solution of the linear system at one point."""

    solvable: bool
    zeta: ObjectArray  # (dim g,)
    c: Scalar
    residual: ObjectArray  # r - (e rho(zeta) w_l - l c w_l), (N,), exactly 0 if solvable
    rank: int  # of [rho(g_m) w_l, w_l]
    dimension: int  # of the orbit


def solve_exactly(
    representation: Representation,
    m: VectorLike,
    velocity: VectorLike,
    right: VectorLike,
    leading: int,
    factor: ScalarLike,
) -> ExactSolution:
    """`ExactSolution` of the linear system at one point."""
    field, n = representation.field, representation.size
    isotropy = representation.isotropy(m)
    velocity_column, right_column = (field.matrix([list(x)], (1, n)).T for x in (velocity, right))
    images = [(representation(row) @ velocity_column).scale(factor).T for row in isotropy.rows()]
    moves = field.stack_rows(images, n).T if images else field.zeros(n, 0)
    full = field.stack_columns([moves, velocity_column.scale(field.convert(-leading))], n)
    rank, moved = full.rank(), moves.rank()
    solvable = field.stack_columns([full, right_column], n).rank() == rank
    # least squares: A^T A x = A^T r has solutions, all with the same A x
    both = full.solve(right_column) if solvable else (full.T @ full).solve(full.T @ right_column)
    reached = full @ both
    c = field.zero if moved == rank else both[both.nrows - 1, 0]
    target = reached + velocity_column.scale(c * leading)
    gram = isotropy.basis @ exact_gram_matrix(representation) @ isotropy.basis.T
    return ExactSolution(
        solvable,
        object_array([row[0] for row in (isotropy.basis.T @ _least(moves, target, gram)).to_rows()]),
        c,
        object_array([row[0] for row in (right_column - reached).to_rows()]),
        int(rank),
        representation.algebra.dimension - isotropy.dimension,
    )


def _least(moves: Matrix, target: Matrix, gram: Matrix) -> Matrix:
    """The y with moves y = target and the smallest y^T gram y, in the form y = gram^-1 moves^T u."""
    if moves.ncols == 0:
        return moves.T @ target
    turned = gram.solve(moves.T)
    return turned @ (moves @ turned).solve(target)


def object_array(elements: Sequence[object] | ObjectArray) -> ObjectArray:
    """One-dimensional array of objects with these elements, into which numpy does not look."""
    return np.fromiter(elements, dtype=object, count=len(elements))


def object_matrix(rows: Sequence[Sequence[object]]) -> ObjectArray:
    """Matrix of objects with these rows."""
    matrix: ObjectArray = np.empty((len(rows), len(rows[0])), dtype=object)
    matrix[...] = rows
    return matrix


# Symbols of a problem: coordinates, time, parameters and constraints, between sympy and a field of functions.
# Expressions are read into elements (exactly: no floats), and elements are written as factorized expressions.

ExpressionLike: TypeAlias = str | Number | Expression
"""A sympy expression, a string of the grammar, or a rational number."""

FieldPolynomial: TypeAlias = Any  # a polynomial of a `FunctionField`, by python-flint

MAX_TERMS_TO_FACTOR = 3000
_COORDINATE = re.compile(r"m[0-9]+", re.ASCII)
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*", re.ASCII)


@final
@dataclass(frozen=True, slots=True)
class Symbols:
    """Coordinates, time and parameters as sympy symbols and as elements of a field."""

    names: tuple[str, ...]  # the variables of the field: m0, ..., m(N-1), t, and the parameters
    size: int  # N
    symbols: dict[str, Any]  # of the user's expressions, and new ones for names in strings
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
            scope = {**from_parameters, "t": t, **{f"m{i}": m[..., i] for i in range(self.size)}}
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
        return evaluated(expression, scope, self.field) + self.field.zero

    def chunks(self, p: FieldPolynomial, size: int) -> list[Any]:
        """List of expressions of at most `size` terms with the polynomial p as their sum."""
        terms, ring = list(p.terms()), self.field.ring.context
        return [self._polynomial(ring.from_dict(dict(terms[i : i + size]))) for i in range(0, len(terms), size)]

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
        return sympy.Mul(sympy.Integer(int(content.p)), *above) / sympy.Mul(sympy.Integer(int(content.q)), *below)

    def nonvanishing(self, elements: Iterable[Any]) -> Expression:
        """Product of the different factors of the denominators of elements and lists of elements."""
        import sympy

        rows = [element if isinstance(element, list) else [element] for element in elements]
        used = {i for row in rows for x in row for i, _ in x.powers}
        return sympy.Mul(*(self._polynomial(self.field.ring.shortest(self.field.atoms[i])) for i in sorted(used)))


def read_symbols(
    representation: Representation,
    psi: Sequence[ExpressionLike],
    constraints: Sequence[Any] | None,
    others: Sequence[Any] = (),
) -> tuple[Symbols, list[Any]]:
    """(`Symbols` of a problem, components of psi as expressions)."""
    import sympy

    if representation.field != QQ:
        raise FieldError(f"closed forms are computed over QQ, the representation is over {representation.field}")
    n, dimension = representation.size, representation.algebra.dimension
    if isinstance(psi, str | bytes) or not isinstance(psi, Iterable):
        raise InputError(f"psi is {psi!r}: expected a list of {dimension} expressions")
    entries = list(psi)
    if len(entries) not in (representation.given, dimension):
        raise ShapeError(f"psi has {len(entries)} components, expected {dimension}")
    base = [*(f"m{i}" for i in range(n)), "t"]
    components = [read_expression(x, f"psi[{i}]") for i, x in enumerate(entries)]
    polynomials = _default_constraints(representation) if constraints is None else list(constraints)
    bounds = [read_expression(x, f"constraints[{i}]") for i, x in enumerate(polynomials)]
    symbols = {s.name: s for x in (*bounds, *components) for s in sorted(x.free_symbols, key=str)}
    for x in (*others, *polynomials, *entries):  # the symbols of the user's expressions, before those in strings
        symbols |= {s.name: s for s in getattr(x, "free_symbols", ()) if s.name in base or s.name in symbols}
    named = [(f"psi[{i}]", x) for i, x in enumerate(components)]
    named += [(f"constraints[{i}]", x) for i, x in enumerate(bounds)]
    for what, name in [(what, name) for what, x in named for name in sorted(s.name for s in x.free_symbols)]:
        if name not in base and _COORDINATE.fullmatch(name):
            raise InputError(f"{what} has the unknown symbol {name}; known are {', '.join(base)}")
    names = (*base, *sorted(set(symbols) - set(base), key=_natural))
    known = {name: symbols.get(name, sympy.Symbol(name)) for name in names}
    return _with_grading(representation, names, n, known, bounds, components), components


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
    polynomials = _checked_constraints(names, constraints)
    plain = Symbols(names, n, symbols, FunctionField(names, polynomials, names[:n]), tuple(constraints))
    _require_invariance(representation, plain, polynomials)
    scope = dict(zip(names, plain.field.variables, strict=True))
    values = [evaluated(x, scope, plain.field) + plain.field.zero for x in components]
    full = values + [plain.field.zero] * (representation.algebra.dimension - len(values))
    vector = action_map(representation)(object_array(full), object_array(plain.point))
    extra = plain.field.ring.graded_weights((x.numerator for x in (*values, *vector)), names[n:]) if n else []
    if not extra:
        return plain
    return Symbols(names, n, symbols, FunctionField(names, polynomials, [*names[:n], *extra]), tuple(constraints))


def _checked_constraints(names: tuple[str, ...], constraints: list[Any]) -> list[dict[tuple[int, ...], Any]]:
    ring = FunctionField(names)
    scope = dict(zip(names, ring.variables, strict=True))
    polynomials = []
    for i, x in enumerate(constraints):
        value = evaluated(x, scope, ring) + ring.zero
        if value.powers:
            raise InputError(f"constraints[{i}], {x}, is not a polynomial")
        polynomials.append({tuple(map(int, e)): c for e, c in value.numerator.terms()})
    return polynomials


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
    """A sympy expression, a string of the grammar or a rational number as a sympy expression."""
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
    """Value of a rational expression whose symbols are elements, arrays of elements, or Jets."""
    if expression.is_Symbol:
        return scope[expression.name]
    if expression.is_Rational:
        return field.convert(expression)
    parts = [evaluated(x, scope, field) for x in expression.args[: 1 if expression.is_Pow else None]]
    if expression.is_Pow and expression.exp.is_Integer:
        power = reduce(mul, [parts[0]] * abs(int(expression.exp)))
        return power if expression.exp > 0 else 1 / power
    if expression.is_Add or expression.is_Mul:
        return reduce(add if expression.is_Add else mul, parts)
    raise InputError(
        f"{expression} is not a rational function of the symbols: use a parameter for a constant, and a rational "
        "parametrization, or new coordinates with constraints, for a function"
    )


# The linear system of Theorem 5 at a symbolic point, over a field of rational functions.
#     e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c in the field
# The solution is the one with the smallest |c| and, among those, the smallest |zeta|. A symmetric matrix S of rank k
# with the characteristic polynomial x^N + p_1 x^(N-1) + ... is inverted on its range by
#     Q(S) = -(S^(k-1) + p_1 S^(k-2) + ... + p_(k-1)) / p_k,
# where p_k is a sum of squares of minors. So the only denominators are functions that vanish if and only if the rank
# drops, and no charts are needed.

MAX_SIZE = 12  # largest dimension of V for which an invariant form is searched


@final
class SymbolicRange:
    """Isotropy at a symbolic point, and the solver r -> (zeta, c) of the linear system."""

    rank: int

    def __init__(self, action: Action, field: FunctionField, point: ObjectArray) -> None:
        self._action, self._field, self._point = action, field, point
        n = action.dimension
        self._units = object_matrix([[field.one if i == j else field.zero for j in range(n)] for i in range(n)])
        self._dual, self._metric = (
            object_matrix([[field.convert(x) for x in row] for row in matrix.to_rows()])
            for matrix in (exact_gram_matrix(action.representation).inverse(), invariant_form(action.representation))
        )
        fixing = self._moved(point)
        adjoint = self._dual @ fixing.T @ self._metric
        inverse = RangeInverse(fixing @ adjoint)
        self.orbit_dimension: int = inverse.rank  # the generic one
        image = np.stack([inverse(column) for column in fixing.T], axis=-1)
        self.projector: ObjectArray = simple(self._units - adjoint @ image)  # on g_m, orthogonal
        # a polynomial generator of g_m of dimension 1; without a gcd it would have factors that do not cancel
        own = n - inverse.rank == 1 and len(field.ring.basis) < 2
        self.row: ObjectArray | None = self._simplest_row() if own else None

    def _moved(self, m: ObjectArray) -> ObjectArray:
        """Matrix of x -> rho(x) m, shape (N, dim g)."""
        return np.stack([self._action.infinitesimal(x, m) for x in self._units], axis=-1)

    def _simplest_row(self) -> ObjectArray:
        rows = [object_array(self._field.primitive(list(row))) for row in (self.projector @ self._dual).T if any(row)]
        return min(rows, key=lambda row: sum(len(x.numerator) for x in row))

    def fixes(self, x: ObjectArray) -> bool:
        """Whether x is in the isotropy subalgebra."""
        return not any(self._action.infinitesimal(x, self._point))

    def prepare(self, velocity: ObjectArray, leading: int, factor: RationalFunction) -> None:
        """Set w_l, l and e."""
        self._velocity, self._leading = velocity, leading
        if self.row is None:
            moves = simple(factor * self._moved(velocity) @ self.projector)
            self._adjoint = simple(self._dual @ moves.T @ self._metric)
        else:  # an orthonormal basis is not needed, as zeta is unique, or 0
            moved: Any = self._action.infinitesimal(self.row, velocity)
            moves = simple(factor * moved)[:, None]
            self._adjoint = moves.T @ self._metric
        self._inverse = RangeInverse(simple(moves @ self._adjoint))
        self._moves = moves
        self._rest = simple((velocity - self._projected(velocity)) @ self._metric)
        self._square = simple(self._rest @ velocity)[()]
        self._determined = self._square != 0
        self.rank = self._inverse.rank + int(self._determined)

    def _projected(self, vector: ObjectArray) -> ObjectArray:
        return self._moves @ (self._adjoint @ self._inverse(vector))

    def solve(self, right: ObjectArray) -> tuple[ObjectArray, RationalFunction]:
        """(zeta, c), or the least-squares solution; zeta has dim g elements, or one, the factor of `row`."""
        c = self._field.zero
        if self._determined:
            c = (-(self._rest @ right) / (self._square * self._leading)).cancelled()
        return simple(self._adjoint @ self._inverse(simple(right + self._leading * c * self._velocity))), c


def invariant_form(representation: Representation) -> Matrix:
    """A positive definite form on V that the group preserves, near the sum of squares, or the identity. With it the
    denominators of the normal equations are invariant; a solution does not depend on it.
    """
    field, n = representation.field, representation.size
    identity = field.identity(n)
    if n > MAX_SIZE or all((a + a.T).is_zero() for a in representation.matrices):
        return identity
    forms = representation.invariant_forms().symmetric
    if not forms:
        return identity
    flat = field.stack_rows([b.reshape(1, n * n) for b in forms], n * n)
    weights = (flat @ flat.T).solve(flat @ identity.reshape(n * n, 1))
    form = (weights.T @ flat).reshape(n, n)
    return form if form.is_positive_definite() else identity


@final
class RangeInverse:
    """The map v -> Q(S) v, the inverse on its range of a positive semidefinite, self-adjoint matrix S."""

    def __init__(self, matrix: ObjectArray) -> None:
        self._matrix = matrix
        zero = 0 * matrix[0, 0]
        one = object_matrix([[zero + int(i == j) for j in range(len(matrix))] for i in range(len(matrix))])
        self._coefficients: list[RationalFunction] = [zero + 1]
        power = matrix
        for k in range(1, len(matrix) + 1):  # Faddeev and LeVerrier
            power = power if k == 1 else simple(matrix @ (power + self._coefficients[-1] * one))
            if not any(power.flat):
                break
            self._coefficients.append((-np.trace(power) / k).cancelled())
        while self._coefficients[-1] == 0:
            self._coefficients.pop()
        self.rank: int = len(self._coefficients) - 1
        self._last: Any = -1 / self._coefficients[-1] if self.rank else zero

    def __call__(self, vector: ObjectArray) -> ObjectArray:
        if self.rank == 0:
            return self._last * vector
        power = vector
        for p in self._coefficients[1:-1]:
            power = simple(self._matrix @ power + p * vector)
        return simple(self._last * power)


def simple(values: ObjectArray) -> ObjectArray:
    """Array of elements with common factors of numerators and denominators cancelled, as far as they are found."""
    values = np.asarray(values, dtype=object)
    result = np.empty(values.shape, dtype=object)
    for index, x in np.ndenumerate(values):
        result[index] = x.cancelled()
    return result
