"""Closures of Pauli words: against matrices, against the generic structure theory, and against known dimensions."""

import functools
import itertools
import pickle

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, LimitError
from tests.sampling import examples

MATRICES = {"I": np.eye(2), "X": [[0, 1], [1, 0]], "Y": [[0, -1j], [1j, 0]], "Z": [[1, 0], [0, -1]]}


def matrix(word: str) -> np.ndarray:
    return functools.reduce(np.kron, [np.asarray(MATRICES[letter]) for letter in word], np.eye(1, dtype=complex))


def word_sets(qubits: int, most: int) -> st.SearchStrategy[list[str]]:
    return st.lists(st.text("IXYZ", min_size=qubits, max_size=qubits), min_size=1, max_size=most, unique=True)


@given(word_sets(3, 5))
@settings(max_examples=examples(60), deadline=None)
def test_table_is_the_commutator_of_the_matrices(words: list[str]) -> None:
    closure = lh.pauli.closure(words)
    basis = [1j * matrix(word) for word in closure.words]
    table = {(i, j): (k, v) for i, j, k, v in closure.algebra.structure_constants()}
    for i, j in itertools.combinations(range(len(basis)), 2):
        k, v = table.get((i, j), (0, 0))
        np.testing.assert_array_equal(basis[i] @ basis[j] - basis[j] @ basis[i], int(v) * basis[k])
    lh.LieAlgebra(closure.algebra.table)  # proves the Jacobi identity


@given(word_sets(4, 7))
@settings(max_examples=examples(60), deadline=None)
def test_name_agrees_with_the_structure_theory(words: list[str]) -> None:
    closure = lh.pauli.closure(words)
    assume(closure.dimension <= 130)
    assert closure.name is not None
    central = sum(ideal.kind == "u(1)" for ideal in closure.ideals)
    assert closure.algebra.center().dimension == central
    semisimple = [part for part in closure.name.split(" + ") if part != "u(1)"]
    if semisimple:
        assert closure.algebra.levi_decomposition().levi.as_algebra().real_form() == " + ".join(semisimple)


@pytest.mark.parametrize("sites", [3, 4, 5, 6, 7, 8])
def test_chains_have_their_known_algebras(sites: int) -> None:
    names = lh.canonical_real_form
    chain, ring = lh.pauli.chain(sites), lh.pauli.chain(sites, periodic=True)
    pauli = lh.pauli
    assert pauli.closure(pauli.ising(chain)).name == names(f"so({2 * sites})")
    assert pauli.closure(pauli.ising(ring)).name == names(f"so({2 * sites})+so({2 * sites})")
    assert pauli.closure(pauli.xy(chain)).name == names(f"so({sites})+so({sites})")
    assert pauli.closure(pauli.kitaev(chain)).name == names(f"so({2 * sites})")
    if sites <= 6:
        power, copies = (sites - 1, 1) if sites % 2 else (sites - 2, 4)
        assert pauli.closure(pauli.heisenberg(chain)).name == names("+".join([f"su({2**power})"] * copies))


def test_a_symplectic_algebra_is_named() -> None:
    # words that the quaternionic structure of three qubits negates: Arf invariant 1
    words = [w for w in map("".join, itertools.product("IXYZ", repeat=3)) if quaternionic(w)]
    closure = lh.pauli.closure(words)
    assert (closure.dimension, closure.name) == (36, "sp(4)")
    assert lh.pauli.closure(["X", "Y"]).name == "so(3)"


def quaternionic(word: str) -> bool:
    form, m = matrix("YII"), matrix(word)
    return bool(np.allclose(m.T @ form, -form @ m))


def test_real_words_generate_the_orthogonal_algebra() -> None:
    words = [w for w in map("".join, itertools.product("IXYZ", repeat=3)) if w.count("Y") % 2]
    assert lh.pauli.closure(words).name == "so(8)"


@pytest.mark.parametrize(("sums", "dimension"), [
    (["XX + YY + ZZ"], 1), (["XX + YY", "ZI"], 4), (["ZZI + IZZ", "XII + IXI + IIX"], 9),
    (["XXI + IXX", "YYI + IYY", "ZZI + IZZ"], 8), (["sqrt(2)*XI + IZ", "ZI"], 3 + 1),
])  # fmt: skip
def test_sums_agree_with_the_closure_of_the_matrices(sums: list[str], dimension: int) -> None:
    closure = lh.pauli.closure(sums)
    assert closure.dimension == closure.algebra.dimension == dimension and (
        closure.name is None or closure.spanned_by_words
    )
    flat = [np.zeros((2**closure.qubits,) * 2, complex) for _ in sums]
    for total, terms in zip(flat, closure.sums.terms, strict=True):
        for word, c in terms.items():
            total += 1j * float(c) * matrix(closure.words[closure._integers.index(word)])
    real = [np.block([[a.real, -a.imag], [a.imag, a.real]]) for a in flat]
    assert lh.LieAlgebra.from_matrices(real).dimension == dimension


