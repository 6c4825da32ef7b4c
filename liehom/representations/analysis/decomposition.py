"""Decomposition: a completely reducible representation as a sum of irreducible ones over the reals, exactly.

V = V^g + gV.  The isotypic components of gV correspond to the real places of the centre of its commutant (`isotypic`);
zero divisors of the commutant split each of them (`splitting`).  A component is defined over the smallest real number
field of its isotypic component, or over a larger field if the multiplicity cannot be split over that field.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast, final

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.display import Displayed
from liehom.errors import CertificateError, NotCompletelyReducibleError
from liehom.representations.analysis.commutant_type import COMMUTANT_DIMENSIONS, CommutantType
from liehom.representations.analysis.complete_reducibility import socle
from liehom.representations.analysis.isotypic import isotypic_pieces
from liehom.representations.analysis.splitting import irreducible_pieces
from liehom.representations.analysis.submodules import restricted
from liehom.representations.core.generating_matrices import exact_matrices, generating_matrices
from liehom.representations.core.representation import Representation
from liehom.representations.invariants.intertwiners import commutant, intertwiners
from liehom.representations.invariants.irreducibility import is_irreducible
from liehom.scalars import ExactField, ExactMatrix, Field, Subspace, as_exact
from liehom.scalars.fields.field import MatrixLike
from liehom.scalars.roots.extension import Extension, trivial_extension
from liehom.scalars.spaces.real_rows import is_basis_of_reals
from liehom.typing import Array


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

        Parameters
        ----------
        form : Matrix, or (N, N) array_like
            A symmetric form, usually invariant: then components that are not dual to each other are orthogonal.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.gl(2))
        >>> rho.decomposition().signatures(rho.algebra.killing_form())
        [(0, 0, 1), (2, 1, 0)]
        """
        size = self.representation.size
        given = self.representation.field.read(form, (size, size))
        pairs = [(part.subspace.basis, part.extension.matrix(given)) for part in self.isotypic]
        return [(rows @ over @ rows.T).signature() for rows, over in pairs]

    def verify(self) -> bool:
        """Whether this is a decomposition into irreducible representations over the reals, proved again.

        Returns
        -------
        bool
            True.

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
        if matrices and first.field == field:
            shape = (dimension, first.dimension)
            if not intertwiners(exact_matrices(first.representation), matrices, shape, field):
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
    found = socle(rho)
    if found.dimension < rho.size:
        raise NotCompletelyReducibleError(
            f"the representation is not completely reducible: its irreducible subspaces span {found.dimension} of "
            f"{rho.size} dimensions; decompose rho.subrepresentation(rho.socle()), or use socle() and quotient()"
        )
    restrictions = _Restrictions(rho)
    components: list[Component] = []
    isotypic: list[IsotypicComponent] = []
    for group in sorted(_groups(rho), key=lambda g: (g.rows[0].nrows, g.extension.field.degree)):
        first, up = len(components), group.extension
        for rows, extension in zip(group.rows, group.extensions, strict=True):
            subspace = Subspace(extension.field, rows, rho.size)
            restriction = restrictions.to(subspace, extension)
            components.append(Component(subspace, restriction, group.type, len(isotypic), extension))
        numbers = tuple(range(first, len(components)))
        whole = Subspace(up.field, group.whole, rho.size)
        isotypic.append(IsotypicComponent(whole, group.type, len(numbers), numbers, up))
    return Decomposition(rho, tuple(components), tuple(isotypic))


@final
@dataclass(frozen=True, slots=True)
class _Group:
    """A split isotypic component: rows over their fields, in the coordinates of the whole space."""

    type: CommutantType
    whole: ExactMatrix
    extension: Extension
    rows: tuple[ExactMatrix, ...]
    extensions: tuple[Extension, ...]


def _groups(rho: Representation) -> Iterator[_Group]:
    """The groups of V^g, which is not split by its commutant, and of the isotypic components of gV."""
    field, size = cast(ExactField, rho.field), rho.size
    fixed = as_exact(rho.invariant_vectors().basis) if rho.matrices else field.identity(size)
    base = trivial_extension(field)
    if fixed.nrows:
        single = tuple(fixed.select(rows=[i]) for i in range(fixed.nrows))
        yield _Group("R", fixed, base, single, (base,) * len(single))
    if fixed.nrows == size:
        return
    # [x, y] V lies in x V + y V, so gV is the sum over generators
    generating = generating_matrices(rho)
    moved = field.stack_rows([a.T for a in generating], size).row_space() if fixed.nrows else field.identity(size)
    inside = restricted(generating, moved)
    for group in isotypic_pieces(field, moved.nrows, commutant(inside, moved.nrows, field)):
        pieces = irreducible_pieces(group)
        whole = group.piece.rows @ group.piece.extension.matrix(moved)
        rows = tuple(piece.rows @ piece.extension.matrix(moved) for piece in pieces)
        yield _Group(group.type, whole, group.piece.extension, rows, tuple(piece.extension for piece in pieces))


class _Restrictions:
    """Restrictions of a representation to subspaces over several fields, with one base change for each field."""

    def __init__(self, rho: Representation) -> None:
        self.rho = rho
        self._seen: list[tuple[Extension, LieAlgebra, list[ExactMatrix]]] = []

    def to(self, subspace: Subspace, extension: Extension) -> Representation:
        if subspace.dimension == self.rho.size and extension.is_trivial:
            return self.rho
        algebra, matrices = self._over(extension)
        # kernels of commuting matrices are invariant
        made = restricted(matrices, as_exact(subspace.basis), check=False)
        # The restriction of a homomorphism to an invariant subspace.
        return Representation(algebra, made, size=subspace.dimension, check=False)

    def _over(self, extension: Extension) -> tuple[LieAlgebra, list[ExactMatrix]]:
        if extension.is_trivial:
            return self.rho.algebra, list(exact_matrices(self.rho))
        for seen, algebra, matrices in self._seen:
            if seen == extension:
                return algebra, matrices
        given = self.rho.algebra
        entries = [(i, j, k, extension.embed(v)) for i, j, k, v in given.table]
        table = StructureConstants(extension.field, given.dimension, entries)
        # The same identities in a larger field.
        algebra = LieAlgebra(table, basis=given.basis_names, name=given.name, check=False)
        matrices = [extension.matrix(a) for a in exact_matrices(self.rho)]
        self._seen.append((extension, algebra, matrices))
        return algebra, matrices
