"""Theorem P, by computation: equivariant brackets, curvature tensors, and the determinant behind `full` certificates.

For each isotropy algebra h in Theorem L, a Lie algebra g = h + V has the brackets T in Hom_h(Lambda^2 V, V) and R in
Hom_h(Lambda^2 V, h) on V. The proof in docs/theory/classification.md says which T and R satisfy the Jacobi identity.
"""

import itertools
import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest

import liehom as lh
from liehom.exact.scalars.rational import QQ

NONCOMPACT = [
    *("sl(2)", "sl(3)", "sl(4)", "sl(5)", "sp(4,R)", "sp(6,R)"),
    *("sl(2,C)", "sl(3,C)", "sp(4,C)", "sl(2,C)+u(1)", "sl(3,C)+u(1)", "sp(4,C)+u(1)"),
    *("sl(2,H)", "sl(2,H)+u(1)", "sl(2,H)+sp(1)", pytest.param("spin(9,1)", marks=pytest.mark.slow)),
]
COMPACT = {  # dimensions of the spaces of T, of R, of the R with the Bianchi identity
    "so(2)": (0, 1, 1),
    "so(3)": (1, 1, 1),
    "so(4)": (0, 2, 1),
    "so(5)": (0, 1, 1),
    "so(6)": (0, 1, 1),
    "su(2)": (0, 1, 0),
    "su(3)": (2, 1, 0),
    "su(4)": (0, 1, 0),
    "u(2)": (0, 2, 1),
    "u(3)": (0, 2, 1),
    "u(4)": (0, 2, 1),
    "sp(2)": (0, 1, 0),
    "sp(2)+u(1)": (0, 2, 0),
    "sp(2)+sp(1)": (0, 2, 1),
    "g2": (1, 1, 0),
    "spin(7)": (0, 1, 0),
    "spin(9)": (0, 1, 1),
}
Form = list[list[list[Any]]]
"""An alternating map of x and y on V: coordinates of the value at e_i, e_j."""


def alternating(matrix: Any, d: int) -> Form:
    """The map of an intertwiner on Lambda^2 V, whose columns are the wedges e_i ^ e_j, i < j."""
    size = matrix.shape[0]
    form: Form = [[[Fraction(0)] * size for _ in range(d)] for _ in range(d)]
    for column, (i, j) in enumerate(itertools.combinations(range(d), 2)):
        value = [Fraction(int(x.p), int(x.q)) for x in (matrix[row, column] for row in range(size))]
        form[i][j] = value
        form[j][i] = [-x for x in value]
    return form


class Brackets:
    """The equivariant T and R of a linear Lie algebra of the catalogue."""

    def __init__(self, name: str) -> None:
        self.rho = lh.catalog.representation(name)
        self.d, self.h = self.rho.size, self.rho.algebra
        wedges = self.rho.exterior_power(2)
        self.T = [alternating(t, self.d) for t in wedges.intertwiners(self.rho)]
        self.R = [alternating(r, self.d) for r in wedges.intertwiners(lh.adjoint(self.h))]
        self.matrices = [
            [[Fraction(int(a[i, j].p), int(a[i, j].q)) for j in range(self.d)] for i in range(self.d)]
            for a in self.rho.matrices
        ]

    def cyclic(self, first: Form, second: Form | None) -> list[Fraction]:
        """All coordinates of the cyclic sum of [first(x, y), z], first in V with a second form, or in h."""
        acting = second if second is not None else [list(map(list, zip(*m, strict=True))) for m in self.matrices]
        total = []
        for triple in itertools.combinations(range(self.d), 3):
            value = [Fraction(0)] * self.d
            for k in range(3):
                x, y, z = triple[k], triple[(k + 1) % 3], triple[(k + 2) % 3]
                for a, factor in enumerate(first[x][y]):
                    if factor:
                        value = [v + factor * w for v, w in zip(value, acting[a][z], strict=True)]
            total += value
        return total

    def bianchi(self, forms: Sequence[Form]) -> int:
        """The dimension of the combinations of the forms R that satisfy the first Bianchi identity."""
        rows = [self.cyclic(form, None) for form in forms]
        return len(rows) - (QQ.matrix(rows).rank() if rows and rows[0] else 0)

    def algebra(self, t: Form | None, r: Form) -> lh.LieAlgebra:
        """The algebra h + V with the brackets T + R on V; LieAlgebra proves the Jacobi identity."""
        n, d = self.h.dimension, self.d
        table: dict[tuple[int, int], dict[int, Any]] = {}
        for a, b in itertools.combinations(range(n), 2):
            value = self.h.bracket([int(i == a) for i in range(n)], [int(i == b) for i in range(n)])
            table[a, b] = {k: x for k, x in enumerate(value) if x}
        for a in range(n):
            for j in range(d):
                table[a, n + j] = {n + i: self.matrices[a][i][j] for i in range(d) if self.matrices[a][i][j]}
        for i, j in itertools.combinations(range(d), 2):
            value = {k: x for k, x in enumerate(r[i][j]) if x}
            value |= {n + k: x for k, x in enumerate(t[i][j]) if x} if t is not None else {}
            table[n + i, n + j] = value
        return lh.LieAlgebra(table, dimension=n + d)


