"""`classify` on pairs that no constructor of the library made, in bases with large numbers.

Each pair is made by linear algebra, so that its row is known from the construction: stabilizers of lines, null lines
and tensors, brackets scaled by a curvature, contractions, and extensions by ideals inside h, split and not split.
"""

import json
import random
from collections.abc import Callable
from typing import Any

import pytest

import liehom as lh
from liehom.exact.fullness.classification import Classification
from liehom.exact.scalars.rational import QQ
from tests.exact.fullness.classification import constructed as make
from tests.exact.fullness.classification.constructed import Made, key
from tests.exact.fullness.support import random_invertible, scrambled
from tests.exact.fullness.test_number_fields import CUBIC, MINUS_ROOT2, ROOT2, element, scrambled as scrambled_over

Maker = Callable[[random.Random], Made]
FIELDS = {"QQ": QQ, "sqrt(2)": ROOT2, "cube root of 2": CUBIC}
CENTRES = ("", "R", "J", "C", "J+c")


def ugly(pair: lh.Pair, rng: random.Random) -> lh.Pair:
    """The pair in a random basis; in small dimensions with numbers of 12 or 20 digits."""
    n, field = pair.algebra.dimension, pair.field
    if field != QQ:
        pair = scrambled_over(pair, field, rng) if n <= 12 else scrambled(pair, rng)
    elif n <= 8:
        change = random_invertible(QQ, n, lambda: QQ.convert(rng.randint(-(10**12), 10**12)) / rng.randint(1, 99))
        return pair.change_of_basis(change)
    else:
        pair = scrambled(pair, rng)
    if n > (16 if field == QQ else 8):
        return pair
    return pair.change_of_basis(make.diagonal(field, [QQ.convert(rng.randint(1, 10**20)) for _ in range(n)]))


def check(built: Made, rng: random.Random) -> None:
    """The right row, or `NotFullError`; a verified key; JSON and back."""
    pair = ugly(built.pair, rng)
    if built.key is None:
        with pytest.raises(lh.NotFullError):
            lh.classify(pair)
        return
    result = lh.classify(pair)
    assert result.key == built.key
    assert result.ideal.dimension == built.ideal
    assert result.verify(pair)
    assert Classification.from_json(json.loads(json.dumps(result.to_json()))) == result


def params(cases: dict[str, Maker]) -> Any:
    return pytest.mark.parametrize("maker", cases.values(), ids=list(cases))


def sized(field: Any, dimension: int) -> bool:
    """Whether a construction on a space of this dimension is small enough for this field."""
    return field is QQ or dimension <= 6


# -- stabilizers -------------------------------------------------------------------------------------------------
HERMITIAN = {
    f"{name}, {what}, K^{n} of dimension {k * n}": lambda rng, a=(f, k, n), w=what: make.hermitian_pair(*a, rng, w)
    for name, f in FIELDS.items()
    for k, n in ((1, 3), (1, 4), (1, 6), (2, 2), (2, 3), (2, 4), (4, 2), (4, 3))
    for what in ("compact", "hyperbolic", "other")
    if sized(f, k * n) and (what != "other" or n > 2)
}
PROJECTIVE = {
    f"{name}, K^{n} of dimension {k * n}, {'definite' if real else 'split'}": lambda rng, a=(f, k, n), r=real: (
        make.projective_pair(*a, rng, definite=r)
    )
    for name, f in FIELDS.items()
    for k, n in ((1, 3), (1, 4), (2, 2), (2, 3), (4, 2), (4, 3))
    for real in (True, False)
    if sized(f, k * n)
}
NULL = {
    f"{name}, null line in K^{n} of dimension {k * n}": lambda rng, a=(f, k, n): make.null_line_pair(*a, rng)
    for name, f in FIELDS.items()
    for k, n in ((1, 4), (1, 6), (2, 3), (4, 3))
    if sized(f, k * n)
}
TENSORS: dict[str, Maker] = {
    f"g2 {base} {'compact' if compact else 'split'}": lambda rng, b=base, c=compact: make.g2_pair(rng, b, compact=c)
    for base in ("affine", "so(7)", "vector")
    for compact in (True, False)
}
TENSORS |= {f"spin(7) {base}": lambda rng, b=base: make.cayley_pair(rng, b) for base in ("affine", "so(8)", "vector")}
AFFINE = {
    f"{name}, {kind} on K^{m} of dimension {k * m}, centre {centre!r}": lambda rng, a=(f, k, m, centre), c=kind: (
        make.with_centre(*a, rng, c)
    )
    for name, f in FIELDS.items()
    for k, m, kind in ((2, 3, "compact"), (2, 2, "sl"), (4, 1, "compact"), (4, 2, "compact"), (4, 2, "sl"))
    for centre in CENTRES
    if sized(f, k * m)
}


