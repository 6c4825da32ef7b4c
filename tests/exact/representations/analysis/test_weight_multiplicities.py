"""Weights in scrambled bases of algebra and module, against Freudenthal's characters."""

import random
from collections import Counter

import pytest

import liehom as lh
from liehom.base.errors import InputError, NotCompletelyReducibleError, UndecidedError
from liehom.exact.representations.analysis.weight_multiplicities import Charge
from liehom.exact.scalars.joint_spectrum import joint_multiplicities, preserved_blocks
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular


def scrambled(rho: lh.Representation, seed: int = 2) -> lh.Representation:
    """The same representation in random bases of the algebra and of the space, proved again."""
    rng = random.Random(seed)
    n, size = rho.algebra.dimension, rho.size
    rows = QQ.matrix(random_unimodular(n, rng))
    change = QQ.matrix(random_unimodular(size, rng))
    flat = QQ.stack_rows([(change @ a @ change.inverse()).reshape(1, size**2) for a in rho.matrices], size**2)
    return lh.Representation(rho.algebra.change_of_basis(rows), (rows @ flat).split_rows(size, size))


@pytest.mark.parametrize(("name", "weight"), [
    ("A1", (4,)), ("A2", (1, 1)), ("A2", (2, 0)), ("B2", (1, 0)), ("B2", (0, 1)), ("G2", (1, 0)), ("A3", (0, 1, 0)),
    ("C3", (0, 1, 0)), ("A1 + B2", (1, 0, 1)), ("B3", (0, 0, 1)),
])  # fmt: skip
def test_split_modules(name: str, weight: tuple[int, ...]) -> None:
    """Up to a symmetry of the diagram, which exchanges (2, 0) and (0, 2) of A2."""
    rho = lh.highest_weight_module(name, weight).representation
    for moved in (rho, scrambled(rho)):
        assert moved.algebra.semisimple_type() == name
        found = moved.highest_weights()
        dual = lh.representations.dual_weight(name, weight)
        assert found in ({weight: 1}, {dual: 1})
        assert moved.weights() == lh.representations.character(name, next(iter(found)))


@pytest.mark.parametrize(("name", "expected"), [
    ("so(5)", {(1, 0): 1}), ("so(3,2)", {(1, 0): 1}), ("sp(4,R)", {(0, 1): 1}), ("sp(2)", {(0, 1): 2}),
    ("so(3,1)", {(1, 1): 1}), ("sl(2,C)", {(1, 0): 1, (0, 1): 1}), ("su(2)", {(1,): 2}),
    ("su(2,1)", {(1, 0): 1, (0, 1): 1}), ("so(4)", {(1, 1): 1}), ("g2", {(1, 0): 1}), ("spin(7)", {(0, 0, 1): 1}),
    ("sl(2,H)", {(1, 0, 0): 2}),
])  # fmt: skip
def test_real_forms(name: str, expected: dict[tuple[int, ...], int]) -> None:
    """On Cartan subalgebras that do not split; a type C or H doubles."""
    rho = lh.defining(name)
    for moved in (rho, scrambled(rho)):
        found = moved.highest_weights()
        mirrored = {tuple(reversed(w)): m for w, m in expected.items()}
        assert found in (expected, mirrored)


def test_multiplicities_of_sums_and_products() -> None:
    so3 = lh.defining(lh.so(3))
    cube = scrambled(so3.tensor(so3).tensor(so3))
    assert cube.highest_weights() == {(6,): 1, (4,): 2, (2,): 3, (0,): 1}
    dimensions = Counter(cube.decomposition().dimensions())
    assert dimensions == {7: 1, 5: 2, 3: 3, 1: 1}
    su3 = lh.defining(lh.su(3))
    assert su3.tensor(su3).highest_weights() == {(2, 0): 1, (1, 1): 2, (0, 2): 1, (1, 0): 1, (0, 1): 1, (0, 0): 2}
    assert lh.representations.trivial(lh.so(3), 4).highest_weights() == {(0,): 4}
    assert lh.representations.trivial(lh.so(3), 0).weights() == {}


def test_over_a_number_field() -> None:
    rho = lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)"))
    assert rho.symmetric_power(2).highest_weights() == {(4,): 1, (0,): 1}


