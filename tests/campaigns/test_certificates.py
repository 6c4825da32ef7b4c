"""A sample of the campaign against the checker, and that the campaign can see what it looks for."""

import json
from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from tests.campaigns import certificates
from tests.campaigns.certificates import FIELDS, NAMES, OTHER, WRONG, Campaign, Case, proofs, table, total
from tests.exact.catalog.claims import CLAIMS

FEW = ("so(3)/so(2)", "sl(2)/so(1,1)", "affine(so(2,1))", "affine(S3(gl(2)))", "affine(field(1,1,1,1))")
FEW += ("affine(form(1,-2))", "affine(gl(2))", "affine(upper(2))", "sl(2)/B", "so(2,1)/so(2)")


def sample(count: int, seed: int = 5) -> Campaign:
    campaign = Campaign(seed=seed, names=FEW)
    campaign.run(count)
    return campaign


def test_no_certificate_of_a_sample_proves_a_wrong_verdict() -> None:
    campaign = sample(500)
    assert campaign.offenders == []
    assert campaign.figures.total() == 500
    assert total(campaign.figures, "accepted with the true") > 50
    assert total(campaign.figures, "refused") > 250
    seen = [key.split(" | ") for key in campaign.figures]
    assert {key[0] for key in seen} == set(certificates.STRATEGIES)
    assert {key[1] for key in seen} == set(FIELDS)
    assert {key[2] for key in seen} >= set(certificates.KINDS)


def test_the_whole_campaign_has_a_hundred_pairs_of_both_verdicts() -> None:
    assert len(NAMES) >= 100 and len(FIELDS) == 4
    assert 40 < sum(CLAIMS[name].full for name in NAMES) < len(NAMES) - 40


def test_every_kind_of_certificate_is_a_source() -> None:
    for field in FIELDS:
        assert {proof["kind"] for name in FEW for proof in proofs(Case(name, field))} == set(certificates.KINDS)


def test_a_campaign_goes_on_where_it_was(tmp_path: Path) -> None:
    output = tmp_path / "figures.json"
    Campaign(seed=3, names=FEW).run(60, output)
    second = Campaign.from_json(json.loads(output.read_text(encoding="utf-8")))
    second.names = FEW
    second.run(100)
    at_once = Campaign(seed=3, names=FEW)
    at_once.run(100)
    assert second.figures == at_once.figures
    assert "| together |" in table(second)


def test_a_checker_that_accepts_everything_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lh, "verify_certificate", lambda *_: True)
    campaign = sample(60)
    assert total(campaign.figures, WRONG) == len(campaign.offenders) > 3


def test_an_exception_of_another_class_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> bool:
        raise ZeroDivisionError

    monkeypatch.setattr(lh, "verify_certificate", fails)
    campaign = sample(20)
    assert total(campaign.figures, OTHER) == len(campaign.offenders) > 5