@params(HERMITIAN | PROJECTIVE | NULL | TENSORS | AFFINE)
def test_stabilizers_are_found_in_their_row(maker: Maker) -> None:
    rng = random.Random(2)
    check(maker(rng), rng)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("field", FIELDS.values(), ids=list(FIELDS))
def test_a_random_operator_with_complex_eigenvalues_is_a_spiral(field: Any, seed: int) -> None:
    rng = random.Random(seed)
    built = make.plane_spiral(field, rng)
    check(built, rng)
    name = lh.classify(built.pair).name
    if name is not None:
        assert lh.classify(lh.pair(name)).key == built.key


# -- deformations ------------------------------------------------------------------------------------------------
SYMMETRIC = {
    (1, 4): ("so(4)/so(3)", "so(3,1)/so(3)", "affine(so(3))"),
    (2, 3): ("su(3)/u(2)", "su(2,1)/u(2)", "affine(sp(1)+u(1))"),
    (2, 4): ("su(4)/u(3)", "su(3,1)/u(3)", "affine(su(3)+u(1))"),
    (4, 3): ("sp(3)/sp(2)+sp(1)", "sp(2,1)/sp(2)+sp(1)", "affine(sp(2)+sp(1))"),
    (1, 7): ("so(7)/so(6)", "so(6,1)/so(6)", "affine(so(6))"),
}
CURVATURES = ((QQ, "22/7"), (QQ, "-12345678901234567890/11"), (QQ, "0"), (ROOT2, "1 - a"), (MINUS_ROOT2, "1 - a"))


@pytest.mark.parametrize(("field", "curvature"), CURVATURES, ids=[f"{c} over {f.name}" for f, c in CURVATURES])
@pytest.mark.parametrize(("size", "names"), SYMMETRIC.items(), ids=[names[0] for names in SYMMETRIC.values()])
def test_the_sign_of_the_curvature_decides(size: tuple[int, int], names: Any, field: Any, curvature: str) -> None:
    rng, value = random.Random(curvature), field.convert(curvature)
    pair = make.hermitian_pair(QQ, *size, rng, "compact").pair
    name = names[2] if value == 0 else names[0 if field.sign(value) > 0 else 1]
    check(Made(make.deformed(pair, 0, value, field), key(pair.dimension, name)), rng)
    if value == 0:
        check(Made(make.contraction(pair), key(pair.dimension, name)), rng)


@pytest.mark.parametrize(("field", "torsion"), [(QQ, "-5/3"), (QQ, "0"), (ROOT2, "1 - a")])
@pytest.mark.parametrize(
    ("base", "name", "flat"), [("vector", "g2/su(3)", "affine(su(3))"), ("so(7)", "spin(7)/g2", "affine(g2)")]
)
def test_torsion_is_absorbed_unless_it_is_zero(base: str, name: str, flat: str, field: Any, torsion: str) -> None:
    rng, t = random.Random(torsion), field.convert(torsion)
    pair = make.g2_pair(rng, base).pair
    check(Made(make.deformed(pair, t, t * t, field), key(pair.dimension, name if t != 0 else flat)), rng)


CONTRACTED: dict[str, Maker] = {
    "affine(sl(3)+R)": lambda rng: make.projective_pair(QQ, 1, 4, rng),
    "affine(sl(2,C)+u(1)+R)": lambda rng: make.projective_pair(QQ, 2, 3, rng),
    "affine(sl(2,H)+sp(1)+R)": lambda rng: make.projective_pair(QQ, 4, 3, rng),
    "affine(so(4)+R)": lambda rng: make.null_line_pair(QQ, 1, 6, rng),
    "affine(gl(1,C))": lambda rng: make.projective_pair(QQ, 2, 2, rng),
}


@pytest.mark.parametrize(("name", "maker"), CONTRACTED.items(), ids=list(CONTRACTED))
def test_the_contraction_of_a_graded_algebra_is_affine_with_an_ideal(name: str, maker: Maker) -> None:
    rng = random.Random(name)
    pair = maker(rng).pair
    check(Made(make.contraction(pair), key(pair.dimension, name), pair.dimension), rng)


