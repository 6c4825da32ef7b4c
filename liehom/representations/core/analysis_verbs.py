"""AnalysisVerbs: the analysis of a representation as methods, each a line into the file that does the work.

intertwiners, irreducibility, commutant_type, hermitian_forms, complete_reducibility, decomposition,
weight_multiplicities, equivalence, submodules.  `Representation` inherits it; nothing else should.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from liehom.errors import FieldError
from liehom.representations.core.generating_matrices import generating_matrices
from liehom.representations.invariants.intertwiners import InvariantForms, commutant, invariant_forms, invariant_vectors
from liehom.representations.invariants.irreducibility import is_irreducible
from liehom.scalars import Subspace

if TYPE_CHECKING:
    from liehom.representations.analysis.decomposition import Decomposition
    from liehom.representations.analysis.hermitian_forms import HermitianForms
    from liehom.representations.analysis.isotypic import Type
    from liehom.representations.core.representation import Representation


class AnalysisVerbs:
    """What a representation answers about itself; all of it exact, over QQ or a real number field."""

    __slots__ = ()

    # -- what commutes, what is invariant ----------------------------------------------------------------
    def commutant(self: Representation) -> list[Any]:  # type: ignore[misc]
        """A basis of the matrices that commute with all rho(x), proved exactly.

        Raises
        ------
        FieldError
            Over float64.

        Examples
        --------
        >>> import liehom as lh
        >>> len(lh.defining(lh.su(2)).commutant())
        4
        """
        return commutant(generating_matrices(exact(self)), self.size, self.field)

    def commutant_type(self: Representation) -> Type:  # type: ignore[misc]
        """'R', 'C' or 'H': what commutes, over the reals, with an irreducible representation.

        Raises
        ------
        InputError
            If the representation is reducible over the reals; use `decomposition`.
        FieldError
            Over float64.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.defining(g).commutant_type() for g in (lh.so(3), lh.su(3), lh.su(2))]
        ['R', 'C', 'H']
        """
        from liehom.representations.analysis.commutant_type import commutant_type

        known = _is_known_semisimple(exact(self))
        return commutant_type(self.matrices, self.size, self.field, generating_matrices(self), semisimple=known)

    def invariant_forms(self: Representation) -> InvariantForms:  # type: ignore[misc]
        """The bilinear forms P with rho(x)^T P + P rho(x) = 0 for all x, symmetric and skew ones apart.

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.so(3, 1)).invariant_forms()
        >>> len(forms.symmetric), len(forms.skew), forms.symmetric[0].signature()
        (1, 0, (3, 1, 0))
        """
        return invariant_forms(generating_matrices(exact(self)), self.size, self.field)

    def hermitian_forms(self: Representation, structure: Any = None) -> HermitianForms:  # type: ignore[misc]
        """The invariant Hermitian forms for a complex structure J, or for the commutant of an irreducible one.

        Parameters
        ----------
        structure : (N, N) array_like, optional
            J with J^2 = -d, d > 0, commuting with all rho(x). By default the representation must be irreducible of
            type C (complex Hermitian forms) or H (quaternionic ones).

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.sp(2)).hermitian_forms()
        >>> forms.kind, len(forms.hermitian), len(forms.skew_hermitian)
        ('quaternionic', 1, 0)
        """
        from liehom.representations.analysis.hermitian_forms import hermitian_forms

        return hermitian_forms(exact(self), structure)

    def invariant_vectors(self: Representation) -> Subspace:  # type: ignore[misc]
        """The subspace of vectors that all rho(x) kill.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.gl(2)).invariant_vectors().dimension
        1
        """
        return invariant_vectors(generating_matrices(exact(self)), self.size, self.field)

    # -- irreducible parts -------------------------------------------------------------------------------
    def is_irreducible(self: Representation) -> bool:  # type: ignore[misc]
        """Whether no subspace of R^N other than 0 and R^N is invariant; decided exactly, over the reals.

        Notes
        -----
        Irreducible over QQ is weaker: a commutant such as QQ(sqrt(2)) splits over the reals. The zero space is
        not irreducible.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.Representation.from_matrices([[[0, -1], [1, 0]]]).is_irreducible()
        True
        >>> lh.Representation.from_matrices([[[0, 2], [1, 0]]]).is_irreducible()
        False
        """
        known = _is_known_semisimple(exact(self))
        return is_irreducible(self.matrices, self.size, self.field, generating_matrices(self), semisimple=known)

    def is_completely_reducible(self: Representation) -> bool:  # type: ignore[misc]
        """Whether every invariant subspace has an invariant complement.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.gl(3)).is_completely_reducible(), lh.adjoint(lh.heisenberg(1)).is_completely_reducible()
        (True, False)
        """
        from liehom.representations.analysis.complete_reducibility import is_completely_reducible

        return is_completely_reducible(exact(self))

    def socle(self: Representation) -> Subspace:  # type: ignore[misc]
        """The sum of all irreducible invariant subspaces, the largest completely reducible one.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.heisenberg(1)).socle().rows()
        [[0, 0, 1]]
        """
        from liehom.representations.analysis.complete_reducibility import socle

        return socle(exact(self))

    def decomposition(self: Representation) -> Decomposition:  # type: ignore[misc]
        """The decomposition into irreducible representations over the reals, exactly.

        Returns
        -------
        Decomposition
            Each component has its subspace, representation, type and field: QQ, or the real number field that its
            splitting needs.

        Raises
        ------
        NotCompletelyReducibleError
            If the representation is not completely reducible; see `socle`.
        FieldError
            Over float64.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3, 1))
        >>> [(c.dimension, c.type) for c in rho.tensor(rho).decomposition()]
        [(1, 'R'), (6, 'C'), (9, 'R')]
        """
        from liehom.representations.analysis.decomposition import decomposition

        return decomposition(exact(self))

    # -- over the complex numbers ------------------------------------------------------------------------
    def weights(self: Representation) -> dict[tuple[int, ...], int]:  # type: ignore[misc]
        """The weights with their multiplicities, for a semisimple algebra in any basis.

        Returns
        -------
        dict
            {weight: multiplicity} in fundamental coordinates, in Bourbaki's numbering of
            ``algebra.semisimple_type()``; up to the symmetries of the Dynkin diagram.

        Raises
        ------
        InputError
            If the algebra is not semisimple.
        FieldError
            Over float64.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(3)).weights()
        {(2,): 1, (0,): 1, (-2,): 1}
        """
        from liehom.representations.analysis.weight_multiplicities import weight_multiplicities

        return weight_multiplicities(exact(self))

    def highest_weights(self: Representation) -> dict[tuple[int, ...], int]:  # type: ignore[misc]
        """The irreducible parts of the complexification: {highest weight: how often}, numbered as in `weights`.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> rho.tensor(rho).highest_weights(), lh.defining(lh.so(3, 1)).highest_weights()
        ({(4,): 1, (2,): 1, (0,): 1}, {(1, 1): 1})
        """
        from liehom.representations.analysis.weight_multiplicities import highest_weights

        return highest_weights(exact(self))

    # -- maps to other representations -------------------------------------------------------------------
    def intertwiners(self: Representation, other: Representation) -> list[Any]:  # type: ignore[misc]
        """A basis of the maps T, shape (M, N), with T rho(x) = sigma(x) T for all x.

        Examples
        --------
        >>> import liehom as lh
        >>> len(lh.defining(lh.so(3)).intertwiners(lh.adjoint(lh.so(3))))
        1
        """
        from liehom.representations.analysis.equivalence import intertwining_maps

        return intertwining_maps(self, other)

    def equivalence(self: Representation, other: Representation) -> Any:  # type: ignore[misc]
        """An invertible T with T rho(x) = sigma(x) T for all x, or None: they are not equivalent (proved).

        Raises
        ------
        InputError, FieldError
            If they are representations of two algebras, or over two fields, or over float64.
        UndecidedError
            Where representations that are not completely reducible resist.

        Examples
        --------
        >>> import liehom as lh
        >>> T = lh.defining(lh.so(3)).equivalence(lh.adjoint(lh.so(3)))
        >>> T.rank()
        3
        """
        from liehom.representations.analysis.equivalence import equivalence

        return equivalence(self, other)

    def is_equivalent(self: Representation, other: Representation) -> bool:  # type: ignore[misc]
        """Whether the representations are equivalent; over the reals and over the field this is the same.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.sl(3))
        >>> rho.is_equivalent(rho.dual()), rho.tensor(rho).is_equivalent(rho.symmetric_power(2).direct_sum(rho.dual()))
        (False, True)
        """
        from liehom.representations.analysis.equivalence import equivalence

        return equivalence(self, other) is not None

    # -- invariant subspaces -----------------------------------------------------------------------------
    def submodule(self: Representation, rows: Any) -> Subspace:  # type: ignore[misc]
        """The least invariant subspace that contains the rows.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.so(4)).submodule([[1, 0, 0, 0, 0, 1]]).dimension
        3
        """
        from liehom.representations.analysis.submodules import generated_submodule

        return generated_submodule(exact(self), rows)

    def subrepresentation(self: Representation, subspace: Any) -> Representation:  # type: ignore[misc]
        """The restriction to an invariant subspace (a `Subspace`, or independent rows, which become the basis).

        Raises
        ------
        NotInvariantError
            If the subspace is not invariant; names the vector and the basis element that moves it out.
        DependentRowsError, ShapeError

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.euclidean(2))
        >>> rho.subrepresentation(rho.socle()).size
        2
        """
        from liehom.representations.analysis.submodules import subrepresentation

        return subrepresentation(exact(self), subspace)

    def quotient(self: Representation, subspace: Any) -> Representation:  # type: ignore[misc]
        """The representation on the quotient by an invariant subspace, in the basis of `scalars.spaces.quotient`.

        Raises
        ------
        NotInvariantError
            If the subspace is not invariant; names the vector and the basis element that moves it out.
        DependentRowsError, ShapeError

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.euclidean(2))
        >>> rho.quotient(rho.socle()).matrices[0].is_zero()
        True
        """
        from liehom.representations.analysis.submodules import quotient_representation

        return quotient_representation(exact(self), subspace)

    def invariant_complement(self: Representation, subspace: Any) -> Subspace:  # type: ignore[misc]
        """An invariant complement of an invariant subspace.

        Raises
        ------
        NotCompletelyReducibleError
            If there is none (proved).
        NotInvariantError, DependentRowsError, ShapeError

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.gl(2)).invariant_complement([[1, 0, 0, 1]]).dimension
        3
        """
        from liehom.representations.analysis.submodules import invariant_complement

        return invariant_complement(exact(self), subspace)


def exact(rho: Representation) -> Representation:
    """The representation itself; `FieldError` over float64."""
    if not rho.field.exact:
        raise FieldError("this is computed exactly: build the representation over QQ or a number field")
    return rho


def _is_known_semisimple(rho: Representation) -> bool:
    """Whether the algebra is semisimple, where its Killing form costs less than the trace form of the matrices."""
    from liehom.representations.analysis.complete_reducibility import is_visibly_semisimple

    return 0 < rho.algebra.dimension <= rho.size and is_visibly_semisimple(rho)
