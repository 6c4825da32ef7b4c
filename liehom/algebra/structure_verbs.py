"""StructureVerbs: the structure theory of a Lie algebra as methods, each a line into the file that does the work.

radical, levi, cartan_subalgebra, direct_sum_decomposition, root_data, identification, cartan_decomposition,
describe, and the constructions of extensions, derivation_algebra, cohomology.
`LieAlgebra` inherits it; nothing else should.  Imports nothing of liehom before a method is called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liehom.algebra.lie_algebra import LieAlgebra
    from liehom.algebra.levi import LeviDecomposition
    from liehom.algebra.subalgebra import Subalgebra


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
        from liehom.algebra.radical import radical

        return radical(self)

    def nilradical(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """The nilradical, the largest nilpotent ideal; exact fields only (`FieldError`).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).nilradical().dimension
        2
        """
        from liehom.algebra.radical import nilradical

        return nilradical(self)

    def levi_decomposition(self: LieAlgebra) -> LeviDecomposition:  # type: ignore[misc]
        """A Levi factor (`.levi`) and the radical (`.radical`); exact fields only (`FieldError`).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).levi_decomposition().levi.dimension
        3
        """
        from liehom.algebra.levi import levi_decomposition

        return levi_decomposition(self)

    def is_semisimple(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the Killing form is nondegenerate (the zero algebra counts as semisimple).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).is_semisimple(), lh.gl(2).is_semisimple()
        (True, False)
        """
        from liehom.algebra.radical import is_semisimple

        return is_semisimple(self)

    def is_solvable(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the derived series ends in 0.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).is_solvable()
        True
        """
        from liehom.algebra.radical import is_solvable

        return is_solvable(self)

    def is_nilpotent(self: LieAlgebra) -> bool:  # type: ignore[misc]
        """Whether the lower central series ends in 0.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(2).is_nilpotent()
        True
        """
        from liehom.algebra.radical import is_nilpotent

        return is_nilpotent(self)

    # -- semisimple structure ----------------------------------------------------------------------------
    def cartan_subalgebra(self: LieAlgebra) -> Subalgebra:  # type: ignore[misc]
        """A Cartan subalgebra: nilpotent and its own normalizer, both proved; exact fields only.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(5).cartan_subalgebra().dimension
        2
        """
        from liehom.algebra.cartan_subalgebra import cartan_subalgebra

        return cartan_subalgebra(self)
