"""Numbers of more digits than Python prints, in every field of a certificate and in its number field."""

from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError, CertificateFormatError, LimitError

LONG = 10**5000
SPHERE = lh.pair("so(3)/so(2)")


def proof() -> dict[str, Any]:
    certificate = lh.decide_fullness(SPHERE).certificate
    assert certificate is not None
    return certificate.to_json()


@pytest.mark.parametrize("key", ["format", "version", "kind", "form", "elements", "eta"])
@pytest.mark.parametrize(
    "value", [LONG, [LONG], [[LONG]], [[LONG, 0, "1"]], [[0, LONG, "1"]], [[0, 0, LONG]]], ids=range(6)
)
def test_long_integers_are_malformed_or_do_not_fit(key: str, value: object) -> None:
    with pytest.raises((CertificateFormatError, CertificateError)):
        lh.verify_certificate(SPHERE, lh.Certificate.from_json(proof() | {key: value}))


def test_long_strings_exceed_the_limit() -> None:
    with pytest.raises(LimitError, match="digits"):
        lh.Certificate.from_json(proof() | {"eta": ["7" * 20_000] * 3})


def test_a_field_with_long_coefficients_is_written_and_compared() -> None:
    long = lh.number_field([-(10**4500) - 7, 0, 1], (10**2250, 10**2250 + 1))
    data = lh.Certificate("trivial", {}, long).to_json()
    assert len(data["field"]["minpoly"][0]) == 4502
    again = lh.Certificate.from_json(data)
    assert again.field == long
    pair = lh.Pair(lh.abelian(2).over(lh.number_field("sqrt(2)")), [[1, 0]])
    with pytest.raises(CertificateError, match="field"):
        lh.verify_certificate(pair, again)
