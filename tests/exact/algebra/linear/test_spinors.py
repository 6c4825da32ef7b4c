"""Clifford generators and spin representations: relations, dimensions, half-spins, invariant forms."""

from itertools import combinations

import numpy as np
import pytest

from liehom.exact.algebra import linear as mf


@pytest.mark.parametrize(("p", "q"), [(p, q) for p in range(10) for q in range(10) if p + q <= 11])
def test_clifford_relations_and_module_dimension(p, q):
    generators = mf.clifford(p, q)
    size = generators.shape[1]
    assert generators.shape[0] == p + q
    one = np.eye(size, dtype=int)
    assert all(np.array_equal(np.abs(g) @ np.abs(g).T, one) for g in generators)
    assert all(np.array_equal(g @ g, one if i < p else -one) for i, g in enumerate(generators))
    assert all(not (a @ b + b @ a).any() for a, b in combinations(generators, 2))
    # dimension of the irreducible modules by (p - q) mod 8: real, complex and quaternionic classes
    n, kind = p + q, (p - q) % 8
    exponent = {0: n // 2, 1: (n - 1) // 2, 2: n // 2, 3: (n + 1) // 2}
    exponent |= {4: n // 2 + 1, 5: (n + 1) // 2, 6: n // 2 + 1, 7: (n + 1) // 2}
    assert size == 2 ** exponent[kind]


def test_the_two_half_spin_representations_differ():
    """On a half-spin module the product of all e_i e_{i+1} is a sign, which the chirality changes."""
    for p, q in ((8, 0), (5, 5), (9, 1)):
        volumes = []
        for chirality in (1, -1):
            generators = mf.spin(p, q, chirality=chirality)[: p + q - 1]
            volumes.append(np.linalg.multi_dot(list(generators)))
        one = np.eye(len(volumes[0]))
        assert np.array_equal(volumes[0], -volumes[1])
        assert np.array_equal(np.abs(volumes[0]), one)


def test_spin_five_five_keeps_no_symmetric_form_and_spin_eight_one_keeps_an_indefinite_one():
    def forms(matrices):
        n = matrices.shape[1]
        mixed = np.tensordot(np.random.default_rng(3).integers(-3, 4, (2, len(matrices))), matrices, 1)
        one = np.eye(n, dtype=int)
        system = np.vstack([np.kron(a.T, one) + np.kron(one, a.T) for a in mixed])
        _, values, vectors = np.linalg.svd(system.astype(float))
        return [v.reshape(n, n) for v, s in zip(vectors, values, strict=True) if s < 1e-8]

    assert not forms(mf.spin(5, 5))
    assert not forms(mf.spin(9, 1))
    (form,) = forms(mf.spin(8, 1))
    eigenvalues = np.linalg.eigvalsh((form + form.T) / 2)
    assert (eigenvalues > 1e-6).sum() == (eigenvalues < -1e-6).sum() == 8
