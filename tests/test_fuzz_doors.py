"""Fuzz of every door: files, certificates, values. Only documented errors come out, and nothing is executed."""

import copy
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings, strategies as st
from typer.testing import CliRunner

import liehom as lh
from liehom import io
from liehom.base import errors
from liehom.cli.app import app
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.scalars import grammar
from liehom.exact.scalars.number_fields import common_field, number_field
from liehom.exact.scalars.rational import QQ
from tests.campaigns.door_inputs import ATTACKS, MONSTERS, SENTINEL, places
from tests.sampling import examples

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
FILES = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(EXAMPLES.glob("*.json"))}
SMALL = {name: data for name, data in FILES.items() if name not in ("g2_su3", "so5_so4_scrambled")}
CERTIFICATES = {
    name: verdict.certificate.to_json()
    for name, verdict in ((n, lh.decide_fullness(lh.load(EXAMPLES / f"{n}.json"))) for n in SMALL)
    if verdict.certificate is not None
}

SIZE = 12  # changed matrices often generate gl(N); those are left alone


@contextmanager
def nothing_is_executed(folder: Path) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield
    assert list(folder.rglob(f"*{SENTINEL}*")) == []


def tried(action: Any, *arguments: Any) -> Any:
    """The result, or None after a documented error with a message that says something."""
    try:
        return action(*arguments)
    except errors.InternalError:
        raise
    except errors.LiehomError as error:
        assert str(error)
        return None


# -- values ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("text", [*ATTACKS, *MONSTERS])
def test_values_are_parsed_never_executed(text: str, tmp_path: Path) -> None:
    with nothing_is_executed(tmp_path):
        for convert in (QQ.convert, number_field("sqrt(2)").convert, common_field, lambda x: common_field([x])):
            tried(convert, text)


@pytest.mark.parametrize("text", ATTACKS)
def test_attacks_are_parse_errors_at_every_door(text: str, tmp_path: Path) -> None:
    doors: list[Any] = [
        lambda: QQ.convert(text),
        lambda: number_field(text),
        lambda: io.from_json({**FILES["so4_so3"], "structure_constants": [[0, 1, 2, text]]}),
        lambda: io.from_json({**FILES["so4_so3"], "subalgebra": [[text] * 6]}),
        lambda: io.from_json({**FILES["sym3"], "point": [text] * 6}),
        lambda: io.from_json({**FILES["rigid_body"], "generator": [text] * 3}),
        lambda: io.from_json({**FILES["vector_field"], "vector_field": [text] * 3}),
        lambda: io.from_json({**FILES["rigid_body"], "dt": text}),
        lambda: lh.LieAlgebra({(0, 1): {0: text}}),
        lambda: lh.Representation.from_matrices([[[text]]]),
    ]
    with nothing_is_executed(tmp_path):
        for door in doors:
            with pytest.raises(errors.ParseError):
                door()
        for key in ("eta", "phi"):
            with pytest.raises(errors.CertificateFormatError):
                Certificate.from_json({**CERTIFICATES["so31_so21"], key: [text] * 6})
        with pytest.raises(errors.CatalogError):
            lh.pair(text)
        field = {"name": text, "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]}
        with pytest.raises(errors.FormatError):
            io.from_json({**FILES["so4_so3"], "field": field})


ALPHABET = "0123456789+-*/() sqrtaem._[]'\"\\\0é"


@given(st.text(alphabet=ALPHABET, max_size=30))
def test_texts_like_values(text: str) -> None:
    tried(QQ.convert, text)
    tried(common_field, [text])


EXPRESSION = st.recursive(
    st.integers(0, 40).map(str),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda x: f"({x[0]}{x[1]}{x[2]})"),
        inner.map(lambda x: f"-{x}"),
        inner.map(lambda x: f"({x})**2"),
    ),
    max_leaves=8,
)


@given(EXPRESSION)
def test_rational_values_mean_what_they_mean_in_mathematics(text: str) -> None:
    from fractions import Fraction

    def number(n: Any) -> Fraction:
        return Fraction(int(n))

    try:
        expected = grammar.evaluate(grammar.parse(text), number, {}, {})
    except errors.ParseError:
        with pytest.raises(errors.ParseError):
            QQ.convert(text)
        return
    assert str(QQ.convert(text)) == str(expected)


