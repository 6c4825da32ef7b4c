"""Invariant Einstein metrics: Ric = c g as polynomial equations for the parameters, solved exactly.

One diagonal entry of the metric is normalized to 1. The group N(H)/H acts on the metrics. If G is compact, each orbit
of its identity component K meets the slice of the forms w with <w, X w0> = 0 for all X in its Lie algebra, in the
points of the orbit nearest to w0, so the metrics on a slice suffice. Groebner bases give all solutions, and
signatures the definite ones. Each metric is verified again by the trace of its curvature tensor.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.base.errors import InputError, UndecidedError
from liehom.exact.geometry.metrics import InvariantMetric, InvariantMetrics
from liehom.exact.geometry.polynomial_systems import UnfinishedError, real_solutions
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.function_field import FunctionField, RationalFunction
from liehom.exact.scalars.polynomial import Polynomial, horner
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.roots import real_ball

MAX_PARAMETERS = 6
Key = tuple[tuple[str, ...], int]
"""An algebraic number: its minimal polynomial, and the number of the root from the left."""


@final
@dataclass(frozen=True, slots=True)
class EinsteinMetric:
    """An invariant Riemannian Einstein metric.

    Attributes
    ----------
    metric : InvariantMetric
    constant : number
        c with Ric = c g; it scales with the metric.
    kind : int
        Metrics of different kinds are not isometric up to scale: the kinds number the values of c^d det g, then of
        |R|^2 / c^2. Metrics of one kind are not distinguished by these invariants.
    """

    metric: InvariantMetric
    constant: Any
    kind: int

    @property
    def parameters(self) -> tuple[Any, ...]:
        """The parameters of the metric, numbers of ``metric.field``."""
        return self.metric.parameters

    def verify(self) -> bool:
        """Whether the metric is positive definite and the trace of its curvature tensor is c g, exactly."""
        traced = np.einsum("ijki->jk", self.metric.curvature())
        definite = self.metric.signature()[0] == len(traced)
        return definite and bool((traced == self.metric.matrix() * self.constant).all())


@final
class EinsteinMetrics:
    """Invariant Einstein metrics of G/H up to scale, a sequence of `EinsteinMetric`; see `InvariantMetrics.einstein`.

    Attributes
    ----------
    metrics : tuple of EinsteinMetric
    complete : bool
        Whether these are proved to be all, up to scale and the identity component of N(H)/H. An orbit of this group may
        have several members here, all of one kind.
    reason : str
        Why the list is complete, or what stopped the computation.
    """

    def __init__(self, metrics: Sequence[EinsteinMetric], complete: bool, reason: str) -> None:
        self.metrics: tuple[EinsteinMetric, ...] = tuple(metrics)
        self.complete = complete
        self.reason = reason

    @property
    def kinds(self) -> int:
        """Number of kinds, which are not isometric."""
        return len({m.kind for m in self.metrics})

    def __len__(self) -> int:
        return len(self.metrics)

    def __iter__(self) -> Iterator[EinsteinMetric]:
        return iter(self.metrics)

    def __getitem__(self, index: int) -> EinsteinMetric:
        return self.metrics[index]

    def __repr__(self) -> str:
        number = f"{len(self)}" if self.complete else f"at least {len(self)}"
        return f"<{number} invariant Einstein metrics, {self.kinds} kind{'s' * (self.kinds != 1)}>"


def einstein_metrics(metrics: InvariantMetrics) -> EinsteinMetrics:
    """Implements `InvariantMetrics.einstein`."""
    if metrics.reference is None:
        return _without_reference(metrics)
    if metrics.dimension == 1:
        metric = metrics([1])
        return _numbered([metric] if metric.einstein_constant() is not None else [], True, "there is one metric")
    if metrics.split.field.degree > 1:
        raise UndecidedError(
            f"the pair is over {metrics.split.field.name}, and Einstein metrics of pairs with several parameters are "
            "found over QQ; give the pair in a basis with rational structure constants"
        )
    try:
        found = [*_solutions(metrics, _slice(metrics))]
    except UnfinishedError as stop:
        return _numbered(_symmetric_solutions(metrics), False, str(stop))
    return _numbered(found, True, "a Groebner basis has finitely many solutions, and these are the definite real ones")


def _symmetric_solutions(metrics: InvariantMetrics) -> list[InvariantMetric]:
    """The Einstein metrics that the identity component of N(H)/H preserves, else only the reference metric."""
    r, field = metrics.dimension, metrics.split.field
    fixed = field.stack_rows(gauge_operators(metrics), r).null_space()
    if 0 < fixed.nrows < r:
        try:
            return [*_solutions(metrics, _adapted_forms(metrics, fixed))]
        except UnfinishedError:
            pass
    metric = metrics(metrics.coordinates(np.asarray(metrics.reference)))
    return [metric] if metric.einstein_constant() is not None else []


def _without_reference(metrics: InvariantMetrics) -> EinsteinMetrics:
    if metrics.dimension < 2:
        return EinsteinMetrics([], True, "no invariant metric is definite")
    return EinsteinMetrics([], False, "no definite invariant metric was found")


def _solutions(metrics: InvariantMetrics, forms: Sequence[ExactMatrix]) -> Iterator[InvariantMetric]:
    """The definite Einstein metrics that are combinations of some forms, the first with coefficient 1."""
    if len(forms) > MAX_PARAMETERS:
        raise UnfinishedError(f"{len(forms)} parameters are more than {MAX_PARAMETERS}")
    names = FunctionField([f"x{a + 1}" for a in range(1, len(forms))])
    values = (names.one, *names.variables)
    columns = [metrics.coordinates(np.asarray(f)) for f in forms]
    parameters = tuple(_combined([c[a] for c in columns], values) for a in range(metrics.dimension))
    metric = InvariantMetric(metrics, parameters, names)
    ricci = metric.ricci_parameters()
    first = next(a for a in range(metrics.dimension) if columns[0][a] != 0)
    equations = [
        (names.convert(r) * parameters[first] - names.convert(ricci[first]) * x).cancelled().numerator
        for a, (r, x) in enumerate(zip(ricci, parameters, strict=True))
        if a != first
    ]
    diagonals = [[f[i, i] for f in forms] for i in range(metrics.split.dimension)]

    def possible(balls: Sequence[Any]) -> bool:
        """Whether enclosures of the parameters leave the diagonal entries of the metric positive."""
        totals = (sum((x * c for x, c in zip(balls, row[1:], strict=True)), 0 * balls[0] + row[0]) for row in diagonals)
        return not any(total < 0 for total in totals)

    for solution in real_solutions(equations, _determinant_factors(metric), possible):
        field, point = solution.field, (solution.field.one, *solution.values)
        numbers = tuple(
            sum((x * field.convert(c[a]) for x, c in zip(point, columns, strict=True)), field.zero)
            for a in range(metrics.dimension)
        )
        candidate = InvariantMetric(metrics, numbers, field)
        if candidate.signature()[0] == metrics.split.dimension and candidate.einstein_constant() is not None:
            yield candidate


def _determinant_factors(metric: InvariantMetric) -> list[Any]:
    """The irreducible factors of the determinant of a metric with parameters, which are poles of the inverse matrix.

    Other polynomials by which elimination has divided may vanish at a metric.
    """
    field: Any = metric.field
    poles: list[Any] = []
    for entry in metric._raised.ravel():
        for i, k in entry.powers:
            for p, e in field.atoms[i].factor()[1]:
                top, order = entry.numerator, k * int(e)
                while order and (quotient := field.ring.divide(top, p)) is not None:
                    top, order = quotient, order - 1
                if order and p not in poles:
                    poles.append(p)
    return poles


def _combined(coefficients: Sequence[Any], values: Sequence[RationalFunction]) -> RationalFunction:
    total = values[0] * 0
    for c, x in zip(coefficients, values, strict=True):
        total = total + x * c
    return total


# The gauge group: n(h)/h acts on V by ad, and on forms by F -> -(A^T F + F A).


def gauge_operators(metrics: InvariantMetrics) -> list[ExactMatrix]:
    """The matrices (r, r) of a basis of n(h) on the parameters, which act on columns; those that are zero left out."""
    split, g = metrics.split, metrics.pair.algebra
    rows = as_exact(g.normalizer(metrics.pair.subalgebra).basis)
    acting = g.table.contract(rows, split.complement, split.coordinates)
    operators = []
    for a in (as_exact(b).T for b in acting):
        images = [metrics.coordinates(np.asarray(-(a.T @ f + f @ a))) for f in metrics.basis]
        matrix = split.field.matrix([list(x) for x in images], (metrics.dimension, metrics.dimension)).T
        if not matrix.is_zero():
            operators.append(matrix)
    return operators


def _slice(metrics: InvariantMetrics) -> list[ExactMatrix]:
    """Forms that span a slice of the gauge group, the first with the only non-zero entry in its first place."""
    operators, r, d, field = gauge_operators(metrics), metrics.dimension, metrics.split.dimension, metrics.split.field
    if not operators:
        return list(metrics.basis)
    if not (-as_exact(metrics.pair.algebra.killing_form())).is_positive_definite():
        raise UnfinishedError("a group that is not compact acts on the invariant metrics")
    inverse = metrics.reference.inverse() if metrics.reference is not None else field.identity(d)
    moved = [inverse @ f for f in metrics.basis]
    gram = field.matrix([[(a @ b).trace() for b in moved] for a in moved], (r, r))
    rng = random.Random(1)
    diagonal = [all(f[i, j] == 0 for i in range(d) for j in range(i)) for f in metrics.basis]
    weights = [3 * a + a * a + 1 if flag else 0 for a, flag in enumerate(diagonal)]
    candidates = [weights, *([rng.randint(1, 40) for _ in range(r)] for _ in range(3))]
    slices = []
    for w in candidates:
        column = field.matrix([w], (1, r)).T
        rows = field.stack_rows([(gram @ x @ column).T for x in operators], r)
        slices.append(rows.null_space())
    best = min(slices, key=lambda s: s.nrows)
    return _adapted_forms(metrics, best)


def _adapted_forms(metrics: InvariantMetrics, rows: ExactMatrix) -> list[ExactMatrix]:
    """The forms with given parameters, in an echelon basis: only the first has its first entry, which is 1."""
    d = metrics.split.dimension
    flat = metrics.split.field.stack_rows([f.reshape(1, d * d) for f in metrics.basis], d * d)
    return list((rows @ flat).row_space().split_rows(d, d))


# Kinds: metrics up to scale, by invariants that are compared exactly.


def _numbered(found: Sequence[InvariantMetric], complete: bool, reason: str) -> EinsteinMetrics:
    """The metrics with their constants, sorted by kind."""
    constants: list[Any] = [m.einstein_constant() for m in found]
    volumes = [_key(m.field, _volume(m, c)) for m, c in zip(found, constants, strict=True)]
    keys = [
        (v, _key(m.field, _norm(m, c)) if volumes.count(v) > 1 else None)
        for m, c, v in zip(found, constants, volumes, strict=True)
    ]
    order = list(dict.fromkeys(keys))
    members = [EinsteinMetric(m, c, order.index(key)) for m, c, key in zip(found, constants, keys, strict=True)]
    return EinsteinMetrics(sorted(members, key=lambda m: m.kind), complete, reason)


def _volume(metric: InvariantMetric, constant: Scalar) -> Scalar:
    """c^d times the determinant of g in terms of the reference form."""
    field: Any = metric.field
    d = len(metric.matrix())
    table = field.matrix(metric.matrix(), (d, d)).determinant()
    reference = metric.metrics.reference
    return constant**d * table / (reference.determinant() if reference is not None else 1)


def _norm(metric: InvariantMetric, constant: Scalar) -> Scalar:
    """|R|^2 / c^2, or |R|^2 if c = 0; the curvature tensor is raised twice and lowered twice."""
    curvature, lower, upper = metric.curvature(), metric.matrix(), metric._raised
    other = np.tensordot(upper, np.tensordot(upper, curvature, (1, 1)), (1, 1))  # indices j, i, k, l
    other = np.tensordot(np.tensordot(other, upper, (2, 0)), lower, (2, 0))  # j, i, k, l
    total = (curvature * other.transpose(1, 0, 2, 3)).sum()
    return total / constant**2 if constant != 0 else total


def _key(field: ExactField | FunctionField, value: Scalar) -> Key:
    """The minimal polynomial of an algebraic number over QQ, and the index of the root that it is."""
    if not isinstance(field, ExactField):
        raise InputError("a metric with parameters has no kind")
    value = field.convert(value)
    powers = [field.one]
    for _ in range(field.degree):
        powers.append(powers[-1] * value)
    table = QQ.matrix([field.coordinates(p) for p in powers], (field.degree + 1, field.degree)).T
    reduced, pivots = table.echelon()
    degree = len(pivots)
    coefficients = [*(-reduced[i, degree] for i in range(degree)), QQ.one]
    minimal = Polynomial(QQ, coefficients)
    # the number of roots to the left, by an interval that contains no other root
    count, precision = minimal.root_counter(), 64
    while True:
        ball = real_ball(value, precision)
        middle, radius = ball.mid().fmpq(), ball.rad().fmpq() + QQ.convert(2) ** -precision
        low, high = middle - radius, middle + radius
        if horner(minimal.coefficients, low, QQ.zero) != 0 and count(low, high) == 1:
            return tuple(map(str, coefficients)), count(None, low)
        precision *= 2
