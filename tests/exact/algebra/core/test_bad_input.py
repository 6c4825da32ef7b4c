"""Input of users: malformed tables, numbers of every kind, dimension zero, fractions of a million digits."""

import inspect
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from scipy import sparse

import liehom as lh
from liehom.base.errors import CatalogError, FieldError, InputError, JacobiError, ShapeError, StructureError

half = sympy.Rational(1, 2)


def table_of(g: lh.LieAlgebra) -> Any:
    """The dense integer table of an algebra."""
    return np.asarray(g.table.dense(), dtype=int).reshape((g.dimension,) * 3)


SO3 = table_of(lh.so(3))


# -- tables that define no Lie algebra -----------------------------------------------------------------------
@pytest.mark.parametrize(("constants", "indices", "value"), [
    ({(0, 1): {0: 1}, (0, 2): {1: 1}}, (0, 1, 2), {1: "1"}),
    ({(1, 2): {3: half}, (3, 4): {0: sympy.Rational(2, 3)}}, (1, 2, 4), {0: "1/3"}),
    ({(0, 1): {0: "sqrt(2)"}, (0, 2): {1: 1}}, (0, 1, 2), {1: "sqrt(2)"}),
], ids=["integers", "fractions", "square roots"])  # fmt: skip
def test_a_jacobi_failure_names_the_triple_and_the_value(constants: Any, indices: Any, value: Any) -> None:
    with pytest.raises(JacobiError, match="expected 0") as caught:
        lh.LieAlgebra(constants, dimension=5)
    assert (caught.value.indices, caught.value.value) == (indices, value)
    assert str(indices) in str(caught.value)


def test_a_jacobi_failure_in_a_large_dense_table() -> None:
    """The proof by generators finds it too, and names a triple that fails."""
    g = lh.sl(4)
    n = g.dimension
    change = lh.QQ.matrix([[1 if i == j else (i + 2 * j) % 3 - 1 if i < j else 0 for j in range(n)] for i in range(n)])
    table = table_of(g.change_of_basis(change))
    table[2, 5, 7] += 1
    table[5, 2, 7] -= 1
    with pytest.raises(JacobiError) as caught:
        lh.LieAlgebra(table)
    i, j, k = caught.value.indices
    total = np.zeros(n, dtype=int)
    for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
        total += table[a, b] @ table[:, c]
    assert {x: str(v) for x, v in enumerate(total) if v} == caught.value.value


def test_a_jacobi_failure_over_floats() -> None:
    with pytest.raises(JacobiError) as caught:
        lh.LieAlgebra({(0, 1): {0: 1.0}, (0, 2): {1: 1.0}}, dimension=3)
    assert "FloatField" not in str(caught.value)


@pytest.mark.parametrize("size", [1e-7, 1e-4])
@pytest.mark.parametrize("n", [4, 7])
def test_a_jacobi_failure_of_noisy_numbers_names_the_tolerance_that_admits_them(n: int, size: float) -> None:
    rng = np.random.default_rng(n)
    table = table_of(lh.so(n)).astype(float)
    noise = rng.standard_normal(table.shape)
    table = table + (noise - noise.transpose(1, 0, 2)) * (size * np.linalg.norm(table) / np.linalg.norm(noise))
    with pytest.raises(JacobiError, match=r"relative error of .*FloatField\(rtol=1e-\d+\)") as caught:
        lh.LieAlgebra(table)
    rtol = float(str(caught.value).split("rtol=")[1].rstrip(")"))
    assert 0.01 * size < rtol <= 10 * size
    assert lh.LieAlgebra(table, field=lh.FloatField(rtol=rtol)).dimension == n * (n - 1) // 2


def test_a_table_that_is_not_antisymmetric() -> None:
    with pytest.raises(StructureError, match=r"c\[0, 1, 1\] = 1 but c\[1, 0, 1\] = 1, expected -1"):
        lh.LieAlgebra({(0, 1): {1: 1}, (1, 0): {1: 1}})
    with pytest.raises(StructureError, match=r"c\[1, 1, 0\] = 1/2.*expected 0"):
        lh.LieAlgebra({(1, 1): {0: half}})
    for table in (np.abs(SO3), sparse.coo_array(np.abs(SO3).reshape(9, 3)), np.abs(SO3) * 0.5):
        with pytest.raises(StructureError, match="not antisymmetric"):
            lh.LieAlgebra(table)


