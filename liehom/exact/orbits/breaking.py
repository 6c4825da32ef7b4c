"""Symmetry breaking: the subalgebra that fixes a vector, and how all modules restrict to it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

from liehom.base.errors import InputError, displayed
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.root_system import RootSystem, root_system
from liehom.exact.orbits.types import structure_name
from liehom.exact.representations.analysis.branching import Branching, BranchingRule
from liehom.exact.representations.analysis.embeddings import branching_rule
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.weights import Weight
from liehom.exact.scalars.field import MatrixLike, VectorLike


@final
@dataclass(frozen=True, slots=True)
class SymmetryBreaking:
    """The subalgebra that a vector leaves unbroken; made by `symmetry_breaking`.

    Call it with a representation of g, a highest weight or the name of a module to see how that field splits. A real
    module of complex type appears with its dual, because the table is that of its complexification.

    Attributes
    ----------
    unbroken : Subalgebra
        The isotropy subalgebra h of the vector.
    name : str
        Of h, such as 'so(3) + su(3) + u(1)'; the canonical name of su(2) is so(3).
    rule : BranchingRule
        From g to h.

    Examples
    --------
    >>> import liehom as lh
    >>> breaking = lh.symmetry_breaking(lh.real_module("so(10)", [0, 0, 0, 0, 1]).representation, [1] + [0] * 31)
    >>> breaking.name, breaking.embedding_indices, str(breaking.broken)
    ('su(5)', (1,), '10 + 10bar + 1')
    >>> print(breaking("10"), "and", breaking("45"))
    5 + 5bar and 24 + 10 + 10bar + 1
    """

    unbroken: Subalgebra
    name: str
    rule: BranchingRule

    @property
    def embedding_indices(self) -> tuple[int, ...] | tuple[tuple[int, ...], ...]:
        """Dynkin's index of each simple ideal of h; see `BranchingRule`."""
        return self.rule.embedding_indices

    @property
    def broken(self) -> Branching:
        """The module g/h, to which the Goldstone bosons and the heavy gauge bosons belong."""
        roots = root_system(self.rule.type)
        total = self.rule.restricted(_adjoint_weights(roots))
        trivial = tuple((0,) * int(kind[1:]) for kind in self.rule.factors)
        own = {trivial: len(self.rule.charge_rows)}
        for k, kind in enumerate(self.rule.factors):
            own[(*trivial[:k], _highest_root(root_system(kind)), *trivial[k + 1 :])] = 1
        terms = []
        for term in total.terms:
            taken = own.get(term.highest_weights, 0) if not any(term.charges) else 0
            if term.multiplicity > taken:
                terms.append(replace(term, multiplicity=term.multiplicity - taken))
        return Branching(self.rule, tuple(terms))

    def __call__(self, module: Sequence[int] | str | Representation) -> Branching:
        return self.rule(module)

    def __repr__(self) -> str:
        whole, broken = self.unbroken.algebra.dimension, self.unbroken.codimension
        return f"<{self.rule.type} broken to {self.name}: {broken} of {whole} directions are broken>"


def symmetry_breaking(rho: Representation, vacuum: VectorLike | MatrixLike) -> SymmetryBreaking:
    """The subalgebra that a vector of a representation leaves unbroken, with its name, index and branching rule.

    Parameters
    ----------
    rho : Representation
        Of a semisimple algebra, over an exact field; of the compact form in models of particle physics.
    vacuum : vector
        The expectation value, as for `Representation.isotropy`; for an adjoint representation, the coordinates of an
        element.

    Raises
    ------
    InputError
        If the isotropy subalgebra is not reductive in g. This does not happen for a compact algebra.

    Notes
    -----
    Modules are named by a choice of simple roots of g. Where the diagram has a symmetry, as for A_n, D_n and E6, this
    choice may exchange the names of a module and of its image, for all modules at once.

    Examples
    --------
    SU(5) broken by a 24 along the hypercharge:

    >>> import liehom as lh
    >>> g = lh.su(5)
    >>> hypercharge = [["2i" if i == j < 3 else "-3i" if i == j else 0 for j in range(5)] for i in range(5)]
    >>> breaking = lh.symmetry_breaking(lh.adjoint(g), lh.defining(g).element(hypercharge))
    >>> breaking
    <A4 broken to so(3) + su(3) + u(1): 12 of 24 directions are broken>
    >>> print(breaking("5"), "and", breaking.broken)
    (1,3)_2 + (2,1)_-3 and (2,3)_5 + (2,3bar)_-5
    """
    if not isinstance(rho, Representation):
        raise InputError(f"expected a representation such as lh.adjoint(lh.su(5)), got {displayed(rho)}")
    unbroken = rho.isotropy(vacuum)
    name = structure_name(unbroken)
    if rho.algebra.killing_signature()[0] == 0:  # compact, and so is the centre
        name = re.sub(r"\bR(?:\^(\d+))?$", lambda match: " + ".join(["u(1)"] * int(match[1] or 1)), name)
    return SymmetryBreaking(unbroken, name, branching_rule(rho.algebra, unbroken))


def _highest_root(roots: RootSystem) -> Weight:
    """The highest root of an irreducible root system in fundamental coordinates."""
    (top,) = roots.highest_roots
    return tuple(sum(c * row[j] for c, row in zip(top, roots.cartan, strict=True)) for j in range(roots.rank))


def _adjoint_weights(roots: RootSystem) -> dict[Weight, int]:
    """The weights of the adjoint representation in fundamental coordinates."""
    table = (roots.root_matrix() @ roots.cartan).tolist() if roots.rank else []
    return {(0,) * roots.rank: roots.rank, **{tuple(row): 1 for row in table}}
