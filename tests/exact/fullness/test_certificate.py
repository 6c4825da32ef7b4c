"""Certificates as data and as JSON: both ways the same, and strict."""

import json
import pickle
from typing import Any

import pytest
from hypothesis import given, strategies as st

from liehom.base.errors import CertificateError, CertificateFormatError, FormatError
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
SAMPLES: list[tuple[str, dict[str, Any]]] = [
    ("trivial", {}),
    ("full", {"form": [[0, 0, "1"], [1, 1, "1/2"]], "elements": [["0", "0", "2"]], "eta": ["1", "0", "2"]}),
    ("full", {"form": [["1", "0"], ["0", "1"]], "elements": [[1, 0, "2"], [0, 1, "3"]], "eta": ["1", "0"]}),
    ("witness", {"minpoly": ["-2", "0", "1"], "interval": ["1", "2"], "eta": ["1", ["0", "1"]], "phi": [["3"], "0"]}),
    ("commutant", {"matrix": [["1", "2"], ["3", "4"]], "complement": [["0", "1"], ["1", "0"]], "cut": "-7/3"}),
    ("dominance", {"element": ["1", "0"], "cut": "1/4", "eps": "1/2"}),
]
HEADER = {"format": "liehom-certificate", "version": 1}


def malformed(data: Any, message: str) -> None:
    with pytest.raises(CertificateFormatError, match=message) as caught:
        Certificate.from_json(data)
    assert isinstance(caught.value, FormatError)
    assert isinstance(caught.value, CertificateError)
    assert caught.value.check in ("format", "field")


@pytest.mark.parametrize(("kind", "fields"), SAMPLES)
@pytest.mark.parametrize("field", [QQ, ROOT2])
def test_json_round_trip_returns_the_same_certificate(kind: str, fields: dict[str, Any], field: Any) -> None:
    certificate = Certificate(kind, fields, field)
    data = certificate.to_json()
    assert ("field" in data) == (field is ROOT2)
    assert data | fields == data  # numbers are written as they were given, dense or sparse
    read = Certificate.from_json(json.loads(json.dumps(data)))
    assert read == certificate and hash(read) == hash(certificate) and read.to_json() == data
    assert pickle.loads(pickle.dumps(certificate)) == certificate
    assert certificate.full == (kind in ("trivial", "full"))


def test_the_second_certificate_of_a_witness() -> None:
    also = Certificate(*SAMPLES[-1])
    fields = SAMPLES[3][1]
    given_as_json = Certificate("witness", fields | {"also": also.to_json()})
    assert given_as_json == Certificate("witness", fields | {"also": also})
    assert given_as_json.fields["also"] == also
    assert Certificate.from_json(given_as_json.to_json()) == given_as_json
    for kind, inner in SAMPLES[:4]:
        malformed(HEADER | {"kind": "witness"} | fields | {"also": Certificate(kind, inner).to_json()}, "also is of")
    malformed(HEADER | {"kind": "witness"} | fields | {"also": 3}, "a certificate is a JSON object")
    malformed(HEADER | {"kind": "dominance"} | SAMPLES[-1][1] | {"also": also.to_json()}, "unknown key 'also'")


def test_fields_cannot_be_changed() -> None:
    certificate = Certificate(*SAMPLES[-1])
    with pytest.raises(AttributeError):
        certificate.kind = "full"  # type: ignore[misc]
    with pytest.raises(TypeError):
        certificate.fields["cut"] = "0"  # type: ignore[index]
    certificate.to_fields()["element"].append("1")
    assert certificate.fields["element"] == (1, 0)