@pytest.mark.parametrize(("constants", "error"), [
    *((x, ShapeError) for x in ([[[0, 1], [2]], [[0]]], [[0, 1], [1, 0]], np.zeros((0, 3, 3)), np.zeros((2, 2, 3)))),
    *((x, StructureError) for x in (3, None, "so(3)", np.full((2, 2, 2), np.nan))),
    (sparse.coo_array(np.eye(3, dtype=int)), ShapeError),
], ids=["jagged", "matrix", "0 x 3 x 3", "2 x 2 x 3", "number", "none", "name", "nan", "sparse"])  # fmt: skip
def test_malformed_constants_raise(constants: Any, error: type[lh.LiehomError]) -> None:
    with pytest.raises(error):
        lh.LieAlgebra(constants)


@pytest.mark.parametrize("table", [
    {("0", 1): {1: 1}}, {(0, 1): {"1": 1}}, {"01": {1: 1}}, {(0, 1.0): {1: 1}}, {(0, 1, 2): {1: 1}}, {(0, 1): [0, 1]},
    {(0, 1): 1}, {3: {1: 1}},
])  # fmt: skip
@pytest.mark.parametrize("field", [None, lh.number_field("sqrt(2)")])
@pytest.mark.parametrize("dimension", [None, 2])
def test_malformed_mappings(table: Any, field: Any, dimension: int | None) -> None:
    with pytest.raises(StructureError):
        lh.LieAlgebra(table, field=field, dimension=dimension)


@pytest.mark.parametrize("dimension", [-1, 2.5, "3"])
def test_invalid_dimensions_raise(dimension: Any) -> None:
    with pytest.raises(ShapeError, match="dimension"):
        lh.LieAlgebra({}, dimension=dimension)


def test_a_table_keeps_its_field_and_dimension() -> None:
    table = lh.so(3).table
    assert lh.LieAlgebra(table, field=lh.QQ, dimension=3) == lh.so(3)
    with pytest.raises(InputError, match=r"over\(\)"):
        lh.LieAlgebra(table, field=lh.number_field("sqrt(2)"))
    with pytest.raises(InputError, match="dimension 3"):
        lh.LieAlgebra(table, dimension=4)


# -- numbers -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("value", [
    0.5, np.float64(0.5), np.float32(0.5), Decimal("0.5"), sympy.Float("0.5"),
], ids=["float", "float64", "float32", "decimal", "sympy"])  # fmt: skip
def test_a_float_where_exactness_was_asked_for(value: Any) -> None:
    g = lh.so(3)
    calls: list[Callable[[], Any]] = [
        lambda: lh.LieAlgebra({(0, 1): {1: value}}, lh.QQ),
        lambda: lh.LieAlgebra([[[0, 0], [0, value]], [[0, -value], [0, 0]]], lh.QQ),
        lambda: g.subalgebra([[0, 0, value]]), lambda: g.bracket([value, 0, 0], [0, 1, 0]),
        lambda: g.ad([value, 0, 0]), lambda: g.change_of_basis([[value, 0, 0], [0, 1, 0], [0, 0, 1]]),
        lambda: g.centralizer([[value, 0, 0]]), lambda: lh.Representation(lh.so(2), [[[0, value], [-value, 0]]]),
        lambda: lh.catalog.representation("so(3)").subrepresentation([[value, 0, 0]]),
        lambda: lh.algebra.central_extension(lh.abelian(2), [[0, value], [-value, 0]]),
        lambda: lh.so(2).cohomology(1, [[[0, value], [-value, 0]]]),
        lambda: lh.semidirect_sum(lh.so(2), [[[0, value], [-value, 0]]]),
        lambda: lh.algebra.Homomorphism(g, g, [[value, 0, 0], [0, 1, 0], [0, 0, 1]]),
    ]  # fmt: skip
    for call in calls:
        with pytest.raises(FieldError, match="write a fraction such as '1/2'"):
            call()


