"""Every refusal of the checkers has a forgery that only it refuses: without this refusal the forgery is accepted.

The refusals are read from the syntax trees of the checkers: `raise` and the calls of `_require` and `_agree`. A few
cannot be the only one, since later lines need what they ensure: without them another error is raised.
"""

import ast
import traceback
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from types import FunctionType
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError, InputError, InternalError, LiehomError
from liehom.exact.fullness import verify_classification
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker import verify, verify_modular, verify_pair
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.fullness.classification_rows import Key
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import Subspace
from tests.exact.fullness.checker.test_verify import (
    BOREL,
    CIRCLE,
    HYPERBOLA,
    HYPERBOLA_NOT,
    MINUS_ROOT2,
    ROOT2,
    SO3,
    SPHERE,
    SPHERE_FULL,
    SPLIT,
    SPLIT_CUT,
    Algebra,
    Pair,
    Subalgebra,
    affine,
    changed,
    make,
    unit,
)
from tests.exact.fullness.support import affine as affine_pair
from tests.mutation.mutants import exchange, live_functions, mutants
from tests.record import ROOT

FOLDER = "liehom/exact/fullness"
MODULES = [f"{FOLDER}/verify_classification.py", *(f"{FOLDER}/checker/{name}.py" for name in (
    "verify", "verify_modular", "verify_pair", "verify_roots"))]  # fmt: skip
Patch = pytest.MonkeyPatch
Site = tuple[str, int]
"""A module and the first line of a statement that refuses."""
TRIVIAL = Certificate("trivial", {})


def refuses(node: ast.AST) -> bool:
    if isinstance(node, ast.Raise):
        return True
    call = node.value if isinstance(node, ast.Expr) else None
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in ("_require", "_agree")


@cache
def sites() -> dict[Site, int]:
    """The last line of every statement that refuses, without those inside `_require` and `_agree` themselves."""
    found = {}
    for module in MODULES:
        tree = ast.parse((ROOT / module).read_text(encoding="utf-8"))
        helpers = [f for f in ast.walk(tree) if isinstance(f, ast.FunctionDef) and f.name in ("_require", "_agree")]
        inside = {id(node) for helper in helpers for node in ast.walk(helper)}
        for node in ast.walk(tree):
            if refuses(node) and id(node) not in inside:
                found[module, node.lineno] = node.end_lineno or node.lineno
    return found


@cache
def without() -> dict[Site, Any]:
    """The code of each module with one refusal left out."""
    return {
        (m.module, m.line): m
        for module in MODULES
        for m in mutants(module)
        if m.change.partition(" -> ")[2].startswith("`pass`")
    }


@cache
def functions() -> list[FunctionType]:
    return live_functions(MODULES)


def site_of(error: BaseException) -> Site:
    """The innermost statement that refuses on the way of an error."""
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        module = frame.f_code.co_filename.removeprefix(f"{ROOT}/")
        for (other, first), last in sites().items():
            if other == module and first <= line <= last:
                return other, first
    raise AssertionError(f"refused elsewhere: {error!r}")


# -- certificates ------------------------------------------------------------------------------------------
def offered(pair: Any, kind: str, **fields: Any) -> Callable[[Patch], Any]:
    return lambda _: verify_certificate(pair, Certificate(kind, fields))


def unchecked_field(minpoly: list[int], interval: tuple[int, int]) -> NumberField:
    """A field whose constructor did not see these numbers."""
    field = NumberField("a", [-2, 0, 1], (1, 2))
    other = NumberField.__new__(NumberField)
    for cls in type(field).__mro__:
        for name in getattr(cls, "__slots__", ()):
            if hasattr(field, name):
                object.__setattr__(other, name, getattr(field, name))
    for name, value in (getattr(field, "__dict__", {})).items():
        other.__dict__[name] = value
    object.__setattr__(other, "minpoly", tuple(QQ.convert(c) for c in minpoly))
    object.__setattr__(other, "interval", tuple(QQ.convert(c) for c in interval))
    return other


def of_another_kind(_: Patch) -> Any:
    certificate = Certificate("trivial", {})
    object.__setattr__(certificate, "kind", "oracle")
    return verify._verify(verify_pair.check_pair(SPHERE), certificate)