def test_refusals() -> None:
    for solvable_radical in (lh.euclidean(3), lh.heisenberg(1)):
        with pytest.raises(InputError, match="reductive"):
            lh.adjoint(solvable_radical).weights()
    with pytest.raises(NotCompletelyReducibleError, match="element 0 of the centre does not act semisimply"):
        lh.Representation.from_matrices([[[1, 1], [0, 1]]]).weights()
    with pytest.raises(UndecidedError, match="rationalize"):
        lh.defining(lh.so(3)).over(lh.RR).weights()


def test_what_one_combination_does_not_separate_is_refused() -> None:
    change = QQ.matrix([[1, 1], [1, 2]])
    a, b = (change @ QQ.matrix([[x, 0], [0, 3 - x]]) @ change.inverse() for x in (1, 2))
    assert joint_multiplicities([a, b], [1, 1]) is None
    found = joint_multiplicities([a, b], [1, 3])
    assert found is not None
    rounded = [(round(complex(v[0]).real), round(complex(v[1]).real), m) for v, m in found.values(64)]
    assert sorted(rounded) == [(1, 2, 1), (2, 1, 1)]


def test_blocks() -> None:
    """What all matrices preserve as they stand is taken block by block."""
    rho = lh.adjoint(lh.chevalley("B2")).direct_sum(lh.representations.trivial(lh.chevalley("B2"), 2))
    diagonal = [rho.matrices[0], rho.matrices[1]]
    assert preserved_blocks(diagonal) == [[i] for i in range(12)]
    assert preserved_blocks([rho.matrices[2], rho.matrices[6]])[0] != [0]
    assert rho.weights() == {**lh.representations.character("B2", [0, 2]), (0, 0): 4}


# -- algebras with a centre --------------------------------------------------------------------------------
def unitary_and_charge(q: int, p: int = 3) -> lh.Representation:
    """su(p) + u(1) on C^p, where the generator of u(1) is i q."""
    su = lh.defining(lh.su(p))
    turn = next(a for a in su.commutant() if a.trace() == 0)  # a multiple of multiplication by i
    size = next(abs(x) for x in turn.entries() if x != 0)
    return lh.Representation(lh.direct_sum(su.algebra, lh.abelian(1)), [*su.matrices, turn.scale(QQ.convert(q) / size)])


def charged(*terms: tuple[tuple[int, ...], tuple[object, object], int]) -> dict[object, int]:
    """Highest weights with one charge (real, imaginary), and multiplicities."""
    return {(weight, (tuple(QQ.convert(x) for x in charge),)): m for weight, charge, m in terms}


CHARGED = {
    "gl(1)": (lambda: lh.defining(lh.gl(1)), charged(((), (1, 0), 1))),
    "gl(3)": (lambda: lh.defining(lh.gl(3)), charged(((1, 0), (1, 0), 1))),
    "gl(3), dual": (lambda: lh.defining(lh.gl(3)).dual(), charged(((0, 1), (-1, 0), 1))),
    "gl(3), Sym^2": (lambda: lh.defining(lh.gl(3)).symmetric_power(2), charged(((2, 0), (2, 0), 1))),
    "gl(4), L^3": (lambda: lh.defining(lh.gl(4)).exterior_power(3), charged(((0, 0, 1), (3, 0), 1))),
    "gl(2), adjoint": (lambda: lh.adjoint(lh.gl(2)), charged(((2,), (0, 0), 1), ((0,), (0, 0), 1))),
    "u(1)": (lambda: lh.defining(lh.u(1)), charged(((), (0, 1), 1), ((), (0, -1), 1))),
    "u(2)": (lambda: lh.defining(lh.u(2)), charged(((1,), (0, 1), 1), ((1,), (0, -1), 1))),
    "u(3)": (lambda: lh.defining(lh.u(3)), charged(((1, 0), (0, 1), 1), ((0, 1), (0, -1), 1))),
    "u(2), products": (
        lambda: lh.defining(lh.u(2)).tensor(lh.defining(lh.u(2))),
        charged(*(((k,), (0, q), 1 + (q == 0)) for k in (2, 0) for q in (2, 0, -2))),
    ),
    "su(3) + u(1), charge 5": (lambda: unitary_and_charge(5), charged(((1, 0), (0, 5), 1), ((0, 1), (0, -5), 1))),
}