def test_floats_alone_call_for_float64() -> None:
    assert lh.LieAlgebra(SO3 * 0.5).field == lh.RR
    assert lh.LieAlgebra({(0, 1): {1: 0.5}, (0, 2): {2: half}}).field == lh.RR
    assert lh.LieAlgebra({(0, 1): {1: sympy.Float("0.5")}}).field == lh.RR


@pytest.mark.parametrize(("value", "error"), [
    *((x, FieldError) for x in (sympy.Symbol("a"), sympy.pi, sympy.I, sympy.nan, sympy.zoo, 1j, None, True)),
    *((x, FieldError) for x in (float("nan"), float("inf"))), *((x, lh.ParseError) for x in ("0.5", "x", "")),
    ("1/0", InputError),
], ids=str)  # fmt: skip
def test_values_that_are_not_numbers_raise(value: Any, error: type[lh.LiehomError]) -> None:
    with pytest.raises(error):
        lh.LieAlgebra({(0, 1): {1: value}})
    with pytest.raises(InputError):
        lh.so(3).bracket([value, 0, 0], [0, 1, 0])


# -- sympy, numpy, fractions, everywhere ---------------------------------------------------------------------
def test_tables_in_every_form() -> None:
    nested = SO3.tolist()
    numbers = [
        [[[kind(x) for x in row] for row in block] for block in nested] for kind in (sympy.Integer, Fraction, str)
    ]
    tables = [
        *(nested, tuple(tuple(tuple(row) for row in block) for block in nested), *numbers, SO3, SO3.astype(object)),
        *(kind(nested) for kind in (sympy.Array, sympy.ImmutableDenseNDimArray, sympy.MutableSparseNDimArray)),
        *(
            [sympy.Matrix(block) for block in nested],
            *(f(SO3.reshape(9, 3)) for f in (sparse.coo_array, sparse.csr_array)),
        ),
        {(sympy.Integer(0), 1): {2: 1}, (0, np.int64(2)): {1: -1}, (1, 2): {np.int8(0): sympy.Integer(1)}},
    ]
    for table in tables:
        assert lh.LieAlgebra(table) == lh.so(3)
    assert lh.LieAlgebra(sympy.Array(nested) * half).bracket([1, 0, 0], [0, 1, 0])[2] == lh.QQ.convert("1/2")
    assert lh.LieAlgebra(sympy.Array(nested) * sympy.sqrt(2)).field.name == "QQ(sqrt(2))"


@pytest.mark.parametrize(
    "rows",
    [
        *(kind([[0, 0, half]]) for kind in (sympy.Matrix, sympy.ImmutableMatrix, sympy.SparseMatrix, sympy.Array)),
        *([sympy.Matrix([0, 0, half])], [sympy.Matrix([[0, 0, half]])], [sympy.Array([0, 0, half])]),
        *([(0, 0, Fraction(1, 2))], np.array([[0, 0, half]]), np.array([[0, 0, 1]])),
        *(sympy.Matrix([[0, 0, half]]).to_DM(), sparse.csr_array(np.array([[0, 0, 1]])), lh.QQ.matrix([[0, 0, "1/2"]])),
    ],
    ids=lambda rows: type(rows).__name__ + ("" if not isinstance(rows, list) else f" of {type(rows[0]).__name__}"),
)
def test_rows_in_every_form(rows: Any) -> None:
    g = lh.so(3)
    h = g.subalgebra([[0, 0, 1]])
    assert g.subalgebra(rows) == h
    assert g.subalgebra_generated_by(rows) == h
    assert g.centralizer(rows) == h
    assert lh.Pair(g, rows).dimension == 2
    assert lh.scalars.Subspace(lh.QQ, rows, 3) == h.subspace
    assert lh.heisenberg(1).quotient(rows).is_abelian()


