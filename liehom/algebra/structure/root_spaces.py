"""The root space decomposition g = h + sum of V_alpha over the field of the algebra.

For a generic x in a Cartan subalgebra h each irreducible factor f of the characteristic polynomial of ad x on g/h gives
the subspace ker f(ad x), which h preserves.  A linear factor gives a root space, [h_j, v] = alpha(h_j) v with exact
values.  A factor of higher degree gives the sum of the root spaces of roots that are conjugate over the field.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra, is_self_normalizing
from liehom.algebra.structure.commuting_maps import evaluate
from liehom.algebra.structure.exact_field import exact_field
from liehom.errors import InputError, InternalError
from liehom.scalars import ExactMatrix, Polynomial, Scalar, Subspace, as_exact

ATTEMPTS = 12  # random elements of the Cartan subalgebra


@final
@dataclass(frozen=True, slots=True)
class RootSpace:
    """A root space, or the sum of the root spaces of roots that are conjugate over the field.

    Attributes
    ----------
    space : Subspace
        A subspace of the algebra, of dimension 1 for a root with values in the field.
    values : tuple of scalars, or None
        The values alpha(h_j) on the basis of the Cartan subalgebra; None for several conjugate roots.
    polynomial : Polynomial
        The irreducible polynomial whose roots are the alpha(x), x the generic element.
    """

    space: Subspace
    values: tuple[Scalar, ...] | None
    polynomial: Polynomial


@final
@dataclass(frozen=True, slots=True)
class RootSpaceDecomposition:
    """The decomposition of g as the sum of a Cartan subalgebra h and the root spaces.

    Attributes
    ----------
    cartan : Subalgebra
        The Cartan subalgebra h.
    element : tuple of scalars
        The generic x in h, in the basis of the algebra.
    spaces : tuple of RootSpace
        By degree of the polynomial, then by its coefficients.
    """

    cartan: Subalgebra
    element: tuple[Scalar, ...]
    spaces: tuple[RootSpace, ...]

    @property
    def is_split(self) -> bool:
        """Whether all roots have values in the field."""
        return all(space.values is not None for space in self.spaces)


def root_space_decomposition(algebra: LieAlgebra, cartan: Subalgebra | None = None) -> RootSpaceDecomposition:
    """Implements `LieAlgebra.root_space_decomposition`."""
    field, n = exact_field(algebra, "root spaces"), algebra.dimension
    h = cartan_subalgebra(algebra) if cartan is None else algebra.as_subalgebra(cartan)
    if not algebra.is_semisimple():
        raise InputError("only a semisimple algebra has root spaces; take the Levi factor of levi_decomposition()")
    if not h.as_algebra().is_abelian() or not is_self_normalizing(h):
        raise InputError(f"{h!r} is not a Cartan subalgebra: it is not abelian or not its own normalizer")
    basis = as_exact(h.basis)
    zero = Polynomial(field, [0, 1])
    rng = random.Random(n)
    for attempt in range(ATTEMPTS):
        size = 3 << attempt
        x = field.matrix([[rng.randint(-size, size) for _ in range(h.dimension)]], (1, h.dimension)) @ basis
        action = algebra.ad(x)
        factors = Polynomial(field, action.characteristic_coefficients()).factor()
        if all(k == 1 or f.monic() == zero for f, k in factors) and sum(k for f, k in factors if f.monic() == zero) == (
            h.dimension
        ):
            others = [f.monic() for f, _ in factors if f.monic() != zero]
            spaces = [_space(algebra, h, action, f) for f in others]
            return RootSpaceDecomposition(h, tuple(x.row(0)), tuple(sorted(spaces, key=_order)))
    raise InternalError("no element of the Cartan subalgebra separates the roots")


def _space(algebra: LieAlgebra, h: Subalgebra, action: ExactMatrix, f: Polynomial) -> RootSpace:
    """The kernel of f(ad x), with the values of the root if f is linear."""
    space = Subspace(algebra.field, evaluate(f, action).null_space(), algebra.dimension)
    if f.degree > 1:
        return RootSpace(space, None, f)
    (v,) = space.basis.to_rows()
    pivot = next(i for i, c in enumerate(v) if c != 0)
    images = (space.basis @ algebra.ad(row).T for row in h.rows())
    return RootSpace(space, tuple(image[0, pivot] / v[pivot] for image in images), f)


def _order(space: RootSpace) -> tuple[int, list[float]]:
    """The key by which root spaces are sorted."""
    return space.polynomial.degree, [space.space.field.to_float(c) for c in reversed(space.polynomial.coefficients)][
        ::-1
    ]
