"""Spin representations: the table of dimensions, the commutants, the two half-spins, forms and stabilisers."""

import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.exact.scalars.rational import QQ

# Real dimension of a spin module of so(p, q), p + q = n, by q = 0, ..., n; so(p, q) and so(q, p) share them.
DIMENSIONS = {
    2: (2, 1, 2), 3: (4, 2, 2, 4), 4: (4, 4, 2, 4, 4), 5: (8, 8, 4, 4, 8, 8), 6: (8, 8, 8, 4, 8, 8, 8),
    7: (8, 16, 16, 8, 8, 16, 16, 8), 8: (8, 16, 16, 16, 8, 16, 16, 16, 8),
    9: (16, 16, 32, 32, 16, 16, 32, 32, 16, 16), 10: (32, 16, 32, 32, 32, 16, 32, 32, 32, 16, 32),
}  # fmt: skip
SIGNATURES = [(n - q, q) for n in DIMENSIONS for q in range(n + 1)]
COMMUTANT = {"R": 1, "C": 2, "H": 4}


@pytest.mark.parametrize(("p", "q"), SIGNATURES)
def test_the_module_has_the_dimension_of_the_table(p: int, q: int) -> None:
    kind = lh.spinor_type(p, q)
    assert kind.dimension == DIMENSIONS[p + q][q]
    # n = 2m + 1: one complex spin module of dimension 2^m; n = 2m: two of dimension 2^(m-1)
    complex_dimension = 2 ** ((p + q - 1) // 2)
    assert kind.dimension == complex_dimension * (1 if kind.division_algebra == "R" else 2)
    rho = lh.spin_representation(p, q)
    assert rho.size == kind.dimension and rho.algebra == lh.so(p, q)


@pytest.mark.parametrize(("p", "q"), [s for s in SIGNATURES if sum(s) <= 7] + [(8, 0), (5, 3), (6, 2), (4, 4), (9, 0)])
def test_the_module_is_irreducible_with_the_commutant_of_the_table(p: int, q: int) -> None:
    rho = lh.spin_representation(p, q)
    assert len(rho.commutant()) == COMMUTANT[lh.spinor_type(p, q).division_algebra] and rho.is_irreducible()


@pytest.mark.parametrize(("p", "q"), [(1, 1), (4, 0), (2, 2), (5, 1), (3, 3), (8, 0), (4, 4), (9, 1), (3, 7)])
def test_the_half_spin_modules_differ_and_the_volume_acts_as_the_chirality(p: int, q: int) -> None:
    signs = [1] * p + [-1] * q
    for chirality in (1, -1):
        rho = lh.spin_representation(p, q, chirality=chirality)
        volume = QQ.identity(rho.size)
        standard = lh.defining(rho.algebra)
        for i in range(0, p + q, 2):
            # e_i e_(i+1) is twice the image of the rotation that takes e_(i+1) to <e_(i+1), e_(i+1)> e_i
            x = next(k for k, a in enumerate(standard.matrices) if a[i, i + 1] != 0)
            volume = volume @ rho.matrices[x].scale(2 * signs[i + 1] * standard.matrices[x][i, i + 1])
        assert volume == QQ.identity(rho.size).scale(chirality)


def test_elsewhere_the_chirality_changes_nothing_up_to_isomorphism() -> None:
    for p, q in ((3, 0), (3, 1), (4, 1), (2, 1)):
        plus, minus = (lh.spin_representation(p, q, chirality=c) for c in (1, -1))
        assert len(plus.direct_sum(minus).commutant()) == 4 * len(plus.commutant())
    plus, minus = (lh.spin_representation(4, 4, chirality=c) for c in (1, -1))
    assert len(plus.direct_sum(minus).commutant()) == 2


def test_rotations_have_half_their_angle() -> None:
    """exp(2 pi x) = -1 for a rotation x in a plane: the images are no integer matrices in any basis."""
    rho = lh.spin_representation(7)
    for a in rho.matrices:
        assert a @ a == QQ.identity(8).scale("-1/4")
    assert all(a @ a == QQ.identity(1).scale("1/4") for a in lh.spin_representation(1, 1).matrices)


@pytest.mark.parametrize(("p", "q", "isotropy"), [
    (6, 0, 8), (7, 0, 14), (4, 3, 14), (8, 0, 21), (9, 0, 21), (8, 1, 21), (9, 1, 29), (10, 0, 21),
])  # fmt: skip
def test_stabilisers_of_the_first_spinor(p: int, q: int, isotropy: int) -> None:
    """su(3) in so(6), forms of g2 in so(7) and so(4, 3), spin(7) in so(8), so(9), so(10), with R^8 in so(9, 1)."""
    rho = lh.spin_representation(p, q)
    assert rho.isotropy([int(i == 0) for i in range(rho.size)]).dimension == isotropy


@pytest.mark.parametrize(("p", "q", "signature"), [(9, 0, (16, 0, 0)), (8, 1, (8, 8, 0)), (4, 3, (4, 4, 0))])
def test_signature_of_the_invariant_form(p: int, q: int, signature: tuple[int, int, int]) -> None:
    (form,) = lh.spin_representation(p, q).invariant_forms().symmetric
    assert form.signature() in (signature, (signature[1], signature[0], 0))


def test_the_same_module_as_the_one_of_the_spin_algebra() -> None:
    """In the basis of products e_i e_j, the matrices span the same space."""
    for p, q in ((5, 0), (4, 1), (3, 3)):
        ours, other = lh.spin_representation(p, q), lh.defining(f"spin({p},{q})" if q else f"spin({p})")
        flat = [QQ.stack_rows([a.reshape(1, a.nrows**2) for a in r.matrices], ours.size**2) for r in (ours, other)]
        assert QQ.stack_rows(flat, ours.size**2).rank() == ours.algebra.dimension


def test_what_is_no_signature_is_refused() -> None:
    for p, q in ((1, 0), (-1, 4), (0, 0)):
        with pytest.raises(InputError):
            lh.spin_representation(p, q)
        with pytest.raises(InputError):
            lh.spinor_type(p, q)
    with pytest.raises(InputError, match="chirality"):
        lh.spin_representation(4, 0, chirality=0)


@pytest.mark.parametrize(("p", "q"), [(30, 0), (15, 15), (64, 0), (65, 0), (10**12, 3)])
def test_matrices_that_fill_the_memory_are_refused(p: int, q: int) -> None:
    with pytest.raises(InputError, match=r"GB|too many|p is 1000000000000, the limit"):
        lh.spin_representation(p, q)


@pytest.mark.parametrize(("p", "q"), [(3, 0), (4, 0), (3, 1), (2, 2), (5, 0), (6, 2)])
def test_a_spin_representation_is_named_by_its_chirality(p: int, q: int) -> None:
    names = [lh.spin_representation(p, q, chirality=c).name for c in ((1, -1) if (p - q) % 4 == 0 else (1,))]
    assert names == (["half-spin +", "half-spin -"] if (p - q) % 4 == 0 else ["spin"])