@pytest.mark.parametrize("x", [
    [0, half, 0], (0, Fraction(1, 2), 0), sympy.Matrix([0, half, 0]), sympy.Matrix([[0, half, 0]]),
    sympy.Array([0, half, 0]), np.array([0, half, 0]), ["0", "1/2", 0],
], ids=["list", "tuple", "column", "row", "Array", "numpy", "texts"])  # fmt: skip
def test_elements_and_points_in_every_form(x: Any) -> None:
    g = lh.so(3)
    assert list(g.bracket([1, 0, 0], x)) == [0, 0, lh.QQ.convert("1/2")]
    assert g.ad(x) == g.ad([0, "1/2", 0])
    assert x in g.subalgebra([[0, 1, 0]])
    rep = lh.catalog.representation("so(3)")
    assert rep.isotropy(x) == rep.isotropy([0, 1, 0])
    assert rep.orbit_dimension(x) == 2


def test_matrices_in_every_form() -> None:
    rows = [[[0, 1], [0, 0]], [[0, 0], [half, 0]]]
    forms = [
        rows, [sympy.Matrix(m) for m in rows], [sympy.ImmutableSparseMatrix(m) for m in rows],
        [sympy.Matrix(m).to_DM() for m in rows], sympy.Array(rows), np.array(rows), [lh.QQ.matrix(rows[0]), rows[1]],
        [sparse.coo_array(np.array(rows[0])), rows[1]],
    ]  # fmt: skip
    expected = lh.LieAlgebra.from_matrices([[["0", 1], [0, 0]], [[0, 0], ["1/2", 0]]])
    for matrices in forms:
        assert lh.LieAlgebra.from_matrices(matrices) == expected
    rotation = sympy.Matrix([[0, -1], [1, 0]])
    assert lh.Representation(lh.so(2), [rotation]).size == 2
    assert lh.semidirect_sum(lh.so(2), [rotation]) == lh.euclidean(2)
    assert lh.affine_of([rotation]) == lh.euclidean(2)
    assert lh.algebra.almost_abelian(rotation) == lh.euclidean(2)
    assert lh.so(2).cohomology(0, [rotation]).dimension == 0
    assert lh.algebra.Homomorphism(lh.so(3), lh.so(3), sympy.eye(3)).is_isomorphism()
    assert lh.so(3).change_of_basis(sympy.eye(3)) == lh.so(3)
    surd = lh.LieAlgebra.from_matrices([sympy.Matrix([[0, sympy.sqrt(2)], [0, 0]]), sympy.Matrix([[0, 0], [1, 0]])])
    assert surd.field.name == "QQ(sqrt(2))"


# -- rows, matrices and maps that are not what they should be ------------------------------------------------
def test_rows_that_do_not_span_a_subalgebra_raise() -> None:
    g = lh.so(3)
    with pytest.raises(lh.errors.DependentRowsError) as dependent:
        g.subalgebra([[0, 0, 1], [0, 0, half], [1, 0, 0]])
    assert dependent.value.dependent == [1]
    with pytest.raises(lh.NotASubalgebraError, match=r"rows 0 and 1 is \(0, 0, 1/2\)") as leaving:
        g.subalgebra([[1, 0, 0], [0, half, 0]])
    assert leaving.value.pair == (0, 1)
    with pytest.raises(lh.errors.DependentRowsError):
        g.subalgebra([[0, 0, 0]])


@pytest.mark.parametrize("rows", [[[1, 0]], [1, 0, 0], 3, "abc", ["abc"], [[1, 0, 0], [1]], [[[1], 0, 0]], None])
def test_malformed_rows_raise(rows: Any) -> None:
    g = lh.so(3)
    for call in (g.subalgebra, g.subalgebra_generated_by, g.centralizer, g.quotient):
        with pytest.raises(InputError):
            call(rows)


@pytest.mark.parametrize("x", [[1, 0], [1, 0, 0, 0], 3, "abc", None, [[1, 0, 0]]])
def test_malformed_elements_raise(x: Any) -> None:
    g = lh.so(3)
    for call in (g.ad, lambda x: g.bracket(x, [1, 0, 0]), lambda x: g.bracket([1, 0, 0], x)):
        with pytest.raises(InputError):
            call(x)