def with_inverse(patch: Patch) -> Any:
    """The inverse of the identity is said to be twice the identity."""
    kind = type(QQ.identity(2))
    patch.setattr(kind, "inverse", lambda self: self.scale(2))
    fields = {"complement": [unit(3, 0), unit(3, 1)], "matrix": [["1", "0"], ["0", "2"]], "cut": "5/4"}
    return verify_certificate(make(3, {}, [[0, 0, 1]]), Certificate("commutant", fields))


def with_image(*rows: list[int]) -> Callable[[Patch], Any]:
    """The basis of rho(h), one line of matrices, is said to be these rows."""

    def offer(patch: Patch) -> Any:
        kind = type(QQ.identity(1))
        echelon, basis = kind.echelon, QQ.matrix([[*row, *[0] * (9 - len(row))] for row in rows])
        said = basis, list(range(len(rows)))
        patch.setattr(kind, "echelon", lambda m: said if m.shape == (1, 9) else echelon(m))
        return verify_certificate(WEIGHTS, Certificate("dominance", {"element": unit(4, 0), "cut": "0", "eps": "1/4"}))

    return offer


def with_open_image(_: Patch) -> Any:
    """rho(h) spanned by two maps whose bracket it does not contain; no pair that is checked has such an isotropy."""
    spanned = QQ.matrix([[0, 1, 0, 0], [0, 0, 1, 0]])
    checked = replace(verify_pair.check_pair(BOREL), isotropy=spanned)
    return verify._adjoint_on_image(checked, QQ.matrix([[0, 1], [0, 0]]))


def with_wrong_quotient(patch: Patch) -> Any:
    """The echelon form of h is said to have another entry off its pivot."""
    kind = type(QQ.identity(1))
    echelon = kind.echelon
    wrong = lambda m: (QQ.matrix([[1, 5, 0]]), [0]) if m.shape == (1, 3) else echelon(m)  # noqa: E731
    patch.setattr(kind, "echelon", wrong)
    fields = {"minpoly": ["0", "1"], "interval": ["0", "0"], "eta": unit(3, 1), "phi": ["0", "0", "1"]}
    return verify_certificate(make(3, {}, [[1, 0, 0]]), Certificate("witness", fields))


def with_hidden_dependence(patch: Patch) -> Any:
    """Two equal lines are said to have an echelon form with two pivots."""
    kind = type(QQ.identity(1))
    patch.setattr(kind, "echelon", lambda m: (QQ.matrix([[0, 1, 0], [0, 0, 1]]), [1, 2]))
    return verify_certificate(make(3, {}, [[0, 0, 1], [0, 0, 2]]), TRIVIAL)


def with_few_primes(patch: Patch) -> Any:
    patch.setattr(verify_modular, "_primes", lambda *_: iter(()))
    return verify_certificate(SPHERE, SPHERE_FULL)


def modular(dense: bool, pair: Any, certificate: Certificate) -> Callable[[Patch], Any]:
    def offer(patch: Patch) -> Any:
        patch.setattr(verify_modular, "_is_dense", lambda n, number: dense)
        return verify_certificate(pair, certificate)

    return offer


def with_an_unchecked_interval(minpoly: list[int], interval: tuple[int, int]) -> Callable[[Patch], Any]:
    """A field with an interval that the constructor does not see."""

    def offer(patch: Patch) -> Any:
        field = unchecked_field(minpoly, interval)
        patch.setattr(verify_pair.NumberField, "__init__", lambda self, *_: None)
        return verify_pair.check_pair(make(1, {}, [], field))

    return offer


ROTATIONS = make(
    5, {(0, 3, 4): 1, (0, 4, 3): -1, (1, 4, 2): 1, (1, 2, 4): -1}, [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0]]
)  # two rotations of R^3 that are declared to commute
ROTATIONS_FULL = Certificate(
    "full", {"form": [[i, i, "1"] for i in (2, 3, 4)], "elements": [unit(5, 0), unit(5, 1)], "eta": unit(5, 4)}
)
OPEN = make(3, SO3, [[1, 0, 0], [0, 1, 0]])  # [e0, e1] = e2
LINE = make(2, {}, [[1, 0]])
FLAT = make(2, {}, [])
BOOST = affine([[[0, 1], [1, 0]]])
SHEAR = affine([[[1, 0], ["1/2", "1/2"]]])  # on coordinate rows: K = ((1, 1/2), (0, 1/2))
LINEAR = affine([[[1, 0], [0, 0]], [[0, 1], [0, 0]], [[0, 0], [1, 0]], [[0, 0], [0, 1]]])
WEIGHTS = affine([[[1, 0, 0], [0, -1, 0], [0, 0, -1]]])
POINT = make(1, {}, [[1]])
AT_ZERO = {"minpoly": ["0", "1"], "interval": ["0", "0"]}
ONE = ["1", "0", "0"]

