"""The list of Theorem P as data: its keys differ, its lengths are those of the page, the names there are full pairs."""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

import liehom as lh
from liehom.exact.fullness.classification_rows import rows as library_rows

PAGE = (Path(__file__).resolve().parents[4] / "docs" / "theory" / "classification.md").read_text(encoding="utf-8")
Key = tuple[str, int, int, int, str, str]
"""Class, d, dimension s of S, dimension e of its commutant, centre, 'compact' or 'non-compact' in class C."""


def semisimple_parts(d: int) -> Iterator[tuple[str, int, int]]:
    """(name, s, e) of the algebras S of Theorem L in dimension d >= 2, with S = 0 for d = 2."""
    if d == 2:
        yield "0", 0, 4
    if d >= 3:
        yield "so", d * (d - 1) // 2, 1
    yield "sl", d * d - 1, 1
    if d % 2 == 0 and d >= 4:
        yield "sp", d * (d + 1) // 2, 1
    if d % 4 == 0 and d >= 8:
        m = d // 4
        yield "sp(m)+sp(1)", 2 * m * m + m + 3, 1
        yield "sl(m,H)+sp(1)", 4 * m * m + 2, 1
        yield "sl(m,H)", 4 * m * m - 1, 4
    yield from {7: [("g2", 14, 1)], 8: [("spin(7)", 21, 1)], 16: [("spin(9)", 36, 1), ("spin(9,1)", 45, 1)]}.get(d, [])
    if d % 2 == 0:
        m = d // 2
        if m >= 3:
            yield "su", m * m - 1, 2
        if m >= 2:
            yield "sl(m,C)", 2 * m * m - 2, 2
        if m >= 4 and m % 2 == 0:
            yield "sp(m,C)", m * m + m, 2
    if d % 4 == 0:
        yield "sp(m)", 2 * (d // 4) ** 2 + d // 4, 4


def rows(d: int) -> list[Key]:
    """The keys of all rows in dimension d >= 2; a family of spirals is one row."""
    parts = {name: (s, e) for name, s, e in semisimple_parts(d)}
    result: list[Key] = []
    for name, (s, e) in parts.items():
        centres = ["J", "C", "J+c"] if name == "0" else ["", "R"] if e == 1 else ["", "R", "J", "C", "J+c"]
        result += [("A", d, s, e, centre, "") for centre in centres]
    b = {"sl": "R", "sl(m,C)": "C", "sl(m,H)+sp(1)": "R", "so": "R", "spin(9,1)": "R", "0": "C"}
    result += [("B", d, *parts[name], centre, "") for name, centre in b.items() if name in parts]
    c = {"0": "J", "so": "", "su": "J", "sp(m)+sp(1)": "", "spin(9)": ""} | ({"sp(m)": "J"} if d == 4 else {})
    for sign in ("compact", "non-compact"):
        result += [("C", d, *parts[name], centre, sign) for name, centre in c.items() if name in parts]
    if d == 6:
        result.append(("C", d, *parts["su"], "", "compact"))
    if d == 7:
        result.append(("C", d, *parts["g2"], "", "compact"))
    return result


def test_keys_of_different_rows_are_different() -> None:
    for d in range(2, 301):
        assert max(Counter(rows(d)).values()) == 1


def test_the_rows_of_the_library_are_those_of_the_theorem() -> None:
    signs = {None: "", 1: "compact", -1: "non-compact"}
    for d in range(2, 61):
        assert sorted((*row.key[:5], signs[row.key.parameter]) for row in library_rows(d)) == sorted(rows(d))


def test_odd_dimensions_have_eight_rows_except_seven() -> None:
    assert {d: len(rows(d)) for d in range(3, 100, 2)} == {d: 11 if d == 7 else 8 for d in range(3, 100, 2)}


def table(header: str) -> list[list[str]]:
    """The cells of the table on the page whose first line is the header."""
    lines = PAGE[PAGE.index(header) :].split("\n\n", 1)[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_numbers_of_rows_on_the_page() -> None:
    printed = [[int(cell) for cell in line] for line in table("| $d$ | A | B | C | all |")]
    assert [line[0] for line in printed] == [*range(2, 11), 12, 16]
    for d, *counts, total in printed:
        letters = Counter(key[0] for key in rows(d))
        assert [letters[x] for x in "ABC"] == counts
        assert total == sum(counts)


def names(d: int) -> list[tuple[str, str]]:
    """(class, name) of the rows of dimension 2, 3 or 4 on the page."""
    lines = [line for line in table("| $d$ | class | rows |") if line[0] == str(d)]
    return [(line[1][0], name) for line in lines for name in re.findall("`([^`]+)`", line[2])]


@pytest.mark.parametrize("d", [2, 3, 4])
def test_names_on_the_page_are_the_rows_and_are_full(d: int) -> None:
    assert sorted(names(d)) == sorted((row.key.letter, row.name) for row in library_rows(d))
    keys = {}
    for letter, name in names(d):
        pair = lh.pair(name.replace("(c,1)", "(1,1)"))
        verdict = lh.decide_fullness(pair)
        assert verdict.full
        assert pair.dimension == d
        assert lh.verify_certificate(pair, verdict.certificate)
        rho = lh.Representation.from_matrices(pair.isotropy_matrices())
        s = rho.algebra.derived_subalgebra()
        e = len(rho.restriction(s).commutant()) if s.dimension else 4
        keys[name] = (letter, d, s.dimension, e)
    assert Counter(keys.values()) == Counter(key[:4] for key in rows(d))


@pytest.mark.parametrize(("name", "d"), [
    *(("so(d)", d) for d in range(3, 10)), *(("sl(d)", d) for d in range(2, 7)), *(("sp(d,R)", d) for d in (4, 6, 8)),
    *((n, d) for n in ("sp(m)+sp(1)", "sl(m,H)+sp(1)", "sp(m)", "sl(m,H)") for d in (8, 12)),
    *((n, 6) for n in ("su(n)", "sl(n,C)")), *((n, 8) for n in ("su(n)", "sl(n,C)", "sp(n,C)", "spin(7)")), ("g2", 7),
    ("spin(9)", 16), ("spin(9,1)", 16),
])  # fmt: skip
def test_dimensions_of_s_and_its_commutant(name: str, d: int) -> None:
    ours = {"so": "so(d)", "sl": "sl(d)", "sp": "sp(d,R)", "su": "su(n)", "sl(m,C)": "sl(n,C)", "sp(m,C)": "sp(n,C)"}
    expected = {ours.get(n, n): (s, e) for n, s, e in semisimple_parts(d)}[name]
    size = {"d": str(d), "n": str(d // 2), "m": str(d // 4)}
    rho = lh.catalog.representation(re.sub(r"(?<=\()[dnm](?=[,)])", lambda letter: size[letter[0]], name))
    assert (rho.size, rho.algebra.dimension, len(rho.commutant())) == (d, *expected)


@pytest.mark.parametrize("d", [3, 4, 5])
def test_a_subalgebra_between_h_and_g_excludes_full(d: int) -> None:
    """so(d-1) in so(d) in so(d+1): full implies maximal."""
    assert not lh.decide_fullness(lh.pair(f"so({d + 1})/so({d - 1})")).full


def test_maximal_does_not_imply_full() -> None:
    assert not lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")).full


def expanded(template: str, d: int) -> str:
    """The name of a row from one with d, m = d/2 and n = d/4."""
    size = {"d": d, "m": d // 2, "n": d // 4}
    return re.sub(r"(?<=\()([dmn])(\+1)?(?=[,)])", lambda x: str(size[x[1]] + bool(x[2])), template)


def test_the_concordance_names_every_row_once() -> None:
    templates = [name for line in table("| rows | [Tits54]") for name in re.findall("`([^`]+)`", line[0])]
    used = Counter(
        (name, d, template)
        for d in range(33)
        for name in {row.name for row in library_rows(d)}
        for template in templates
        if expanded(template, d) == name and (template != "affine(so(d))" or d > 2)
    )
    assert {(name, d) for name, d, _ in used} == {(row.name, d) for d in range(33) for row in library_rows(d)}
    assert len(used) == sum(len(library_rows(d)) for d in range(33))
    assert {template for *_, template in used} == set(templates)


def test_the_concordance_gives_each_source_the_rows_of_its_scope() -> None:
    scopes = {name: line[1:] for line in table("| rows | [Tits54]") for name in re.findall("`([^`]+)`", line[0])}
    compact = {
        "so(2)",
        "so(d)",
        "su(m)",
        "su(m)+u(1)",
        "sp(n)",
        "sp(n)+u(1)",
        "sp(n)+sp(1)",
        "g2",
        "spin(7)",
        "spin(9)",
    }
    for name, (isotropic, spheres, two_transitive, kernel) in scopes.items():
        inner = name[len("affine(") : -1] if name.startswith("affine") else ""
        parabolic = "/P" in name
        assert (spheres != "–") == (inner in compact), name
        assert (kernel != "–") == parabolic, name
        affine = bool(inner) and inner not in compact | {"spiral(c,1)"}
        assert (two_transitive != "–") == (parabolic or affine), name
        small = name in {"0/0", "R/0", "aff(1)/R"}
        assert (isotropic == "list") == (inner in compact or not (inner or parabolic or small)), name


def test_names_of_compact_rows_are_pairs_of_their_dimension() -> None:
    for d in (6, 7, 8):
        named = [row for row in library_rows(d) if row.key.letter == "C"]
        assert [lh.pair(row.name).dimension for row in named] == [d] * len(named)