def multiple(form: Form, factor: Any) -> Form:
    return [[[factor * x for x in value] for value in row] for row in form]


@pytest.mark.parametrize("name", NONCOMPACT)
def test_noncompact_isotropy_admits_no_equivariant_bracket(name: str) -> None:
    rho = lh.catalog.representation(name)
    wedges = rho.exterior_power(2)
    assert not wedges.intertwiners(rho)
    assert not wedges.intertwiners(lh.adjoint(rho.algebra))


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n == "spin(9)" else n for n in COMPACT])
def test_dimensions_of_the_brackets_of_compact_isotropy(name: str) -> None:
    brackets = Brackets(name)
    actual = len(brackets.T), len(brackets.R), brackets.bianchi(brackets.R)
    assert actual == COMPACT[name]


@pytest.mark.parametrize(("name", "compact", "dual"), [
    ("so(2)", "so(3)", "so(2,1)"), ("so(4)", "so(5)", "so(4,1)"), ("u(2)", "su(3)", "su(2,1)"),
    ("u(3)", "su(4)", "su(3,1)"), pytest.param("sp(2)+sp(1)", "sp(3)", "sp(2,1)", marks=pytest.mark.slow),
])  # fmt: skip
def test_the_two_signs_of_the_curvature_are_the_compact_algebra_and_its_dual(
    name: str, compact: str, dual: str
) -> None:
    brackets = Brackets(name)
    (kernel,) = null_space([brackets.cyclic(r, None) for r in brackets.R])
    curvature = combination(brackets.R, kernel)
    actual = [brackets.algebra(None, multiple(curvature, sign)) for sign in (1, -1)]
    if actual[0].killing_signature()[0]:
        actual.reverse()
    assert actual[0].is_isomorphic(lh.catalog.algebra(compact))
    assert actual[1].is_isomorphic(lh.catalog.algebra(dual))


def combination(forms: Sequence[Form], factors: Sequence[Any]) -> Form:
    size = len(forms[0][0][0])
    d = len(forms[0])
    return [
        [[sum(c * f[i][j][k] for c, f in zip(factors, forms, strict=True)) for k in range(size)] for j in range(d)]
        for i in range(d)
    ]


def null_space(rows: Sequence[Sequence[Fraction]]) -> list[list[Fraction]]:
    """The combinations of the rows that vanish."""
    if not rows[0]:
        return [[Fraction(int(i == j)) for j in range(len(rows))] for i in range(len(rows))]
    basis = QQ.matrix([list(row) for row in rows]).T.null_space().to_rows()
    return [[Fraction(int(x.p), int(x.q)) for x in row] for row in basis]


@pytest.mark.parametrize(("name", "result", "draws"), [("su(3)", "g2", 3), ("g2", "so(7)", 1)])
def test_a_tangential_bracket_determines_one_compact_algebra(name: str, result: str, draws: int) -> None:
    """T determines R, whatever T is; the Killing form is negative definite each time, so there is no dual."""
    brackets = Brackets(name)
    rng = random.Random(5)
    for _ in range(draws):
        t = combination(brackets.T, [Fraction(rng.randint(1, 4)) for _ in brackets.T])
        (solution,) = null_space([brackets.cyclic(t, t), *(brackets.cyclic(r, None) for r in brackets.R)])
        assert solution[0]
        g = brackets.algebra(t, combination(brackets.R, [x / solution[0] for x in solution[1:]]))
        assert g.killing_signature() == (0, g.dimension, 0)
        assert g.is_isomorphic(lh.catalog.algebra(result))


