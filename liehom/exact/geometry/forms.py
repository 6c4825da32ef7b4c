"""Invariant differential forms of G/H and their cohomology, symplectic and complex structures, connections.

Invariant k-forms of G/H are ad(h)-invariant alternating forms on V = m. Their differential is the antiderivation with
(d w)(X, Y) = -w([X, Y]_m). If G is compact and connected and H is connected, their cohomology, which is that of the
pair (g, h), is the de Rham cohomology of G/H.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations, product
from math import comb
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.budget import in_time, within
from liehom.base.errors import InputError, InternalError, ShapeError, UndecidedError, displayed
from liehom.base.typing import ScalarLike
from liehom.exact.geometry.metrics import InvariantMetric, curvature_of
from liehom.exact.geometry.reductive import ObjectArray, ReductiveSplit, kernel_projector, reductive_split
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import MatrixAlgebra, commutant, intertwiners, invariant_forms
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.number_fields import common_field
from liehom.exact.scalars.polynomial_matrix import PolynomialMatrix
from liehom.exact.scalars.rational import QQ

Form: TypeAlias = dict[tuple[int, ...], Any]
"""A form: its non-zero values on basis elements of V, by increasing indices."""


@final
class InvariantDifferentialForms:
    """The invariant k-forms of G/H, the result of `Pair.invariant_forms`.

    Attributes
    ----------
    pair : Pair
    degree : int
        k.
    basis : tuple of dict
        The forms, each as {(i_1, ..., i_k): value} with i_1 < ... < i_k, on the basis of
        ``pair.reductive_complement()``.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.pair("so(3)/so(2)").invariant_forms(2).basis
    ({(0, 1): 1},)
    """

    def __init__(self, pair: Pair, degree: int) -> None:
        self.pair = pair
        self.degree = degree
        self._split = reductive_split(pair)
        self._tuples = list(combinations(range(self._split.dimension), degree))
        self.basis: tuple[Form, ...] = tuple(self._invariant())

    @property
    def dimension(self) -> int:
        """Number of linearly independent forms, an int."""
        return len(self.basis)

    def _invariant(self) -> list[Form]:
        """The forms that every z in h annihilates, z after z; a covector e^l is mapped to -sum_j A[l, j] e^j."""
        field, width = self._split.field, len(self._tuples)
        within("entries", width * width, "the equations for invariant forms have {} entries")
        position = {indices: x for x, indices in enumerate(self._tuples)}
        space: ExactMatrix = field.identity(width)
        for z in self._split.isotropy:
            in_time()
            rules: list[Form] = [{(j,): -c for j, c in enumerate(z.row(i)) if c != 0} for i in range(z.nrows)]
            images: list[list[Scalar]] = []
            for indices in self._tuples:
                row = [field.zero] * width
                for key, c in derived({indices: field.one}, rules).items():
                    row[position[key]] = c
                images.append(row)
            space = (space @ field.matrix(images, (width, width))).left_null_space() @ space
            if not space.nrows:
                break
        rows = space.row_space().to_rows() if space.nrows else []
        return [{indices: c for indices, c in zip(self._tuples, row, strict=True) if c != 0} for row in rows]

    def differential(self, form: Mapping[tuple[int, ...], Any]) -> Form:
        """The exterior derivative of an invariant form, a dict of its values on basis elements."""
        return derived(form, _differentials(self._split))

    def rank(self) -> int:
        """Rank of the exterior derivative on these forms, an int."""
        images = [self.differential(form) for form in self.basis]
        places = sorted({key for image in images for key in image})
        if not places:
            return 0
        zero = self._split.field.zero
        return self._split.field.matrix([[image.get(key, zero) for key in places] for image in images]).rank()

    def closed(self) -> tuple[Form, ...]:
        """A basis of the closed forms."""
        field = self._split.field
        images = [self.differential(form) for form in self.basis]
        places = sorted({key for image in images for key in image})
        if not places:
            return self.basis
        table = field.matrix([[image.get(key, field.zero) for key in places] for image in images])
        return tuple(combined(row, self.basis) for row in table.left_null_space().to_rows())

    def __repr__(self) -> str:
        return f"<invariant {self.degree}-forms of {self.pair!r}: dimension {self.dimension}>"


def derived(form: Mapping[tuple[int, ...], Any], rules: Sequence[Mapping[tuple[int, ...], Any]]) -> Form:
    """The image of a form under the derivation, or antiderivation of degree 1, with given values on covectors."""
    total: Form = {}
    for indices, value in form.items():
        for p, index in enumerate(indices):
            before, after = indices[:p], indices[p + 1 :]
            for inserted, c in rules[index].items():
                merged = (*before, *inserted, *after)
                if len(set(merged)) < len(merged):
                    continue
                odd = (sum(a > b for a, b in combinations(merged, 2)) + p * (len(inserted) - 1)) % 2
                key = tuple(sorted(merged))
                term = value * c
                total[key] = total.get(key, 0) + (-term if odd else term)
    return {key: value for key, value in total.items() if value != 0}


def combined(coefficients: Iterable[Any], forms: Iterable[Form]) -> Form:
    """The linear combination of forms."""
    total: Form = {}
    for c, form in zip(coefficients, forms, strict=True):
        for key, value in form.items():
            total[key] = total.get(key, 0) + c * value
    return {key: value for key, value in total.items() if value != 0}


def _differentials(split: ReductiveSplit) -> list[Form]:
    """The differentials of the dual basis of V: d e^l = -sum_{i<j} [m_i, m_j]_l e^i e^j."""
    rules: list[Form] = [{} for _ in range(split.dimension)]
    for i, j in combinations(range(split.dimension), 2):
        for index, c in enumerate(split.horizontal[i].row(j)):
            if c != 0:
                rules[index][i, j] = -c
    return rules


def invariant_differential_forms(pair: Pair, degree: int) -> InvariantDifferentialForms:
    """Implements `Pair.invariant_forms`."""
    if isinstance(degree, bool) or not isinstance(degree, int) or degree < 0:
        raise InputError(f"the degree of forms is {displayed(degree)}, expected an integer from 0")
    return InvariantDifferentialForms(pair, degree)


def invariant_cohomology(pair: Pair) -> tuple[int, ...]:
    """Implements `Pair.invariant_cohomology`."""
    d = reductive_split(pair).dimension
    within("entries", comb(d, d // 2) ** 2, "the equations for invariant forms have {} entries")
    spaces = [InvariantDifferentialForms(pair, k) for k in range(d + 1)]
    ranks = [0, *(s.rank() if s.dimension else 0 for s in spaces)]
    return tuple(s.dimension - ranks[k] - ranks[k + 1] for k, s in enumerate(spaces))


# Symplectic forms: closed and non-degenerate invariant 2-forms.


@final
class InvariantSymplecticForms:
    """The closed invariant 2-forms of G/H; the non-degenerate ones among them are the symplectic forms.

    Attributes
    ----------
    pair : Pair
    closed : tuple of Matrix
        A basis of the closed invariant 2-forms, skew matrices (d, d).
    example : Matrix or None
        A non-degenerate one, or None if all closed invariant 2-forms are degenerate.

    Examples
    --------
    >>> import liehom as lh
    >>> su3 = lh.su(3)
    >>> forms = lh.Pair(su3, su3.cartan_subalgebra()).invariant_symplectic_forms()
    >>> len(forms.closed), forms.exist, lh.pair("g2/su(3)").invariant_symplectic_forms().exist
    (2, True, False)
    """

    def __init__(self, pair: Pair) -> None:
        split = reductive_split(pair)
        self.pair = pair
        d, field = split.dimension, split.field
        matrices = []
        for form in InvariantDifferentialForms(pair, 2).closed():
            rows = [[field.zero] * d for _ in range(d)]
            for (i, j), value in form.items():
                rows[i][j], rows[j][i] = value, -value
            matrices.append(field.matrix(rows, (d, d)))
        self.closed: tuple[ExactMatrix, ...] = tuple(matrices)
        self.example: ExactMatrix | None = non_singular_member(matrices)

    @property
    def exist(self) -> bool:
        """Whether G/H has an invariant symplectic form."""
        return self.example is not None

    def __repr__(self) -> str:
        return f"<{len(self.closed)} closed invariant 2-forms of {self.pair!r}, symplectic forms: {self.exist}>"


def non_singular_member(matrices: Sequence[ExactMatrix]) -> ExactMatrix | None:
    """A non-singular combination of square matrices, or None if all combinations are singular.

    Random combinations are tried first. The generic rank of the matrix with symbols as coefficients proves "None".
    """
    if not matrices:
        return None
    field, d = matrices[0].field, matrices[0].nrows
    rng = random.Random(3)
    for _ in range(6):
        total = sum((m.scale(rng.randint(1, 1000)) for m in matrices), field.zeros(d, d))
        if total.rank() == d:
            return total
    if d % 2 and all(-m == m.T for m in matrices):
        return None
    if len(matrices) == 1 or field.stack_rows(list(matrices), d).rank() < d:
        return None
    if field.degree > 1:
        raise UndecidedError(f"whether {len(matrices)} matrices over {field.name} have a non-singular combination")
    exponents = [tuple(int(a == b) for b in range(len(matrices))) for a in range(len(matrices))]
    entries = [
        [{e: m[i, j] for e, m in zip(exponents, matrices, strict=True) if m[i, j] != 0} for j in range(d)]
        for i in range(d)
    ]
    if PolynomialMatrix(len(matrices), entries, (d, d)).rank == d:
        raise InternalError("a non-singular combination of matrices was not found")
    return None


# Complex structures: J in End_h(V) with J^2 = -1 and [JX, JY] - J[JX, Y] - J[X, JY] - [X, Y] = 0 in V.


def invariant_complex_structures(pair: Pair) -> tuple[Matrix, ...]:
    """Implements `Pair.invariant_complex_structures`."""
    split = reductive_split(pair)
    structures = almost_complex_structures(split)
    return tuple(j for j in structures if (_nijenhuis(split, np.asarray(j)) == 0).all())


def almost_complex_structures(split: ReductiveSplit) -> list[ExactMatrix]:
    """All J in End_h(V) with J^2 = -1, up to signs on inequivalent isotropy summands; undecided for equivalent ones."""
    d, field = split.dimension, split.field
    maps = commutant(split.isotropy, d, field)
    if any(a @ b != b @ a for a, b in combinations(maps, 2)):
        raise UndecidedError(
            f"{displayed(split.pair)} has equivalent isotropy summands, so its almost complex structures form "
            "families, which are not searched for complex structures"
        )
    if d % 2:
        return []
    generator, polynomial = MatrixAlgebra(field, d, maps).generator()
    units = []
    for factor, _ in polynomial.factor():
        if factor.degree == 1:
            return []  # a summand of real type
        if factor.degree > 2:
            raise UndecidedError("the isotropy summands are not defined over the field of the pair; extend it by .over")
        units.append((kernel_projector(generator, polynomial, factor), factor))
    # (T - b)^2 = -c on a summand with polynomial t^2 - 2 b t + b^2 + c
    signs = [(f.coefficients[1] * f.coefficients[1] / 4 - f.coefficients[0]) for _, f in units]
    if any(field.sign(s) >= 0 for s in signs):
        return []
    over: Any = field if field.degree > 1 else common_field([f"sqrt({-s})" for s in signs])
    blocks = []
    for (projector, f), s in zip(units, signs, strict=True):
        shifted = (generator + field.identity(d).scale(f.coefficients[1] / 2)) @ projector
        blocks.append(over.read(shifted).scale(over.one / over.sqrt(over.convert(-s))))
    return [
        sum((b.scale(e) for e, b in zip(choice, blocks, strict=True)), over.zeros(d, d))
        for choice in product((1, -1), repeat=len(blocks))
    ]


def _nijenhuis(split: ReductiveSplit, j: ObjectArray) -> ObjectArray:
    """The tensor [JX, JY] - J[JX, Y] - J[X, JY] - [X, Y], indices (X, Y, component)."""
    brackets = split.brackets()
    one = np.tensordot(j.T, brackets, 1)  # [J m_i, m_j]
    both = np.tensordot(j.T, one, (1, 1)).transpose(1, 0, 2)  # [J m_i, J m_j]
    other = one - one.transpose(1, 0, 2)  # [J m_i, m_j] + [m_i, J m_j]
    tensor: ObjectArray = both - other @ j.T - brackets
    return tensor


def kaehler_form(metric: InvariantMetric) -> Matrix | None:
    """Implements `InvariantMetric.kaehler_form`."""
    field: Any = metric.field
    d, split = len(metric.matrix()), metric.metrics.split
    if not isinstance(field, ExactField) or metric.signature()[0] < d:
        raise InputError("a Kaehler form is computed for a positive definite metric with numbers as parameters")
    operators = [field.matrix(a.T, (d, d)) for a in metric.connection()] + [field.read(a) for a in split.isotropy]
    return non_singular_member(list(invariant_forms(operators, d, field).skew))


# Connections: Nomizu maps Lambda in Hom_h(V x V, V).


@final
class InvariantConnections:
    """The invariant affine connections of G/H, the result of `Pair.invariant_connections`.

    Attributes
    ----------
    pair : Pair
    basis : tuple of arrays
        A basis of Hom_h(V x V, V), arrays (d, d, d): entry (i, j, l) is the part of Lambda(m_i) m_j on m_l. Zero
        is the canonical connection of the complement m.

    Examples
    --------
    >>> import liehom as lh
    >>> connections = lh.pair("g2/su(3)").invariant_connections()
    >>> connections.dimension, connections([0, 0]).torsion().any()
    (2, np.True_)
    """

    def __init__(self, pair: Pair) -> None:
        self.pair = pair
        self._split = split = reductive_split(pair)
        d, field = split.dimension, split.field
        one = field.identity(d)
        squares = [kronecker(a, one) + kronecker(one, a) for a in split.isotropy]
        maps = intertwiners(squares, split.isotropy, (d, d * d), field)
        self.basis: tuple[ObjectArray, ...] = tuple(np.asarray(t.T).reshape(d, d, d) for t in maps)

    @property
    def dimension(self) -> int:
        """Dimension of the space of invariant connections, an int."""
        return len(self.basis)

    def __call__(self, parameters: Sequence[ScalarLike]) -> InvariantConnection:
        """The connection with given coefficients, numbers of the field of the pair, in the basis."""
        values: list[Any] = list(parameters)
        if len(values) != self.dimension:
            raise ShapeError(f"{len(values)} parameters were given, expected {self.dimension}")
        field, d = self._split.field, self._split.dimension
        total = np.full((d, d, d), QQ.zero, dtype=object)
        for x, t in zip(values, self.basis, strict=True):
            total = total + t * field.convert(x)
        return InvariantConnection(self._split, total)

    def __repr__(self) -> str:
        return f"<invariant connections of {self.pair!r}: dimension {self.dimension}>"


@final
class InvariantConnection:
    """An invariant affine connection of G/H, by its Nomizu map.

    Attributes
    ----------
    nomizu : array (d, d, d)
        Entry (i, j, l) is the part of Lambda(m_i) m_j on m_l.
    """

    def __init__(self, split: ReductiveSplit, nomizu: ObjectArray) -> None:
        self._split = split
        self.nomizu: ObjectArray = nomizu

    def torsion(self) -> ObjectArray:
        """T(X, Y) = Lambda(X) Y - Lambda(Y) X - [X, Y]_m, an array (d, d, d)."""
        total: ObjectArray = self.nomizu - self.nomizu.transpose(1, 0, 2) - self._split.brackets()
        return total

    def curvature(self) -> ObjectArray:
        """R(X, Y) Z, an array (d, d, d, d) with the indices (X, Y, Z, component)."""
        return curvature_of(self._split, self.nomizu)


def kronecker(a: ExactMatrix, b: ExactMatrix) -> ExactMatrix:
    """The Kronecker product of two square matrices."""
    table = np.kron(np.asarray(a), np.asarray(b))
    return a.field.matrix(table, table.shape)