@pytest.mark.parametrize("name", CHARGED)
def test_charges_of_algebras_with_a_centre(name: str) -> None:
    make, expected = CHARGED[name]
    rho = make()
    found = rho.highest_weights()
    mirrored = {(tuple(reversed(w)), c): m for (w, c), m in expected.items()}
    assert found in (expected, mirrored) and sum(rho.weights().values()) == rho.size


@pytest.mark.parametrize(("name", "weights", "compact"), [
    ("su(3)/u(2)", {(1,)}, True), ("su(2,1)/u(2)", {(1,)}, True), ("so(5)/so(3)+so(2)", {(2,)}, True),
    ("sp(4,R)/u(2)", {(2,)}, True), ("sl(3)/s(gl(2)+gl(1))", {(1,)}, False), ("sp(4,R)/gl(2)", {(2,)}, False),
    ("su(4)/s(u(2)+u(2))", {(1, 1)}, True), ("so(3)/so(2)", {()}, True),
])  # fmt: skip
def test_isotropy_of_symmetric_spaces(name: str, weights: set[tuple[int, ...]], compact: bool) -> None:
    """Hermitian symmetric spaces have imaginary charges, para-Hermitian ones real charges, of both signs."""
    rho = lh.pair(name).isotropy_representation()
    found = rho.highest_weights()
    assert {w for w, _ in found} == weights and len(found) == 2
    (first,), (second,) = (charges for _, charges in found)
    assert first.real == -second.real and first.imaginary == -second.imaginary
    assert (first.real == 0) is compact and (first.imaginary == 0) is not compact


def test_charges_are_the_eigenvalues_of_the_centre_in_any_basis() -> None:
    """Power sums of the charges are traces of powers of rho(z)."""
    copies = lh.defining(lh.u(2))
    mixed = lh.Representation.from_matrices([[[0, -2], [1, 0]], [[3, -2], [1, 3]]])
    for rho in (scrambled(lh.defining(lh.gl(3))), scrambled(copies.tensor(copies)), scrambled(mixed)):
        for k, z in enumerate(rho.algebra.center().rows()):
            a = rho(z)
            total = [complex(0), complex(0)]
            for (_, charges), m in rho.weights().items():
                value = complex(float(charges[k].real), float(charges[k].imaginary))
                total = [total[0] + m * value, total[1] + m * value**2]
            for found, matrix in zip(total, (a, a @ a), strict=True):
                assert found == pytest.approx(float(matrix.trace()), abs=1e-9)


def test_charges_in_number_fields() -> None:
    """x^3 = 2 has one real and two complex roots; their parts are in fields of degree 3 and 6."""
    rho = lh.Representation.from_matrices([[[0, 0, 2], [1, 0, 0], [0, 1, 0]]])
    charges = [c for _, (c,) in rho.weights()]
    (real,) = (c for c in charges if c.imaginary == 0)
    z = rho.algebra.center().rows()[0]
    assert z == [1] and real.real**3 == 2
    for c in charges:
        re, im = float(c.real), float(c.imaginary)
        assert complex(re, im) ** 3 == pytest.approx(2)


def test_charges_are_printed_as_complex_numbers() -> None:
    half = QQ.convert("1/2")
    shown = [lh.representations.Charge(a, b) for a in (QQ.zero, half) for b in (QQ.zero, QQ.one, -QQ.one, -half)]
    assert str(shown) == "[0, i, -i, -(1/2)*i, 1/2, 1/2 + i, 1/2 - i, 1/2 - (1/2)*i]"


@pytest.mark.parametrize(("real", "imaginary", "shown"), [
    ("0", "0", "0"), ("-1/2", "0", "-1/2"), ("0", "1", "i"), ("0", "-1", "-i"), ("0", "1/2", "(1/2)*i"),
    ("0", "-1/2", "-(1/2)*i"), ("0", "2", "2*i"), ("3", "2", "3 + 2*i"), ("3", "-1", "3 - i"),
    ("1/2", "-1/3", "1/2 - (1/3)*i"),
])  # fmt: skip
def test_charges_as_text(real: str, imaginary: str, shown: str) -> None:
    assert repr(Charge(QQ.convert(real), QQ.convert(imaginary))) == shown
