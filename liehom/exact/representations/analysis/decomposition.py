"""Equivalence of representations, invariant Hermitian forms, decomposition over the reals, primitive pairs."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, cast, final

import numpy as np

from liehom.base.errors import (
    CertificateError,
    FieldError,
    InputError,
    NotCompletelyReducibleError,
    UndecidedError,
    displayed,
)
from liehom.base.objects import Displayed
from liehom.base.typing import Array
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.structure.ideals import over_extension
from liehom.exact.representations.analysis.isotypic import (
    COMMUTANT_DIMENSIONS,
    CommutantType,
    complex_structure,
    imaginary_units,
    irreducible_pieces,
    isotypic_pieces,
)
from liehom.exact.representations.analysis.submodules import is_completely_reducible, restricted, socle
from liehom.exact.representations.core.elements import exact_matrices, generating_matrices
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.invariants.intertwiners import all_maps, commutant, intertwiners
from liehom.exact.representations.invariants.irreducibility import combination, is_irreducible
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.extension import Extension, adjoin_root, trivial_extension
from liehom.exact.scalars.field import Field, MatrixLike, Scalar
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.roots import is_basis_of_reals
from liehom.exact.scalars.subspaces import Subspace

# Over an infinite field there is an invertible intertwiner over the field if there is a real one (Noether-Deuring).
# For completely reducible V = sum m_i V_i and W = sum n_i V_i with End(V_i) of dimension d_i, dim End V + dim End W - 2
# dim Hom(V, W) = sum d_i (m_i - n_i)^2 is zero if and only if V and W are equivalent.  In general Hom(V, W) is a module
# over End V; if T generates it and is not invertible, then no T u is invertible.

ATTEMPTS = 30


def intertwining_maps(rho: Representation, sigma: Representation) -> list[ExactMatrix]:
    """Implements `Representation.intertwiners`."""
    if not hasattr(sigma, "algebra") or not hasattr(sigma, "matrices"):
        raise InputError(f"expected a Representation of the algebra, such as lh.adjoint(g); got {displayed(sigma)}")
    if rho.algebra is not sigma.algebra:
        if rho.field != sigma.field:
            raise FieldError(f"representations over {rho.field.name} and {sigma.field.name}: bring both over one field")
        if rho.algebra != sigma.algebra:
            raise InputError(f"representations of two algebras, {rho.algebra!r} and {sigma.algebra!r}")
    if not rho.field.exact:
        raise UndecidedError(
            "floats do not decide which maps are intertwiners: build the representations over QQ or a number field, or "
            "go to exact numbers by lh.rationalize(rho, max_denominator=...)"
        )
    if not rho.matrices:
        return all_maps(rho.field, sigma.size, rho.size)
    size = max(rho.size, sigma.size)
    left, right = generating_matrices(rho, size), generating_matrices(sigma, size)
    return intertwiners(left, right, (sigma.size, rho.size), rho.field)


def equivalence(rho: Representation, sigma: Representation) -> ExactMatrix | None:
    """Implements `Representation.equivalence`."""
    maps = intertwining_maps(rho, sigma)
    if rho.size != sigma.size:
        return None
    if rho.size == 0:
        return cast(ExactMatrix, rho.field.identity(0))
    own = len(_endomorphisms(rho))
    if len(maps) != own or len(maps) != len(_endomorphisms(sigma)):
        return None
    rng = random.Random(own)
    for attempt in range(ATTEMPTS):
        bound = attempt // 4 + 1
        total: ExactMatrix = rho.field.zeros(rho.size, rho.size)
        for t in maps:
            total = total + t.scale(rng.randint(-bound, bound))
        # invertible modulo a prime proves it; the rank decides otherwise
        if total.rank() == rho.size:
            return total
        if attempt >= ATTEMPTS // 3 and _generates(rho, total, own):
            return None
    if is_completely_reducible(rho) and is_completely_reducible(sigma):
        raise UndecidedError("the dimensions say equivalent, and no invertible intertwiner was found: try again")
    raise UndecidedError(
        "the representations are not completely reducible, all dimensions of intertwiners agree, and no random "
        "intertwiner is invertible: they are very likely not equivalent, which is not proved"
    )


def _endomorphisms(rho: Representation) -> list[ExactMatrix]:
    return commutant(generating_matrices(rho), rho.size, rho.field)


def _generates(rho: Representation, t: ExactMatrix, dimension: int) -> bool:
    """Whether u -> t u is injective on End(rho): then t generates Hom(rho, sigma), of the same dimension."""
    n = rho.size
    rows = [(t @ u).reshape(1, n * n) for u in _endomorphisms(rho)]
    return int(rho.field.stack_rows(rows, n * n).rank()) == dimension


# For J in the commutant with J^2 = -1, a Hermitian form is h(u, v) = s(u, v) + i s(u, J v), linear in u and antilinear
# in v with i u = J u.  Here s is symmetric and s(J u, v) = -s(u, J v).  Three anticommuting units I, J, K give h = s(u,
# v) + i s(u, I v) + j s(u, J v) + k s(u, K v), with s symmetric for Hermitian and skew-symmetric for skew-Hermitian
# forms.  h is invariant if and only if s is.  Units need only satisfy J^2 = -d, d > 0.


@final
@dataclass(frozen=True, slots=True)
class HermitianForms:
    """The invariant Hermitian forms of a representation with a structure, by their real parts.

    Attributes
    ----------
    kind : {'complex', 'quaternionic'}
    units : tuple of (Matrix, scalar)
        One or three anticommuting matrices J of the commutant with J^2 = -d, and d > 0.
    hermitian : tuple of Matrix
        A basis of the real parts s (symmetric) of the Hermitian forms: a real vector space.
    skew_hermitian : tuple of Matrix
        A basis of the real parts (skew-symmetric) of the skew-Hermitian forms; in the complex case these are the i h.

    Examples
    --------
    >>> import liehom as lh
    >>> forms = lh.defining(lh.su(2, 1)).hermitian_forms()
    >>> forms.kind, len(forms.hermitian), sorted(forms.signature(forms.hermitian[0]))
    ('complex', 1, [0, 1, 2])
    """

    kind: Literal["complex", "quaternionic"]
    units: tuple[tuple[ExactMatrix, Scalar], ...]
    hermitian: tuple[ExactMatrix, ...]
    skew_hermitian: tuple[ExactMatrix, ...]

    def signature(self, form: ExactMatrix) -> tuple[int, int, int]:
        """Signature (positive, negative, zero) over C or H of a Hermitian form, given by its real part."""
        per = 2 if self.kind == "complex" else 4
        positive, negative, zero = form.signature()
        return positive // per, negative // per, zero // per

    def imaginary_part(self, form: ExactMatrix, unit: int = 0) -> ExactMatrix:
        """The matrix of the part s(u, J v) / sqrt(d) at the unit i (0), j (1) or k (2), over a field with sqrt(d).

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.su(2)).hermitian_forms()
        >>> part = forms.imaginary_part(forms.hermitian[0])
        >>> part == -part.T
        True
        """
        structure, square = self.units[unit]
        value = form @ structure
        f = Polynomial(value.field, [-square, 0, 1]).factor()[0][0]
        up, root = adjoin_root(f, f.degree - 1)
        return up.matrix(value).scale(1 / (root if up.field.sign(root) > 0 else -root))


def hermitian_forms(rho: Representation, structure: MatrixLike | None = None) -> HermitianForms:
    """Implements `Representation.hermitian_forms`."""
    matrices, size, field = exact_matrices(rho), rho.size, rho.field
    if structure is not None:
        units = [_checked(rho, structure)]
    else:
        units = imaginary_units(matrices, size, field)
        if not units:
            complex_structure(matrices, size, field)  # says what is missing
    forms = rho.invariant_forms()
    hermitian, skew = _adapted(forms.symmetric, units), _adapted(forms.skew, units)
    return HermitianForms("complex" if len(units) == 1 else "quaternionic", tuple(units), hermitian, skew)


def _checked(rho: Representation, structure: MatrixLike) -> tuple[ExactMatrix, Scalar]:
    size, field = rho.size, rho.field
    j = field.read(structure, (size, size))
    failing = next((i for i, a in enumerate(rho.matrices) if j @ a != a @ j), None)
    if failing is not None:
        raise InputError(f"the structure does not commute with the matrix of basis element {failing}")
    square = j @ j
    value = square[0, 0] if size else -field.one
    if square != field.identity(size).scale(value) or field.sign(value) >= 0:
        raise InputError("the square of a complex structure is a negative number times the identity")
    return j, -value


def _adapted(forms: Sequence[ExactMatrix], units: Sequence[tuple[ExactMatrix, Scalar]]) -> tuple[ExactMatrix, ...]:
    """The combinations s of the forms with s(J u, v) = -s(u, J v) for all units."""
    if not forms:
        return ()
    field, size = forms[0].field, forms[0].nrows
    rows = [field.stack_columns([(j.T @ s + s @ j).reshape(1, size * size) for j, _ in units], 1) for s in forms]
    weights = field.stack_rows(rows, size * size * len(units)).left_null_space()
    return tuple(combination(forms, weights.row(i)) for i in range(weights.nrows))


# V = V^g + gV.  The isotypic components of gV correspond to the real places of the centre of its commutant
# (`isotypic`); zero divisors of the commutant split each of them (`splitting`).  A component is defined over the
# smallest real number field of its isotypic component, or over a larger field if the multiplicity cannot be split over
# that field.


@final
@dataclass(frozen=True, slots=True)
class Component:
    """An irreducible component over the reals.

    Attributes
    ----------
    subspace : Subspace
        Over ``field``, which is the field of the representation or a larger real number field.
    representation : Representation
        The restriction, in the canonical basis of the subspace, over the same field.
    type : {'R', 'C', 'H'}
        The commutant over the reals.
    isotypic : int
        Index of the isotypic component to which it belongs.
    extension : Extension
        The embedding of the field of the representation in the field of the component.

    Examples
    --------
    >>> import liehom as lh
    >>> first = lh.Representation.from_matrices([[[0, 2], [1, 0]]]).decomposition().components[0]
    >>> first.field, first.dimension, first.type, first.subspace.rows()
    (QQ(sqrt(2)), 1, 'R', [[1, -1/2*sqrt(2)]])
    """

    subspace: Subspace
    representation: Representation
    type: CommutantType
    isotypic: int
    extension: Extension

    @property
    def field(self) -> Field:
        """The real number field over which the component is given."""
        return self.subspace.field

    @property
    def dimension(self) -> int:
        """Dimension of the component, an int."""
        return self.subspace.dimension


@final
@dataclass(frozen=True, slots=True)
class IsotypicComponent:
    """The sum of all irreducible subspaces of one equivalence class (over the reals).

    Attributes
    ----------
    subspace : Subspace
        Over the smallest real number field over which it is defined.
    type : {'R', 'C', 'H'}
    multiplicity : int
    components : tuple of int
        Indices of its irreducible components.
    extension : Extension
        The embedding of the field of the representation in the field of the component.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.defining(lh.so(3))
    >>> isotypic = so3.direct_sum(so3).decomposition().isotypic[0]
    >>> isotypic.multiplicity, isotypic.dimension, isotypic.irreducible_dimension, isotypic.components
    (2, 6, 3, (0, 1))
    """

    subspace: Subspace
    type: CommutantType
    multiplicity: int
    components: tuple[int, ...]
    extension: Extension

    @property
    def field(self) -> Field:
        """The real number field over which the component is given."""
        return self.subspace.field

    @property
    def dimension(self) -> int:
        """Dimension of the component, an int."""
        return self.subspace.dimension

    @property
    def irreducible_dimension(self) -> int:
        """The dimension of each of the irreducible summands."""
        return self.subspace.dimension // self.multiplicity


@final
@dataclass(frozen=True, slots=True)
class Decomposition(Displayed):
    """A representation as a direct sum of irreducible representations over the reals.

    Attributes
    ----------
    representation : Representation
    components : tuple of Component
        Grouped by isotypic component. Their sum is direct, and is the whole space (over the reals).
    isotypic : tuple of IsotypicComponent
        In order of the dimension of the irreducible representation, then of the degree of the field.

    Notes
    -----
    The isotypic components are unique, and each is given over the smallest field over which it is defined. The
    irreducible components of an isotypic component of multiplicity above one are a choice.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.defining(lh.so(3))
    >>> decomposition = so3.tensor(so3).decomposition()
    >>> decomposition
    <decomposition of a representation on QQ^9: 1 + 3 + 5>
    >>> decomposition.verify()
    True
    """

    representation: Representation
    components: tuple[Component, ...]
    isotypic: tuple[IsotypicComponent, ...]

    def __iter__(self) -> Iterator[Component]:
        return iter(self.components)

    def __len__(self) -> int:
        return len(self.components)

    def dimensions(self) -> list[int]:
        """List of the dimensions of the irreducible components, in order."""
        return [c.dimension for c in self.components]

    def basis(self) -> Array:
        """The rows of all components as a float matrix (N, N): a basis in which the representation has block form."""
        blocks = [c.subspace.basis.to_numpy() for c in self.components]
        return np.concatenate(blocks) if blocks else np.zeros((0, 0))

    def signatures(self, form: MatrixLike) -> list[tuple[int, int, int]]:
        """List of the signatures (positive, negative, zero) of a symmetric form on the isotypic components.

        If the form is invariant, components that are not dual to each other are orthogonal.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.gl(2))
        >>> rho.decomposition().signatures(rho.algebra.killing_form())
        [(0, 0, 1), (2, 1, 0)]
        """
        size = self.representation.size
        matrix = self.representation.field.read(form, (size, size))
        pairs = [(part.subspace.basis, part.extension.matrix(matrix)) for part in self.isotypic]
        return [(rows @ over @ rows.T).signature() for rows, over in pairs]

    def verify(self) -> bool:
        """Whether this is a decomposition into irreducible representations over the reals, proved again.

        Raises
        ------
        CertificateError
            If a component is not invariant, not irreducible or of another type, if the sum is not direct or not the
            whole space, or if components of one group over one field are not equivalent.
        """
        rho = self.representation
        if not is_basis_of_reals([as_exact(c.subspace.basis) for c in self.components], rho.size):
            raise CertificateError("sum", "the components are not a basis of the space")
        for number, component in enumerate(self.components):
            self._verify_component(number, component)
        return True

    def _verify_component(self, number: int, component: Component) -> None:
        field, dimension = component.field, component.dimension
        matrices = exact_matrices(component.representation)
        over = [component.extension.matrix(a) for a in exact_matrices(self.representation)]
        if restricted(over, as_exact(component.subspace.basis)) != list(matrices):
            raise CertificateError("restriction", f"component {number} is not the restriction to its subspace")
        generating = generating_matrices(component.representation)
        if not is_irreducible(matrices, dimension, field, generating):
            raise CertificateError("irreducible", f"component {number} is reducible")
        if len(commutant(generating, dimension, field)) != COMMUTANT_DIMENSIONS[component.type]:
            raise CertificateError("type", f"component {number} is not of type {component.type}")
        first = self.components[self.isotypic[component.isotypic].components[0]]
        shape, firsts = (dimension, first.dimension), exact_matrices(first.representation)
        if matrices and first.field == field and not intertwiners(firsts, matrices, shape, field):
            raise CertificateError("isotypic", f"component {number} is not equivalent to the first of its group")

    def __repr__(self) -> str:
        terms = []
        for isotypic in self.isotypic:
            n, m = isotypic.irreducible_dimension, isotypic.multiplicity
            kind = "" if isotypic.type == "R" else f"({isotypic.type})"
            terms.append(f"{m} x {n}{kind}" if m > 1 else f"{n}{kind}")
        rho = self.representation
        return f"<decomposition of a representation on {rho.field.name}^{rho.size}: {' + '.join(terms) or '0'}>"


def decomposition(rho: Representation) -> Decomposition:
    """Implements `Representation.decomposition`."""
    dimension = socle(rho).dimension
    if dimension < rho.size:
        raise NotCompletelyReducibleError(
            f"the representation is not completely reducible: its irreducible subspaces span {dimension} of "
            f"{rho.size} dimensions; decompose rho.subrepresentation(rho.socle()), or use socle() and quotient()"
        )
    restrictions = _Restrictions(rho)
    components: list[Component] = []
    isotypic: list[IsotypicComponent] = []
    for group in sorted(_groups(rho), key=lambda g: (g.rows[0].nrows, g.extension.field.degree)):
        first = len(components)
        for rows, extension in zip(group.rows, group.extensions, strict=True):
            subspace = Subspace(extension.field, rows, rho.size)
            restriction = restrictions.to(subspace, extension)
            components.append(Component(subspace, restriction, group.type, len(isotypic), extension))
        numbers = tuple(range(first, len(components)))
        subspace = Subspace(group.extension.field, group.span, rho.size)
        isotypic.append(IsotypicComponent(subspace, group.type, len(numbers), numbers, group.extension))
    return Decomposition(rho, tuple(components), tuple(isotypic))


@final
@dataclass(frozen=True, slots=True)
class _Group:
    """A split isotypic component, its span and summands by rows over their fields, in coordinates of R^N."""

    type: CommutantType
    span: ExactMatrix
    extension: Extension
    rows: tuple[ExactMatrix, ...]
    extensions: tuple[Extension, ...]


def _groups(rho: Representation) -> Iterator[_Group]:
    """The groups of V^g, which is not split by its commutant, and of the isotypic components of gV."""
    field, size = cast(ExactField, rho.field), rho.size
    fixed = as_exact(rho.invariant_vectors().basis) if rho.matrices else field.identity(size)
    base = trivial_extension(field)
    if fixed.nrows:
        single = tuple(fixed.split_rows(1, size))
        yield _Group("R", fixed, base, single, (base,) * len(single))
    if fixed.nrows == size:
        return
    # [x, y] V lies in x V + y V, so gV is the sum over generators
    generating = generating_matrices(rho)
    moved = field.stack_rows([a.T for a in generating], size).row_space() if fixed.nrows else field.identity(size)
    for group in isotypic_pieces(field, moved.nrows, commutant(restricted(generating, moved), moved.nrows, field)):
        pieces = irreducible_pieces(group)
        span, *rows = (piece.rows @ piece.extension.matrix(moved) for piece in (group.piece, *pieces))
        yield _Group(group.type, span, group.piece.extension, tuple(rows), tuple(piece.extension for piece in pieces))


class _Restrictions:
    """Restrictions of a representation to subspaces over several fields, with one base change for each field."""

    def __init__(self, rho: Representation) -> None:
        self.rho = rho
        self._seen: list[tuple[Extension, LieAlgebra, list[ExactMatrix]]] = []

    def to(self, subspace: Subspace, extension: Extension) -> Representation:
        if subspace.dimension == self.rho.size and extension.is_trivial:
            return self.rho
        algebra, matrices = self._over(extension)
        # The restriction of a homomorphism to an invariant subspace: kernels of commuting matrices are invariant.
        blocks = restricted(matrices, as_exact(subspace.basis), check=False)
        return Representation(algebra, blocks, size=subspace.dimension, check=False)

    def _over(self, extension: Extension) -> tuple[LieAlgebra, list[ExactMatrix]]:
        if extension.is_trivial:
            return self.rho.algebra, list(exact_matrices(self.rho))
        for seen, algebra, matrices in self._seen:
            if seen == extension:
                return algebra, matrices
        base = self.rho.algebra
        entries = [(i, j, k, extension.embed(v)) for i, j, k, v in base.table]
        table = StructureConstants(extension.field, base.dimension, entries)
        # The same identities in a larger field.
        algebra = LieAlgebra(table, basis=base.basis_names, name=base.name, check=False)
        matrices = [extension.matrix(a) for a in exact_matrices(self.rho)]
        self._seen.append((extension, algebra, matrices))
        return algebra, matrices


# A subalgebra strictly between h and g is an h-submodule of g that contains h. Its image in g/h contains an irreducible
# submodule S of g/h. Hence h is maximal if and only if h and S generate g for every irreducible S. These S are in the
# socle of g/h. If its irreducible components are pairwise inequivalent over the reals, they are the only ones.


def is_primitive(pair: Pair) -> bool:
    """Implements `Pair.is_primitive`."""
    if not isinstance(pair.field, ExactField):
        raise UndecidedError(
            f"maximal subalgebras are decided over exact fields; found {pair.field.name}; make the pair exact by "
            "lh.rationalize"
        )
    if pair.dimension == 0:
        return False
    rho = pair.isotropy_representation()
    socle = rho.socle()
    parts = rho.subrepresentation(socle).decomposition()
    if not all(_generates_algebra(pair, component, socle) for component in parts.components):
        return False
    if any(part.multiplicity > 1 for part in parts.isotypic):
        raise UndecidedError(
            f"g/h of {pair!r} contains equivalent irreducible subspaces, so infinitely many: {parts!r}; no subalgebra "
            "between h and g was found in the ones that were tried"
        )
    return True


def _generates_algebra(pair: Pair, component: Component, socle: Subspace) -> bool:
    """Whether h and an irreducible subspace of the socle of g/h generate g."""
    up = component.extension
    algebra = over_extension(pair.algebra, up)
    lift = up.matrix(as_exact(socle.basis) @ as_exact(pair.subalgebra.quotient().lift))
    blocks = [up.matrix(as_exact(pair.subalgebra.basis)), as_exact(component.subspace.basis) @ lift]
    rows = component.subspace.field.stack_rows(blocks, algebra.dimension)
    return algebra.subalgebra_generated_by(rows).dimension == algebra.dimension
