"""The page of a pair: one well-formed file without a network, which says what is proved and what is left out."""

import base64
import hashlib
import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.exact.fullness.verdict import Verdict
from liehom.io import page as html
from tests.browser import dom, needs_browser
from tests.html_structure import Balance

pytest.importorskip("matplotlib")

EVIL = "</script></title><script>alert(1)</script> \" ' & $x$ $\\evil{ --> ]]>"


def evil() -> lh.Pair:
    algebra = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}, basis=[EVIL, "y$", "z"], name=EVIL)
    return lh.Pair(algebra, [[0, 0, 1]], name=EVIL)


def over_sqrt3() -> lh.Pair:
    """The null cone of x^2 + y^2 - 3 z^2, over a field in which it has points."""
    pair = lh.pair("affine(form(1,1,-3))")
    field = lh.number_field("sqrt(3)")
    return lh.Pair(pair.algebra.over(field), [[str(x) for x in row] for row in pair.subalgebra.basis.to_rows()])


PAIRS: dict[str, Callable[[], lh.Pair]] = {
    "full": lambda: lh.pair("so(4)/so(3)"),
    "null cone in space": lambda: lh.pair("so(3,1)/so(2,1)"),
    "lines in the plane": lambda: lh.pair("sl(2)/so(1,1)"),
    "commutant": lambda: lh.pair("affine(field(1,1,1,1))"),
    "number field": lambda: lh.pair("affine(form(1,1,-3))"),
    "over a number field": over_sqrt3,
    "fails everywhere": lambda: lh.pair("su(2)/0"),
    "h = 0, abelian": lambda: lh.pair("R^2/0"),
    "h = g": lambda: lh.Pair(lh.so(3), lh.QQ.identity(3)),
    "dimension 0": lambda: lh.Pair(lh.abelian(0), []),
    "dimension 1": lambda: lh.Pair(lh.abelian(1), []),
    "numerically full": lambda: lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]),
    "numerically not full": lambda: lh.Pair(lh.abelian(2).over(lh.RR), []),
    "undecided": lambda: lh.Pair(lh.LieAlgebra({(0, 1): {2: 1.0}, (0, 2): {1: -1e-8}}, dimension=3), [[1, 0, 0]]),
    "evil": evil,
}


@cache
def verdict_of(name: str) -> Verdict:
    return lh.decide_fullness(PAIRS[name]())


PICTURED = {"null cone in space", "lines in the plane", "evil"}
"""The pages with pictures; those of the others would show nothing more and take most of the time."""


def no_matplotlib(name: str) -> object:
    raise lh.InputError("plots need matplotlib: install it")


@cache
def page_of(name: str) -> str:
    with pytest.MonkeyPatch.context() as patch:
        if name not in PICTURED:
            patch.setattr(html, "matplotlib_module", no_matplotlib)
        return lh.pair_page(verdict_of(name))


@cache
def read(name: str) -> Balance:
    return Balance(page_of(name))


def links(page: Balance) -> list[dict[str, str | None]]:
    return [attributes for tag, attributes in page.elements if tag == "a"]


def files(page: Balance) -> dict[str, dict[str, object]]:
    """The JSON objects that the links of a page save, by the names of their files."""
    found = {}
    for link in links(page):
        if link.get("download"):
            data = str(link["href"]).removeprefix("data:application/json;base64,")
            found[str(link["download"])] = json.loads(base64.b64decode(data))
    return found


