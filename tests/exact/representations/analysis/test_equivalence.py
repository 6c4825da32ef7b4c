"""Equivalence, invariant subspaces and Hermitian forms."""

from typing import Any

import pytest
import sympy

import liehom as lh
from liehom.base.errors import DependentRowsError, FieldError, InputError, NotInvariantError, ShapeError, UndecidedError
from liehom.exact.scalars.rational import QQ
from tests.exact.representations.analysis.test_decomposition import scrambled


def intertwines(t: Any, rho: lh.Representation, sigma: lh.Representation) -> bool:
    return t.rank() == rho.size and all(t @ a == b @ t for a, b in zip(rho.matrices, sigma.matrices, strict=True))


@pytest.mark.parametrize("rho", [
    lh.defining(lh.so(4)), lh.adjoint(lh.sl(2)), lh.defining(lh.su(2)), lh.adjoint(lh.heisenberg(1)),
    lh.catalog.representation("copies(2,so(3))"), lh.adjoint(lh.euclidean(2)), lh.representations.trivial(lh.so(3), 2),
])  # fmt: skip
def test_a_change_of_basis_is_an_equivalence(rho: lh.Representation) -> None:
    moved = scrambled(rho)
    found = rho.equivalence(moved)
    assert intertwines(found, rho, moved) and rho.is_equivalent(rho)


def test_known_equivalences() -> None:
    g = lh.sl(3)
    v = lh.defining(g)
    assert v.exterior_power(2).is_equivalent(v.dual()) and not v.is_equivalent(v.dual())
    h = lh.so(3)
    w = lh.defining(h)
    assert w.exterior_power(2).is_equivalent(w)
    assert w.tensor(w).is_equivalent(w.symmetric_power(2).direct_sum(w.exterior_power(2)))
    assert not w.direct_sum(lh.representations.trivial(h, 3)).is_equivalent(w.direct_sum(w))
    assert not w.is_equivalent(lh.representations.trivial(h, 2))


def test_what_is_not_completely_reducible() -> None:
    """A representation and its dual: same dimensions everywhere, equivalent or not."""
    upper = lh.catalog.representation("upper(2)")
    assert not upper.is_equivalent(upper.dual())
    line = lh.Representation.from_matrices([[[0, 1, 0], [0, 0, 0], [0, 0, 0]]])
    other = lh.Representation(line.algebra, [[[0, 1, 0], [0, 0, 1], [0, 0, 0]]])
    assert line.is_equivalent(line.dual()) is False or intertwines(line.equivalence(line.dual()), line, line.dual())
    assert not line.is_equivalent(other)
    assert other.is_equivalent(lh.Representation(line.algebra, [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]))


def test_refusals_of_equivalence() -> None:
    with pytest.raises(InputError, match="two algebras"):
        lh.defining(lh.so(3)).is_equivalent(lh.defining(lh.sl(2)))
    over = lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)"))
    with pytest.raises(FieldError, match="one field"):
        lh.defining(lh.so(3)).is_equivalent(over)
    floating = lh.defining(lh.so(3)).over(lh.RR)
    with pytest.raises(UndecidedError, match="rationalize"):
        floating.is_equivalent(floating)
    with pytest.raises(UndecidedError, match="rationalize"):
        floating.subrepresentation([[1, 0, 0]])


# -- invariant subspaces -------------------------------------------------------------------------------------
def test_sub_and_quotient() -> None:
    rho = scrambled(lh.adjoint(lh.gl(3)))
    for found in (c.subspace for c in rho.decomposition()):
        sub, over = rho.subrepresentation(found), rho.quotient(found)
        assert sub.size == found.dimension and over.size == rho.size - sub.size
        for made in (sub, over):  # proved again
            lh.Representation(rho.algebra, made.matrices, size=made.size)
        assert over.is_equivalent(rho.subrepresentation(rho.invariant_complement(found)))
        assert rho.submodule(found.rows()[:1]) == found


def test_the_basis_of_a_subrepresentation_is_the_one_given() -> None:
    rho = lh.adjoint(lh.euclidean(2))
    basis = [list(row) for row in rho.socle().rows()]
    doubled = [[2 * x for x in basis[1]], basis[0]]
    made = rho.subrepresentation(doubled)
    for a, b in zip(rho.matrices, made.matrices, strict=True):
        rows = QQ.matrix(doubled)
        assert rows @ a.T == b.T @ rows