# -- files: random bytes, random JSON, mutated files -----------------------------------------------------
@given(st.binary(max_size=300))
@example(b"\xef\xbb\xbf{}")
@example(b"\x00" * 100)
@example(b'{"dimension": 1e400, "structure_constants": [], "subalgebra": []}')
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_random_bytes(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "random.json"
    file.write_bytes(data)
    assert tried(io.load, file) is None


JSON = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(-5, 5),
        st.integers(),
        st.floats(),
        st.sampled_from(["1", "0", "-1/2", "sqrt(2)", "liehom-pair", "x", "", "a", *ATTACKS[:2]]),
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=3), inner, max_size=3)),
    max_leaves=12,
)
KEYS = ["format", "version", "dimension", "structure_constants", "subalgebra", "matrices", "point", "field", "basis"]
KEYS += ["arithmetic", "generator", "t_span", "t_eval", "dt", "rtol", "order", "base", "vector_field", "clock"]


@given(st.one_of(JSON, st.dictionaries(st.sampled_from(KEYS), JSON)))
def test_random_json(data: Any) -> None:
    tried(io.from_json, data)
    tried(Certificate.from_json, data)
    tried(io.loads, json.dumps(data))


Path_ = tuple[Any, ...]


def parent(data: Any, path: Path_) -> Any:
    for key in path[:-1]:
        data = data[key]
    return data


@st.composite
def mutated(draw: st.DrawFn, originals: dict[str, Any]) -> tuple[str, Any]:
    """A JSON object with one to three changes: a value replaced, removed, repeated, moved, or a key renamed."""
    name = draw(st.sampled_from(sorted(originals)))
    data = copy.deepcopy(originals[name])
    for _ in range(draw(st.integers(1, 3))):
        paths = list(places(data))
        if not paths:
            break
        path = draw(st.sampled_from(paths))
        around, key = parent(data, path), path[-1]
        kind = draw(st.sampled_from(["replace", "value", "value", "remove", "repeat", "swap", "rename"]))
        if kind == "replace":
            around[key] = draw(JSON)
        elif kind == "value":
            around[key] = draw(
                st.sampled_from(["0", "1", "-1", "2/3", "sqrt(3)", "7", 3, 1, 0, -1, 0.5, "a", "", None])
            )
        elif kind == "remove":
            del around[key]
        elif kind == "repeat" and isinstance(around, list):
            around.append(copy.deepcopy(around[key]))
        elif kind == "swap":
            other = draw(st.sampled_from(list(around) if isinstance(around, dict) else list(range(len(around)))))
            around[key], around[other] = around[other], around[key]
        elif kind == "rename" and isinstance(around, dict):
            around[f"{key}_"] = around.pop(key)
    return name, data


@given(mutated(SMALL))
@settings(max_examples=examples(400))
def test_mutated_files(case: tuple[str, Any]) -> None:
    found = tried(io.from_json, case[1])
    if isinstance(found, lh.Pair) and found.algebra.dimension <= SIZE:
        assert io.from_json(io.to_json(found)) == found


@given(mutated(SMALL))
@settings(max_examples=examples(200))
def test_mutated_files_that_are_read_are_decided(case: tuple[str, Any]) -> None:
    found = tried(io.from_json, case[1])
    if isinstance(found, lh.Pair) and found.field.exact and found.algebra.dimension <= SIZE:
        assert lh.decide_fullness(found).verify()


@given(mutated(CERTIFICATES))
@settings(max_examples=examples(400))
def test_mutated_certificates_never_prove_the_opposite(case: tuple[str, Any]) -> None:
    """Harmless changes may be accepted (any eta will do); a certificate that is accepted claims what is true."""
    name, data = case
    certificate = tried(Certificate.from_json, data)
    pair = lh.load(EXAMPLES / f"{name}.json")
    if certificate is not None and tried(lh.verify_certificate, pair, certificate):
        assert certificate.full == lh.decide_fullness(pair).full