CERTIFICATES: dict[str, Callable[[Patch], Any]] = {
    "kind: not one of the five": of_another_kind,
    "trivial: a sphere": offered(SPHERE, "trivial"),
    "full: dimension one": offered(make(1, {}, []), "full", form=[["1"]], elements=[], eta=["1"]),
    # K F is skew, so F is preserved as if it were symmetric; K has two real eigenvectors
    "full: a form that is not symmetric": offered(
        SHEAR, "full", form=[[1, 1, "1"], [1, 2, "1"], [2, 1, "-2"]], elements=[ONE], eta=["0", "1", "0"]
    ),
    "full: a form that does not vanish on h": lambda _: verify_certificate(
        SPHERE, changed(SPHERE_FULL, form=[[0, 0, "1"], [1, 1, "1"], [2, 2, "1"]])
    ),
    "full: an indefinite form": offered(
        BOOST, "full", form=[[1, 1, "1"], [2, 2, "-1"]], elements=[ONE], eta=["0", "1", "0"]
    ),
    "full: an element outside h": lambda _: verify_certificate(
        SPHERE, changed(SPHERE_FULL, elements=[["0", "1", "1"]])
    ),
    "full: a form that is not preserved": offered(
        BOOST, "full", form=[[1, 1, "1"], [2, 2, "1"]], elements=[ONE], eta=["0", "1", "0"]
    ),
    "full: no rotations": offered(FLAT, "full", form=[["1", "0"], ["0", "1"]], elements=[], eta=["1", "0"]),
    "witness: phi = 0": offered(SPHERE, "witness", **AT_ZERO, eta=unit(3, 0), phi=["0", "0", "0"]),
    "witness: eta in h": offered(SPHERE, "witness", **AT_ZERO, eta=unit(3, 2), phi=unit(3, 0)),
    "witness: phi on h": offered(SPHERE, "witness", **AT_ZERO, eta=unit(3, 0), phi=unit(3, 2)),
    "witness: phi(eta) != 0": offered(SPHERE, "witness", **AT_ZERO, eta=unit(3, 0), phi=unit(3, 0)),
    "witness: phi([h, eta]) != 0": offered(SPHERE, "witness", **AT_ZERO, eta=unit(3, 0), phi=unit(3, 1)),
    "witness: a triple root": lambda _: verify_certificate(
        HYPERBOLA, changed(HYPERBOLA_NOT, minpoly=["0", "0", "0", "1"])
    ),
    "witness: no real root": offered(
        CIRCLE, "witness", minpoly=["1", "0", "1"], interval=["-1", "1"], eta=["0", ["0", "1"], "1"],
        phi=["0", "1", ["0", "-1"]],
    ),
    "commutant: rows that are no complement": offered(
        SPLIT, "commutant", **SPLIT_CUT.to_fields() | {"complement": [[0, 1, "1"], [1, 1, "1"]]}
    ),
    "commutant: a point": offered(POINT, "commutant", complement=[], matrix=[], cut="0"),
    "commutant: a wrong inverse": with_inverse,
    "commutant: a matrix that does not commute": offered(
        SPHERE, "commutant", complement=[unit(3, 0), unit(3, 1)], matrix=[["1", "0"], ["0", "2"]], cut="5/4"
    ),
    "commutant: all eigenvalues on one side": offered(
        SPHERE, "commutant", complement=[unit(3, 0), unit(3, 1)], matrix=[["1", "0"], ["0", "1"]], cut="0"
    ),
    "dominance: eps < 0": offered(WEIGHTS, "dominance", element=unit(4, 0), cut="0", eps="-1/4"),
    "dominance: an element outside h": offered(
        BOREL, "dominance", element=["1", "5", "1", "0"], cut="1/2", eps="1/4"
    ),
    "dominance: a point": offered(POINT, "dominance", element=["1"], cut="0", eps="1"),
    "dominance: no eigenvalue above the cut": offered(SPHERE, "dominance", element=["0"] * 3, cut="5", eps="1"),
    "dominance: an eigenvalue in the gap": offered(LINEAR, "dominance", element=unit(6, 0), cut="1/4", eps="2"),
    "dominance: W = V": offered(SPHERE, "dominance", element=["0"] * 3, cut="-1", eps="1/2"),
    "dominance: a wrong basis of rho(h)": with_image([1]),
    "dominance: a basis of rho(h) with a row more": with_image([1, 0, 0, 0, -1, 0, 0, 0, -1], [0]),
    "dominance: rho(h) is not closed": with_open_image,
    "dominance: eigenvalues on the line": offered(FLAT, "dominance", element=["0", "0"], cut="0", eps="1"),
    "pair: over floats": lambda _: verify_certificate(make(3, {}, [[0, 0, 1]], RR), TRIVIAL),
    "pair: a basis of another length": lambda _: verify_certificate(
        Pair(LINE.algebra, Subalgebra(QQ.matrix([[1]]))), TRIVIAL
    ),
    "pair: a constant twice": lambda _: verify_certificate(
        Pair(Algebra(QQ, 3, ((0, 2, 1, QQ.one), (0, 2, 1, QQ.one))), Subalgebra(QQ.identity(3).select(rows=[0, 1]))),
        TRIVIAL,
    ),
    "pair: dependent rows": with_hidden_dependence,
    "pair: a wrong quotient": with_wrong_quotient,
    "pair: too large for the primes": with_few_primes,
    "pair: not closed": modular(True, OPEN, TRIVIAL),
    "pair: not closed, sparse": modular(False, OPEN, TRIVIAL),
    "pair: not a representation": modular(True, ROTATIONS, ROTATIONS_FULL),
    "pair: not a representation, sparse": modular(False, ROTATIONS, ROTATIONS_FULL),
    "field: QQ and a number field": lambda _: verify_certificate(make(1, {}, []), Certificate("trivial", {}, ROOT2)),
    "field: another embedding": lambda _: verify_certificate(
        make(1, {}, [], ROOT2), Certificate("trivial", {}, MINUS_ROOT2)
    ),
    "field: a reducible polynomial": lambda _: verify_pair._check_field(unchecked_field([-1, 0, 1], (0, 2))),
    "field: an interval with two roots": with_an_unchecked_interval([-2, 0, 1], (-2, 2)),
    "field: a root at the lower end": with_an_unchecked_interval([0, -1, 1], (0, 2)),
}  # fmt: skip


