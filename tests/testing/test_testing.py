"""The conformance suite: it passes what is right, and each check catches what it is there for."""

import json
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom import testing
from liehom.base.errors import ConformanceError
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ
from tests.floats import constants_of, pair_of

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

ALGEBRAS: dict[str, Callable[[], lh.LieAlgebra]] = {
    "zero": lambda: lh.LieAlgebra({}, dimension=0),
    "line": lambda: lh.abelian(1),
    "abelian": lambda: lh.abelian(4),
    "heisenberg": lambda: lh.heisenberg(2),
    "so(3,1)": lambda: lh.so(3, 1),
    "sl(3)": lambda: lh.sl(3),
    "so(3) over QQ(sqrt(2))": lambda: lh.so(3).over(lh.number_field("sqrt(2)")),
    "so(3) over float64": lambda: lh.so(3).over(RR),
}


@pytest.mark.parametrize("name", ALGEBRAS)
def test_algebras_conform(name: str) -> None:
    testing.check_lie_algebra(ALGEBRAS[name]())


@pytest.mark.parametrize("name", ["so(4)", "sl(2)"])
def test_representations_conform(name: str) -> None:
    rho = lh.defining(lh.so(4) if name == "so(4)" else lh.sl(2))
    for found in (
        rho,
        rho.dual(),
        rho.symmetric_power(2),
        lh.adjoint(rho.algebra),
        lh.representations.trivial(rho.algebra, 2),
    ):
        testing.check_representation(found)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_floats_conform_or_are_caught_at_every_scale(scale: float) -> None:
    for name in ("so(4)/so(3)", "sl(3)/P1"):
        constants, rows = constants_of(lh.pair(name))
        testing.check_pair(pair_of(scale * constants, rows))
    matrices = [scale * a.to_numpy() for a in lh.defining(lh.so(3)).matrices]
    rho = lh.Representation.from_matrices(matrices)
    testing.check_representation(rho)
    wrong = lh.Representation(rho.algebra, [1.001 * a for a in matrices], check=False)
    with pytest.raises(ConformanceError, match="bracket"):
        testing.check_representation(wrong)


@pytest.mark.parametrize("name", sorted(path.stem for path in EXAMPLES.glob("*.json")))
def test_example_files_conform(name: str) -> None:
    pair = lh.load(EXAMPLES / f"{name}.json")
    testing.check_pair(pair)
    if pair.field.exact:
        testing.check_certificate(pair, lh.decide_fullness(pair).certificate, bases=2)


@given(st.integers(0, 7), st.integers(0, 40), st.randoms(use_true_random=False))
def test_random_unimodular_matrices_are_unimodular(n: int, operations: int, rng: random.Random) -> None:
    rows = testing.random_unimodular(n, rng, operations)
    assert abs(QQ.matrix(rows, (n, n)).determinant()) == 1


def broken(entries: list[tuple[int, int, int, int]], n: int) -> lh.LieAlgebra:
    """A table that is taken without proof."""
    table = StructureConstants(QQ, n, [(i, j, k, QQ.convert(v)) for i, j, k, v in entries])
    return lh.LieAlgebra(table, check=False)


def test_a_table_without_the_jacobi_identity_is_caught() -> None:
    with pytest.raises(ConformanceError) as caught:
        testing.check_lie_algebra(broken([(0, 1, 0, 1), (1, 2, 1, 1)], 3))
    assert caught.value.check in ("Jacobi", "killing form")


def test_matrices_that_do_not_respect_the_bracket_are_caught() -> None:
    so3 = lh.so(3)
    rho = lh.Representation(so3, [a.scale(2) for a in lh.defining(so3).matrices], check=False)
    with pytest.raises(ConformanceError, match="bracket"):
        testing.check_representation(rho)


def test_a_span_that_is_not_closed_is_caught() -> None:
    so3 = lh.so(3)
    h = lh.Subalgebra(so3, QQ.matrix([[1, 0, 0], [0, 1, 0]]), check=False)
    with pytest.raises(ConformanceError, match=r"closure|isotropy"):
        testing.check_pair(lh.Pair(so3, h), trials=10)


@pytest.mark.parametrize("other", ["so31_so21", "g2_su3"])
def test_a_certificate_of_another_pair_is_caught(other: str) -> None:
    certificate = lh.decide_fullness(lh.load(EXAMPLES / f"{other}.json")).certificate
    with pytest.raises(ConformanceError, match="verification"):
        testing.check_certificate(lh.load(EXAMPLES / "so4_so3.json"), certificate)


def test_a_certificate_may_be_its_json_object() -> None:
    pair: Any = lh.load(EXAMPLES / "so31_so21.json")
    data = json.loads(json.dumps(lh.decide_fullness(pair).certificate.to_json()))
    testing.check_certificate(pair, data)
    assert isinstance(Certificate.from_json(data), Certificate)


# -- one wrong object for each refusal ---------------------------------------------------------------------------
def dependent(pair: lh.Pair) -> lh.Pair:
    """The pair with the first row of h in place of all."""
    return lh.Pair(pair.algebra, lh.Subalgebra(pair.algebra, QQ.matrix([[1, *[0] * 5]] * 3), check=False))


