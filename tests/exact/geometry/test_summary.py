"""The facts of `liehom geometry` and of the page of a pair."""

import json

import pytest

import liehom as lh
from liehom.exact.geometry.summary import geometry_facts
from tests.cli.test_cli import liehom


def values(name: str, **options: bool) -> dict[str, object]:
    return {fact.name: fact.value for fact in geometry_facts(lh.pair(name), **options)}


def words(name: str) -> dict[str, str]:
    return {fact.name: fact.words for fact in geometry_facts(lh.pair(name))}


def test_flag_manifold() -> None:
    facts = values("SU(3)/T^2")
    assert (facts["reductive"], facts["symmetric"], facts["metrics"]) == (True, False, 3)
    assert facts["einstein_metrics"] == {
        "count": 4, "kinds": 2, "complete": True,
        "parameters": [["1", "1", "1"], ["1", "1", "2"], ["1", "2", "1"], ["1", "1/2", "1/2"]],
    }  # fmt: skip
    assert facts["cohomology"] == [1, 0, 2, 0, 2, 0, 1]
    assert (facts["symplectic_forms"], facts["complex_structures"]) == (True, 6)
    assert facts["standard_metric"] == {
        "scalar_curvature": "30", "einstein": True, "holonomy": "su(4)", "naturally_reductive": True,
    }  # fmt: skip
    assert "einstein_metrics" not in values("SU(3)/T^2", einstein=False)


def test_space_without_a_complement_and_a_point() -> None:
    assert values("sl(3)/P1") == {"reductive": False}
    assert values("so(3)/so(3)") == {"reductive": True}


def test_lorentzian_space_has_no_standard_metric() -> None:
    facts = values("dS^3")
    assert facts["standard_metric"] is None
    assert facts["einstein_metrics"] == {"count": 0, "kinds": 0, "complete": True, "parameters": []}


def test_what_is_not_decided_says_why() -> None:
    """Equivalent isotropy summands: complex structures are in families."""
    facts = words("SU(2)/0")
    assert facts["complex_structures"].startswith("not decided: pair('su(2)/0') has equivalent isotropy summands")
    assert values("SU(2)/0")["complex_structures"] is None
    with lh.limits(entries=300):
        assert words("SU(3)/T^2")["cohomology"].startswith("not decided: the equations")


def test_irrational_parameters_are_shown_as_decimals() -> None:
    shown = words("W(1,2)")["einstein_metrics"]
    assert shown.startswith("2 up to scale, of 2 kinds: about (1, ")
    assert "(1, 0.967865, 2.48173, 2.33533)" in shown


def test_floats_are_refused() -> None:
    with pytest.raises(lh.UndecidedError):
        list(geometry_facts(lh.defining(lh.so(4)).pair([0.6, 0, 0, 0.8])))


def test_command_prints_the_facts() -> None:
    result = liehom("geometry", "CP^2")
    assert result.exit_code == 0
    assert "G/H has invariant metrics with 1 parameter\n" in result.stdout
    assert "holonomy so(3) + R" in result.stdout
    data = json.loads(liehom("geometry", "CP^2", "--json").stdout)
    assert (data["cohomology"], data["complex_structures"]) == ([1, 0, 1, 0, 1], 2)
    assert "is not reductive" in liehom("geometry", "sl(3)/P1").stdout


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("CP^2", "Einstein, Ric = 6 g, naturally reductive, holonomy so(3) + R"),
        ("sl(3)/P1", "no: h has no invariant complement in g"),
        ("so(12)/so(11)", "up to dim g/h = 8"),
    ],
)
def test_page_of_a_pair_has_a_section_on_geometry(name: str, words: str) -> None:
    page = lh.pair_page(lh.decide_fullness(lh.pair(name)))
    section = page.partition('<section id="geometry">')[2].partition("</section>")[0]
    assert words in section
