"""StructureVerbs: the structure theory of a Lie algebra as methods, each a line into the file that does the work.

radical, levi, cartan_subalgebra, direct_sum_decomposition, root_data, identification, cartan_decomposition,
describe, and the constructions of extensions, complex_algebra, derivation_algebra, cohomology.
`LieAlgebra` inherits it; nothing else should.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liehom.algebra.cohomology.cohomology import Cohomology
    from liehom.algebra.cohomology.derivation_algebra import Derivations
    from liehom.algebra.constructions.complex_algebra import ComplexLieAlgebra
    from liehom.algebra.core.lie_algebra import LieAlgebra
    from liehom.algebra.core.subalgebra import Subalgebra
    from liehom.algebra.involutions.cartan_decomposition import CartanDecomposition
    from liehom.algebra.roots.real_form import RealForm
    from liehom.algebra.roots.root_system import RootSystem
    from liehom.algebra.structure.levi import LeviDecomposition
    from liehom.algebra.structure.root_spaces import RootSpaceDecomposition


class StructureVerbs:
    """What a Lie algebra answers about its structure."""

    __slots__ = ()

    # -- radical and Levi factor -------------------------------------------------------------------------
    def radical(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """The solvable radical, the largest solvable ideal: {x : K(x, [g, g]) = 0}.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(3).radical().dimension
        1
        """
        from liehom.algebra.structure.radical import radical

        return radical(self)

    def nilradical(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """The nilradical, the largest nilpotent ideal; exact fields only (`FieldError`).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).nilradical().dimension
        2
        """
        from liehom.algebra.structure.radical import nilradical

        return nilradical(self)

    def levi_decomposition(self: LieAlgebra) -> LeviDecomposition:  # type: ignore[misc]
        """A Levi factor (`.levi`) and the radical (`.radical`); exact fields only (`FieldError`).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).levi_decomposition().levi.dimension
        3
        """
        from liehom.algebra.structure.levi import levi_decomposition

        return levi_decomposition(self)

    def is_semisimple(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the Killing form is nondegenerate (the zero algebra counts as semisimple).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).is_semisimple(), lh.gl(2).is_semisimple()
        (True, False)
        """
        from liehom.algebra.structure.radical import is_semisimple

        return is_semisimple(self)

    def is_solvable(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the derived series ends in 0.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).is_solvable()
        True
        """
        from liehom.algebra.structure.radical import is_solvable

        return is_solvable(self)

    def is_nilpotent(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the lower central series ends in 0.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(2).is_nilpotent()
        True
        """
        from liehom.algebra.structure.radical import is_nilpotent

        return is_nilpotent(self)

    # -- ideals ------------------------------------------------------------------------------------------
    def direct_sum_decomposition(self: LieAlgebra) -> list[Subalgebra]:  # type: ignore[misc]
        """Indecomposable ideals, over the field of the algebra, whose direct sum is the algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> [h.dimension for h in lh.gl(3).direct_sum_decomposition()]
        [1, 8]
        """
        from liehom.algebra.structure.direct_sum_decomposition import direct_sum_decomposition

        return direct_sum_decomposition(self)

    def simple_ideals(self: LieAlgebra) -> list[Subalgebra]:  # type: ignore[misc]
        """The simple ideals over the reals; where they need an irrational number they live in ``g.over(field)``.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).simple_ideals()
        [<subalgebra of dimension 3 in so(4) over QQ>, <subalgebra of dimension 3 in so(4) over QQ>]
        >>> [h.dimension for h in lh.so(3, 1).simple_ideals()]
        [6]
        """
        from liehom.algebra.structure.simple_ideals import simple_ideals

        return simple_ideals(self)

    def centroid(self: LieAlgebra) -> tuple[Any, ...]:  # type: ignore[misc]
        """A basis of the matrices (n, n), on columns, with phi [x, y] = [phi x, y].

        Examples
        --------
        >>> import liehom as lh
        >>> len(lh.so(3, 1).centroid()), len(lh.sl(3).centroid())
        (2, 1)
        """
        from liehom.algebra.structure.centroid import centroid

        return centroid(self)

    def quotient(self: LieAlgebra, ideal: Any, *, name: str | None = None) -> LieAlgebra:  # type: ignore[misc]
        """The quotient by an ideal (a `Subalgebra` or rows); `NotAnIdealError` if it is none.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.heisenberg(1)
        >>> g.quotient(g.center()).is_abelian()
        True
        """
        from liehom.algebra.constructions.extensions import quotient

        return quotient(self, ideal, name=name)

    def complexification(self: LieAlgebra, *, name: str | None = None) -> ComplexLieAlgebra:  # type: ignore[misc]
        """g (x) C as a real algebra of twice the dimension (``.algebra``) with its complex structure.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).complexification().algebra.real_form()
        'sl(2,C)'
        """
        from liehom.algebra.constructions.complex_algebra import complexification

        return complexification(self, name=name)

    # -- derivations and cohomology ----------------------------------------------------------------------
    def derivations(self: LieAlgebra) -> Derivations:  # type: ignore[misc]
        """The derivations: their matrices, the inner ones, and the Lie algebra that they form.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(1).derivations().dimension
        6
        """
        from liehom.algebra.cohomology.derivation_algebra import derivations

        return derivations(self)

    def cohomology(self: LieAlgebra, degree: int, matrices: Any = None) -> Cohomology:  # type: ignore[misc]
        """Chevalley-Eilenberg cohomology in a degree, with trivial coefficients or those of a module by its matrices.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.heisenberg(1).cohomology(k).dimension for k in range(4)]
        [1, 2, 2, 1]
        """
        from liehom.algebra.cohomology.cohomology import cohomology

        return cohomology(self, degree, matrices)

    # -- semisimple structure ----------------------------------------------------------------------------
    def cartan_subalgebra(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """A Cartan subalgebra: nilpotent and its own normalizer, both proved; exact fields only.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(5).cartan_subalgebra().dimension
        2
        """
        from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra

        return cartan_subalgebra(self)

    def rank(self: LieAlgebra) -> int:  # type: ignore[misc]
        """The rank: the dimension of the Cartan subalgebras.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(5).rank(), lh.gl(3).rank()
        (2, 3)
        """
        return self.cartan_subalgebra().dimension

    def is_reductive(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the radical is the centre.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(3).is_reductive(), lh.euclidean(3).is_reductive()
        (True, False)
        """
        return self.radical().dimension == self.center().dimension

    def root_space_decomposition(  # type: ignore[misc]
        self: LieAlgebra, cartan: Subalgebra | None = None
    ) -> RootSpaceDecomposition:
        """A Cartan subalgebra with the root spaces, [h, v] = alpha(h) v; conjugate irrational roots stay together.

        Examples
        --------
        >>> import liehom as lh
        >>> found = lh.sl(3).root_space_decomposition()
        >>> found.cartan.dimension, len(found.spaces), found.spaces[0].space.dimension
        (2, 6, 1)
        """
        from liehom.algebra.structure.root_spaces import root_space_decomposition

        return root_space_decomposition(self, cartan)

    def restricted_roots(self: LieAlgebra) -> list[tuple[str, str, dict[str, int]]]:  # type: ignore[misc]
        """For each simple ideal over the reals: its name, the type of the restricted roots, and their multiplicities.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.su(2, 1).restricted_roots()
        [('su(2,1)', 'BC1', {'short': 2, 'long': 1})]
        """
        return [(form.name, form.restricted_type, form.multiplicities) for form in self.real_forms()]

    def root_system(self: LieAlgebra) -> RootSystem:  # type: ignore[misc]
        """The root system of the complexification; `InputError` if the algebra is not semisimple.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).root_system().type, lh.so(4).root_system().weyl_group_order()
        ('A1', 4)
        """
        from liehom.algebra.structure.identification import root_system

        return root_system(self)

    def semisimple_type(self: LieAlgebra) -> str:  # type: ignore[misc]
        """The type of the complexification of the algebra or of its Levi factor, such as 'A1 + B2'; '0' for none.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).semisimple_type(), lh.gl(3).semisimple_type()
        ('A1 + A1', 'A2')
        """
        from liehom.algebra.structure.identification import semisimple_type

        return semisimple_type(self)

    def real_form(self: LieAlgebra) -> str:  # type: ignore[misc]
        """The name, over the reals, of the algebra or of its Levi factor: 'so(4,1)', 'so(3) + sl(2,R)'; '0' for none.

        Raises
        ------
        FieldError
            Over float64.
        UndecidedError
            For the few pairs of forms, of dimension at least 153, that type and Killing signature do not tell apart.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(1, 4).real_form(), lh.su(2).real_form(), lh.so(2, 2).real_form()
        ('so(4,1)', 'so(3)', 'sl(2,R) + sl(2,R)')
        """
        from liehom.algebra.structure.identification import real_form

        return real_form(self)

    def real_forms(self: LieAlgebra) -> list[RealForm]:  # type: ignore[misc]
        """The real forms of the simple ideals over the reals of the algebra or its Levi factor.

        Examples
        --------
        >>> import liehom as lh
        >>> [form.satake.black for form in lh.so(4, 1).real_forms()]
        [(1,)]
        """
        from liehom.algebra.structure.identification import real_forms_of

        return real_forms_of(self)

    def is_simple(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the algebra is simple over the reals: so(3,1) is, so(4) is not.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3, 1).is_simple(), lh.so(4).is_simple(), lh.abelian(1).is_simple()
        (True, False, False)
        """
        from liehom.algebra.structure.identification import simple_parts

        if self.dimension == 0 or not self.is_semisimple():
            return False
        return sum(len(part.places) for part in simple_parts(self)) == 1

    def real_rank(self: LieAlgebra) -> int:  # type: ignore[misc]
        """The real rank of the algebra or of its Levi factor: the dimension of a maximal split abelian subspace of p.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 1).real_rank(), lh.so(5).real_rank(), lh.sl(3).real_rank()
        (1, 0, 2)
        """
        return sum(form.real_rank for form in self.real_forms())

    def cartan_decomposition(self: LieAlgebra) -> CartanDecomposition:  # type: ignore[misc]
        """g = k + p for a Cartan involution that is proved; unpacks as ``k, p``, and has ``.theta``.

        Raises
        ------
        InputError
            If the algebra is not semisimple.
        NoRationalInvolutionError, UndecidedError
            If it is proved that no Cartan involution has entries in the field; if none with small rational entries
            was found. In both cases over ``lh.RR`` one is found numerically.

        Examples
        --------
        >>> import liehom as lh
        >>> k, p = lh.sl(3).cartan_decomposition()
        >>> k.dimension, p.dimension
        (3, 5)
        """
        from liehom.algebra.involutions.cartan_decomposition import cartan_decomposition

        return cartan_decomposition(self)

    def cartan_involution(self: LieAlgebra) -> Any:  # type: ignore[misc]
        """The matrix (n, n), on columns, of the Cartan involution of `cartan_decomposition`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).cartan_involution() == lh.QQ.identity(3)
        True
        """
        return self.cartan_decomposition().theta

    def maximal_compact_subalgebra(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """The fixed points of a Cartan involution (`cartan_decomposition`).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 1).maximal_compact_subalgebra().as_algebra().real_form()
        'so(3) + so(3)'
        """
        return self.cartan_decomposition().k

    def is_isomorphic(self: LieAlgebra, other: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether two semisimple algebras are isomorphic over the reals; `InputError` if one has a radical.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 2).is_isomorphic(lh.su(2, 2))
        True
        """
        from liehom.algebra.structure.identification import is_isomorphic

        return is_isomorphic(self, other)

    def describe(self: LieAlgebra) -> str:  # type: ignore[misc]
        """A card with what a mathematician would ask first.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.euclidean(2).describe())
        e(2), dimension 3 over QQ
          solvable, not nilpotent
          nilradical of dimension 2, centre of dimension 0
          derived series 3 > 2 > 0, lower central series 3 > 2
          Killing form of signature (0, 1, 2) (positive, negative, zero)
        """
        from liehom.algebra.structure.describe import describe

        return describe(self)