def one_less(self: Any, make: Any = lh.Pair.isotropy_matrices) -> Any:
    return make(self)[:-1]


def doubled(self: Any, make: Any = lh.Pair.isotropy_matrices) -> Any:
    return [a.scale(2) for a in make(self)]


def onto_more(self: Any, make: Any = lh.Subalgebra.quotient) -> Any:
    data = make(self)
    return replace(data, projection=QQ.matrix([[1] * data.projection.ncols] * data.projection.nrows))


def whole(self: lh.Representation, point: object) -> lh.Subalgebra:
    return lh.Subalgebra(self.algebra, QQ.identity(self.algebra.dimension))


Patches = dict[tuple[Any, str], Any]
PAIR, RHO, TABLE = (lambda: lh.pair("so(4)/so(3)")), (lambda: lh.defining(lh.so(3))), (lambda: lh.sl(2))
OTHER = lambda *_, **__: lh.Pair(lh.abelian(3), [])  # noqa: E731
FORGERIES: list[tuple[str, str, Callable[[Any], None], Callable[[], Any], Patches]] = [
    ("killing form", "not symmetric", testing.check_lie_algebra, TABLE,
     {(lh.LieAlgebra, "killing_form"): lambda _: QQ.matrix([[0, 1, 0], [0, 0, 0], [0, 0, 0]])}),
    ("Jacobi", "is not 0", testing.check_lie_algebra, lambda: broken([(0, 1, 0, 1), (1, 2, 1, 1)], 3), {}),
    ("killing form", "differ", testing.check_lie_algebra, TABLE,
     {(lh.LieAlgebra, "killing_form"): lambda _: QQ.identity(3)}),
    ("change of basis", "another table", testing.check_lie_algebra, TABLE,
     {(lh.LieAlgebra, "change_of_basis"): lambda *_: lh.so(3)}),
    ("file", "another table", testing.check_lie_algebra, TABLE, {(testing, "from_json"): OTHER}),
    ("file", "another table", testing.check_lie_algebra, TABLE, {(testing, "from_json"): lambda _: lh.sl(2)}),
    ("shape", "2 matrices for dimension 3", testing.check_representation, RHO,
     {(lh.Representation, "matrices"): tuple(lh.defining(lh.so(3)).matrices[:2])}),
    ("shape", "not N x N", testing.check_representation, RHO,
     {(lh.Representation, "matrices"): tuple(lh.defining(lh.so(4)).matrices[:3])}),
    ("isotropy", "moves the point", testing.check_representation, RHO, {(lh.Representation, "isotropy"): whole}),
    ("orbit", "is not dim g = 3", testing.check_representation, RHO,
     {(lh.Representation, "orbit_dimension"): lambda *_: 1}),
    ("basis", "dependent", testing.check_pair, lambda: dependent(PAIR()), {}),
    ("quotient", "does not vanish on h", testing.check_pair, PAIR, {(lh.Subalgebra, "quotient"): onto_more}),
    ("isotropy", "2 matrices for dim h = 3", testing.check_pair, PAIR, {(lh.Pair, "isotropy_matrices"): one_less}),
    ("isotropy", "differ on g/h", testing.check_pair, PAIR, {(lh.Pair, "isotropy_matrices"): doubled}),
    ("file", "another pair", testing.check_pair, PAIR,
     {(testing, "from_json"): lambda data, read=testing.from_json: lh.Pair(read(data).algebra, [])}),
]  # fmt: skip


@pytest.mark.parametrize(("check", "words", "run", "make", "patches"), FORGERIES, ids=[
    f"{i}: {row[0]}, {row[1]}" for i, row in enumerate(FORGERIES)
])  # fmt: skip
def test_each_refusal_has_an_object_that_only_it_stops(
    check: str, words: str, run: Any, make: Any, patches: Patches, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = make()
    if not (check == "Jacobi" or words == "dependent"):
        run(wrong)
    for (owner, name), value in patches.items():
        monkeypatch.setattr(owner, name, value)
    with pytest.raises(ConformanceError, match=words) as caught:
        run(wrong)
    assert caught.value.check == check


def test_refusals_of_a_checker_that_accepts_all_and_of_a_search_that_depends_on_the_basis(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pair = lh.load(EXAMPLES / "so4_so3.json")
    certificate, another = (lh.decide_fullness(p).certificate for p in (pair, lh.pair("R^2/0")))
    assert another.full != certificate.full
    testing.check_certificate(pair, certificate)
    for check, words, owner, name, value in (
        ("control", "empty", testing, "verify_certificate", lambda *_: True),
        ("invariance", "basis", testing, "decide_fullness", lambda *_: lh.decide_fullness(lh.pair("R^2/0"))),
        ("file", "another", Certificate, "from_json", lambda *_: another),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, value)
            with pytest.raises(ConformanceError, match=words) as caught:
                testing.check_certificate(pair, certificate)
        assert caught.value.check == check