@given(mutated(SMALL), st.sampled_from(["fullness", "isotropy", "range"]))
@settings(max_examples=examples(100), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mutated_files_on_the_command_line(tmp_path: Path, case: tuple[str, Any], command: str) -> None:
    file = tmp_path / "mutant.json"
    file.write_text(json.dumps(case[1]), encoding="utf-8")
    with nothing_is_executed(tmp_path):
        result = CliRunner().invoke(app, [command, str(file)])
    assert result.exit_code in (0, 1, 2, 3), (result.exit_code, result.stderr, case[1])
    if result.exit_code == 2:
        assert result.stdout == ""
        assert result.stderr.startswith("liehom: error: ")


@given(st.text(max_size=40))
@settings(max_examples=examples(100))
def test_any_text_as_a_pair_point_or_row(text: str) -> None:
    sphere, sym3 = str(EXAMPLES / "so4_so3.json"), str(EXAMPLES / "sym3.json")
    for words in (["fullness", "--", text], ["range", sphere, f"--psi={text}"], ["isotropy", sym3, f"--point={text}"]):
        result = CliRunner().invoke(app, words)
        assert result.exit_code in (0, 1, 2, 3), (words, result.exit_code, result.stderr)


# -- integration: the fields, the options, the files that are written -----------------------------------
PROBLEMS = {name: data for name, data in FILES.items() if {"generator", "vector_field"} & data.keys()}
TERMS = st.recursive(
    st.sampled_from(["m0", "m1", "m2", "t", "0", "1", "2", "7", "1/3"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda x: f"({x[0]}{x[1]}{x[2]})"),
        st.tuples(inner, st.integers(-40, 40)).map(lambda x: f"({x[0]})**{x[1]}"),
        st.tuples(st.sampled_from(["sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh"]), inner).map(
            lambda x: f"{x[0]}({x[1]})"
        ),
    ),
    max_leaves=5,
)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(st.lists(TERMS, min_size=3, max_size=3), st.sampled_from(["lietaylor", "euler", "rk4", "backward euler"]))
@example(["m0", "m2 + sqrt(m0)", "m0"], "euler")
@example(["0", "0", "t" + " + m0*t" * 2000], "lietaylor")
@settings(max_examples=examples(60))
def test_any_generator_is_integrated_or_refused(texts: list[str], base: str) -> None:
    data = {**FILES["rigid_body"], "generator": texts, "base": base, "order": 3, "t_span": [0, 1], "dt": 0.2}
    problem = tried(lambda: io.loads(json.dumps(data), problem=True))
    solution = None if problem is None else tried(lambda: problem.integrate(max_steps=5))
    if solution is not None:
        assert np.isfinite(solution.y).all()
        assert np.allclose(np.linalg.norm(solution.y, axis=0), 1, atol=1e-12)


@given(mutated(PROBLEMS))
@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mutated_problems_on_the_command_line(tmp_path: Path, case: tuple[str, Any]) -> None:
    file, out = tmp_path / "mutant.json", tmp_path / "out.npz"
    file.write_text(json.dumps(case[1]), encoding="utf-8")
    out.unlink(missing_ok=True)
    with nothing_is_executed(tmp_path):
        result = CliRunner().invoke(app, ["integrate", str(file), "--out", str(out), "--max-steps", "3"])
    assert result.exit_code in (0, 1, 2), (result.exit_code, result.stderr, case[1])
    if result.exit_code == 2:
        assert result.stdout == ""
        assert result.stderr.startswith("liehom: error: ")
    else:
        assert result.stderr == ""
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"mutant.json"} | (set() if result.exit_code == 2 else {"out.npz"})


@given(st.text(max_size=20), st.sampled_from(["dt", "rtol", "atol", "base", "exponential", "clock", "order"]))
@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_text_as_an_option(tmp_path: Path, text: str, option: str) -> None:
    words = ["integrate", str(EXAMPLES / "rigid_body.json"), f"--{option}={text}", "--out", str(tmp_path / "out.npz")]
    result = CliRunner().invoke(app, [*words, "--force", "--max-steps", "3"])
    assert result.exit_code in (0, 1, 2), (words, result.exit_code, result.stderr)
    if result.exit_code == 2:
        assert result.stdout == ""
