"""The pages are what the script makes of the figures."""

from pathlib import Path

import pytest

from tests.campaigns import doors, report


@pytest.mark.parametrize("page", report.PAGES, ids=lambda page: page.stem)
def test_a_page_is_what_the_script_writes(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == report.rewritten(text, report.PAGES[page]), "run python -m tests.campaigns.report"


def test_a_page_without_markers_is_refused() -> None:
    with pytest.raises(ValueError, match="begin limits"):
        report.rewritten("# Reliability\n", {"limits": report.limits_table})


def test_the_figures_have_no_offender_and_count_right() -> None:
    data = report.figures("doors")
    assert data["offenders"] == []
    assert sum(row[key] for row in data["rows"] for key in doors.OUTCOMES) == data["count"]
    assert all(row["believed"] == 0 for row in report.figures("damage")["rows"])