# -- every page ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", PAIRS)
def test_a_page_is_well_formed_and_needs_no_network(name: str) -> None:
    text, page = page_of(name), read(name)
    assert text.startswith("<!doctype html>\n<html lang")
    ids = [str(attributes["id"]) for _, attributes in page.elements if "id" in attributes]
    assert len(set(ids)) == len(ids)
    assert {str(link["href"])[1:] for link in links(page) if str(link["href"]).startswith("#")} == set(html.SECTIONS)
    assert set(html.SECTIONS) <= set(ids)
    for tag, attributes in page.elements:
        assert not {"src", "srcset", "data", "action", "style" if tag == "body" else "src"} & attributes.keys(), tag
        assert not [key for key in attributes if key.startswith("on")], "no handler in an attribute"
        for key in ("href", "xlink:href"):
            assert str(attributes.get(key, "#")).startswith(("#", "data:application/json;base64,"))
    names_of_formats = ("http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink")  # nothing is fetched from there
    assert set(re.findall(r"https?://[^\"' )]*", text)) <= set(names_of_formats)
    assert not re.search(r"@import|url\((?!#)", text)
    assert len(page.scripts) == 1 + text.count('id="cone"')


@pytest.mark.parametrize("name", PAIRS)
def test_a_page_has_the_sentence_of_its_verdict(name: str) -> None:
    verdict, page = verdict_of(name), read(name)
    assert str(verdict) in page.text
    title = {
        True: r"The pair \S.* is full\.",
        False: r"The pair \S.* is not full\.",
        None: r"The pair \S.* is undecided\.",
    }
    assert len(re.findall(f"^{title[verdict.full]}", page.text, flags=re.MULTILINE)) == 2, "title and heading"
    assert ("not proved" in page.text) is (verdict.certificate is None)


@pytest.mark.parametrize("name", PAIRS)
def test_the_files_of_a_page_are_the_pair_and_a_proof_of_the_verdict(name: str) -> None:
    verdict, found = verdict_of(name), files(read(name))
    pair = lh.from_json(found["pair.json"])
    assert pair == verdict.pair
    assert ("certificate.json" in found) is (verdict.certificate is not None)
    if verdict.certificate is not None:
        assert lh.verify_certificate(pair, found["certificate.json"])
        assert "liehom verify pair.json certificate.json" in page_of(name)


def test_equal_pairs_have_equal_pages() -> None:
    assert lh.pair_page(lh.pair("sl(2)/so(1,1)")) == page_of("lines in the plane")


