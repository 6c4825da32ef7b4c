"""The matrices of physics: their defining relations, and the names of the Lie algebras that they generate."""

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import InputError, LiehomError
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ

I = sympy.I
BASES = ("dirac", "weyl", "majorana")


def commutator(a: Any, b: Any) -> Any:
    return a * b - b * a


def name(matrices: Any, **options: Any) -> str:
    return lh.LieAlgebra.from_matrices(matrices, **options).real_form()


# -- the matrices --------------------------------------------------------------------------------------------
def test_pauli_matrices_anticommute_and_square_to_one() -> None:
    pauli = lh.algebra.pauli_matrices()
    for (j, a), (k, b) in itertools.product(enumerate(pauli), repeat=2):
        assert a * b + b * a == 2 * int(j == k) * sympy.eye(2)
    assert commutator(pauli[0], pauli[1]) == 2 * I * pauli[2]


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("normalized", [True, False])
def test_gell_mann_matrices_are_an_orthogonal_basis(n: int, normalized: bool) -> None:
    matrices = lh.algebra.gell_mann_matrices(n, normalized=normalized)
    assert len(matrices) == n * n - 1
    for (j, a), (k, b) in itertools.product(enumerate(matrices), repeat=2):
        assert a == a.H and a.trace() == 0
        product = sum(x * y for x, y in zip(a, b.T, strict=True))
        assert (sympy.expand(product) == 0) == (j != k)
        assert not normalized or j != k or sympy.expand(product) == 2


def test_gell_mann_matrices_are_in_gell_manns_order() -> None:
    matrices = lh.algebra.gell_mann_matrices()
    assert matrices[1] == sympy.Matrix([[0, -I, 0], [I, 0, 0], [0, 0, 0]])
    assert matrices[2] == sympy.diag(1, -1, 0)
    assert matrices[4] == sympy.Matrix([[0, 0, -I], [0, 0, 0], [I, 0, 0]])
    assert matrices[7] == sympy.diag(1, 1, -2) / sympy.sqrt(3)


@pytest.mark.parametrize("basis", BASES)
def test_dirac_matrices_satisfy_the_clifford_relations(basis: Any) -> None:
    gamma = lh.algebra.dirac_matrices(basis)
    metric = sympy.diag(1, -1, -1, -1)
    for j, k in itertools.product(range(4), repeat=2):
        assert gamma[j] * gamma[k] + gamma[k] * gamma[j] == 2 * metric[j, k] * sympy.eye(4)
    assert gamma[0] == gamma[0].H and all(-g == g.H for g in gamma[1:])
    assert (basis == "majorana") == all(sympy.re(x) == 0 for g in gamma for x in g)


@pytest.mark.parametrize("spin", [0, "1/2", 1, Fraction(3, 2), sympy.Integer(2), "5/2"])
def test_spin_matrices_satisfy_the_angular_momentum_relations(spin: Any) -> None:
    x, y, z = lh.algebra.spin_matrices(spin)
    j = sympy.Rational(str(spin))
    assert commutator(x, y).expand() == (I * z).expand() and commutator(y, z).expand() == (I * x).expand()
    assert (x**2 + y**2 + z**2).expand() == j * (j + 1) * sympy.eye(2 * j + 1)
    assert all(a == a.H for a in (x, y, z))


def test_wrong_parameters_raise() -> None:
    for n in (0, -1, 2.5, "3", True):
        with pytest.raises(InputError, match="n must be an integer"):
            lh.algebra.gell_mann_matrices(n)  # type: ignore[arg-type]
    for spin in (-1, "1/3", 0.5, "half", None, float("nan")):
        with pytest.raises(InputError, match="integer or half-integer"):
            lh.algebra.spin_matrices(spin)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="'dirac', 'weyl' and 'majorana'"):
        lh.algebra.dirac_matrices("chiral")  # type: ignore[arg-type]


# -- the algebras that they generate -------------------------------------------------------------------------
@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_gell_mann_matrices_generate_su_n(n: int) -> None:
    matrices = lh.algebra.gell_mann_matrices(n, normalized=False)
    rational = lh.Representation.from_matrices(matrices, hermitian=True)
    assert rational.field == QQ and rational.kept == tuple(range(n * n - 1)) and rational.appended == ()
    assert rational.algebra.real_form() == lh.su(n).real_form()
    if n < 5:  # the number field for n = 5 has degree 8
        assert name(lh.algebra.gell_mann_matrices(n), hermitian=True) == lh.su(n).real_form()
    assert str(lh.su(n).real_form()) in rational.algebra.describe()
    # two generic ones generate all
    pair = [sum(((k if m == 1 else k * k % 7) * a for k, a in enumerate(matrices, 1)), sympy.zeros(n)) for m in (1, 2)]
    assert lh.LieAlgebra.from_matrices(pair, hermitian=True).dimension == n * n - 1


