"""The weights of a representation of a reductive algebra, and the charges of its centre."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

from liehom.base.errors import InputError, InternalError, NotCompletelyReducibleError
from liehom.exact.algebra.roots.root_system import diagram_components
from liehom.exact.algebra.structure.root_spaces import RootData, root_data
from liehom.exact.representations.analysis.submodules import semisimple_defect
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.characters import decompose_character
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.extension import RealFactor, adjoin_root, real_factors
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.joint_spectrum import JointMultiplicities, coroot_pairings, joint_multiplicities
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.roots import complex_ball

# The charges of the centre are joint eigenvalues of commuting semisimple matrices, as exact complex numbers.  One
# combination x of the matrices M_j separates the joint eigenspaces, so that M_j = p_j(x).  Each irreducible factor of
# the minimal polynomial of x over the field K has real factors t - mu over K(mu) and t^2 - p t + q over K(p, q).  The
# joint eigenvalues are the p_j(mu), and c + c' mu if p_j = c + c' t modulo t^2 - p t + q.

ATTEMPTS = 20


class Charge(NamedTuple):
    """An exact complex number, an eigenvalue of an element of the centre.

    Attributes
    ----------
    real : field element
        Not zero for elements that generate a non-compact group, as in gl(n).
    imaginary : field element
        Not zero for elements that generate rotations, as in u(n).

    Examples
    --------
    >>> import liehom as lh
    >>> [weight.charges for weight in lh.defining(lh.gl(2)).weights()]
    [(1,), (1,)]
    """

    real: Scalar
    imaginary: Scalar

    def __repr__(self) -> str:
        if self.imaginary == 0:
            return str(self.real)
        shown = str(abs(self.imaginary))
        shown = "i" if shown == "1" else f"({shown})*i" if any(c in shown for c in "+-/ ") else f"{shown}*i"
        minus = "-" if self.imaginary < 0 else ""
        return f"{minus}{shown}" if self.real == 0 else f"{self.real} {minus or '+'} {shown}"


Charges = tuple[Charge, ...]


def central_charges(matrices: Sequence[ExactMatrix]) -> list[Charges]:
    """The different joint eigenvalues of commuting semisimple matrices, at least one, the largest first."""
    for i, a in enumerate(matrices):
        if not semisimple_defect(a).is_zero():
            raise NotCompletelyReducibleError(
                f"element {i} of the centre does not act semisimply, so there are no weight spaces for it; "
                "rho.subrepresentation(rho.socle()) is completely reducible"
            )
    joint = separated(matrices, len(matrices), blocks=False)
    if joint is None:
        raise InternalError("no combination of the elements of the centre separates the charges")
    (block,) = joint.blocks
    factors = [f for part, _ in block.parts for f, _ in part.factor()]
    charges = [c for f in factors for r in real_factors(f) for c in _charges(r, block.polynomials)]
    return sorted(charges, key=lambda row: [-float(x) for c in row for x in c])


def separated(matrices: Sequence[ExactMatrix], seed: int, *, blocks: bool = True) -> JointMultiplicities | None:
    """The joint eigenvalues of commuting semisimple matrices, by a random combination that separates them."""
    rng = random.Random(seed)
    for attempt in range(ATTEMPTS):
        bound = (3 + matrices[0].nrows ** 2) << attempt
        if joint := joint_multiplicities(matrices, [rng.randint(-bound, bound) for _ in matrices], blocks=blocks):
            return joint
    return None


def _charges(factor: RealFactor, polynomials: Sequence[Polynomial]) -> list[Charges]:
    """The values of polynomials over K at the roots of a real factor."""
    up, f = factor.extension, factor.polynomial
    reduced = [up.polynomial(p) % f for p in polynomials]
    zero = up.field.zero
    rests = [[*p.coefficients, zero, zero][:2] for p in reduced]
    if f.degree == 1:
        return [tuple(Charge(c, zero) for c, _ in rests)]
    q, minus_p, _ = f.monic().coefficients
    square = q - minus_p * minus_p / 4  # of the imaginary part of the roots
    top, root = _square_root(up.field, square)
    pairs = [(top(c - d * minus_p / 2), top(d) * root) for c, d in rests]
    return [tuple(Charge(re, sign * im) for re, im in pairs) for sign in (1, -1)]


def _square_root(field: ExactField, value: Scalar) -> tuple[Callable[[Scalar], Scalar], Scalar]:
    """The embedding of the field in a field with the positive square root of a positive element, and the root."""
    factors = [f for f, _ in Polynomial(field, [-value, field.zero, field.one]).factor()]
    if len(factors) == 2:
        root = factors[0].coefficients[0] / factors[0].coefficients[1]
        return (lambda x: x), root if field.sign(root) > 0 else -root
    extension, root = adjoin_root(factors[0], 1)
    return extension.embed, root


# On a rational Cartan subalgebra h of the semisimple part, which need not split, and on the centre, rho is a commuting
# family of semisimple matrices.  Its joint eigenvalues are computed as rigorous enclosures.  Their values on the
# coroots are integers, their values on the centre are among the exact `central_charges`.

Weight = tuple[int, ...]
PRECISIONS = (1, 4, 16, 64)  # times that of the roots
FIRST_PRECISION = 128


class ChargedWeight(NamedTuple):
    """A weight of a reductive algebra with centre.

    Attributes
    ----------
    weight : tuple of int
        Its values on the simple coroots of the semisimple part.
    charges : tuple of Charge
        Its values on the canonical basis of the centre, ``algebra.center()``.
    """

    weight: Weight
    charges: Charges


def weight_multiplicities(rho: Representation) -> dict[Any, int]:
    """Implements `Representation.weights`."""
    g = rho.algebra
    if g.is_semisimple():
        return weights_on(rho, rho, [])
    center = g.center()
    if not g.is_reductive():
        raise InputError(
            "weights are defined for representations of reductive algebras: the radical must be the centre; "
            "restrict to the Levi factor of levi_decomposition()"
        )
    central = [cast(ExactMatrix, rho(row)) for row in center.rows()]
    return weights_on(rho, rho.restriction(g.derived_subalgebra()), central)


def weights_on(
    rho: Representation, derived: Representation, central: list[ExactMatrix], data: RootData | None = None
) -> dict[Any, int]:
    """Weights of the semisimple part, with charges if there are elements of the centre."""
    if rho.size == 0:
        return {}
    charges = central_charges(central) if central else [()]
    data = data or root_data(derived.algebra)
    rank = data.cartan.dimension
    cartan = [cast(ExactMatrix, derived(row)) for row in data.cartan.rows()]
    if not cartan and not central:
        return {(): rho.size}
    joint = separated([*cartan, *central], rho.size)
    if joint is None:
        raise InternalError("no element of a Cartan subalgebra separates the weights")
    h = as_exact(data.cartan.basis)
    dual_form = as_exact(h @ as_exact(derived.algebra.killing_form()) @ h.T).inverse()
    precision = max(data.spectrum.precision, FIRST_PRECISION)
    for factor in PRECISIONS:
        bits = factor * precision
        values = joint.values(bits)
        weights = coroot_pairings([v[:rank] for v, _ in values], data.simple_values(), dual_form, bits) if rank else []
        places = _matched([v[rank:] for v, _ in values], charges, bits)
        if weights is None or places is None:
            continue
        order = [i for _, nodes in diagram_components(data.root_system.cartan) for i in nodes]
        counted: Counter[tuple[Weight, int]] = Counter()
        for i, (_, m) in enumerate(values):
            counted[tuple(weights[i][k] for k in order) if rank else (), places[i]] += m
        ordered = sorted(counted, key=lambda key: (key[1], tuple(-x for x in key[0])))
        if not central:
            return {w: counted[w, 0] for w, _ in ordered}
        return {ChargedWeight(w, charges[place]): counted[w, place] for w, place in ordered}
    raise InternalError("the weights could not be distinguished")


def _matched(values: Sequence[Sequence[Any]], charges: Sequence[Charges], precision: int) -> list[int] | None:
    """For each joint eigenvalue of the centre, in balls, its place among the exact charges; None if not unique."""
    balls = [[complex_ball(c.real, c.imaginary, precision) for c in row] for row in charges]
    near = [
        [i for i, row in enumerate(balls) if all(a.overlaps(b) for a, b in zip(value, row, strict=True))]
        for value in values
    ]
    return [place for (place,) in near] if all(len(places) == 1 for places in near) else None


def highest_weights(rho: Representation) -> dict[Any, int]:
    """Implements `Representation.highest_weights`."""
    weights = weight_multiplicities(rho)
    if not weights:
        return {}
    if rho.algebra.is_semisimple():
        return decompose_character(rho.algebra.semisimple_type(), weights)
    derived = rho.algebra.derived_subalgebra().as_algebra()
    name = derived.semisimple_type() if derived.dimension else None
    characters: dict[Charges, dict[Sequence[int], int]] = {}
    for (weight, charges), m in weights.items():
        characters.setdefault(charges, {})[weight] = m
    return {
        ChargedWeight(tuple(w), charges): m
        for charges, character in characters.items()
        for w, m in (decompose_character(name, character) if name else character).items()
    }