@pytest.mark.parametrize("tau", [0, 1, 2, -3])
def test_the_tangential_bracket_of_so3_is_removed_by_another_complement(tau: int) -> None:
    """[x, y] = tau x * y + c phi(x * y) is the algebra with tau = 0 and c + tau^2 / 4: so(4), e(3) or so(3,1)."""
    brackets = Brackets("so(3)")
    (t,), (r,) = brackets.T, brackets.R
    unit = multiple(t, 1 / t[0][1][2]), multiple(r, 1 / r[0][1][0])  # e_0 * e_1 = e_2, and phi(e_2) = L_01
    for c in (Fraction(k, 4) for k in range(-10, 4)):
        curvature = c + Fraction(tau**2, 4)
        signature = (0, 6, 0) if curvature > 0 else (3, 3, 0) if curvature else (0, 3, 3)
        assert brackets.algebra(multiple(unit[0], tau), multiple(unit[1], c)).killing_signature() == signature


@pytest.mark.parametrize(("name", "kappa", "holds"), [
    ("so(5)", 3, True), ("so(7)", 5, True), ("spin(9)", Fraction(7, 2), True), ("spin(7)", 5, False), ("g2", 4, False),
])  # fmt: skip
def test_killing_form_is_kappa_times_the_trace_form(name: str, kappa: Fraction, holds: bool) -> None:
    """1 + kappa = 2 dim k / d is the Bianchi identity of the projection onto a simple k, in docs/theory."""
    rho = lh.catalog.representation(name)
    killing = lh.adjoint(rho.algebra)
    for i, j in [(0, 0), (0, 1), (1, 1), (2, 5)]:
        form = (rho.matrices[i] @ rho.matrices[j]).trace()
        assert 2 * (killing.matrices[i] @ killing.matrices[j]).trace() == int(2 * kappa) * form
    assert (1 + kappa == Fraction(2 * rho.algebra.dimension, rho.size)) is holds


# -- symmetric operators: which p extend a compact k -----------------------------------------------------------


