"""A certificate holds plain types, and the checker works on its own copy: no object can answer in two ways."""

from typing import Any

import flint
import pytest

import liehom as lh
from liehom.base.errors import CertificateError, CertificateFormatError

SPHERE = lh.pair("so(3)/so(2)")
POINT = lh.pair("so(2)/so(1)")


class TwoFaced(str):
    """A string that equals 'trivial' when it is asked for the second time, and hashes like 'full'."""

    asked = 0

    def __eq__(self, other: object) -> bool:
        self.asked += 1
        return str.__eq__(self, other) if self.asked < 2 else other == "trivial"

    def __hash__(self) -> int:
        return hash("full")

    def __str__(self) -> str:
        return "trivial"


def test_the_kind_is_a_plain_string() -> None:
    fields = lh.decide_fullness(SPHERE).certificate.to_fields()
    built = lh.Certificate(TwoFaced("full"), fields)
    assert type(built.kind) is str and built.kind == "full"
    assert type(lh.Certificate.from_json(built.to_json() | {"kind": TwoFaced("full")}).kind) is str


def test_the_checker_uses_a_copy() -> None:
    """Attributes of frozen dataclasses can be set by force; the checker reads them once and checks what it has read."""
    certificate = lh.decide_fullness(SPHERE).certificate
    object.__setattr__(certificate, "kind", TwoFaced("trivial"))
    with pytest.raises(CertificateError):
        lh.verify_certificate(SPHERE, certificate)
    certificate = lh.decide_fullness(SPHERE).certificate
    object.__setattr__(certificate, "fields", dict(certificate.fields) | {"eta": ("nonsense",)})
    with pytest.raises(CertificateError):
        lh.verify_certificate(SPHERE, certificate)


def test_numbers_of_a_subclass_are_refused() -> None:
    class Positive(flint.fmpq):  # type: ignore[misc]
        def __gt__(self, other: object) -> bool:
            return True

    fields: dict[str, Any] = {"element": ["1", "0"], "cut": "1/4", "eps": Positive(-1)}
    with pytest.raises(CertificateFormatError, match="eps"):
        lh.Certificate("dominance", fields)


def test_a_verdict_is_not_verified_by_a_certificate_of_its_contrary() -> None:
    full, not_full = lh.decide_fullness(SPHERE), lh.decide_fullness(lh.pair("so(3,1)/so(2,1)"))
    with pytest.raises(CertificateError, match="proves that a pair is not full"):
        lh.fullness.Full(not_full.pair, not_full.certificate, "wrong").verify()
    with pytest.raises(CertificateError, match="proves that a pair is full"):
        lh.fullness.NotFull(full.pair, full.certificate, "wrong").verify()
    assert full.verify() and not_full.verify()