# -- keys --------------------------------------------------------------------------------------------------
def claimed(name: str, **parts: Any) -> Callable[[Patch], Any]:
    """The key of a pair with other parts."""

    def offer(_: Patch) -> Any:
        pair = lh.pair(name)
        result = lh.classify(pair)
        return replace(result, key=result.key._replace(**parts)).verify(pair)

    return offer


def with_key(pair: lh.Pair, key: Key, ideal: Any = None) -> Any:
    n = pair.algebra.dimension
    ideal = pair.field.zeros(0, n) if ideal is None else pair.field.matrix(ideal)
    return verify_classification.verify_key(pair, key, Subspace(pair.field, ideal, n))


def with_the_other_ideal(_: Patch) -> Any:
    """so(4) = so(3) + so(3) has two ideals, and u(2) contains one of them."""
    pair = lh.pair("so(4)/u(2)")
    result = lh.classify(pair)
    other = next(i for i in pair.algebra.simple_ideals() if i.subspace != result.ideal)
    return replace(result, ideal=other.subspace).verify(pair)


def with_no_ideal(_: Patch) -> Any:
    """h = R + so(2), with R central, is said to be spanned by z + j modulo an ideal, where [j, V] = V."""
    central = lh.semidirect_sum(lh.abelian(2), [QQ.zeros(2, 2), QQ.matrix([[0, -1], [1, 0]])], size=2)
    pair = lh.Pair(central, [[1, 0, 0, 0], [0, 1, 0, 0]])
    return with_key(pair, Key("A", 2, 0, 4, "J", None), [[1, 1, 0, 0]])