@pytest.mark.parametrize(("name", "dimensions"), [
    *((f"so({d})", [d * (d + 1) // 2 - 1]) for d in (2, 3, 4, 5, 6)), ("su(3)", [8, 12]), ("u(3)", [8, 12]),
    pytest.param("u(4)", [15, 20], marks=pytest.mark.slow), ("sp(1)", [3, 3, 3]), ("sp(1)+u(1)", [3, 6]),
    ("sp(2)", [5, 10, 10, 10]), pytest.param("sp(2)+u(1)", [5, 10, 20], marks=pytest.mark.slow),
    ("sp(2)+sp(1)", [5, 30]), ("g2", [27]), ("spin(7)", [35]),
    pytest.param("spin(9)", [9, 126], marks=pytest.mark.slow),
])  # fmt: skip
def test_irreducible_parts_of_the_symmetric_operators(name: str, dimensions: list[int]) -> None:
    parts = lh.catalog.representation(name).symmetric_power(2).decomposition().components
    assert sorted(part.subspace.dimension for part in parts) == sorted([1, *dimensions])


def symmetric_operators(rho: lh.Representation, rows: Any) -> list[Any]:
    """Symmetric matrices of vectors of Sym^2, in monomials x_i x_j: half of a coefficient for i < j."""
    d = rho.size
    matrices = []
    for row in rows:
        entries = [[Fraction(0)] * d for _ in range(d)]
        for value, (i, j) in zip(row, itertools.combinations_with_replacement(range(d), 2), strict=True):
            x = Fraction(int(value.p), int(value.q))
            entries[i][j] = entries[j][i] = x if i == j else x / 2
        matrices.append(QQ.matrix(entries))
    return matrices


def rank(matrices: Sequence[Any]) -> int:
    return QQ.stack_rows([m.reshape(1, m.shape[0] ** 2) for m in matrices], matrices[0].shape[0] ** 2).rank()


@pytest.mark.parametrize(("name", "actual"), [
    ("so(3)", {"sl(3)"}), ("so(4)", {"sl(4)"}), ("su(3)", {"sl(3,C)"}), ("u(3)", {"sl(3,C)+u(1)", "sp(6,R)"}),
    ("sp(1)+u(1)", {"sl(2,C)+u(1)", "sp(4,R)"}),
    pytest.param("sp(2)+u(1)", {"sl(2,H)+u(1)", "sp(4,C)+u(1)"}, marks=pytest.mark.slow),
    ("sp(2)+sp(1)", {"sl(2,H)+sp(1)"}), ("g2", set()), ("spin(7)", set()),
    pytest.param("spin(9)", {"spin(9,1)"}, marks=pytest.mark.slow),
])  # fmt: skip
def test_sums_of_parts_that_close_with_a_compact_algebra(name: str, actual: set[str]) -> None:
    """For pairwise non-isomorphic parts of Sym_0 each p is a sum of some of them."""
    rho = lh.catalog.representation(name)
    k = list(rho.matrices)
    parts = rho.symmetric_power(2).decomposition().components
    p_parts = [symmetric_operators(rho, part.subspace.basis.to_rows()) for part in parts if part.subspace.dimension > 1]
    closed = []
    for size in range(1, len(p_parts) + 1):
        for chosen in itertools.combinations(p_parts, size):
            p = [m for part in chosen for m in part]
            brackets = [a @ b - b @ a for a, b in itertools.combinations(p, 2)]
            if rank([*k, *brackets]) == len(k):
                closed.append(len(k) + len(p))
    assert sorted(closed) == sorted(lh.catalog.representation(n).algebra.dimension for n in actual)


@pytest.mark.parametrize(("name", "units", "closes"), [
    *((f"sp({m})", units, units == 1) for m in (1, 2) for units in (1, 2, 3)), ("sp(1)+u(1)", 1, True),
    ("sp(1)+u(1)", 2, True),  # sp(4,R)
    ("sp(2)+u(1)", 1, True), ("sp(2)+u(1)", 2, False),
])  # fmt: skip
def test_quaternion_units_that_extend_sp(name: str, units: int, closes: bool) -> None:
    """k = sp(m) and u(1) = R(1 x i), with p = A x U for U = <i>, <i, j>, <i, j, k>, or <j, k> next to u(1)."""
    sp = lh.catalog.representation(name.partition("+")[0])
    i, j = quaternion_units(sp)
    right = [j, i @ j] if units == 2 and "u(1)" in name else [i, j, i @ j][:units]
    k = [*sp.matrices, i] if "u(1)" in name else list(sp.matrices)
    p = [a @ u for u in right for a in sp.matrices]
    brackets = [a @ b - b @ a for a, b in itertools.combinations(p, 2)]
    assert (rank([*k, *brackets]) == len(k)) is closes


def quaternion_units(rho: lh.Representation) -> tuple[Any, Any]:
    """Multiples of two operators i, j that commute with sp(m), with ij = -ji."""
    one = QQ.identity(rho.size)
    imaginary = [c - one.scale(c.trace() / rho.size) for c in rho.commutant()]
    i, v = [u for u in imaginary if not u.is_zero()][:2]
    j = v - i.scale((v @ i).trace() / (i @ i).trace())
    assert i @ j == -(j @ i)
    assert not j.is_zero()
    return i, j


# -- the determinant f = const q^d of the first proof of soundness ---------------------------------------------


def gram_determinant(matrices: Sequence[Any], y: Any) -> Any:
    """f(y) = det(sum g^ab (B_a y)(B_b y)^T + y y^T) for skew-symmetric B_a, with g_ab = -tr(B_a B_b)."""
    gram = QQ.matrix([[-(a @ b).trace() for b in matrices] for a in matrices])
    images = QQ.stack_columns([b @ y for b in matrices], y.shape[0])
    return (images @ gram.inverse() @ images.T + y @ y.T).determinant()


@pytest.mark.parametrize("name", ["so(3)", "su(3)", "u(2)", "sp(2)", "sp(2)+sp(1)", "g2", "spin(7)", "spin(9)"])
def test_determinant_of_a_transitive_algebra_is_a_power_of_the_form(name: str) -> None:
    rho = lh.catalog.representation(name)
    rng = random.Random(3)
    ratios = set()
    for _ in range(4):
        y = QQ.matrix([[rng.randint(-5, 5)] for _ in range(rho.size)])
        ratios.add(gram_determinant(rho.matrices, y) / (y.T @ y)[0, 0] ** rho.size)
    (constant,) = ratios
    assert constant > 0


@pytest.mark.parametrize("name", ["blocks(so(2),so(2))", "blocks(so(3),so(3))", "copies(2,so(3))", "copies(2,su(2))"])
def test_determinant_of_a_compact_algebra_that_is_not_transitive_vanishes(name: str) -> None:
    rho = lh.catalog.representation(name)
    rng = random.Random(3)
    for _ in range(3):
        assert gram_determinant(rho.matrices, QQ.matrix([[rng.randint(-5, 5)] for _ in range(rho.size)])) == 0