def test_refusals_of_subspaces() -> None:
    rho = lh.adjoint(lh.heisenberg(1))
    with pytest.raises(NotInvariantError, match="basis element 1 moves row 0, \\(1, 0, 0\\)") as caught:
        rho.subrepresentation([[1, 0, 0]])
    assert (caught.value.vector, caught.value.element) == (0, 1)
    with pytest.raises(NotInvariantError):
        rho.quotient([[0, 0, 1], [1, 0, 0], [0, 1, 0]][1:])
    with pytest.raises(DependentRowsError):
        rho.subrepresentation([[0, 0, 1], [0, 0, 2]])
    with pytest.raises(ShapeError):
        rho.quotient([[0, 1]])
    with pytest.raises(lh.errors.NotCompletelyReducibleError):
        rho.invariant_complement([[0, 0, 1]])
    assert rho.subrepresentation([]).size == 0 and rho.quotient([]).size == 3
    assert rho.invariant_complement([]).dimension == 3


def test_sympy_matrices_are_representations() -> None:
    half = sympy.Rational(1, 2)
    matrices = [sympy.Matrix([[0, half], [0, 0]]), sympy.Matrix([[0, 0], [2, 0]])]
    rho = lh.Representation.from_matrices(matrices)
    assert rho.algebra.dimension == 3 and rho.matrices[0].to_strings() == [["0", "1/2"], ["0", "0"]]
    again = [sympy.ImmutableMatrix([[str(x) for x in row] for row in a.to_rows()]) for a in rho.matrices]
    assert lh.Representation(rho.algebra, again) == rho and rho.isotropy(sympy.Matrix([1, 0])).dimension == 1
    roots = lh.Representation.from_matrices([sympy.Matrix([[0, sympy.sqrt(2)], [1, 0]])])
    assert roots.field.name == "QQ(sqrt(2))" and roots.decomposition().dimensions() == [1, 1]


# -- Hermitian forms -----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("name", "kind", "hermitian", "skew", "signature"), [
    ("su(3)", "complex", 1, 1, (3, 0, 0)), ("su(2,1)", "complex", 1, 1, (2, 1, 0)),
    ("su(2,2)", "complex", 1, 1, (2, 2, 0)), ("sl(3,C)", "complex", 0, 0, None),
    ("sp(2)", "quaternionic", 1, 0, (2, 0, 0)), ("sp(1,1)", "quaternionic", 1, 0, (1, 1, 0)),
    ("so*(6)", "quaternionic", 0, 1, None), ("sl(2,H)", "quaternionic", 0, 0, None), ("so(3,C)", "complex", 0, 0, None),
])  # fmt: skip
def test_hermitian_forms(name: str, kind: str, hermitian: int, skew: int, signature: Any) -> None:
    for rho in (lh.defining(name), scrambled(lh.defining(name))):
        forms = rho.hermitian_forms()
        assert (forms.kind, len(forms.hermitian), len(forms.skew_hermitian)) == (kind, hermitian, skew)
        for s in (*forms.hermitian, *forms.skew_hermitian):
            assert all((a.T @ s + s @ a).is_zero() for a in rho.matrices)
            assert all((j.T @ s + s @ j).is_zero() for j, _ in forms.units)
        if signature:
            found = forms.signature(forms.hermitian[0])
            assert found in (signature, (signature[1], signature[0], signature[2]))
            imaginary = [forms.imaginary_part(forms.hermitian[0], i) for i in range(len(forms.units))]
            assert all(m == -m.T for m in imaginary)


def test_a_structure_of_ones_own() -> None:
    """Two copies of R^3 are C^3 with one Hermitian form, two copies of that have a space of dimension four."""
    for copies, dimension in ((2, 1), (4, 4)):
        rho = lh.catalog.representation(f"copies({copies},so(3))")
        n, half = rho.size, rho.size // 2
        j = [[(i == k + half) - (k == i + half) for k in range(n)] for i in range(n)]
        forms = rho.hermitian_forms([[int(x) for x in row] for row in j])
        assert len(forms.hermitian) == len(forms.skew_hermitian) == dimension
    with pytest.raises(InputError, match="commute"):
        lh.defining(lh.so(4)).hermitian_forms([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, -1], [0, 0, 1, 0]])
    with pytest.raises(InputError, match="negative"):
        lh.defining(lh.so(4)).hermitian_forms(QQ.identity(4))
    with pytest.raises(InputError, match="type R"):
        lh.defining(lh.so(3)).hermitian_forms()
    with pytest.raises(InputError, match="reducible"):
        rho.hermitian_forms()


def test_the_square_root_in_the_imaginary_part() -> None:
    """J^2 = -2: the imaginary part needs sqrt(2), and is that of an honest complex structure."""
    rho = lh.Representation.from_matrices([[[0, -2], [1, 0]]])
    forms = rho.hermitian_forms()
    imaginary = forms.imaginary_part(forms.hermitian[0])
    assert imaginary.field.name == "QQ(sqrt(2))"
    # |omega(u, v)|^2 = s(u, u) s(v, v) for a complex line and real-orthogonal u, v
    s = forms.hermitian[0]
    assert imaginary[0, 1] ** 2 == s[0, 0] * s[1, 1] - s[0, 1] ** 2