def with_a_smaller_ideal(_: Patch) -> Any:
    central = lh.semidirect_sum(lh.abelian(2), [QQ.zeros(2, 2), QQ.matrix([[0, -1], [1, 0]])], size=2)
    return with_key(lh.Pair(central, [[1, 0, 0, 0], [0, 1, 0, 0]]), Key("A", 2, 0, 4, "J", None))


def over_another_field(_: Patch) -> Any:
    pair = lh.pair("so(4)/so(3)")
    ideal = Subspace(ROOT2, ROOT2.zeros(0, 6), 6)
    return verify_classification.verify_key(pair, lh.classify(pair).key, ideal)


def with_few_directions(_: Patch) -> Any:
    """so(3) on R^3 + R moves each point in at most two directions, sp(1) moves a quaternion in three."""
    turns = [[[0, -1, 0, 0], [1, 0, 0, 0]], [[0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]]]
    padded = [QQ.matrix([*rows, *[[0] * 4] * (4 - len(rows))]) for rows in turns]
    return with_key(affine_pair(padded), Key("A", 4, 3, 4, "", None))


def with_cubics(_: Patch) -> Any:
    """sl(2) on cubic forms moves a generic one in three directions, as sp(1) moves a quaternion; x^3 it does not."""
    raising = [[0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 3], [0, 0, 0, 0]]
    lowering = [[0, 0, 0, 0], [3, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]]
    return with_key(affine_pair([QQ.matrix(raising), QQ.matrix(lowering)]), Key("A", 4, 3, 4, "", None))


def with_one_choice(patch: Patch) -> Any:
    """If all random elements of sp(1) are equal, those that commute with them seem to be its centre."""
    row = verify_classification._random_row
    chosen = lambda field, n, rng: field.unit(n, 0) if n == 3 else row(field, n, rng)  # noqa: E731
    patch.setattr(verify_classification, "_random_row", chosen)
    return with_key(lh.pair("affine(sp(1))"), Key("A", 4, 3, 4, "J", None))


def with_another_killing_form(patch: Patch) -> Any:
    form = lh.LieAlgebra.killing_form
    patch.setattr(lh.LieAlgebra, "killing_form", lambda g: -form(g))
    return with_key(lh.pair("so(4)/so(3)"), Key("C", 3, 3, 1, "", -1))


KEYS: dict[str, Callable[[Patch], Any]] = {
    "key: of a pair over floats": lambda _: verify_classification.verify_key(
        lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]), Key("C", 2, 0, 4, "J", 1), Subspace(RR, [], 3)
    ),
    "key: an ideal over another field": over_another_field,
    "key: in no row": lambda _: with_key(
        affine_pair([QQ.matrix([[1, 0, 0], [0, 1, 0], [0, 0, -2]])]), Key("A", 3, 0, 9, "J", None)
    ),
    "key: another d": claimed("affine(so(3))", d=2),
    "key: another s": claimed("affine(so(3))", s=8),
    "key: another e": claimed("affine(so(4))", e=2),
    "key: another centre": claimed("R/0", centre="R"),
    "key: another letter": claimed("aff(1)/R", letter="B"),
    "key: another sign": claimed("so(3)/so(2)", parameter=-1),
    "key: an ideal outside h": with_the_other_ideal,
    "key: a subspace that is not an ideal": with_no_ideal,
    "key: a smaller ideal": with_a_smaller_ideal,
    "key: S moves points in few directions": with_few_directions,
    "key: S commutes with few maps": with_cubics,
    "key: elements that only seem central": with_one_choice,
    "key: another Killing form": with_another_killing_form,
}


# -- the range condition at generic eta --------------------------------------------------------------------
def about_range(pair: Any, kind: str, **fields: Any) -> Callable[[Patch], Any]:
    return lambda _: verify.verify_range(pair, Certificate(kind, fields))


def about_range_of_another_kind(_: Patch) -> Any:
    certificate = Certificate("lattice", {"point": ["1", "0"], "directions": [["0", "1"]]})
    object.__setattr__(certificate, "kind", "oracle")
    return verify._verify_range(verify_pair.check_pair(FLAT), certificate)


