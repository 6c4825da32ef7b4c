"""Forms that are proposed from the algebra alone: they are positive, and compatible with what the algebra preserves."""

import random

import numpy as np
import pytest

from liehom.exact.fullness.search.forms import complex_symplectic_form, symplectic_form
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.rational import QQ


def skew_matrix(n: int, seed: int) -> ExactMatrix:
    rng = random.Random(seed)
    upper = [[rng.randint(-3, 3) if i < j else 0 for j in range(n)] for i in range(n)]
    return QQ.matrix(upper) - QQ.matrix(upper).T


@pytest.mark.parametrize("n", [2, 4, 6])
def test_a_symplectic_form_and_its_definite_form_give_a_complex_structure(n: int) -> None:
    skew = skew_matrix(n, seed=n)
    form = symplectic_form(skew)
    assert form is not None and form == form.T and form.signature() == (n, 0, 0)
    structure = form.inverse() @ skew
    assert structure @ structure == -QQ.identity(n)


def test_degenerate_skew_forms_have_no_darboux_basis() -> None:
    singular = QQ.matrix([[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])
    assert all(symplectic_form(skew) is None for skew in (skew_matrix(3, 1), QQ.zeros(1, 1), QQ.zeros(2, 2), singular))


@pytest.mark.parametrize(("a", "pairs"), [(1, 1), (2, 1), (1, 2), (2, 2)])
def test_a_complex_symplectic_form_and_its_hermitian_form_give_quaternions(a: int, pairs: int) -> None:
    """The real part of a skew form A + sqrt(-a) B on pairs x + sqrt(-a) y, in a basis that mixes x and y."""
    n = 2 * pairs
    real, imaginary = (np.array(skew_matrix(n, seed).to_numpy(), dtype=int) for seed in (5, 6))
    mixed = QQ.matrix((np.eye(2 * n, dtype=int) + np.triu(np.ones((2 * n, 2 * n), dtype=int), 1)).tolist())
    skew = QQ.matrix(np.block([[real, -a * imaginary], [-a * imaginary, -a * real]]).tolist())
    structure = QQ.matrix(np.kron([[0, -a], [1, 0]], np.eye(n, dtype=int)).tolist())
    skew, structure = mixed.T @ skew @ mixed, mixed.inverse() @ structure @ mixed
    form = complex_symplectic_form(skew, structure)
    assert form is not None and form == form.T and form.signature() == (2 * n, 0, 0)
    assert structure.T @ form @ structure == form.scale(a)
    other = form.inverse() @ skew
    assert other @ other == -QQ.identity(2 * n) and other @ structure == -structure @ other
    assert complex_symplectic_form(skew - skew, structure) is None
