"""Pair: a Lie algebra with a subalgebra, the infinitesimal description of a homogeneous space G/H."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.scalars.field import Field, Matrix, MatrixLike
from liehom.exact.scalars.subspaces import Subspace

if TYPE_CHECKING:
    from liehom.exact.geometry.forms import (
        InvariantConnections,
        InvariantDifferentialForms,
        InvariantSymplecticForms,
    )
    from liehom.exact.geometry.metrics import InvariantMetric, InvariantMetrics
    from liehom.exact.representations.core.representation import Representation


@final
class Pair(Displayed, Immutable):
    """A pair (g, h) of a Lie algebra and a subalgebra.

    Parameters
    ----------
    algebra : LieAlgebra
    subalgebra : Subalgebra, or rows of coefficients (k, n)
    name : str, optional
        A name to print, such as 'so(4)/so(3)'.

    Notes
    -----
    The tangent space of G/H at the base point is V = g/h, on which h acts by the isotropy representation
    rho(z) (x + h) = [z, x] + h.

    Two pairs are equal (``==``), and hash equal, if their algebras and subalgebras are; names are not compared.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.Pair(lh.so(3), [[0, 0, 1]])
    >>> pair.dimension, [str(m) for m in pair.isotropy_matrices()]
    (2, ['[0, -1]\\n[1, 0]'])
    """

    __slots__ = ("_isotropy", "algebra", "name", "subalgebra")

    def __init__(self, algebra: LieAlgebra, subalgebra: Subalgebra | MatrixLike, *, name: str | None = None) -> None:
        if not isinstance(algebra, LieAlgebra):
            raise InputError(
                f"expected a LieAlgebra and a subalgebra of it, got {displayed(algebra)}; names go to liehom.pair"
            )
        if isinstance(subalgebra, LieAlgebra):
            raise InputError(
                f"expected a subalgebra of the Lie algebra, got {displayed(subalgebra)}: how it lies in g is "
                "not given; write Pair(g, rows) with rows that span it, or Pair(g, g.subalgebra(rows))"
            )
        self.algebra: LieAlgebra = algebra
        self.subalgebra: Subalgebra = (
            subalgebra if isinstance(subalgebra, Subalgebra) else algebra.subalgebra(subalgebra)
        )
        if self.subalgebra.algebra is not algebra and self.subalgebra.algebra != algebra:
            raise InputError("the subalgebra belongs to another Lie algebra")
        self.name: str | None = name
        self._isotropy: list[Matrix] | None = None

    @property
    def field(self) -> Field:
        """The field of the structure constants."""
        return self.algebra.field

    @property
    def dimension(self) -> int:
        """Dimension of G/H, dim g - dim h."""
        return self.subalgebra.codimension

    def over(self, field: Field) -> Pair:
        """The pair over another field that contains the structure constants and the entries of the subalgebra.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.range_condition(lh.pair("so(3)/so(2)").over(lh.RR), [0.6, 0.4, 0.1]))
        the range condition holds at psi: [h, psi] + R psi has rank 2 of 2 in g/h
        """
        return Pair(self.algebra.over(field), self.subalgebra.basis, name=self.name)

    def isotropy_matrices(self) -> list[Matrix]:
        """The matrices (d, d) of rho on g/h, acting on columns, one per row of ``subalgebra.quotient().subspace``."""
        if self._isotropy is None:
            data = self.subalgebra.quotient()
            self._isotropy = [b.T for b in self.algebra.table.contract(data.subspace, data.lift, data.projection)]
        return self._isotropy

    def isotropy_representation(self) -> Representation:
        """The representation of h on g/h, h as a Lie algebra in the basis of ``subalgebra``.

        Coordinates on g/h are those of ``subalgebra.quotient()``.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.Pair(lh.so(3), [[0, 0, 1]]).isotropy_representation()
        <representation of <Lie algebra of dimension 1 over QQ> on QQ^2>
        """
        from liehom.exact.representations.core.representation import Representation

        data = self.subalgebra.quotient()
        # [z, [w, x]] - [w, [z, x]] = [[z, w], x] in g, and all three maps descend to g/h.
        matrices = [b.T for b in self.algebra.table.contract(self.subalgebra.basis, data.lift, data.projection)]
        return Representation(self.subalgebra.as_algebra(), matrices, size=self.dimension, check=False)

    def is_primitive(self) -> bool:
        """Whether h is a maximal subalgebra of g: h != g, and no subalgebra is strictly between h and g.

        Raises
        ------
        UndecidedError
            Over float64, or if g/h contains equivalent irreducible subspaces and no subalgebra between was found.

        Notes
        -----
        Then no foliation of G/H is invariant under G. The answer is over the reals, for any field of the pair.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.pair(name).is_primitive() for name in ("so(4)/so(3)", "sl(3)/P1", "sl(3)/B", "sl(3)/0")]
        [True, True, False, False]
        """
        from liehom.exact.representations.analysis.decomposition import is_primitive

        return is_primitive(self)

    # -- invariant geometry, see docs/theory/geometry.md ---------------------------------------------------
    def reductive_complement(self) -> Subspace:
        """An ad(h)-invariant complement of h in g: orthogonal for the Killing form, if that is not degenerate on h.

        Raises
        ------
        NotReductiveError
            If there is none; its `proof` combines the linear equations for one to 0 = 1.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pair("so(3)/so(2)").reductive_complement().dimension, lh.pair("sl(2)/B").is_reductive()
        (2, False)
        """
        from liehom.exact.geometry.reductive import reductive_complement

        return reductive_complement(self)

    def is_reductive(self) -> bool:
        """Whether h has an ad(h)-invariant complement in g."""
        from liehom.exact.geometry.reductive import is_reductive

        return is_reductive(self)

    def is_symmetric(self) -> bool:
        """Whether h is the fixed algebra of an involution of g: [m, m] in h for an invariant complement m.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.pair(name).is_symmetric() for name in ("so(5)/so(4)", "g2/su(3)")]
        [True, False]
        """
        from liehom.exact.geometry.reductive import is_symmetric

        return is_symmetric(self)

    def invariant_metrics(self) -> InvariantMetrics:
        """The invariant metrics of G/H, with their curvature: ``metrics([1, 2, 3])`` is one of them.

        Raises
        ------
        NotReductiveError
            If h has no invariant complement.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pair("g2/su(3)").invariant_metrics()([1]).einstein_constant()
        5
        """
        from liehom.exact.geometry.metrics import InvariantMetrics

        return InvariantMetrics(self)

    def is_naturally_reductive(self, metric: InvariantMetric) -> bool:
        """Whether <[X, Y]_m, Z> + <Y, [X, Z]_m> = 0 for an invariant complement m of this g and h."""
        from liehom.exact.geometry.metrics import is_naturally_reductive

        return is_naturally_reductive(self, metric)

    def invariant_forms(self, degree: int) -> InvariantDifferentialForms:
        """The invariant differential forms of G/H of a degree.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.pair("g2/su(3)").invariant_forms(k).dimension for k in range(7)]
        [1, 0, 1, 2, 1, 0, 1]
        """
        from liehom.exact.geometry.forms import invariant_differential_forms

        return invariant_differential_forms(self, degree)

    def invariant_cohomology(self) -> tuple[int, ...]:
        """Dimensions of the relative cohomology H^k(g, h), k = 0, ..., d: Betti numbers of G/H if G is compact.

        H is connected here; a larger group with this Lie algebra may have fewer invariant forms.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pair("su(3)/u(2)").invariant_cohomology(), lh.pair("so(4)/so(3)").invariant_cohomology()
        ((1, 0, 1, 0, 1), (1, 0, 0, 1))
        """
        from liehom.exact.geometry.forms import invariant_cohomology

        return invariant_cohomology(self)

    def invariant_symplectic_forms(self) -> InvariantSymplecticForms:
        """The closed invariant 2-forms of G/H, and whether one of them is symplectic."""
        from liehom.exact.geometry.forms import InvariantSymplecticForms

        return InvariantSymplecticForms(self)

    def invariant_complex_structures(self) -> tuple[Matrix, ...]:
        """All invariant complex structures J of G/H, matrices (d, d) on columns of V.

        Raises
        ------
        UndecidedError
            If isotropy summands are equivalent, so that the J with J^2 = -1 form families.

        Examples
        --------
        >>> import liehom as lh
        >>> su3 = lh.su(3)
        >>> len(lh.Pair(su3, su3.cartan_subalgebra()).invariant_complex_structures())
        6
        >>> lh.pair("g2/su(3)").invariant_complex_structures()
        ()
        """
        from liehom.exact.geometry.forms import invariant_complex_structures

        return invariant_complex_structures(self)

    def invariant_connections(self) -> InvariantConnections:
        """The invariant affine connections of G/H, by Nomizu maps V x V -> V, with torsion and curvature."""
        from liehom.exact.geometry.forms import InvariantConnections

        return InvariantConnections(self)

    def coordinates(self, x: VectorLike) -> Matrix:
        """The coordinates of x mod h, a row matrix (1, d), in the complement of ``subalgebra.quotient()``."""
        return self.algebra.row(x) @ self.subalgebra.quotient().projection

    def change_of_basis(self, rows: MatrixLike) -> Pair:
        """The same pair in the basis of g given by rows (n, n)."""
        n = self.algebra.dimension
        matrix = self.field.read(rows, (n, n))
        if matrix.shape != (n, n):
            raise ShapeError(f"a change of basis has shape {(n, n)}, got {matrix.shape}")
        algebra = self.algebra.change_of_basis(matrix)
        # The same subspace in other coordinates: still closed.
        return Pair(algebra, Subalgebra(algebra, self.subalgebra.basis @ matrix.inverse(), check=False))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pair) and self.algebra == other.algebra and self.subalgebra == other.subalgebra

    def __hash__(self) -> int:
        return hash(self.subalgebra)

    def __repr__(self) -> str:
        if self.name:
            return f"pair({self.name!r})"
        return f"<pair of dimensions {self.algebra.dimension}/{self.subalgebra.dimension} over {self.field.name}>"
