"""Involutions of real forms: automorphisms, completeness of the classification, Berger's counts."""

import numpy as np
import pytest

import liehom as lh
from liehom.exact.algebra.roots.chevalley import RootAutomorphism, base_exponents, compact_form, permutation_of
from liehom.exact.algebra.roots.real_form import complex_form, real_forms
from liehom.exact.algebra.roots.real_form_involutions import (
    _conjugation_shifts,
    candidates,
    involution_type,
    involutions,
    root_symmetries,
)

BERGER = {
    "sl(2,R)": 2, "sl(3,R)": 3, "su(2,1)": 3, "su(3)": 2, "sl(3,C)": 5, "so(3,2)": 5, "so(4,1)": 4, "so(5)": 2,
    "g2(2)": 2, "g2(C)": 3, "sl(4,R)": 7, "su(2,2)": 8, "su(3,1)": 4, "sl(2,H)": 5, "sp(6,R)": 4, "sp(2,1)": 3,
    "so(6,1)": 6, "so(5,4)": 14, "so(4,4)": 8, "so(6,2)": 11, "so(8)": 4, "f4": 2, "f4(4)": 4, "f4(-20)": 3,
    "f4(C)": 5,
}  # fmt: skip
"""The numbers of symmetric pairs in Berger's lists; triality joins some of so(4,4)."""

SMALL = ["A1", "A2", "B2", "G2", "A3", "B3", "C3"]
LARGE = ["A4", "B4", "C4", "D4", "F4"]


@pytest.mark.parametrize(("name", "count"), BERGER.items())
def test_numbers_of_classes_are_those_of_berger(name, count):
    assert len(involutions(lh.RealForm.of_name(name))) == count


@pytest.mark.parametrize("type_name", ["A2", "B2", "G2", "A3", "B3", "C3"])
def test_involutions_are_commuting_automorphisms_of_order_two(type_name):
    """Each matrix preserves the brackets of the compact form; a sign changed in it does not."""
    algebra = compact_form(type_name)
    n = algebra.dimension
    constants = np.zeros((n, n, n))
    for i, j, k, value in algebra.table:
        constants[i, j, k], constants[j, i, k] = float(value), -float(value)

    def preserves(matrix):
        left = np.einsum("ai,bj,ijk->abk", matrix, matrix, constants, optimize=True)
        return np.array_equal(left, constants @ matrix)

    for form in real_forms(type_name):
        theta = RootAutomorphism.of_vogan(form.vogan).matrix()
        for involution in involutions(form):
            sigma = involution.matrix()
            assert preserves(sigma)
            assert np.array_equal(sigma @ sigma, np.eye(n))
            assert np.array_equal(sigma @ theta, theta @ sigma)
            broken = sigma.copy()
            broken[-1] *= -1
            assert not preserves(broken)


def test_composition_is_the_product_of_matrices():
    one = RootAutomorphism("B2", ((-1, 0), (1, 1)), (1, 2))
    two = RootAutomorphism("B2", ((1, 2), (0, -1)), (3, 1))
    assert np.array_equal((one @ two).matrix(), two.matrix() @ one.matrix())
    assert one @ two != two @ one


@pytest.mark.parametrize("type_name", SMALL + LARGE)
def test_complex_algebras_have_linear_and_conjugate_linear_involutions(type_name):
    """The linear ones belong to the other real forms, the conjugations to all real forms."""
    form, count = complex_form(type_name), len(real_forms(type_name))
    types = [involution_type(form, involution) for involution in involutions(form)]
    assert len(set(types)) == len(types) == 2 * count - 1


@pytest.mark.parametrize("type_name", [*SMALL, *(pytest.param(name, marks=pytest.mark.slow) for name in LARGE)])
def test_candidates_of_one_type_are_conjugate(type_name):
    """The orbits of candidates under the normalizer of the torus in K are as many as their types, which are distinct.

    Candidates of one type thus belong to one orbit: the classification by types neither joins nor splits classes.
    """
    for form in real_forms(type_name)[:-1]:
        automorphisms = list(candidates(form))
        types = {involution_type(form, candidate) for candidate in automorphisms}
        assert len(_orbits(form, automorphisms)) == len(types) == len(involutions(form)), form.name


def _orbits(form, automorphisms):
    """The orbits of the candidates under conjugation with lifts of root symmetries that commute with theta."""
    theta = RootAutomorphism.of_vogan(form.vogan)
    shifts = {c.images: _conjugation_shifts(form.vogan, np.array(c.images)) for c in automorphisms}
    index = {c: i for i, c in enumerate(automorphisms)}
    label = list(range(len(automorphisms)))

    def root(i):
        while label[i] != i:
            i = label[i]
        return i

    for lift in _lifts(form, theta):
        back = _inverse(lift)
        for candidate in automorphisms:
            moved = lift @ candidate @ back
            if moved.images in shifts:
                smallest = min(((np.array(moved.exponents) + shifts[moved.images]) % 4).tolist())
                other = RootAutomorphism(moved.type, moved.images, tuple(smallest))
                label[root(index[candidate])] = root(index[other])
    return {root(i) for i in range(len(automorphisms))}


def _lifts(form, theta):
    """One automorphism that commutes with theta for each root symmetry that has one."""
    system, delta = form.root_system(), form.vogan.involution()
    rank = system.rank
    grid = np.stack(np.meshgrid(*[range(4)] * rank, indexing="ij"), axis=-1).reshape(-1, rank)
    turned, own, roots = theta.permutation()[:rank], theta.all_exponents(), system.root_matrix()
    for w in root_symmetries(system):
        if not np.array_equal(w @ delta, delta @ w):
            continue
        images = tuple(map(tuple, w.tolist()))
        known, moved = base_exponents(form.type, images), permutation_of(system, images)[:rank]
        change = grid + own[moved] - own[:rank] - known[turned] - grid @ roots[turned].T
        valid = grid[(change % 4 == 0).all(axis=1)]
        if len(valid):
            yield RootAutomorphism(form.type, images, tuple(valid[0].tolist()))


def _inverse(lift):
    images = tuple(map(tuple, np.rint(np.linalg.inv(np.array(lift.images))).astype(int).tolist()))
    product = lift @ RootAutomorphism(lift.type, images, (0,) * len(images))
    automorphism = RootAutomorphism(lift.type, images, tuple(-x % 4 for x in product.exponents))
    assert (lift @ automorphism).exponents == (0,) * len(images)
    return automorphism
