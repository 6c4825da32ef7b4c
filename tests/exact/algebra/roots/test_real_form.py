"""Real forms beside the tables of Helgason, ch. X: Satake diagrams, restricted roots, maximal compact subalgebras."""

import re

import numpy as np
import pytest

import liehom as lh
from liehom.exact.algebra.roots.diagrams import SatakeDiagram, VoganDiagram
from liehom.exact.algebra.roots.real_form import RealForm, canonical_ideals, complex_form, parse_name, real_forms_with
from liehom.exact.algebra.roots.root_system import root_system

EXCEPTIONAL_TYPES = ["E6", "E7", "E8", "F4", "G2"]
CLASSICAL_TYPES = [f"{x}{n}" for x, low in (("A", 1), ("B", 2), ("C", 3), ("D", 4)) for n in range(low, 9)]
FORMS = [form for name in CLASSICAL_TYPES + EXCEPTIONAL_TYPES for form in lh.real_forms(name)]

# Table VI of ch. X: restricted type, multiplicities by length, black nodes and arrows counted from 1, k
TABLE = {
    "e6(6)": ("E6", (1,), "", (), "sp(4)"), "e6(2)": ("F4", (2, 1), "", ((1, 6), (3, 5)), "su(6)+su(2)"),
    "e6(-14)": ("BC2", (8, 6, 1), "345", ((1, 6),), "so(10)+u(1)"), "e6(-26)": ("A2", (8,), "2345", (), "f4"),
    "e7(7)": ("E7", (1,), "", (), "su(8)"), "e7(-5)": ("F4", (4, 1), "257", (), "so(12)+su(2)"),
    "e7(-25)": ("C3", (8, 1), "2345", (), "e6+u(1)"), "e8(8)": ("E8", (1,), "", (), "so(16)"),
    "e8(-24)": ("F4", (8, 1), "2345", (), "e7+su(2)"), "f4(4)": ("F4", (1, 1), "", (), "sp(3)+su(2)"),
    "f4(-20)": ("BC1", (8, 7), "123", (), "so(9)"), "g2(2)": ("G2", (1, 1), "", (), "su(2)+su(2)"),
}  # fmt: skip


def series(letter, rank):
    """B_1 and C_1 are A_1, C_2 is written B_2, D_3 is A_3."""
    return {"B1": "A1", "C1": "A1", "C2": "B2", "D3": "A3"}.get(f"{letter}{rank}", f"{letter}{rank}")


def lengths(rank, *multiplicities):
    """Of the rank-one systems only one of two lengths is there; in BC_1 the middle one is missing."""
    if len(multiplicities) == 3:
        return multiplicities if rank > 1 else multiplicities[::2]
    return multiplicities


def expected_restricted(form):
    """Restricted type and multiplicities of the classical forms."""
    kind, numbers, letter = parse_name(form.name)
    if kind == "sl":
        return series("A", numbers[0] - 1), (4,) if letter == "H" else (1,)
    if kind == "so*":
        half, odd = numbers[0] // 4, numbers[0] // 2 % 2
        return (f"BC{half}", lengths(half, 4, 4, 1)) if odd else (series("C", half), (4, 1))
    if letter == "R":
        return series("C", numbers[0] // 2), (1, 1)
    p, q = numbers
    if kind == "so":
        if p == q:
            return series("D", q), (1,)
        return series("B", q), (p - q, 1) if q > 1 else (p - q,)
    scale, long = (2, 1) if kind == "su" else (4, 3)
    if p == q:
        return series("C", q), (scale, long) if q > 1 else (long,)
    return f"BC{q}", lengths(q, scale * (p - q), scale, long)


def expected_satake(form):
    """Black nodes and arrows of the classical forms, counted from 1."""
    kind, numbers, letter = parse_name(form.name)
    n = form.rank
    if kind == "sl":
        return (range(1, n + 1, 2) if letter == "H" else ()), ()
    if kind == "so*":
        return (range(1, n, 2), [(n - 1, n)]) if n % 2 else ([*range(1, n - 2, 2), n], ())
    if letter == "R":
        return (), ()
    p, q = numbers
    if kind == "su":
        return range(q + 1, p), [(i, p + q - i) for i in range(1, q + 1) if i != p + q - i]
    if kind == "sp":
        return [*range(1, 2 * q, 2), *range(2 * q + 1, n + 1)], ()
    if p - q == 2:
        return (), [(n - 1, n)]
    return (range(q + 1, n + 1) if p > q else ()), ()


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.name)
def test_satake_diagrams_agree_with_the_table_of_helgason(form):
    satake = form.satake
    black, arrows = tuple(i + 1 for i in satake.black), tuple((i + 1, j + 1) for i, j in satake.arrows)
    restricted = (form.restricted_type, tuple(form.multiplicities.values()))
    if form.is_compact:
        assert (restricted, black, arrows) == (("0", ()), tuple(range(1, form.rank + 1)), ())
    elif form.name in TABLE:
        kind, times, nodes, pairs, compact = TABLE[form.name]
        assert (restricted, black, arrows) == ((kind, times), tuple(map(int, nodes)), pairs)
        assert form.maximal_compact == compact
    else:
        assert restricted == expected_restricted(form)
        assert (black, arrows) == tuple(map(tuple, expected_satake(form)))


