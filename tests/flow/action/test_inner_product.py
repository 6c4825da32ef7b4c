"""Which inner product is taken, that it is what its name says, and where it is Ad-invariant."""

from typing import Any

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, strategies as st

import liehom as lh
from liehom.flow.action.frames import inner_product
from tests.flow.action.support import BUILDERS, matrices, representation, scrambled

TRACE = "-tr(rho(x) rho(y)), Ad-invariant"
KILLING = "minus the Killing form, Ad-invariant"
THETA = "tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose"
CENTRE = "minus the Killing form, plus the coefficients on the centre, Ad-invariant"
DEFINING = "-B(x, theta y), B the Killing form, theta = minus transpose in the defining matrices"
PLAIN = "coefficients in the given basis"


def solvable() -> lh.Representation:
    """x -> a x + b."""
    return lh.Representation.from_matrices([[[1, 0], [0, 0]], [[0, 1], [0, 0]]])


CASES: dict[str, tuple[Any, str]] = {
    "so(3)": (lambda: lh.defining(lh.so(3)), TRACE),
    "so(5) scrambled": (lambda: scrambled(lh.defining(lh.so(5)), 5), TRACE),
    "Sym(4)": (lambda: lh.sym_conjugation(4), TRACE), "u(3)": (lambda: lh.defining(lh.u(3)), TRACE),
    "u(3) scrambled": (lambda: scrambled(lh.defining(lh.u(3)), 6), TRACE),
    "g2 scrambled": (lambda: scrambled(lh.defining("g2"), 7), TRACE),
    "su(3) adjoint": (lambda: lh.adjoint(lh.su(3)), TRACE),
    "so(3) trivial": (lambda: lh.representations.trivial(lh.so(3), 2), KILLING),
    "so(4) on a factor": (lambda: lh.adjoint(lh.direct_sum(lh.so(3), lh.so(3))), TRACE),
    "u(2) adjoint": (lambda: lh.adjoint(lh.u(2)), CENTRE),
    "u(2) adjoint scrambled": (lambda: scrambled(lh.adjoint(lh.u(2)), 8), CENTRE),
    "so(3,1)": (lambda: lh.defining(lh.so(3, 1)), THETA), "sl(3)": (lambda: lh.defining(lh.sl(3)), THETA),
    "sp(4,R)": (lambda: lh.defining("sp(4,R)"), THETA),
    "sl(2) cubic forms": (lambda: lh.defining(lh.sl(2)).symmetric_power(3), DEFINING),
    "so(3,1) scrambled": (lambda: scrambled(lh.defining(lh.so(3, 1)), 9), PLAIN),
    "gl(2)": (lambda: lh.defining(lh.gl(2)), THETA), "Heisenberg": (lambda: representation("Heisenberg"), PLAIN),
    "affine line": (solvable, PLAIN), "e(3)": (lambda: representation("e(3)"), PLAIN),
    "abelian": (lambda: lh.representations.trivial(lh.abelian(3)), PLAIN + ", Ad-invariant"),
    "zero": (lambda: lh.representations.trivial(lh.abelian(0), 2), TRACE),
    "zero on nothing": (lambda: lh.representations.trivial(lh.abelian(0), 0), TRACE),
    "so(3) on nothing": (lambda: lh.representations.trivial(lh.so(3), 0), KILLING),
}  # fmt: skip


def adjoints(rho: lh.Representation) -> Any:
    n = rho.algebra.dimension
    return np.array([a.to_numpy() for a in lh.adjoint(rho.algebra).matrices]).reshape(n, n, n)


def is_invariant(rho: lh.Representation, form: Any) -> bool:
    """Under Ad_exp(x) for a few random x."""
    rng = np.random.default_rng(0)
    for _ in range(3):
        ad = np.einsum("a,aij->ij", rng.normal(size=len(form)), adjoints(rho))
        turn = scipy.linalg.expm(ad / max(1.0, float(np.linalg.norm(ad))))
        if not np.allclose(turn.T @ form @ turn, form, rtol=0, atol=1e-10 * np.abs(form).max(initial=1.0)):
            return False
    return True


@pytest.mark.parametrize("name", CASES)
def test_which_product_is_taken(name: str) -> None:
    build, wanted = CASES[name]
    rho = build()
    made = inner_product(rho)
    assert made.name == wanted
    n = rho.algebra.dimension
    assert made.matrix.shape == (n, n)
    np.testing.assert_array_equal(made.matrix, made.matrix.T)
    assert n == 0 or np.linalg.eigvalsh(made.matrix)[0] > 0
    assert made.invariant == is_invariant(rho, made.matrix) == made.name.endswith("Ad-invariant")
    basis = made.orthonormal_basis()
    np.testing.assert_allclose(basis.T @ made.matrix @ basis, np.eye(n), atol=1e-10)


@pytest.mark.parametrize("name", [n for n in BUILDERS if n not in ("zero", "trivial")])
def test_the_names_are_formulas(name: str) -> None:
    rho = representation(name)
    made, a = inner_product(rho), matrices(name)
    killing = np.einsum("aij,bji->ab", adjoints(rho), adjoints(rho))
    formulas = {
        TRACE: -np.einsum("aij,bji->ab", a, a), KILLING: -killing, THETA: np.einsum("aij,bij->ab", a, a),
        PLAIN: np.eye(len(a)),
    }  # fmt: skip
    formula = made.name if made.name in formulas else made.name.removesuffix(", Ad-invariant")
    if formula in formulas:
        np.testing.assert_allclose(made.matrix, formulas[formula], atol=1e-12)
    else:
        assert made.name == DEFINING and name in ("sl(2) cubic forms",)


@pytest.mark.parametrize("name", ["so(3,1)", "sl(3)", "sp(4,R)", "sl(2) cubic forms"])
def test_others_are_invariant_under_the_maximal_compact_subgroup(name: str) -> None:
    rho = representation(name)
    form, ad = inner_product(rho).matrix, adjoints(rho)
    defined = np.array([a.to_numpy() for a in lh.defining(rho.algebra).matrices])
    compact = [x for x in np.eye(len(form)) if np.allclose(sym := np.einsum("a,aij->ij", x, defined), -sym.T)]
    compact += [
        x - y
        for x in np.eye(len(form))
        for y in np.eye(len(form))
        if np.allclose(sym := np.einsum("a,aij->ij", x - y, defined), -sym.T)
    ]
    assert compact
    for x in compact:
        turn = scipy.linalg.expm(np.einsum("a,aij->ij", x, ad))
        np.testing.assert_allclose(turn.T @ form @ turn, form, atol=1e-12)


@given(st.lists(st.sampled_from([1e-6, 1e-3, 1.0, 50.0, 1e5]), min_size=3, max_size=3), st.integers(0, 50))
def test_lengths_and_directions_of_the_basis_do_not_matter(lengths: list[float], seed: int) -> None:
    """<x, y> of so(3) is the same function of the matrices whatever the basis."""
    rows = np.array(lengths)[:, None] * np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    made = [np.einsum("a,aij->ij", row, matrices("so(3)")).tolist() for row in rows]
    rho = lh.Representation(lh.so(3).over(lh.FloatField(1e-12)).change_of_basis(rows.tolist()), made)
    product = inner_product(rho)
    assert product.name == TRACE
    wanted = rows @ inner_product(representation("so(3)")).matrix @ rows.T
    np.testing.assert_allclose(product.matrix, wanted, rtol=1e-9, atol=1e-12 * np.abs(wanted).max())
