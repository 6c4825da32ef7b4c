"""Invariant metrics of G/H, their Levi-Civita connections and curvature.

An invariant metric is an ad(h)-invariant symmetric form on V = m, x_1 F_1 + ... + x_r F_r in a basis of these forms.
With Lambda(X) Y = [X, Y]_m / 2 + U(X, Y), where 2 <U(X, Y), Z> = <[Z, X]_m, Y> + <X, [Z, Y]_m>, the curvature is
R(X, Y) = [Lambda(X), Lambda(Y)] - Lambda([X, Y]_m) - ad([X, Y]_h), Ric(Y, Z) is the trace of X -> R(X, Y) Z, and the
sectional curvature is <R(X, Y) Y, X> over the square of the area. The unit sphere S^n then has Ric = (n - 1) g.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any, final

import numpy as np

from liehom.base.errors import FieldError, InputError, ShapeError, SingularError, UndecidedError, displayed
from liehom.base.typing import ScalarLike, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.core.tables import field_of_values
from liehom.exact.geometry.reductive import (
    ObjectArray,
    ReductiveSplit,
    Value,
    has_solution,
    kernel_projector,
    reductive_split,
)
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import MatrixAlgebra, invariant_forms
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Matrix, MatrixLike, Scalar
from liehom.exact.scalars.function_field import FunctionField, RationalFunction
from liehom.exact.scalars.rational import QQ

if TYPE_CHECKING:
    from liehom.exact.geometry.einstein import EinsteinMetrics

MAX_FUNCTION_PARAMETERS = 12


@final
class InvariantMetrics:
    """The invariant metrics of G/H of all signatures, the result of `Pair.invariant_metrics`.

    Attributes
    ----------
    pair : Pair
    basis : tuple of Matrix
        Invariant symmetric forms F_a on V, shape (d, d), in the basis of ``pair.reductive_complement()``. If the
        isotropy summands are inequivalent, there is one for each: there F_a is the reference form, elsewhere 0.
    reference : Matrix or None
        A positive definite invariant form: minus the Killing form, divided by `killing_factor`, if that is definite.
        None if no definite form was found.

    Examples
    --------
    >>> import liehom as lh
    >>> su3 = lh.su(3)
    >>> metrics = lh.Pair(su3, su3.cartan_subalgebra()).invariant_metrics()
    >>> metrics.dimension, metrics([1, 1, 2]).ricci_parameters()
    (3, (4, 4, 8))
    """

    def __init__(self, pair: Pair) -> None:
        self.pair = pair
        self.split: ReductiveSplit = reductive_split(pair)
        d, field = self.split.dimension, self.split.field
        forms = list(invariant_forms(self.split.isotropy, d, field).symmetric)
        self.reference: ExactMatrix | None = self._definite(forms)
        self.basis: tuple[ExactMatrix, ...] = tuple(self._adapted(forms))
        self._dual = invariant_forms([-a.T for a in self.split.isotropy], d, field).symmetric
        flat = field.stack_rows([f.reshape(1, d * d) for f in self.basis], d * d)
        self._pivots: list[int] = flat.echelon()[1]
        self._inverse = flat.select(columns=self._pivots).inverse()

    @property
    def dimension(self) -> int:
        """Number r of parameters, an int."""
        return len(self.basis)

    @property
    def killing_factor(self) -> Scalar | None:
        """The number k for which minus the Killing form of g is k times `reference` on V, or None if there is none."""
        killing, form = -self.split.killing(), self.reference
        factor = killing.trace() / form.trace() if form is not None and form.nrows else None
        return factor if factor is not None and form is not None and killing == form.scale(factor) else None

    @property
    def diagonal(self) -> bool:
        """Whether the positive definite metrics are those with positive parameters: their cone is an orthant."""
        definite = self.reference is not None and all(f.signature()[1] == 0 for f in self.basis)
        return definite and sum(f.rank() for f in self.basis) == self.split.dimension

    def signatures(self) -> tuple[tuple[int, int], ...]:
        """The pairs (positive, negative) of all non-degenerate invariant metrics, for a `diagonal` family.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pair("su(3)/su(2)").invariant_metrics().signatures()
        ((0, 5), (1, 4), (4, 1), (5, 0))
        """
        if not self.diagonal:
            raise UndecidedError(f"{self!r} are not diagonal, so their signatures are not listed; ask single metrics")
        d, sums = self.split.dimension, {0}
        for form in self.basis:
            sums |= {s + form.rank() for s in sums}
        return tuple((p, d - p) for p in sorted(sums))

    def _definite(self, forms: list[ExactMatrix]) -> ExactMatrix | None:
        """A positive definite form: minus the Killing form, else a member of the basis up to sign, or their sum."""
        killing = -self.split.killing()
        candidates = [killing, *forms, *(-f for f in forms)]
        if forms:
            candidates.append(sum(forms[1:], forms[0]))
        form = next((f for f in candidates if f.is_positive_definite()), None)
        return form if form is None or form.field.degree > 1 else form.primitive()

    def _adapted(self, forms: list[ExactMatrix]) -> list[ExactMatrix]:
        """The restrictions of the reference form to the isotropy summands if they are inequivalent, else `forms`."""
        if self.reference is None or len(forms) < 2:
            return forms if self.reference is None else [self.reference][: len(forms)]
        inverse, d = self.reference.inverse(), self.split.dimension
        maps = [inverse @ f for f in forms]
        if any(a @ b != b @ a for a, b in combinations(maps, 2)):
            return forms
        algebra = MatrixAlgebra(self.split.field, d, maps)
        if algebra.dimension > len(forms):
            return forms
        generator, polynomial = algebra.generator()
        factors = [f for f, _ in polynomial.factor()]
        if any(f.degree > 1 for f in factors):
            return forms
        parts = [kernel_projector(generator, polynomial, f) for f in factors]
        blocks = [self.reference @ p for p in parts]
        return sorted(blocks, key=lambda f: (f.rank(), f.first_nonzero_row() or 0))

    def __call__(self, parameters: Sequence[ScalarLike] | MatrixLike) -> InvariantMetric:
        """The metric x_1 F_1 + ... + x_r F_r; `SingularError` if it is degenerate.

        The r numbers are of the field of the pair or, if that is QQ, of one real number field. In their place the
        symmetric matrix (d, d) of an invariant form may stand.
        """
        values: list[Any] = list(parameters)
        if values and isinstance(values[0], (Sequence, np.ndarray)) and not isinstance(values[0], str):
            values = self._parameters_of(values)
        if len(values) != self.dimension:
            raise ShapeError(f"{len(values)} parameters were given, expected {self.dimension}")
        field: Any = self.split.field
        if (field.degree == 1 and not any(isinstance(x, int) for x in values)) or any(
            isinstance(x, str) for x in values
        ):
            field = field_of_values(values) if field.degree == 1 else field
        elif field.degree == 1:
            field = field_of_values([x for x in values if not isinstance(x, int)])
        if not isinstance(field, ExactField):
            raise FieldError("the parameters have floats; give fractions, or strings such as 'sqrt(2)'")
        return InvariantMetric(self, tuple(map(field.convert, values)), field)

    def _parameters_of(self, rows: list[Any]) -> list[Any]:
        """The parameters of the invariant form with a matrix."""
        d, field = self.split.dimension, field_of_values([x for row in rows for x in row])
        form = field.matrix(rows, (d, d)).reshape(d * d, 1)
        basis = field.matrix([f.reshape(1, d * d).to_rows()[0] for f in self.basis], (self.dimension, d * d))
        try:
            return [row[0] for row in basis.T.solve(form).to_rows()]
        except SingularError:
            raise InputError("the matrix is not that of an invariant symmetric form") from None

    def generic(self, *, first: ScalarLike | None = None) -> InvariantMetric:
        """The metric with the parameters x1, ..., xr themselves, or a number for x1, as rational functions over QQ.

        Examples
        --------
        >>> import liehom as lh
        >>> metric = lh.Pair(lh.so(3), [[0, 0, 1]]).invariant_metrics().generic()
        >>> metric.scalar()
        (2)/((x1))
        """
        if self.split.field.degree > 1:
            raise FieldError(
                f"rational functions are over QQ, and the pair is over {self.split.field.name}; give numbers"
            )
        if self.dimension > MAX_FUNCTION_PARAMETERS:
            raise InputError(f"{self.dimension} parameters are more than {MAX_FUNCTION_PARAMETERS}; give numbers")
        start = 0 if first is None else 1
        field = FunctionField([f"x{a + 1}" for a in range(start, self.dimension)])
        return InvariantMetric(
            self, (*([] if first is None else [field.convert(QQ.convert(first))]), *field.variables), field
        )

    def coordinates(self, form: ObjectArray) -> tuple[Any, ...]:
        """The parameters of an invariant symmetric form, given as an array (d, d)."""
        values = form.reshape(-1)[self._pivots]
        return tuple((values @ np.asarray(self._inverse)).tolist())

    def form(self, parameters: Sequence[Any], *, dual: bool = False) -> ObjectArray:
        """The array (d, d) of the form with these parameters, in the basis of forms on V or on its dual."""
        d = self.split.dimension
        total = np.full((d, d), parameters[0] * 0 if len(parameters) else 0, dtype=object)
        for x, f in zip(parameters, self._dual if dual else self.basis, strict=True):
            for i, j in np.argwhere(np.asarray(f) != 0).tolist():
                total[i, j] = total[i, j] + x * f[i, j]
        return total

    def einstein(self) -> EinsteinMetrics:
        """All invariant Riemannian Einstein metrics, up to scale and the gauge group N(H)/H.

        The result says by `complete` whether the computation ended in its limits; otherwise it holds at least these.

        Examples
        --------
        >>> import liehom as lh
        >>> su3 = lh.su(3)
        >>> found = lh.Pair(su3, su3.cartan_subalgebra()).invariant_metrics().einstein()
        >>> [metric.parameters for metric in found], found.complete
        ([(1, 1, 1), (1, 1, 2), (1, 2, 1), (1, 1/2, 1/2)], True)
        """
        from liehom.exact.geometry.einstein import einstein_metrics

        return einstein_metrics(self)

    def __repr__(self) -> str:
        return f"<invariant metrics of {self.pair!r}: {self.dimension} parameters>"


@final
class InvariantMetric:
    """An invariant metric of G/H; its tensors are numpy arrays of exact numbers, or of rational functions.

    Attributes
    ----------
    metrics : InvariantMetrics
    parameters : tuple of numbers or RationalFunction
    field : ExactField or FunctionField

    Examples
    --------
    >>> import liehom as lh
    >>> sphere = lh.pair("so(4)/so(3)").invariant_metrics()([1])
    >>> sphere.sectional([1, 0, 0], [0, 1, 0]), sphere.scalar()
    (1, 6)
    """

    def __init__(
        self, metrics: InvariantMetrics, parameters: tuple[Any, ...], field: ExactField | FunctionField
    ) -> None:
        self.metrics = metrics
        self.parameters = parameters
        self.field = field
        self._matrix = metrics.form(parameters)
        self._raised = self._inverse()

    def _inverse(self) -> ObjectArray:
        """The inverse of the matrix, shape (d, d)."""
        d = len(self._matrix)
        if isinstance(self.field, ExactField):
            form = self.field.matrix(self._matrix, (d, d))
            if form.rank() < d:
                raise SingularError(
                    f"the form with the parameters {displayed(self.parameters)} is degenerate; they are the "
                    "coefficients of the forms in `basis`, not all of which are positive if summands are equivalent"
                )
            return np.asarray(form.inverse())
        # the inverse is an invariant form on the dual: r linear equations for its parameters, independent at one point
        dual, ring = self.metrics._dual, self.metrics.split.field
        if len(dual) < self.metrics.dimension:
            raise SingularError("every invariant form is degenerate, so G/H has no invariant metric")
        rng = random.Random(2)
        for _ in range(12):
            numbers = [QQ.convert(rng.randint(1, 1000)) for _ in self.field.variables]
            values = [p.numerator(*numbers) for p in self.parameters]  # the parameters are polynomials
            point = sum((f.scale(x) for x, f in zip(values, self.metrics.basis, strict=True)), ring.zeros(d, d))
            if point.rank() == d:
                break
        else:
            raise SingularError("no metric with these parameters was found that is not degenerate")
        columns = ring.stack_rows([(point @ f).reshape(1, d * d) for f in dual], d * d)
        places = columns.echelon()[1]
        table = [(self._matrix @ np.asarray(f)).reshape(-1)[places] for f in dual]
        right = np.asarray(ring.identity(d)).reshape(-1)[places]
        return self.metrics.form(_solved(np.array(table, dtype=object).T, right), dual=True)

    # -- the form ----------------------------------------------------------------------------------------
    def matrix(self) -> ObjectArray:
        """The array (d, d) of <m_i, m_j>, in the basis of ``pair.reductive_complement()``."""
        return self._matrix.copy()

    def signature(self) -> tuple[int, int, int]:
        """Numbers of (positive, negative, zero) eigenvalues; the parameters must be numbers."""
        return self._numbers("the signature").matrix(self._matrix, self._matrix.shape).signature()

    def _numbers(self, what: str) -> ExactField:
        if not isinstance(self.field, ExactField):
            raise FieldError(f"{what} of a metric with parameters depends on their values; give numbers")
        return self.field

    # -- connection and curvature ------------------------------------------------------------------------
    @cached_property
    def _connection(self) -> ObjectArray:
        lowered = self.metrics.split.brackets() @ self._matrix  # <[m_i, m_j], m_l>
        # 2 <Lambda(m_i) m_j, m_l>: the terms with the indices (i, j, l), (l, i, j) and (l, j, i)
        koszul = lowered + lowered.transpose(1, 2, 0) + lowered.transpose(2, 1, 0)
        return _simplified((koszul * QQ.convert("1/2")) @ self._raised)

    def connection(self) -> ObjectArray:
        """The Nomizu map of the Levi-Civita connection: entry (i, j, l) is the part of Lambda(m_i) m_j on m_l."""
        return self._connection.copy()

    @cached_property
    def _curvature(self) -> ObjectArray:
        return curvature_of(self.metrics.split, self._connection)

    def curvature(self) -> ObjectArray:
        """The curvature tensor: entry (i, j, k, l) is the part of R(m_i, m_j) m_k on m_l."""
        return self._curvature.copy()

    def sectional(self, x: VectorLike, y: VectorLike) -> Value:
        """Sectional curvature of the plane of two vectors, given by d coordinates each."""
        u, v = (np.asarray(self._vector(z), dtype=object) for z in (x, y))
        area = (u @ self._matrix @ u) * (v @ self._matrix @ v) - (u @ self._matrix @ v) ** 2
        if area == 0:
            raise InputError("the two vectors span no plane on which the metric is non-degenerate")
        moved = np.tensordot(v, np.tensordot(v, np.tensordot(u, self._curvature, 1), 1), 1)
        return (moved @ self._matrix @ u) / area

    def _vector(self, x: VectorLike) -> list[Any]:
        values: list[Any] = list(x)
        if len(values) != len(self._matrix):
            raise ShapeError(f"a tangent vector has {len(self._matrix)} coordinates, got {len(values)}")
        field: Any = self.field
        return [field.convert(v) for v in values]

    @cached_property
    def _ricci(self) -> ObjectArray:
        """Besse 7.38, without the curvature tensor: -1/2 sum <[X, e_a], [Y, e_a]> - B(X, Y) / 2 + ..."""
        split, half = self.metrics.split, QQ.convert("1/2")
        brackets, raised = split.brackets(), self._raised
        lowered = _simplified(brackets @ self._matrix)
        moved = np.array([raised @ c for c in brackets], dtype=object)  # g^ab [m_i, m_b]
        both = np.tensordot(raised, np.tensordot(raised, lowered, (1, 1)), (1, 1))  # g^ab g^cd <[m_b, m_d], m_j>
        total = np.tensordot(lowered, both, ((0, 1), (0, 1))) * (half * half)
        total = total - np.tensordot(lowered, moved, ((1, 2), (1, 2))) * half - np.asarray(split.killing()) * half
        for traces in split.traces():
            mean = np.tensordot(raised @ np.asarray(traces)[0], lowered, 1)
            total = total - (mean + mean.T) * half
        return _simplified(total)

    def ricci(self) -> ObjectArray:
        """The Ricci tensor Ric(m_i, m_j), an array (d, d)."""
        return self._ricci.copy()

    def ricci_parameters(self) -> tuple[Any, ...]:
        """The parameters of the Ricci tensor, which is an invariant symmetric form; it does not depend on scale."""
        return self.metrics.coordinates(self._ricci)

    def scalar(self) -> Value:
        """The scalar curvature."""
        return _simplified(np.array([(self._raised * self._ricci).sum()], dtype=object))[0]

    def einstein_constant(self) -> Value | None:
        """The number c with Ric = c g, or None if the metric is not an Einstein metric."""
        total: Any = self.scalar()
        constant: Value = total / len(self._matrix)
        return constant if bool((self._ricci == self._matrix * constant).all()) else None

    def holonomy(self) -> Subalgebra:
        """The holonomy algebra of the metric, generated at the base point by curvature, a subalgebra of so(V).

        It is the smallest algebra that contains the R(X, Y) and is closed under brackets with all Lambda(Z) (Nomizu).
        `liehom.structure_name` names it.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pair("so(5)/so(4)").invariant_metrics()([1]).holonomy().dimension
        6
        """
        field, d = self._numbers("the holonomy"), len(self._matrix)
        operators = [field.matrix(a.T, (d, d)) for a in self._connection]
        curvature = [self._curvature[i, j].T for i, j in combinations(range(d), 2)]
        span = field.stack_rows([field.matrix(a, (d, d)).reshape(1, d * d) for a in curvature], d * d).row_space()
        while True:
            members = span.split_rows(d, d)
            grown = [(z @ a - a @ z).reshape(1, d * d) for z in operators for a in members]
            larger = field.stack_rows([span, *grown], d * d).row_space()
            if larger.nrows == span.nrows:
                break
            span = larger
        raised = field.matrix(self._raised, (d, d))
        units = ((field.unit(d, i).T @ field.unit(d, j)) for i, j in combinations(range(d), 2))
        skew = [raised @ (e - e.T) for e in units]
        whole = LieAlgebra.from_matrices(skew, field=field, name="so(V)") if skew else LieAlgebra({}, dimension=0)
        lowered = [field.matrix(self._matrix, (d, d)) @ a for a in span.split_rows(d, d)]
        rows = [[a[i, j] for i, j in combinations(range(d), 2)] for a in lowered]
        return whole.subalgebra(field.matrix(rows, (len(rows), whole.dimension)))

    def kaehler_form(self) -> Matrix | None:
        """A parallel invariant 2-form that is not degenerate, a skew matrix (d, d), or None if there is none.

        If there is one, the metric is a Kaehler metric for an invariant complex structure.

        Examples
        --------
        >>> import liehom as lh
        >>> su3 = lh.su(3)
        >>> metrics = lh.Pair(su3, su3.cartan_subalgebra()).invariant_metrics()
        >>> [metrics(x).kaehler_form() is None for x in ([1, 1, 1], [1, 1, 2], [1, 2, 3])]
        [True, False, False]
        """
        from liehom.exact.geometry.forms import kaehler_form

        return kaehler_form(self)

    def is_naturally_reductive(self) -> bool:
        """Whether <[X, Y]_m, Z> + <Y, [X, Z]_m> = 0 for some invariant complement m, so with respect to this G."""
        field, split = self._numbers("natural reductivity"), self.metrics.split

        def defect(brackets: ObjectArray) -> ObjectArray:
            lowered = brackets @ self._matrix
            return lowered + lowered.transpose(0, 2, 1)

        columns = [defect(split.corrected(phi)) for phi in split.corrections()]
        return has_solution(field, -defect(split.brackets()), columns)

    def geodesic_vector(self, x: VectorLike) -> ObjectArray | None:
        """The X in g, array (n,), whose curve exp(tX) H is the geodesic with initial velocity x, or None.

        x has d exact coordinates, and X = x + z with z in h and <[X, Y]_m, x> = 0 for all Y in m.

        O. Kowalski and L. Vanhecke, Riemannian manifolds with homogeneous geodesics, Boll. Un. Mat. Ital. B 5 (1991).

        Examples
        --------
        >>> import liehom as lh
        >>> metric = lh.pair("SU(2)/0").invariant_metrics()([1, 0, 0, 2, 0, 3])
        >>> metric.geodesic_vector([1, 0, 0]), metric.geodesic_vector([1, 1, 0])
        (array([1, 0, 0], dtype=object), None)
        """
        field, split = self._numbers("a homogeneous geodesic"), self.metrics.split
        v = np.asarray(self._vector(x), dtype=object)
        lowered, k = v @ self._matrix, len(split.isotropy)
        columns = [list(lowered @ np.asarray(field.read(a))) for a in split.isotropy]
        right = field.matrix([list(-np.tensordot(v, split.brackets(), 1) @ lowered)], (1, len(v))).T
        try:
            z = field.matrix(columns, (k, len(v))).T.solve(right).T if k else field.zeros(1, 0)
        except SingularError:
            return None
        if not k and not right.is_zero():
            return None
        row = field.matrix([list(v)], (1, len(v))) @ field.read(split.complement)
        total: ObjectArray = np.asarray(row + z @ field.read(split.lower) if k else row)[0]
        return total

    def __repr__(self) -> str:
        return f"<invariant metric {self.parameters} of {self.metrics.pair!r}>"


def curvature_of(split: ReductiveSplit, nomizu: ObjectArray) -> ObjectArray:
    """The curvature tensor (d, d, d, d) of the connection with a Nomizu map (d, d, d): see the head of this file."""
    d, operators = split.dimension, [a.T for a in nomizu]
    acting = [np.asarray(a) for a in split.isotropy]
    table = np.full((d, d, d, d), QQ.zero, dtype=object)
    for i, j in combinations(range(d), 2):
        value = operators[i] @ operators[j] - operators[j] @ operators[i]
        for row, matrices in ((split.horizontal[i].row(j), operators), (split.vertical[i].row(j), acting)):
            for c, matrix in zip(row, matrices, strict=True):
                value = value - matrix * c if c != 0 else value
        table[i, j], table[j, i] = _simplified(value.T), _simplified(-value.T)
    return table


def _solved(table: ObjectArray, right: ObjectArray) -> list[Any]:
    """The solution of a square system of rational functions by elimination."""
    size = len(table)
    rows = [[*table[i], right[i]] for i in range(size)]
    for c in range(size):
        pivot = next(i for i in range(c, size) if rows[i][c] != 0)
        rows[c], rows[pivot] = rows[pivot], rows[c]
        rows[c] = [(x / rows[c][c]).cancelled() if x != 0 else x for x in rows[c]]
        for i in range(size):
            if i != c and rows[i][c] != 0:
                factor = rows[i][c]
                rows[i] = [(x - factor * y).cancelled() if y != 0 else x for x, y in zip(rows[i], rows[c], strict=True)]
    return [row[-1] for row in rows]


def _simplified(values: ObjectArray) -> ObjectArray:
    """The array with the fractions of rational functions cancelled."""
    table: ObjectArray = np.empty(values.shape, dtype=object)
    flat = values.reshape(-1)
    table.reshape(-1)[:] = [x.cancelled() if isinstance(x, RationalFunction) else x for x in flat]
    return table


def is_naturally_reductive(pair: Pair, metric: InvariantMetric) -> bool:
    """Implements `Pair.is_naturally_reductive`."""
    if not isinstance(metric, InvariantMetric) or metric.metrics.pair != pair:
        raise InputError(f"expected an invariant metric of {displayed(pair)}, got {displayed(metric)}")
    return metric.is_naturally_reductive()