def with_a_small_limit(patch: Patch) -> Any:
    patch.setattr(verify, "MAX_LATTICE", 2)
    return about_range(FLAT, "lattice", point=["1", "0"], directions=[["0", "1"]])(patch)


TURN = affine([[[0, 1], [-1, 0]]])
PLANE = {"point": ["0"] * 3, "directions": [unit(3, 1), unit(3, 2)]}
MATRICES = {"point": ["0"] * 6, "directions": [unit(6, 4), unit(6, 5)]}
RANGE: dict[str, Callable[[Patch], Any]] = {
    "range: another kind": about_range_of_another_kind,
    "generic: a point of lower rank": about_range(FLAT, "generic", eta=["1", "0"]),
    "slice: directions that do not span": about_range(
        LINEAR, "slice", point=["0"] * 6, directions=[], stabilizer=[unit(7, i) for i in range(4)]
    ),
    "slice: a stabilizer that is too small": about_range(LINEAR, "slice", **MATRICES, stabilizer=[]),
    "slice: elements that are dependent": about_range(LINEAR, "slice", **MATRICES, stabilizer=[["0"] * 7] * 4),
    "slice: an element outside h": about_range(TURN, "slice", **PLANE, stabilizer=[unit(4, 1)]),
    "slice: an element that moves": about_range(TURN, "slice", **PLANE, stabilizer=[unit(4, 0)]),
    "lattice: no directions": about_range(TURN, "lattice", point=unit(3, 1), directions=[]),
    "lattice: too many points": with_a_small_limit,
    "lattice: a higher rank": about_range(TURN, "lattice", point=unit(3, 1), directions=[unit(3, 2)]),
}
FORGERIES = CERTIFICATES | KEYS | RANGE
NEEDED = {
    "dominance: a basis of rho(h) with a row more",
    "commutant: rows that are no complement", "commutant: a point", "dominance: a point",
    "dominance: eigenvalues on the line", "pair: over floats",
    "key: of a pair over floats", "key: an ideal over another field", "key: S moves points in few directions",
}  # fmt: skip
"""Forgeries whose refusal the later lines need: without it there is another error."""


def refusal(name: str) -> LiehomError:
    with pytest.MonkeyPatch.context() as patch, pytest.raises(LiehomError) as caught:
        FORGERIES[name](patch)
    assert type(caught.value) in (lh.CertificateError, InputError, InternalError)
    return caught.value


@pytest.mark.parametrize("name", FORGERIES)
def test_only_one_refusal_stands_between_a_forgery_and_its_verdict(name: str) -> None:
    module, line = site_of(refusal(name))
    before = [(f, f.__code__) for f in functions()]
    exchange(functions(), module, without()[module, line].codes)
    try:
        with pytest.MonkeyPatch.context() as patch:
            if name not in NEEDED:
                FORGERIES[name](patch)
            else:
                with pytest.raises((LiehomError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)):
                    FORGERIES[name](patch)
    finally:
        for function, code in before:
            function.__code__ = code


def test_every_refusal_has_a_forgery() -> None:
    reached = {site_of(refusal(name)) for name in FORGERIES}
    assert reached == set(sites()), sorted(set(sites()) - reached)


@pytest.mark.parametrize("offer", [
    with_an_unchecked_interval([-2, 1], (1, 2)),  # a root at the upper end
    lambda _: verify_certificate(
        make(1, {}, [], ROOT2), Certificate("trivial", {}, unchecked_field([-2, 0, 1], (-2, 2)))
    ),
], ids=["pair", "certificate"])  # fmt: skip
def test_fields_of_both_sides_are_checked(offer: Callable[[Patch], Any]) -> None:
    with pytest.MonkeyPatch.context() as patch, pytest.raises(lh.CertificateError) as caught:
        offer(patch)
    assert caught.value.check == "field"


def test_a_lattice_is_checked_within_a_limit_of_time(monkeypatch: Patch) -> None:
    asked: list[bool] = []
    monkeypatch.setattr(verify, "in_time", lambda: asked.append(True))
    with pytest.raises(CertificateError, match="rank"):
        RANGE["lattice: a higher rank"](monkeypatch)
    assert asked