@pytest.mark.parametrize("matrices", [3, "abc", None, [], [3], [[1, 2]], [[[1, 2]]], [[[1], [2, 3]]], [[["x"]]]])
def test_malformed_matrices_raise(matrices: Any) -> None:
    with pytest.raises(InputError):
        lh.LieAlgebra.from_matrices(matrices)


def test_invalid_representations_maps_and_cocycles_raise() -> None:
    with pytest.raises(lh.RepresentationError) as caught:
        lh.Representation(lh.so(3), [sympy.eye(2)] * 3)
    assert caught.value.pair == (0, 1)
    with pytest.raises(InputError):
        lh.algebra.Homomorphism(lh.so(3), lh.so(3), sympy.eye(3) * 2)
    with pytest.raises(ShapeError):
        lh.so(3).change_of_basis(sympy.eye(2))
    with pytest.raises(lh.errors.CocycleError):
        lh.algebra.central_extension(
            lh.heisenberg(2), sympy.Matrix(5, 5, lambda i, j: {(0, 4): 1, (4, 0): -1}.get((i, j), 0))
        )


# -- dimension zero ------------------------------------------------------------------------------------------
ZERO = {
    "QQ": lh.abelian(0),
    "a number field": lh.abelian(0).over(lh.number_field("sqrt(2)")),
    "float64": lh.abelian(0).over(lh.RR),
}
ARGUMENTS: dict[str, Any] = {"x": [], "y": [], "rows": [], "ideal": [], "degree": 1}


def public_methods() -> list[str]:
    """The public methods of LieAlgebra for which `ARGUMENTS` has what they need."""
    methods = [x for x in inspect.getmembers(lh.LieAlgebra, inspect.isfunction) if not x[0].startswith("_")]
    known = {"self", *ARGUMENTS, "subalgebra", "other", "field"}
    return [name for name, method in methods if known.issuperset(needed(method))]


def needed(method: Callable[..., Any]) -> list[str]:
    return [p.name for p in inspect.signature(method).parameters.values() if p.default is p.empty]


def test_the_public_methods_are_listed() -> None:
    names = {"ad", "bracket", "cohomology", "derivations", "killing_form", "normalizer", "quotient"}
    assert names <= set(public_methods())


@pytest.mark.parametrize("name", public_methods())
@pytest.mark.parametrize("field", ZERO)
def test_every_method_is_legal_in_dimension_zero(field: str, name: str) -> None:
    g = ZERO[field]
    arguments = {**ARGUMENTS, "subalgebra": g.center(), "other": g, "field": g.field}
    try:
        getattr(g, name)(*(arguments[x] for x in needed(getattr(g, name))))
    except lh.UndecidedError as error:
        assert not g.field.exact and "lh.rationalize" in str(error)  # some questions are for exact fields only


def test_answers_in_dimension_zero() -> None:
    g = lh.LieAlgebra({})
    assert g == lh.LieAlgebra([]) == lh.LieAlgebra(np.zeros((0, 0, 0), dtype=int)) == lh.abelian(0)
    assert (g.dimension, g.is_abelian(), g.killing_signature()) == (0, True, (0, 0, 0))
    assert [s.dimension for s in g.derived_series()] == [s.dimension for s in g.lower_central_series()] == [0]
    assert g.center().dimension == g.derivations().dimension == 0
    assert [g.cohomology(k).dimension for k in range(3)] == [1, 0, 0]
    assert g.index() == len(g.casimirs(2)) == 0
    assert g.subalgebra([]) == g.center()
    assert [] in g.center()
    assert g.center().quotient_algebra() == g.center().as_algebra() == g
    assert lh.direct_sum(g, lh.so(3)) == lh.so(3)
    assert g.complexification().complex_dimension == 0
    assert lh.algebra.Homomorphism(g, g, []).is_isomorphism()
    assert lh.algebra.Homomorphism(lh.so(3), g, []).kernel().dimension == 3
    assert lh.algebra.Homomorphism(g, lh.so(3), [[], [], []]).image().dimension == 0
    assert lh.Representation(g, [], size=2).size == 2
    assert lh.adjoint(g).size == 0
    assert lh.Pair(g, []).dimension == 0
    assert lh.from_json(lh.to_json(g)) == g
    assert str(g).startswith("Lie algebra over QQ, dimension 0")