# -- what could break out ------------------------------------------------------------------------------------
def test_only_the_script_of_the_library_may_run() -> None:
    page = read("evil")
    policy = next(str(a["content"]) for _, a in page.elements if a.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'; ")
    allowed = re.findall(r"script-src ([^;]*)", policy)
    script = (Path(html.__file__).parent / "page.js").read_text(encoding="utf-8")
    assert page.scripts == [script]
    assert allowed == [f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"]
    assert not re.search(r"\beval\b|innerHTML|document\.write|new Function|https?:|fetch\(|import\(", script)
    assert "alert(1)" in page.text


def test_json_in_a_script_ends_no_element() -> None:
    for value in (EVIL, {"</script>": ["<!--", "\u2028"]}):
        assert json.loads(Balance(html.json_script("data", value)).scripts[0]) == value


def test_characters_that_html_forbids_are_replaced() -> None:
    assert html.text("a\x00\x1b\ud800b") == "a\ufffd\ufffd\ufffdb"
    algebra = lh.LieAlgebra({(0, 1): {1: 1}}, basis=["a\x00", "b\ud800"], name="g\x1b")
    page = lh.pair_page(lh.Pair(algebra, [[1, 0]], name="p\udfff"))
    assert "[a\ufffd, b\ufffd]" in Balance(page).text
    assert not re.search("[\x00-\x08\x1b\ud800-\udfff]", page)


def test_long_names_are_cut() -> None:
    algebra = lh.LieAlgebra({(0, 1): {1: 1}}, basis=["x" * 10**5, "y"], name="g" * 10**5)
    assert len(re.sub(r'href="[^"]*"', "", lh.pair_page(lh.Pair(algebra, [[1, 0]], name="p" * 10**5)))) < 60_000


# -- steps of proofs -----------------------------------------------------------------------------------------
def steps(name: str) -> str:
    found = re.search(r'<div class="steps">.*?</section>', page_of(name), flags=re.DOTALL)
    return Balance(found[0].removesuffix("</div></details></section>")).text if found else ""


def test_steps_of_a_proof_that_a_pair_is_full() -> None:
    text = steps("full")
    assert "2 elements z of h preserve P" in text
    assert "have rank 3." in text
    assert read("full").seen.count("details") == 12  # seven sections, four steps, and the coordinates


def test_a_witness_satisfies_the_equations_of_its_steps() -> None:
    """phi vanishes at eta and at the brackets that are shown; they are computed here from the shown eta and phi."""
    text = steps("null cone in space")
    eta, phi = (dict(_terms(re.search(rf"{x} = (.*?)[,φ]", text)[1])) for x in "ηφ")  # type: ignore[index]
    g = verdict_of("null cone in space").pair.algebra
    phi = {name.rstrip("*"): c for name, c in phi.items()}
    assert sum(eta.get(name, 0) * c for name, c in phi.items()) == 0
    for z in ("e3", "e4", "e5"):
        bracket = dict(zip(g.basis_names, g.bracket(z, {k: str(v) for k, v in eta.items()}), strict=True))
        assert sum(bracket[name] * c for name, c in phi.items()) == 0
        assert f"{z}{g.show(list(bracket.values()))}0" in text, "a row of the table"


def _terms(words: str) -> list[tuple[str, int]]:
    """Names and coefficients of a combination such as '-e0 + 2*e1'."""
    return [
        (name, int(f"{sign.replace(' ', '')}{factor.rstrip('*') or 1}"))
        for sign, factor, name in re.findall(r"([-+]? ?)(\d+\*)?([a-z]\w*\*?)", words)
    ]


def test_roots_and_counts_of_the_steps() -> None:
    assert "θ is a real number between" in steps("number field")
    assert "θ is a root of θ^2 - 1/3" in steps("number field")
    assert "θ is a" not in steps("over a number field")
    assert re.search(r"An exact count, with multiplicity: [123] of 4\.", steps("commutant"))
    assert "there is no η outside h" in steps("h = g")
    assert "Every η outside h spans g/h" in steps("dimension 1")


def test_the_second_proof_counts_exactly() -> None:
    verdict = lh.decide_fullness(lh.pair("affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))"))
    text = Balance("".join(html.certificate_steps(verdict.pair, verdict.certificate))).text
    numbers = re.search(r"dim W = (\d+) and m = (\d+), and .* is less than dim g/h = 8", text)
    assert numbers is not None
    assert int(numbers[1]) > 0
    assert int(numbers[1]) + int(numbers[2]) < 8


def test_a_certificate_that_fails_makes_no_page(tmp_path: Path) -> None:
    wrong = lh.fullness.NotFull(
        lh.pair("so(4)/so(3)"), verdict_of("null cone in space").certificate, "by another certificate"
    )
    with pytest.raises(lh.CertificateError):
        lh.pair_page(wrong, tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


def test_numbers_beyond_floats_have_a_page() -> None:
    pair = lh.pair("affine(field(1,1,1,1))")
    scales = [[10**400 if i == j and i % 2 else int(i == j) for j in range(8)] for i in range(8)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(html, "matplotlib_module", no_matplotlib)
        page = Balance(lh.pair_page(pair.change_of_basis(scales)))
    assert "Rounded eigenvalues: too large for floats." in page.text
    assert "An exact count, with multiplicity: 2 of 4." in page.text


# -- pictures ------------------------------------------------------------------------------------------------
def test_the_points_of_the_cone_are_on_it() -> None:
    curves = json.loads(read("null cone in space").scripts[0])
    assert len(curves) == 2
    for curve in curves:
        x = np.array(curve).T
        assert 100 < x.shape[1] <= html.MOST_POINTS
        assert abs(x[0] ** 2 + x[1] ** 2 - x[2] ** 2).max() < 2e-3
        assert abs((x**2).sum(axis=0) - 1).max() < 1e-3
        assert np.linalg.norm(x[:, 0] - x[:, -1]) < 0.1, "it is closed"


def test_pictures_are_there_in_both_colours_with_a_caption() -> None:
    text = page_of("lines in the plane")
    assert text.count('<div class="light"><svg') == text.count('<div class="dark"><svg') == 3
    assert text.count("<figcaption>") == 3
    assert "canvas" not in text.partition("<script>")[0].partition("</style>")[2]


@pytest.mark.parametrize("name", sorted({"full", "number field", "numerically full", "h = g"}))
def test_without_matplotlib_a_sentence_stands_in_the_place_of_pictures(name: str) -> None:
    assert "<svg" not in page_of(name)
    assert "No picture: when this page was written, plots need matplotlib" in read(name).text


def test_a_limit_leaves_the_verdict_and_its_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    def limited(*args: object) -> object:
        raise lh.errors.LimitError("seconds", 2, 1, "this takes longer")

    monkeypatch.setattr(html, "matplotlib_module", no_matplotlib)
    monkeypatch.setattr(html, "failure_report", limited)
    monkeypatch.setattr(lh.LieAlgebra, "describe", limited)
    page = Balance(lh.pair_page(verdict_of("lines in the plane")))
    assert "Not computed: this takes longer" in page.text
    assert "The structure of h is not described: this takes longer" in page.text
    assert "φ also vanishes on [h, η]" in page.text


def test_where_the_condition_fails() -> None:
    assert "(6.3) holds for no ψ" in read("fails everywhere").text
    assert "Nowhere" in read("full").text
    assert "the zeros of x0^2 + x1^2 - x2^2" in read("null cone in space").text
    assert "The cone is drawn for dim g/h = 2 or 3; here dim g/h = 4" in read("commutant").text
    assert "for exact pairs only" in read("undecided").text


# -- what is cut ---------------------------------------------------------------------------------------------
def test_large_tables_are_cut_and_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(html, "matplotlib_module", no_matplotlib)
    for name, most in (("MOST_BRACKETS", 5), ("MOST_MATRICES", 2), ("MAX_DESCRIBED", 9)):
        monkeypatch.setattr(html, name, most)
    monkeypatch.setattr(html, "MOST_ROWS", 3)
    pair = lh.pair("so(5)/so(4)")
    page = Balance(lh.pair_page(pair))
    assert "The first 5 of 30 brackets; the file of the pair has all." in page.text
    assert "The first 2 of 6 matrices." in page.text
    assert "ρ(e0) is 4 x 4 with 2 entries that are not 0: (0, 1): -1; (1, 0): 1" in page.text
    assert "g has dimension 10; structure is described here up to 9." in page.text
    assert lh.from_json(files(page)["pair.json"]) == pair
    monkeypatch.setattr(html, "MAX_FILE", 500)
    small = Balance(lh.pair_page(pair))
    assert set(files(small)) == {"certificate.json"}
    assert "Too large for this page: pair.json; liehom.dump writes such files." in small.text


def test_matrices_and_tables_say_what_is_left_out() -> None:
    assert "is shown" not in html.matrix_table(lh.QQ.identity(3), "A")
    many = html.matrix_table(lh.QQ.matrix([[1]] * 13), "A")
    assert "A is 13 x 1 with 13 entries that are not 0, first: (0, 0): 1; " in many and "(12, 0)" not in many
    assert "note" not in html.table(["n"], [[1]], "numbers", most=1)


# -- files ---------------------------------------------------------------------------------------------------
def test_a_page_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "page.html"
    assert lh.pair_page(verdict_of("dimension 1"), file) == file.read_text(encoding="utf-8") == page_of("dimension 1")
    monkeypatch.setattr(html, "decide_fullness", lambda pair: pytest.fail("decided before the folder was looked for"))
    with pytest.raises(lh.FormatError, match="does not exist"):
        lh.pair_page(lh.pair("so(4)/so(3)"), tmp_path / "no" / "page.html")
    with pytest.raises(lh.InputError, match="a pair or a verdict"):
        lh.pair_page("so(4)/so(3)")  # type: ignore[arg-type]


# -- in a browser --------------------------------------------------------------------------------------------
@needs_browser
def test_the_cone_turns_in_a_browser(tmp_path: Path) -> None:
    """The page as it is, then with a second script that turns the cone in all ways and prints what happened."""
    text = page_of("null cone in space")
    file = tmp_path / "page.html"
    file.write_text(text, encoding="utf-8")
    canvas = next(attributes for tag, attributes in Balance(dom(file, "data-angles")).elements if tag == "canvas")
    assert canvas["tabindex"] == "0"
    assert "arrow keys" in str(canvas["aria-label"])
    assert canvas["data-angles"] == "-2.18 0.38", "it is drawn: the policy of the page allows its script"


@pytest.mark.slow
@needs_browser
def test_the_cone_turns_by_keys_buttons_and_dragging(tmp_path: Path) -> None:
    uses = """
    const errors = []; window.addEventListener("error", (event) => errors.push(event.message));
    window.addEventListener("load", () => setTimeout(() => {
      const canvas = document.querySelector("canvas"), out = { errors };
      const angles = () => canvas.dataset.angles.split(" ").map(Number);
      const painted = () => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data
        .filter((x, i) => i % 4 === 3 && x > 0).length;
      out.first = angles(); out.painted = painted();
      for (const key of ["ArrowRight", "ArrowUp", "a"])
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
      out.keys = angles();
      document.querySelector("[aria-label='turn left']").click(); out.left = angles();
      document.querySelector("[aria-label='first position']").click(); out.reset = angles();
      canvas.setPointerCapture = () => {};
      const at = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, pointerId: 1 }));
      at("pointerdown", 10, 10); at("pointermove", 130, 70); out.dragged = angles(); out.then = painted();
      at("pointerup", 130, 70); at("pointermove", 0, 0); out.released = angles();
      window.dispatchEvent(new Event("beforeprint"));
      out.open = [...document.querySelectorAll("details")].every((part) => part.open);
      out.still = document.querySelector(".unturned").checkVisibility();
      document.body.replaceChildren(JSON.stringify(out));
    }, 200));
    """
    text = re.sub(
        '<meta http-equiv="Content-Security-Policy"[^>]*>', f"<script>{uses}</script>", page_of("null cone in space")
    )
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    out = json.loads(re.search(r"<body>(.*)</body>", dom(tmp_path / "page.html", "<body>{"), flags=re.DOTALL)[1])  # type: ignore[index]
    assert out["errors"] == []
    assert out["first"] == out["reset"] == [-2.18, 0.38]
    assert out["keys"] == [-2.08, 0.48]
    assert out["left"] == [-2.28, 0.48]
    assert out["dragged"] == out["released"] == [-1.18, 0.88]
    assert min(out["painted"], out["then"]) > 5000
    assert out["open"] is True
    assert out["still"] is False


@pytest.mark.parametrize(
    "coefficients",
    [[], [0], [0, 0], [1], [-1], [0, 1], [0, -1], [-2, 0, 1], [1, -1, 1], ["-1/2", "3/2", 0, -1], [0, 0, 2]],
)
def test_a_polynomial_on_a_page_has_the_given_coefficients(coefficients: list[Any]) -> None:
    theta = sympy.Symbol("θ")
    text = html._polynomial(lh.QQ, [lh.QQ.convert(c) for c in coefficients])
    wanted = sum((sympy.Rational(c) * theta**i for i, c in enumerate(coefficients)), sympy.Integer(0))
    assert sympy.expand(sympy.sympify(text.replace("^", "**"), {"θ": theta}) - wanted) == 0
    assert text and "+ -" not in text and not re.search(r"θ\^[01]\b|\b1\*?θ", text)
