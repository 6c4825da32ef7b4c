"""A sample of the campaign against steps that jump over features, and that the campaign can see what it looks for."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import erf

from tests.campaigns.checked_fields import SPAN, Group, groups
from tests.campaigns.checked_steps import RTOLS, References, allowed, is_wrong, key, main, reference, rows, summary

GROUPS = {(group.name, group.space): group for group in groups(2031)}
REFERENCES = References(None)


def run(group: Group, step: str, rtol: float) -> list[dict[str, object]]:
    return rows(group, "numpy", step, rtol, {}, REFERENCES.of(group))


JUMPS = [
    ("nmr pulse", "default", 1e-6), ("pulse on a body", "default", 1e-4), ("logistic 100", "default", 1e-4),
    ("sin 8", "default", 1e-6), ("t 8", "default", 1e-6), ("exp(-1/t)", "default", 1e-6),
    ("late wall", "default", 1e-9), ("nmr pulse of 1 percent", "rk45", 1e-6), ("early pulse alone", "rk45", 1e-9),
    ("hot spot 0.1 on a circle", "corrected-heun:4", 1e-4), ("hot spot 0.06 on a circle", "corrected-heun:4", 1e-4),
]  # fmt: skip


@pytest.mark.parametrize(("name", "step", "rtol"), JUMPS)
def test_features_that_unchecked_steps_jump_over_are_seen(name: str, step: str, rtol: float) -> None:
    (row,) = run(GROUPS[name, "sphere"], step, rtol)
    assert row["success"] and not is_wrong(row), row


@pytest.mark.parametrize("space", ["sphere", "projective"])
@pytest.mark.parametrize("name", ["smooth body", "smooth waves"])
def test_smooth_fields_have_the_accuracy_that_is_asked_for(name: str, space: str) -> None:
    figures = summary(run(GROUPS[name, space], "default", 1e-6))
    assert (
        figures["runs"] == len(GROUPS[name, space].widths)
        and figures["wrong"] == figures["failed"] == figures["refused"] == 0
    )


def test_there_are_enough_fields_and_a_seed_draws_them_again() -> None:
    names = [name for group in GROUPS.values() for name in group.names]
    assert len(set(names)) == len(names) >= 400
    assert len({key(group, j) for group in GROUPS.values() for j in range(len(group.widths))}) == len(names)
    assert sum(len(group.widths) for group in GROUPS.values() if group.smooth) >= 60
    for group, again, other in zip(GROUPS.values(), groups(2031), groups(2032), strict=True):
        rhs, start = group.rhs(0), group.space_of.start
        assert np.isfinite(rhs(group.span[0], start)).all() and (group.widths > 0).all()
        assert key(group, 0) == key(again, 0) and (key(group, 0) == key(other, 0)) == (not group.args)


def test_references_agree_with_closed_forms() -> None:
    """Without a background, psi turns about one axis, by the integral of its shape."""
    for name, integral in (
        ("gauss", lambda a, t: a["w"] * np.pi**0.5 / 2 * erf((t - a["c"]) / a["w"])),
        ("lorentz", lambda a, t: a["w"] * np.arctan((t - a["c"]) / a["w"])),
        ("tanh", lambda a, t: (t + a["w"] * np.logaddexp((t - a["c"]) / a["w"], -(t - a["c"]) / a["w"])) / 2),
    ):
        group = GROUPS[name, "sphere"]
        a = {k: x[0] for k, x in group.args.items()}
        assert not a["b"].any() and not a["beta"] and group.span == (0.0, SPAN)
        angle = integral(a, SPAN) - integral(a, 0.0)
        end = expm(angle * np.einsum("r,rij", a["e"], group.space_of.matrices)) @ group.space_of.start
        assert np.linalg.norm(reference(group, 0)["end"] - end) < 1e-10


def test_a_run_is_wrong_if_neither_tolerance_nor_field_explains_its_error() -> None:
    row = {"success": True, "error": 1e-3, "tolerance": 1e-6, "resolved": 1e-7}
    assert is_wrong(row) and is_wrong({**row, "error": float("nan")})
    assert not is_wrong({**row, "error": 9e-5}) and not is_wrong({**row, "resolved": 2e-5})
    assert not is_wrong({**row, "success": False})
    assert allowed(1e-6, np.array([3.0, 4.0])) == pytest.approx(5e-6 + 1e-9 * 2**0.5)


def test_the_reference_would_find_a_jump(monkeypatch: pytest.MonkeyPatch) -> None:
    """A method that returns the start is wrong on the fields of the sample."""
    from tests.campaigns import checked_steps

    def still(group: Group, *_: object) -> list[checked_steps.Run]:
        return [(group.space_of.start, True, 1, "")] * len(group.widths)

    monkeypatch.setattr(checked_steps, "of_liehom", still)
    for name, step, rtol in JUMPS:
        assert is_wrong(run(GROUPS[name, "sphere"], step, rtol)[0])


def test_a_report_counts_and_names_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output, stored = tmp_path / "out.json", tmp_path / "references.json"
    main(["--engine", "scipy", "--step", "RK45", "--fields", "late pulse", "--references", str(stored), str(output)])
    data = json.loads(output.read_text())
    assert [row["rtol"] for row in data["rows"]] == list(RTOLS) and len(json.loads(stored.read_text())) == 1
    main(["report", str(output)])
    text = capsys.readouterr().out
    assert text.count("| scipy | RK45 | None |") == 6 and "late pulse alone/sphere/0 wrong: width 1/200" in text


def test_a_field_that_a_step_refuses_is_not_counted_as_run() -> None:
    group = GROUPS["bump", "sphere"]
    known = [{"end": group.space_of.start, "dop853": [0.0] * 3, "resolved": [0.0] * 3}] * len(group.widths)
    figures = summary(rows(group, "numpy", "taylor", 1e-4, {}, known))
    assert figures["refused"] == figures["runs"] == 4 and figures["wrong"] == figures["failed"] == 0
