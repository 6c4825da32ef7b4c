"""Representations that nobody has thought of: random constructions in random bases, through everything."""

from typing import Any

import numpy as np
import scipy.linalg
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.action.custom_exponential import exponential_of
from liehom.flow.action.field import check_point
from liehom.flow.action.frames import inner_product
from tests.flow.action.support import heisenberg_matrices, rigid_motions, scrambled
from tests.sampling import examples

BASES: list[Any] = [
    lambda: lh.defining(lh.so(3)), lambda: lh.defining(lh.so(2, 1)), lambda: lh.defining(lh.sl(2)),
    lambda: lh.defining(lh.su(2)), lambda: lh.defining(lh.so(4)), lambda: lh.defining(lh.gl(2)), heisenberg_matrices,
    rigid_motions, lambda: lh.Representation.from_matrices([[[1, 1], [0, 1]]]),
]  # fmt: skip


@st.composite
def representations(draw: st.DrawFn) -> lh.Representation:
    rho = draw(st.sampled_from(BASES))()
    for what in draw(st.lists(st.sampled_from(["dual", "square", "forms", "tensor", "sum", "scramble"]), max_size=3)):
        if what == "dual":
            rho = rho.dual()
        elif what == "scramble":
            rho = scrambled(rho, draw(st.integers(0, 99)))
        elif rho.size <= 4 and what == "square":
            rho = rho.symmetric_power(2)
        elif 2 < rho.size <= 4 and what == "forms":
            rho = rho.exterior_power(2)
        elif rho.size <= 4 and what == "tensor":
            rho = rho.tensor(rho.dual())
        elif rho.size <= 6 and what == "sum":
            rho = rho.direct_sum(lh.representations.trivial(rho.algebra, 1))
    return rho


@settings(max_examples=examples(40))
@given(representations(), st.integers(0, 1000))
def test_any_representation_works(rho: lh.Representation, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, size = rho.algebra.dimension, rho.size
    a = np.array([b.to_numpy() for b in rho.matrices])
    x = rng.normal(size=(3, n))
    x /= np.linalg.norm(np.einsum("ka,aij->kij", x, a), axis=(1, 2)).max()
    m = rng.normal(size=(3, size))
    wanted = np.array([scipy.linalg.expm(np.einsum("a,aij->ij", y, a)) @ p for y, p in zip(x, m, strict=True)])
    for which in ("exp", "series", "expm"):
        np.testing.assert_allclose(exponential_of(rho, which)(x, m), wanted, rtol=1e-11, atol=1e-12)
    action = lh.Action(rho)
    basis = inner_product(rho).orthonormal_basis()
    np.testing.assert_allclose(basis.T @ action.inner_product.matrix @ basis, np.eye(n), atol=1e-8)
    psi = rng.normal(size=(n, size)) / np.abs(a).max()
    given_psi = lh.GeneratorField(rho, lambda m: np.einsum("ai,...i", psi, m))
    field = lh.GeneratorField.from_vector_field(rho, lambda m: given_psi.vector(m))
    given_psi.check(m)
    field.check(m)
    np.testing.assert_allclose(field.vector(m), given_psi.vector(m), rtol=1e-7, atol=1e-8 * np.abs(m).max() ** 2)
    one, other = (lh.steps.flow_series(f, m, 3).points.coefficients for f in (field, given_psi))
    np.testing.assert_allclose(one, other, rtol=1e-5, atol=1e-6 * np.abs(other).max())
    d = rho.orbit_dimension([rho.field.convert(int(1e6 * v)) for v in m[0]])
    assert check_point(rho, m[0]) == d
    frame = action.isotropy_frame(m[0], d)
    assert frame.basis.shape == (n, n - d)
    moved = action.infinitesimal(frame.basis.T, m[0])
    assert (
        np.abs(moved).max(initial=0.0)
        <= 1e-9 * np.abs(frame.basis).max(initial=1.0) * np.abs(a).max() * np.abs(m).max()
    )


@settings(max_examples=examples(25))
@given(representations(), st.integers(0, 1000))
def test_cayley_is_in_the_group_or_refused(rho: lh.Representation, seed: int) -> None:
    """What it does is an automorphism of every invariant form, to all sizes of x."""
    try:
        cayley = exponential_of(rho, "cayley")
    except InputError as error:
        assert "quadratic group" in str(error)
        return
    rng = np.random.default_rng(seed)
    a = np.array([b.to_numpy() for b in rho.matrices])
    x = rng.normal(size=rho.algebra.dimension)
    x *= 0.5 / np.linalg.norm(np.einsum("a,aij->ij", x, a))
    moved = np.array([cayley(x, e) for e in np.eye(rho.size)]).T
    forms = rho.invariant_forms()
    for form in (*forms.symmetric, *forms.skew):
        p = form.to_numpy()
        np.testing.assert_allclose(
            moved.T @ p @ moved, p, atol=1e-10 * np.abs(p).max() * max(1, np.abs(moved).max()) ** 2
        )
    h = 1e-4
    slope = (cayley(h * x, np.eye(rho.size)) - cayley(-h * x, np.eye(rho.size))) / (2 * h)
    np.testing.assert_allclose(slope.T, np.einsum("a,aij->ij", x, a), atol=1e-7)