def test_numbers_written_and_read() -> None:
    matrix = ROOT2.matrix([["a", 0], [1, "1/2 - a"]])
    certificate = Certificate.over(ROOT2, "commutant", matrix=matrix, complement=[[0, 1], [ROOT2.generator, 0]], cut=1)
    assert certificate.matrix("matrix", 2, 2) == matrix
    assert certificate.matrix("complement", 2, 2) == ROOT2.matrix([[0, 1], ["a", 0]])
    assert certificate.number("cut") == 1
    sparse = Certificate.over(QQ, "full", form=QQ.identity(12), elements=QQ.identity(12), eta=[1] * 12)
    assert sparse.fields["form"][3] == (3, 3, 1)
    assert sparse.matrix("form", 12, 12) == sparse.matrix("elements", None, 12) == QQ.identity(12)
    dense = Certificate.over(QQ, "full", form=QQ.zeros(12, 12), elements=QQ.zeros(12, 12), eta=[1] * 12)
    assert dense.matrix("elements", None, 12) == QQ.zeros(12, 12)
    quadratic = NumberField("sqrt(5)", [-5, 0, 1], (2, 3))
    golden = Certificate.over(quadratic, "dominance", element=[quadratic.convert("sqrt(5)/2")], cut=0, eps=1)
    assert Certificate.from_json(golden.to_json()).vector("element", 1)[0] == golden.number("eps") / 2 * (
        quadratic.generator
    )
    assert Certificate(*SAMPLES[3]).polynomials("eta", 2, 2) == QQ.matrix([[1, 0], [0, 1]])


def test_numbers_are_written_in_their_normal_form() -> None:
    fields = {"element": ["2/4", "sqrt(4)"], "cut": "1/4 + 1", "eps": "0"}
    certificate = Certificate("dominance", fields)
    assert certificate.to_fields() == {"element": ["1/2", "2"], "cut": "5/4", "eps": "0"}
    assert certificate == Certificate("dominance", certificate.fields)  # numbers are read as well as strings
    for value in (1, 1.5, RR.one, ROOT2.generator):
        with pytest.raises(CertificateFormatError, match="write numbers as strings"):
            Certificate("dominance", fields | {"cut": value})


def test_lengths_that_do_not_fit_the_pair() -> None:
    full, witness = Certificate(*SAMPLES[1]), Certificate(*SAMPLES[3])
    for call in (
        lambda: full.vector("eta", 4),
        lambda: full.matrix("form", 1, 1),
        lambda: full.matrix("elements", None, 2),
        lambda: full.matrix("elements", 2, 3),
        lambda: witness.polynomials("eta", 3, 2),
        lambda: witness.polynomials("eta", 2, 1),
    ):
        with pytest.raises(CertificateError) as caught:
            call()
        assert caught.value.check == "length"


def test_wrong_format_version_or_kind_is_malformed() -> None:
    good = HEADER | {"kind": "trivial"}
    assert Certificate.from_json(good) == Certificate("trivial", {})
    for data in (None, [], "trivial", 3, [good], json.dumps(good)):
        malformed(data, "a certificate is a JSON object")
    for key, values in {"format": ["liehom-pair", None, 1], "version": [2, "1", True, 1.0, None]}.items():
        for value in values:
            malformed(good | {key: value}, f"{key} is ")
        malformed({k: v for k, v in good.items() if k != key}, f"{key} is None")
    for kind in ("proof", None, 1, ["full"], {"full": 1}):
        malformed(
            HEADER | {"kind": kind}, "the kind is .*, expected one of trivial, full, witness, commutant, dominance"
        )
    malformed(HEADER, "'kind' is missing")
    malformed(good | {"note": "hello", "x": 1}, "unknown key 'note', 'x' in a certificate of kind 'trivial'")
    with pytest.raises(CertificateFormatError, match="must be exact"):
        Certificate("trivial", {}, RR)


@pytest.mark.parametrize(("kind", "fields"), SAMPLES[1:])
def test_every_field_is_required_and_no_other_allowed(kind: str, fields: dict[str, Any]) -> None:
    data = HEADER | {"kind": kind} | fields
    for key in fields:
        malformed({k: v for k, v in data.items() if k != key}, f"'{key}' is missing")
        for wrong in (None, 1, 1.5, True, {}, [1.5], [[1.5]], [[0, 0, 1.5]], [[[]]], "1..2", ["x"], [["a"]], "1/0"):
            malformed(data | {key: wrong}, key)
    malformed(data | {"vector": ["1"]}, "unknown key 'vector'")


