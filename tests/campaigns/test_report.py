"""The page on reliability is what the script makes of the figures."""

import pytest

from tests.campaigns import doors, report


def test_the_page_is_what_the_script_writes() -> None:
    page = report.PAGE.read_text(encoding="utf-8")
    assert page == report.rewritten(page), "run python -m tests.campaigns.report"


def test_a_page_without_markers_is_refused() -> None:
    with pytest.raises(ValueError, match="begin limits"):
        report.rewritten("# Reliability\n")


def test_the_figures_have_no_offender_and_count_right() -> None:
    data = report.figures("doors")
    assert data["offenders"] == []
    assert sum(row[key] for row in data["rows"] for key in doors.OUTCOMES) == data["count"]
    assert all(row["believed"] == 0 for row in report.figures("damage")["rows"])