@pytest.mark.parametrize("basis", BASES)
def test_commutators_of_dirac_matrices_generate_the_lorentz_algebra(basis: Any) -> None:
    gamma = lh.algebra.dirac_matrices(basis)
    spin = [commutator(gamma[j], gamma[k]) / 4 for j in range(4) for k in range(j)]
    rho = lh.Representation.from_matrices(spin)
    assert (rho.algebra.dimension, rho.algebra.real_form()) == (6, lh.so(3, 1).real_form())
    assert rho.complex_size == (None if basis == "majorana" else 4)  # Majorana spinors are real
    rotations = rho.subalgebra([commutator(gamma[j], gamma[k]) / 4 for j in range(1, 4) for k in range(1, j)])
    assert rotations.as_algebra().real_form() == "so(3)"
    boost = lh.pair_from_matrices(spin, [spin[k] for k in (2, 4, 5)])
    assert (boost.dimension, boost.subalgebra.as_algebra().real_form()) == (3, "so(3)")


def test_dirac_matrices_and_their_products_generate_the_conformal_algebra() -> None:
    """[gamma^a, gamma^b] / 4 and gamma^a / 2 span so(3, 2); with gamma_5 the conformal so(4, 2) = su(2, 2)."""
    gamma = lh.algebra.dirac_matrices()
    assert name([I * g / 2 for g in gamma]) == lh.so(3, 2).real_form()
    five = I * gamma[0] * gamma[1] * gamma[2] * gamma[3]
    spin = [commutator(gamma[j], gamma[k]) / 4 for j in range(4) for k in range(j)]
    assert name([*spin, *gamma, *(g * five for g in gamma), five]) == lh.su(2, 2).real_form()


@pytest.mark.parametrize("spin", ["1/2", 1, "3/2", 2])
def test_angular_momentum_is_su_2_and_ladder_operators_are_sl_2(spin: Any) -> None:
    x, y, z = lh.algebra.spin_matrices(spin)
    assert name([x, y, z], hermitian=True) == lh.su(2).real_form()
    raising, lowering = (x + I * y).expand(), (x - I * y).expand()
    assert name([raising, lowering, z]) == lh.sl(2).real_form()


@pytest.mark.parametrize(("modes", "particles"), [(2, 1), (2, 3), (3, 1), (3, 2)])
def test_quadratic_hamiltonians_of_n_bosonic_modes_generate_u_n(modes: int, particles: int) -> None:
    """a_i^* a_j on the states with a fixed number of particles: u(n) for the Hermitian parts, gl(n, R) as they are."""
    states = [s for s in itertools.product(range(particles + 1), repeat=modes) if sum(s) == particles]
    index = {s: k for k, s in enumerate(states)}

    def hopping(i: int, j: int) -> Any:
        matrix = sympy.zeros(len(states))
        for s in states:
            if s[j]:
                target = list(s)
                target[j] -= 1
                target[i] += 1
                matrix[index[tuple(target)], index[s]] = sympy.sqrt(s[j] * target[i])
        return matrix

    pairs = list(itertools.combinations_with_replacement(range(modes), 2))
    hamiltonians = [hopping(i, j) + hopping(j, i) for i, j in pairs]
    hamiltonians += [I * (hopping(i, j) - hopping(j, i)) for i, j in pairs if i < j]
    g = lh.LieAlgebra.from_matrices(hamiltonians, hermitian=True)
    assert (g.dimension, g.center().dimension) == (modes**2, 1)
    assert g.derived_subalgebra().as_algebra().real_form() == lh.su(modes).real_form()
    real = lh.LieAlgebra.from_matrices([hopping(i, j) for i in range(modes) for j in range(modes)])
    assert (real.dimension, real.center().dimension) == (modes**2, 1)
    assert real.derived_subalgebra().as_algebra().real_form() == lh.sl(modes).real_form()


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_numpy_matrices_with_integer_parts_are_named_once_they_are_rationalized(n: int) -> None:
    arrays = [np.array(a.tolist(), dtype=complex) for a in lh.algebra.gell_mann_matrices(n, normalized=False)]
    for observables in (arrays, arrays[:2] + arrays, [arrays[0] + 2 * arrays[-1], sum(arrays)]):
        floats = lh.Representation.from_matrices(observables, hermitian=True)
        with pytest.raises(LiehomError, match="rationalize"):
            floats.algebra.real_form()
        exact, change = lh.rationalize(floats)
        assert (exact.field, exact.complex_size, exact.dropped) == (QQ, n, floats.dropped) and change < 1e-12
        assert exact.algebra.real_form() == lh.su(n).real_form()


@pytest.mark.parametrize("basis", BASES)
def test_numpy_dirac_matrices_are_named_once_they_are_rationalized(basis: Any) -> None:
    gamma = [np.array(g.tolist(), dtype=complex) for g in lh.algebra.dirac_matrices(basis)]
    floats = lh.Representation.from_matrices([(a @ b - b @ a) / 4 for a, b in itertools.combinations(gamma, 2)])
    exact = lh.rationalize(floats).exact
    assert (floats.complex_size, exact.algebra.real_form()) == (4, lh.so(3, 1).real_form())


def test_numpy_matrices_generate_float_algebras_of_the_same_dimension() -> None:
    for n in (2, 3, 4):
        arrays = [np.array(a.evalf().tolist(), dtype=complex) for a in lh.algebra.gell_mann_matrices(n)]
        rho = lh.Representation.from_matrices(arrays[:2] + arrays, hermitian=True)
        assert (rho.field, rho.algebra.dimension, rho.dropped) == (RR, n * n - 1, (2, 3))
        state = np.array([1, 1j, *[0.5] * (n - 2)])
        assert rho.isotropy(state).dimension == (n - 1) ** 2 - 1