# -- ideals inside h ---------------------------------------------------------------------------------------------
SMALL_AFFINE = [
    (f, k, m, centre, kind)
    for f in (QQ, ROOT2)
    for k, m, kind in ((2, 3, "compact"), (2, 2, "sl"), (4, 1, "compact"))
    for centre in CENTRES
]


@pytest.mark.parametrize("case", SMALL_AFFINE, ids=lambda case: f"{case[0].name} {case[1:]}")
def test_a_square_of_v_inside_h_does_not_split_and_leaves_the_key(case: tuple[Any, ...]) -> None:
    *arguments, kind = case
    rng = random.Random(str(arguments[1:]))
    built = make.with_centre(*arguments, rng, kind)
    d = built.pair.dimension
    check(Made(make.extension_by_products(built.pair), built.key, d * (d - 1) // 2), rng)
    forms = make.invariant_two_forms(built.pair)
    assert len(forms) == {2: {"": 1, "J": 1}, 4: {"": 3, "J": 1}}[built.key.e].get(built.key.centre, 0) or kind == "sl"  # type: ignore[union-attr]
    if forms:
        check(Made(make.central_extension(built.pair, forms), built.key, len(forms)), rng)


def test_a_spiral_with_a_square_of_v_inside_h() -> None:
    rng = random.Random(5)
    for field in FIELDS.values():
        built = make.plane_spiral(field, rng)
        check(Made(make.extension_by_products(built.pair), built.key, 1), rng)


EXTENDED: dict[str, Maker] = {
    "S^3": lambda rng: make.hermitian_pair(QQ, 1, 4, rng, "compact"),
    "CH^2": lambda rng: make.hermitian_pair(QQ, 2, 3, rng, "hyperbolic"),
    "RP^2": lambda rng: make.projective_pair(QQ, 1, 3, rng),
    "S^3 under conformal maps": lambda rng: make.null_line_pair(QQ, 1, 5, rng),
    "H under a spiral": lambda rng: make.with_centre(QQ, 4, 1, "J+c", rng, "compact"),
    "not full": lambda rng: make.null_line_pair(QQ, 2, 3, rng),
}


@pytest.mark.parametrize("degree", [2, 3])
@params(EXTENDED)
def test_polynomials_with_constant_term_in_h(maker: Maker, degree: int) -> None:
    rng = random.Random(degree)
    built = maker(rng)
    n = built.pair.algebra.dimension
    pair = make.truncated_polynomials(built.pair, degree)
    check(Made(pair, built.key, (degree - 1) * n), rng)
    generators = pair.field.identity(degree * n).select(rows=range((degree - 1) * n, degree * n))
    check(Made(make.quotient(pair, generators), built.key, (degree - 2) * n), rng)


@params(EXTENDED)
def test_a_trivial_ideal_of_dimension_30(maker: Maker) -> None:
    rng = random.Random(30)
    built = maker(rng)
    check(Made(make.trivial_ideal(built.pair, 30), built.key, 30), rng)


# -- dimensions 0 and 1 --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("name", ["R/0", "aff(1)/R", "sl(2)/P1"])
def test_subalgebras_of_codimension_one(name: str, n: int) -> None:
    rng = random.Random(n)
    check(make.line_pair(n, rng, name), rng)


@pytest.mark.parametrize("algebra", [lh.abelian(0), lh.so(4), lh.heisenberg(2), lh.gl(3)], ids=lambda g: g.name)
def test_h_equal_to_g_is_a_point(algebra: lh.LieAlgebra) -> None:
    pair = lh.Pair(algebra, QQ.identity(algebra.dimension))
    check(Made(pair, key(0, "0/0"), algebra.dimension), random.Random(1))


@pytest.mark.parametrize("seed", range(3))
def test_a_rational_spiral_in_an_irrational_basis_has_a_rational_parameter(seed: int) -> None:
    rng = random.Random(seed)
    built = make.plane_spiral(QQ, rng)
    moved = scrambled_over(built.pair, CUBIC, rng)
    factor = element(CUBIC, rng, 9)
    assert built.key is not None
    if factor == 0:
        return
    moved = moved.change_of_basis(make.diagonal(CUBIC, [factor] * 3))
    result = lh.classify(moved)
    assert result.key == built.key._replace(parameter=CUBIC.convert(built.key.parameter))
    assert result.name == lh.classify(built.pair).name
    assert result.verify(moved)