@pytest.mark.parametrize(("name", "value", "message"), [
    ("form", [["1", "0"], ["0"]], "different lengths: .1, 2."), ("form", [["1", "0"]], "must be square, it is 1 x 2"),
    ("form", [[0, 0, "1"], [0, 0, "1"]], r"entry \(0, 0\) twice"), ("form", [[0, -1, "1"]], "indices from 0"),
    ("form", [[0, True, "1"]], "indices from 0"), ("form", [[0, 0, "1"], ["1", "0"]], "expected .i, j, number"),
    ("form", [["1", "0"], [0, 0, "1"]], "holds 0, of type int"), ("form", [[0, 0]], "expected .i, j, number"),
    ("form", [[0, 0, 1]], "holds 1, of type int"), ("form", [[0.0, 0, "1"]], "expected .i, j, number"),
    ("form", "11", "must be a list"), ("form", ["10", "01"], "a row of form must be a list"),
    ("elements", [[1, 0, "2"]], "row without entries"), ("elements", [[0, 0, "2"], [2, 0, "1"]], "row without entries"),
    ("eta", ["1", 0.5], "0.5, a float; write numbers as strings"), ("eta", ["1", "0.5"], "is not a value"),
    ("eta", ["1", "sqrt(2)"], "not in QQ"), ("eta", ["1", "a"], "the name 'a' is not known"),
    ("eta", ["1", "__import__('os')"], "is not a value"), ("eta", ["1", "nan"], "the name 'nan' is not known"),
])  # fmt: skip
def test_malformed_fields_of_full(name: str, value: Any, message: str) -> None:
    malformed(HEADER | {"kind": "full"} | SAMPLES[2][1] | {name: value}, message)


@pytest.mark.parametrize(("name", "value", "message"), [
    ("minpoly", ["1"], "degree at least 1"), ("minpoly", [], "degree at least 1"),
    ("minpoly", ["1", "2", "0"], "degree at least 1"), ("interval", ["1"], "must have two ends, it has 1"),
    ("interval", ["1", "2", "3"], "it has 3"), ("eta", ["1", []], "empty list of coefficients"),
    ("phi", ["1", [["1"]]], "of type list"), ("phi", {"0": "1"}, "must be a list"),
])  # fmt: skip
def test_malformed_fields_of_witness(name: str, value: Any, message: str) -> None:
    malformed(HEADER | {"kind": "witness"} | SAMPLES[3][1] | {name: value}, message)


@pytest.mark.parametrize(("change", "message"), [
    ({"name": "2a"}, "expected an identifier"), ({"name": "sqrt"}, "expected an identifier"),
    ({"name": None}, "expected an identifier"), ({"minpoly": ["-4", "0", "1"]}, "reducible"),
    ({"minpoly": ["2", "0", "1"]}, "contains 0 real roots"), ({"minpoly": ["-2", "1"]}, "degree at least 2"),
    ({"minpoly": [-2, 0, 1]}, "of type int"), ({"interval": ["-2", "2"]}, "contains 2 real roots"),
    ({"interval": ["2", "1"]}, "empty"), ({"interval": ["1"]}, "two ends"), ({"interval": ["a", "2"]}, "is not known"),
    ({"degree": "2"}, "unknown key 'degree' in field"),
])  # fmt: skip
def test_malformed_number_field_names_the_fault(change: dict[str, Any], message: str) -> None:
    field = {"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]}
    data = HEADER | {"kind": "trivial"}
    assert Certificate.from_json(data | {"field": field}).field == ROOT2
    malformed(data | {"field": field | change}, message)
    malformed(data | {"field": {k: v for k, v in field.items() if k != "name"}}, "'name' is missing")
    malformed(data | {"field": "QQ"}, "field must be a JSON object")


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 3) | st.floats() | st.sampled_from(["0", "1", "-1/2", "a", "x(", ""]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["kind", "field", "eta"]), inner),
    max_leaves=12,
)


@given(st.sampled_from(SAMPLES), st.data())
def test_anything_else_is_refused_as_malformed(sample: tuple[str, dict[str, Any]], data: st.DataObject) -> None:
    kind, fields = sample
    joined = Certificate(kind, fields).to_json()
    key = data.draw(st.sampled_from([*joined, "field", "also"]))
    joined[key] = data.draw(JSON_VALUES)
    try:
        certificate = Certificate.from_json(joined)
    except CertificateFormatError:
        return
    assert certificate.to_json() == joined
