"""Compact forms, and real forms from Vogan diagrams: Jacobi, Cartan decompositions, real ranks, every form."""

import random

import pytest

import liehom as lh
from liehom.exact.algebra.constructions.classical import real_form_builders
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.roots.chevalley import compact_form, real_form_of
from liehom.exact.algebra.roots.diagrams import VoganDiagram
from liehom.exact.algebra.roots.real_form import complex_form, real_forms

TYPES = ["A1", "A2", "A3", "A4", "B2", "B3", "C3", "C4", "D4", "D5", "E6", "E7", "F4", "G2"]
COMPLEX = ["A1", "A2", "A3", "B2", "C3", "F4", "G2"]
FORMS = [form for name in TYPES for form in real_forms(name)] + [complex_form(name) for name in COMPLEX]


@pytest.mark.parametrize("name", ["A1", "A3", "B3", "C3", "G2", "A1 + B2"])
def test_compact_forms_are_compact(name):
    g = compact_form(name)
    prove_jacobi(g.table, g.basis_names)
    assert g.table.den == 1
    assert g.killing_signature() == (0, g.dimension, 0)


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.name)
def test_real_forms_from_vogan_diagrams(form):
    g = real_form_of(form.vogan, form.name)
    prove_jacobi(g.table, g.basis_names)
    assert g.table.den == 1
    k = form.compact_dimension
    assert g.dimension == form.dimension
    for i, j, target, _ in g.structure_constants():
        assert (target < k) == ((i < k) == (j < k))  # [k, k] and [p, p] in k, [k, p] in p
    # on k the Killing form is negative, on p positive: the eigenspaces of a Cartan involution
    killing = g.killing_form()
    assert killing.select(rows=range(k), columns=range(k, g.dimension)).is_zero()
    assert killing.select(rows=range(k), columns=range(k)).signature() == (0, k, 0)
    p = range(k, g.dimension)
    assert killing.select(rows=p, columns=p).signature() == (len(p), 0, 0)


@pytest.mark.parametrize("form", [form for form in FORMS if not form.is_compact], ids=lambda form: form.name)
def test_the_centralizer_of_a_generic_element_of_p_is_a_plus_m(form):
    """A Cartan subspace a of p and its centralizer m in k, whose dimensions the Satake diagram gives."""
    g = real_form_of(form.vogan)
    randomness = random.Random(form.name)
    k = form.compact_dimension
    x = [0] * k + [randomness.randint(-99, 99) for _ in range(g.dimension - k)]
    assert g.centralizer([x]).dimension == form.real_rank + form.satake.anisotropic_dimension


@pytest.mark.slow
@pytest.mark.parametrize("form", real_forms("E8"), ids=lambda form: form.name)
def test_real_forms_of_e8(form):
    g = real_form_of(form.vogan)
    prove_jacobi(g.table, g.basis_names)
    assert g.killing_signature() == (248 - form.compact_dimension, form.compact_dimension, 0)


@pytest.mark.parametrize("type_name", ["A1", "A2", "A3", "B2", "B3", "C2", "C3", "D3", "D4", "G2", "E7"])
def test_constructions_are_the_forms_that_their_names_say(type_name):
    """The algebras of matrices have the signatures that the Vogan diagrams of their names give."""
    canonical = set()
    for name in real_form_builders(type_name):
        g, form = lh.simple(type_name, name), lh.RealForm.of_name(name)
        canonical.add(form.name)
        assert g.name == name
        assert g.killing_signature() == (form.dimension - form.compact_dimension, form.compact_dimension, 0)
    assert canonical == {form.name for form in real_forms(type_name)}


def test_e8_by_its_three_forms():
    for name, k in (("split", 120), ("e8(-24)", 136), ("e8(-248)", 248)):
        assert lh.simple("E8", name).killing_signature() == (248 - k, k, 0)


@pytest.mark.parametrize(("type_name", "alias", "name"), [
    ("A1", "so(3)", "su(2)"), ("A1", "split", "sl(2)"), ("A3", "so(5,1)", "sl(2,H)"), ("A3", "compact", "su(4)"),
    ("D3", "compact", "so(6)"), ("B2", "sp(4, R)", "so(3,2)"), ("C2", "so(4,1)", "sp(1,1)"), ("D4", "so*(8)", "so*(8)"),
    ("B3", "so(3,4)", "so(4,3)"), ("G2", "g2(-14)", "g2"), ("F4", "f4(-52)", "f4"), ("E6", "e6(-78)", "e6"),
    ("E7", "e7(-133)", "e7"), ("E7", "split", "e7(7)"), ("A2", "complex", "sl(3,C)"), ("B2", "sp(4,C)", "so(5,C)"),
    ("G2", "complex", "g2(C)"),
])  # fmt: skip
def test_other_names_of_forms(type_name, alias, name):
    assert lh.simple(type_name, alias).name == name


def test_complex_algebras_are_realifications():
    for type_name in ("A2", "C3", "G2"):
        g, split = lh.simple(type_name, "complex"), lh.simple(type_name)
        assert g.dimension == 2 * split.dimension
        assert g.killing_signature() == (split.dimension, split.dimension, 0)


@pytest.mark.parametrize(("painted", "automorphism"), [
    ((5,), ()), ((0,), (2, 1, 0)), ((), (1, 0, 2)), ((), (1, 2, 0)), ((), (0, 1)), ((-1,), ()),
])  # fmt: skip
def test_invalid_vogan_diagram_raises_input_error(painted, automorphism):
    with pytest.raises(lh.errors.InputError):
        VoganDiagram("A3", painted, automorphism)


def test_several_painted_nodes_are_legal_and_give_one_of_the_forms():
    """Borel and de Siebenthal: one painted node is always enough."""
    known = {form.character for form in real_forms("F4")}
    for mask in range(16):
        painted = tuple(i for i in range(4) if mask >> i & 1)
        assert VoganDiagram("F4", painted).character in known