@pytest.mark.parametrize(
    "form",
    FORMS + [complex_form(name) for name in CLASSICAL_TYPES[::3] + EXCEPTIONAL_TYPES],
    ids=lambda form: form.name,
)
def test_vogan_and_satake_diagrams_give_equal_dimensions(form):
    satake = form.satake
    multiplicities = satake.restricted_roots()
    assert form.dimension == satake.anisotropic_dimension + form.real_rank + sum(multiplicities.values())
    assert satake.compact_dimension == form.compact_dimension
    assert form.character == form.dimension - 2 * form.compact_dimension
    assert RealForm.of_name(form.name) == form
    # the restricted roots are a root system whose Weyl group keeps the multiplicities: reflect in all of them
    system = satake.root_system()
    roots = np.array(list(multiplicities), dtype=np.int64).reshape(len(multiplicities), system.rank)
    gram = np.array(system.cartan) * np.array(system.norms) // 2
    for root in roots[: len(roots) // 2 : 5]:
        moved = roots - np.outer(2 * (roots @ gram @ root) // (root @ gram @ root), root)
        assert {tuple(x): m for x, m in zip(moved.tolist(), multiplicities.values(), strict=True)} == multiplicities


def semisimple_part(name):
    """The types of the simple ideals of a compact algebra by its name, and the dimension of its centre."""
    types, center = [], 0
    for part in name.split("+"):
        if part in ("u(1)", "so(2)"):
            center += 1
            continue
        if part.startswith("u("):
            center, part = center + 1, f"s{part}"
        types += [RealForm.of_name(ideal).type for ideal in canonical_ideals(part)]
    return sorted(types), center


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.name)
def test_the_name_of_the_maximal_compact_subalgebra_is_that_of_the_fixed_algebra(form):
    kind, center = form.vogan.maximal_compact_type()
    assert semisimple_part(form.maximal_compact) == ([x for x in kind.split(" + ") if x != "0"], center)


@pytest.mark.parametrize(("type_name", "names"), [
    ("A1", "sl(2,R) so(3)"), ("A3", "sl(4,R) su(2,2) su(3,1) sl(2,H) su(4)"), ("C2", "so(3,2) so(4,1) so(5)"),
    ("B3", "so(4,3) so(5,2) so(6,1) so(7)"), ("C3", "sp(6,R) sp(2,1) sp(3)"),
    ("D3", "sl(4,R) su(2,2) su(3,1) sl(2,H) su(4)"), ("D4", "so(4,4) so(5,3) so(6,2) so(7,1) so(8)"),
    ("D5", "so(5,5) so(6,4) so(7,3) so*(10) so(8,2) so(9,1) so(10)"), ("E6", "e6(6) e6(2) e6(-14) e6(-26) e6"),
    ("E7", "e7(7) e7(-5) e7(-25) e7"), ("E8", "e8(8) e8(-24) e8"), ("F4", "f4(4) f4(-20) f4"), ("G2", "g2(2) g2"),
])  # fmt: skip
def test_lists_of_real_forms(type_name, names):
    forms = lh.real_forms(type_name)
    assert [form.name for form in forms] == names.split()
    assert forms[0].is_split
    assert forms[-1].is_compact
    for form in forms:
        shown = re.fullmatch(r"[efg]\d\((-?\d+)\)", form.name)
        assert shown is None or int(shown[1]) == form.character


def test_every_involution_gives_a_form_of_the_list():
    """All Vogan diagrams with one painted node or none, on all diagram involutions of D4, D5 and E6."""
    for name in ("D4", "D5", "E6", "A5"):
        system = root_system(name)
        listed = {form.satake for form in lh.real_forms(name)}
        flips = {"D4": (0, 1, 3, 2), "D5": (0, 1, 2, 4, 3), "E6": (5, 1, 4, 3, 2, 0), "A5": (4, 3, 2, 1, 0)}
        diagrams = {
            SatakeDiagram.of(VoganDiagram(name, painted, sigma))
            for sigma in (tuple(range(system.rank)), flips[name])
            for painted in [(), *((i,) for i in range(system.rank) if sigma[i] == i)]
        }
        assert diagrams == listed


def test_several_forms_may_have_one_character():
    assert [form.name for form in real_forms_with("A13", -15)] == ["su(9,5)", "sl(7,H)"]
    assert real_forms_with("A13", -15)[0].real_rank == 5
    assert real_forms_with("A13", -15)[1].real_rank == 6
    assert [form.name for form in real_forms_with("D9", -9)] == ["so(12,6)", "so*(18)"]
    assert [form.real_rank for form in real_forms_with("E8", -24)] == [4]
    assert real_forms_with("E8", 1) == []


def test_complex_simple_algebras_as_real_forms():
    form = complex_form("E8")
    assert (form.name, form.type, form.is_complex, form.dimension) == ("e8(C)", "E8", True, 496)
    assert (form.maximal_compact, form.compact_dimension, form.real_rank, form.rank) == ("e8", 248, 8, 16)
    assert (form.restricted_type, form.multiplicities) == ("E8", {"all": 2})
    assert form.satake.arrows == tuple((i, i + 8) for i in range(8))
    names = {"A2": "sl(3,C)", "B2": "so(5,C)", "C2": "so(5,C)", "C3": "sp(6,C)", "D3": "sl(4,C)", "D4": "so(8,C)"}
    assert {name: complex_form(name).name for name in names} == names
    assert not RealForm.of_name("so(4,1)").is_complex


def test_satake_diagram_as_a_graph():
    graph = lh.RealForm.of_name("e6(-14)").satake_diagram()
    assert {i for i, black in graph.nodes(data="black") if black} == {2, 3, 4}
    assert {(i, j) for i, j in graph.nodes(data="arrow") if j is not None} == {(0, 5), (5, 0)}
    assert graph.number_of_edges() == 10


@pytest.mark.parametrize(
    ("black", "arrows"), [((), ((0, 1),)), ((1,), ((0, 1),)), ((7,), ()), ((), ((0, 2), (2, 1))), ((), ((0, 4),))]
)
def test_invalid_satake_diagram_raises_input_error(black, arrows):
    with pytest.raises(lh.errors.InputError):
        SatakeDiagram("A3", black, arrows)


@pytest.mark.parametrize("name", ["D2", "A1 + A1", "X4", "E9", "0"])
def test_type_that_is_not_simple_raises_catalog_error(name):
    for function in (lh.real_forms, complex_form):
        with pytest.raises(lh.errors.CatalogError):
            function(name)


def test_name_of_a_sum_raises_catalog_error():
    with pytest.raises(lh.errors.CatalogError, match=r"sl\(2,R\) \+ sl\(2,R\)"):
        RealForm.of_name("so(2,2)")
