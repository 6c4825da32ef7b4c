"""Weights in fundamental coordinates: Weyl orbits, dominant conjugates, dual weights.

A weight is the tuple of its values <mu, alpha_i^vee> on the simple coroots, so that alpha_i is row i of the Cartan
matrix and s_i(mu) = mu - mu_i alpha_i.  Roots are tuples of coefficients in the simple roots.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import InputError, ShapeError, displayed
from liehom.exact.algebra.roots.root_system import RootSystem, root_system

Weight = tuple[int, ...]
Root = tuple[int, ...]


@final
@dataclass(frozen=True, slots=True)
class WeightSpace:
    """The weight lattice of a root system, with the integers that formulas for characters need.

    Attributes
    ----------
    cartan : tuple of tuples of int
        cartan[i][j] = <alpha_i, alpha_j^vee>; row i is alpha_i as a weight.
    norms : tuple of int
        (alpha_i, alpha_i) / 2, so that (mu, alpha_i) = norms[i] mu_i.
    positive_roots : tuple of Root
        The positive roots, by height.
    heights : tuple of int
        heights[i] = <omega_i, 2 rho^vee>, so that mu has the height sum_i heights[i] mu_i and alpha_i has 2.
    """

    cartan: tuple[Weight, ...]
    norms: tuple[int, ...]
    positive_roots: tuple[Root, ...]
    heights: tuple[int, ...]

    @property
    def rank(self) -> int:
        """Number of simple roots."""
        return len(self.cartan)

    def as_weight(self, root: Root) -> Weight:
        """A root in fundamental coordinates."""
        return tuple(sum(c * row[j] for c, row in zip(root, self.cartan, strict=True)) for j in range(self.rank))

    def product(self, weight: Weight, root: Root) -> int:
        """The invariant scalar product of a weight and a root; (alpha, alpha) = 2 for short roots."""
        return sum(m * c * d for m, c, d in zip(weight, root, self.norms, strict=True))

    def height(self, weight: Weight) -> int:
        """The height <mu, 2 rho^vee>, which falls by 2 with every simple root that is subtracted."""
        return sum(m * h for m, h in zip(weight, self.heights, strict=True))

    def reflected(self, weight: Weight, i: int) -> Weight:
        """The image under the reflection in alpha_i."""
        factor = weight[i]
        return tuple(m - factor * a for m, a in zip(weight, self.cartan[i], strict=True))

    def dominant(self, weight: Weight) -> tuple[Weight, int]:
        """The dominant weight of the orbit, and the sign of the Weyl group element that was used."""
        sign = 1
        while True:
            i = next((i for i, m in enumerate(weight) if m < 0), None)
            if i is None:
                return weight, sign
            weight, sign = self.reflected(weight, i), -sign

    def orbit(self, dominant: Weight) -> Iterator[Weight]:
        """The Weyl orbit of a dominant weight, by decreasing height."""
        level = {dominant: None}
        while level:
            yield from level
            # nu is reached only from s_j(nu), with j the first index at which nu is negative.
            below: dict[Weight, None] = {}
            for mu in level:
                in_time()
                for i, m in enumerate(mu):
                    if m > 0:
                        nu = self.reflected(mu, i)
                        if all(x >= 0 for x in nu[:i]):
                            below[nu] = None
            level = below


def weight_space(system: RootSystem | str) -> WeightSpace:
    """The weight lattice of a root system, or of a type such as 'B3' or 'A2 + G2'."""
    roots = root_system_of(system)
    coroots = [roots.coroot(alpha) for alpha in roots.positive_roots]
    heights = tuple(map(sum, zip(*coroots, strict=True)))
    return WeightSpace(roots.cartan, tuple(norm // 2 for norm in roots.norms), roots.positive_roots, heights)


def root_system_of(system: RootSystem | str) -> RootSystem:
    """The root system of a type; a root system is returned unchanged."""
    roots = root_system(system) if isinstance(system, str) else system
    if not isinstance(roots, RootSystem):
        raise InputError(
            f"a root system or the name of a type such as 'B3' or 'A2 + G2' is needed, got {displayed(system)}"
        )
    return roots


def checked_weight(space: WeightSpace, weight: Sequence[int] | str, *, dominant: bool = True) -> Weight:
    """A weight as a tuple of ints, after a check."""
    if isinstance(weight, str):
        raise InputError(
            f"expected a highest weight of {space.rank} integers, got the name {weight!r}: names of modules "
            "are read by branching rules only"
        )
    values: list[Any] = list(weight)
    if len(values) != space.rank:
        raise ShapeError(f"the weight {values} has {len(values)} coordinates, the rank is {space.rank}")
    for x in values:
        if isinstance(x, bool) or not isinstance(x, (int, np.integer)):
            raise InputError(f"the weight {values} is not integral: its fundamental coordinates must be integers")
    if dominant and any(x < 0 for x in values):
        raise InputError(f"the weight {values} is not dominant: its fundamental coordinates must not be negative")
    return tuple(int(x) for x in values)


def weyl_orbit(system: RootSystem | str, weight: Sequence[int]) -> list[Weight]:
    """The orbit of an integral weight under the Weyl group, by decreasing height; the dominant weight is first.

    The reflections are s_i(mu) = mu - <mu, alpha_i^vee> alpha_i.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.weyl_orbit("A2", [1, 0])
    [(1, 0), (-1, 1), (0, -1)]
    >>> len(lh.representations.weyl_orbit("E8", [0, 0, 0, 0, 0, 0, 0, 1]))
    240
    """
    space = weight_space(system)
    return list(space.orbit(space.dominant(checked_weight(space, weight, dominant=False))[0]))


def dual_weight(system: RootSystem | str, weight: Sequence[int]) -> Weight:
    """The highest weight of the dual of the module with a dominant highest weight, as in `weyl_dimension`.

    The dual weight is -w_0(lambda), w_0 the longest element of the Weyl group; the lowest weight is w_0(lambda).

    Examples
    --------
    >>> from liehom.exact.representations import dual_weight
    >>> dual_weight("A3", [2, 1, 0]), dual_weight("E6", [1, 0, 0, 0, 0, 0]), dual_weight("D4", [0, 0, 1, 0])
    ((0, 1, 2), (0, 0, 0, 0, 0, 1), (0, 0, 1, 0))
    """
    space = weight_space(system)
    return space.dominant(tuple(-x for x in checked_weight(space, weight)))[0]


def frobenius_schur_indicator(system: RootSystem | str, weight: Sequence[int]) -> int:
    """Frobenius-Schur indicator 1, -1 or 0: the module is real, quaternionic or complex for the compact form.

    It is 1 if the module has an invariant symmetric form, and is then the complexification of a real module of the
    compact form. It is -1 if the module has an invariant skew-symmetric form, and is then quaternionic, or pseudo-real.
    It is 0 if the module is not isomorphic to its dual, and is then complex.

    A self-dual module has an invariant form that is symmetric for even and skew-symmetric for odd <lambda, 2 rho^vee>.
    The module of the split form is real, whatever the indicator.

    Examples
    --------
    >>> from liehom.exact.representations import frobenius_schur_indicator as indicator
    >>> [indicator("A1", [n]) for n in range(4)], indicator("A2", [1, 0])
    ([1, -1, 1, -1], 0)
    """
    space = weight_space(system)
    top = checked_weight(space, weight)
    if space.dominant(tuple(-x for x in top))[0] != top:
        return 0
    return -1 if space.height(top) % 2 else 1


def casimir_eigenvalue(system: RootSystem | str, weight: Sequence[int]) -> Fraction:
    """The eigenvalue (lambda, lambda + 2 rho) of the quadratic Casimir element on an irreducible module, a Fraction.

    The inner product is 2 on long roots, so the value on the adjoint module is twice the dual Coxeter number. Half of
    it is usual in physics, such as 4/3 for the 3 of SU(3).

    Examples
    --------
    >>> from liehom.exact.representations import casimir_eigenvalue
    >>> [str(casimir_eigenvalue("A2", weight)) for weight in ([1, 0], [1, 1])]
    ['8/3', '6']
    """
    roots, space, top = of_simple(system, weight)
    shifted = tuple(x + 2 for x in checked_weight(space, top))
    inverse = roots.fundamental_weights()
    in_roots = [sum((x * row[i] for x, row in zip(top, inverse, strict=True)), Fraction(0)) for i in range(space.rank)]
    double = sum((m * c * d for m, c, d in zip(shifted, in_roots, space.norms, strict=True)), Fraction(0))
    return double / max(space.norms)


def dynkin_index(system: RootSystem | str, weight: Sequence[int]) -> int:
    """Dynkin's index of an irreducible module of a simple algebra, an int: 1 for the smallest module of A_n and C_n.

    dim V (lambda, lambda + 2 rho) / dim g, with the inner product 2 on long roots. The trace of rho(x) rho(y) is the
    index times that in the smallest module of A_n. The index of a sum is the sum of the indices.

    Examples
    --------
    >>> from liehom.exact.representations import dynkin_index
    >>> dynkin_index("A4", [1, 0, 0, 0]), dynkin_index("D5", [0, 0, 0, 0, 1]), dynkin_index("E8", [0] * 7 + [1])
    (1, 4, 60)
    """
    roots, space, top = of_simple(system, weight)
    checked_weight(space, top)
    rho = (1,) * space.rank
    size = Fraction(1)
    for root in space.positive_roots:
        size *= 1 + Fraction(space.product(top, root), space.product(rho, root))
    return int(size * casimir_eigenvalue(roots, top) / (roots.number_of_roots + roots.rank))


def congruency_class(system: RootSystem | str, weight: Sequence[int]) -> tuple[int, ...]:
    """The class of a weight modulo the root lattice, a tuple of int, which adds in tensor products.

    It is one number modulo n + 1 for A_n (the n-ality), modulo 2 for B_n, C_n and E7, modulo 3 for E6, and () for E8,
    F4 and G2. For D_n it is two numbers: modulo 2, 1 for spinors, and modulo 4.

    Examples
    --------
    >>> from liehom.exact.representations import congruency_class
    >>> congruency_class("A2", [1, 0]), congruency_class("D5", [0, 0, 0, 0, 1]), congruency_class("E8", [1] * 8)
    ((1,), (1, 1), ())
    """
    roots, _, top = of_simple(system, weight)
    ((name, nodes),) = roots.components()
    n, a = len(nodes), [top[i] for i in nodes]
    if name[0] == "A":
        return (sum((i + 1) * x for i, x in enumerate(a)) % (n + 1),)
    if name[0] == "D":
        return (a[-2] + a[-1]) % 2, (2 * sum(a[: n - 2 : 2]) + (n - 2) * a[-2] + n * a[-1]) % 4
    forms = {"B": ([n - 1], 2), "C": (range(0, n, 2), 2), "E6": ([0, 2, 2, 4, 5, 5], 3), "E7": ([1, 4, 6], 2)}
    places, order = forms.get(name, forms.get(name[0], ((), 1)))
    return (sum(a[i] for i in places) % order,) if order > 1 else ()


def of_simple(system: RootSystem | str, weight: Sequence[int]) -> tuple[RootSystem, WeightSpace, Weight]:
    """The root system of a simple algebra, its weight space and an integral weight, checked."""
    roots = root_system_of(system)
    if len(roots.components()) != 1:
        raise InputError(
            f"{roots.type} is not the type of a simple algebra; take its components, such as 'A2', in turn"
        )
    space = weight_space(roots)
    return roots, space, checked_weight(space, weight, dominant=False)