@given(st.data())
@settings(max_examples=examples(25), deadline=None)
def test_dimension_of_sums_is_that_of_spanned_matrices(data: st.DataObject) -> None:
    term = st.tuples(st.sampled_from(["XII", "ZZI", "IYX", "IZZ", "YIY", "IXI"]), st.integers(-3, 3).filter(bool))
    sums = data.draw(st.lists(st.lists(term, min_size=1, max_size=3, unique_by=lambda t: t[0]), min_size=1, max_size=3))
    closure = lh.pauli.closure(sums)
    sums_flat = [sum((c * matrix(w) for w, c in s), np.zeros((8, 8), complex)).ravel() for s in sums]
    generators = [a.reshape(8, 8) / np.linalg.norm(a) for a in sums_flat]
    basis = np.linalg.qr(np.array([g.ravel() for g in generators[:1]]).T)[0].T
    queue = list(generators)
    while queue:
        m = queue.pop()
        left = m.ravel() - basis.T @ (basis.conj() @ m.ravel())
        left -= basis.T @ (basis.conj() @ left)
        if np.linalg.norm(left) > 1e-7 or len(basis) == 0:
            new = (left / np.linalg.norm(left)).reshape(8, 8)
            basis = np.vstack([basis, new.ravel()])
        elif m is not generators[0]:
            continue
        else:
            new = m
        queue += [c / n for g in generators if (n := np.linalg.norm(c := g @ new - new @ g)) > 1e-7]
    # Hermitian matrices that are independent over the reals are independent over the complex numbers
    assert closure.dimension == len(basis)


def test_element_gives_the_coefficients_of_a_hamiltonian() -> None:
    closure = lh.pauli.closure(["ZZI + IZZ", "XII + IXI + IIX"])
    total = closure.element("ZZI + IZZ")
    rows = closure.subalgebra.rows()
    combined = {w: sum(c * row[i] for c, row in zip(total, rows, strict=True)) for i, w in enumerate(closure.words)}
    assert {w: c for w, c in combined.items() if c != 0} == {"ZZI": 1, "IZZ": 1}
    with pytest.raises(InputError):
        closure.element("ZZI")
    with pytest.raises(InputError, match="ZIZ does not occur"):
        lh.pauli.closure(["XXX", "ZII"]).element("ZIZ")


def test_a_single_word_may_carry_any_coefficient() -> None:
    assert lh.pauli.closure(["-3*XX", "sqrt(2)*ZI"]).words == lh.pauli.closure(["XX", "ZI"]).words


def test_repeated_and_dependent_hamiltonians_do_not_change_the_algebra() -> None:
    assert lh.pauli.closure(["XX", "XX", "ZI"]).dimension == lh.pauli.closure(["XX", "ZI"]).dimension
    assert lh.pauli.closure(["XX + ZI", "2*XX + 2*ZI"]).dimension == 1


def test_too_many_words_are_refused_before_they_are_made() -> None:
    words = [*lh.pauli.heisenberg(lh.pauli.chain(9)), "X" + "I" * 8]
    with pytest.raises(LimitError, match="the limit is 4096; raise it by"):
        lh.pauli.closure(words)


def test_a_pickled_closure_is_the_same() -> None:
    closure = lh.pauli.closure(["XX + YY", "ZI"])
    assert pickle.loads(pickle.dumps(closure)).algebra == closure.algebra


def test_bad_edges_are_refused() -> None:
    for edges in ([(0, 0)], [(0, -1)], [(0,)], [], ["a"]):
        with pytest.raises(InputError):
            lh.pauli.ising(edges)  # type: ignore[arg-type]
    for sites in (1, 0, True, 2.0):
        with pytest.raises(InputError):
            lh.pauli.chain(sites)  # type: ignore[arg-type]


@given(word_sets(2, 4))
@settings(max_examples=examples(20), deadline=None)
def test_representation_has_the_matrices_of_the_words(words: list[str]) -> None:
    rho = lh.pauli.closure(words).representation()
    lh.Representation(rho.algebra, rho.matrices)  # proves the representation identity
    for word, image in zip(rho.algebra.basis_names, rho.over(lh.scalars.RR).complex_matrices(), strict=True):
        np.testing.assert_array_equal(image, 1j * matrix(word))


def test_representation_of_sums_is_a_representation() -> None:
    rho = lh.pauli.closure(["XX + sqrt(2)*YY", "ZI"]).representation()
    assert lh.Representation(rho.algebra, rho.matrices).size == 8 and rho.complex_size == 4
    assert lh.pauli.closure(["XX", "ZI", "IZ"]).representation().isotropy([1, 0, 0, 1]).dimension == 3


def test_words_and_matrices_generate_the_same_algebra() -> None:
    words = ["ZZ", "XI", "IX"]
    by_matrices = lh.Representation.from_matrices([matrix(w).real.astype(int).tolist() for w in words], hermitian=True)
    closure = lh.pauli.closure(words)
    assert by_matrices.algebra.real_form() == closure.name == "so(3) + so(3)"