# -- fractions that fill a book ------------------------------------------------------------------------------
def long_fraction(digits: int) -> str:
    return f"1{'0' * (digits - 2)}1/1{'0' * (digits - 2)}3"


def check_long_fractions(digits: int) -> None:
    q = lh.QQ.convert(long_fraction(digits))
    assert q == lh.QQ.convert(Fraction(10 ** (digits - 1) + 1, 10 ** (digits - 1) + 3))
    g = lh.LieAlgebra({(0, 1): {1: long_fraction(digits)}})
    assert g.bracket([q, 0], [0, 1])[1] == q * q
    assert g.killing_form()[0, 0] == q * q
    assert (g.center().dimension, g.derivations().dimension) == (0, 2)
    so3 = lh.LieAlgebra({(0, 1): {2: q}, (1, 2): {0: 1}, (0, 2): {1: -1}})
    assert so3.killing_signature() == (0, 3, 0)
    with pytest.raises(JacobiError) as caught:
        lh.LieAlgebra({(0, 1): {0: q}, (0, 2): {1: 1}}, dimension=3)
    assert caught.value.value == {1: str(q)}
    assert len(str(caught.value)) < 400  # the message does not fill a book
    with pytest.raises(StructureError) as wrong:
        lh.LieAlgebra({(0, 1): {0: q}, (1, 0): {0: q}})
    assert len(str(wrong.value)) < 800
    with pytest.raises(lh.NotASubalgebraError) as leaving:
        so3.subalgebra([[q, 0, 0], [0, 1, 0]])
    assert len(str(leaving.value)) < 800


def test_fractions_of_ten_thousand_digits() -> None:
    check_long_fractions(10**4)


@pytest.mark.slow
def test_fractions_of_a_million_digits() -> None:
    with pytest.raises(lh.LimitError, match="digits=1000000"):
        check_long_fractions(10**6)
    with lh.limits(digits=10**6):
        check_long_fractions(10**6)


# -- a text or a list where an object is needed ---------------------------------------------------------------
def test_a_list_of_summands_is_to_be_unpacked() -> None:
    with pytest.raises(InputError, match="unpack the list"):
        lh.direct_sum([lh.so(3), lh.sl(2)])  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"\.over\(K\)"):
        lh.direct_sum(lh.so(3), lh.sl(2).over(lh.RR))


@pytest.mark.parametrize("build", [lh.adjoint, lh.coadjoint, lh.representations.trivial, lh.so(3).is_isomorphic])
def test_name_in_place_of_an_algebra_raises(build: Callable[[Any], Any]) -> None:
    with pytest.raises(InputError, match="so\\(3\\)"):
        build("so(3)")


@pytest.mark.parametrize("verb", ["tensor", "direct_sum", "is_equivalent", "equivalence", "intertwiners"])
def test_number_in_place_of_a_representation_raises(verb: str) -> None:
    with pytest.raises(InputError, match="expected a Representation"):
        getattr(lh.defining(lh.so(3)), verb)(3)


def test_the_diagram_of_a_type() -> None:
    assert sorted(lh.algebra.dynkin_diagram("G2").edges(data="entry")) == [(0, 1, 1), (1, 0, 3)]
    with pytest.raises(CatalogError):
        lh.algebra.dynkin_diagram("G3")


@pytest.mark.parametrize("name", ["f4(-20)", "g2", "so(4,1)", "sl(2,C)", "E6(-26)"])
def test_a_simple_algebra_by_the_name_of_its_real_form(name: str) -> None:
    form = lh.RealForm.of_name(name)
    assert lh.simple(name) == lh.simple(form.type, form.name)


def test_the_types_that_are_listed_are_simple() -> None:
    with pytest.raises(CatalogError, match=r"known: .*D3") as caught:
        lh.simple("X9")
    assert "D2" not in str(caught.value)
    with pytest.raises(CatalogError, match="is not simple"):
        lh.simple("so(4)")


def test_a_real_algebra_is_complexified() -> None:
    with pytest.raises(InputError, match="complexification"):
        lh.algebra.realification(lh.so(3))
