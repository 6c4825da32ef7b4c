"""Homogeneous spaces with the number of their invariant Einstein metrics up to scale.

Each row says where its count is from.

- Schur: the isotropy representation is irreducible over the reals, so there is one invariant metric up to scale, and
  its Ricci tensor is a multiple of it.
- Nikonorov: the theorem on simply connected homogeneous Einstein manifolds of dimension 7 in Yu. Nikonorov, Compact
  homogeneous Einstein 7-manifolds, Geom. Dedicata 109 (2004): all spaces with their numbers of metrics, as A. Rivero
  lists them from it in the thread "List of compact 7 dimensional Einstein manifolds", physicsforums.com/threads/371804.
  His i.1 to i.6 are here "i.1" to "i.6", and the symmetric cases "s.1" to "s.5".
- Boehm-Kerr: Ch. Boehm and M. Kerr, Low-dimensional homogeneous Einstein manifolds, Trans. AMS 358 (2006), p. 1455: the
  12-dimensional space SU(4)/SU(2)_10 has no homogeneous Einstein metric (after Wang and Ziller), and compact ones of
  dimension 3 have constant curvature.
- Belgun: F. Belgun, V. Cortes, A. Haupt, D. Lindemann, Left-invariant Einstein metrics on S^3 x S^3, arXiv:1703.10512,
  abstract: those with an isotropy group other than Z_2 are the standard and the nearly Kaehler metric.
- computed: found by this library, and verified by two other computations of Ricci. Counts of flag manifolds are in
  Table 1 of Chrysikos and Sakane, arXiv:1206.1306, and those of spheres and projective spaces in Ziller, Math. Ann. 259
  (1982), with which these rows are not compared here.
"""

from collections.abc import Callable, Sequence
from functools import partial
from math import comb

import liehom as lh


def flag(rho: lh.Representation, matrix: object) -> lh.Pair:
    """The pair of g and the centralizer of the element with a matrix."""
    return lh.Pair(rho.algebra, rho.algebra.centralizer([rho.element(matrix)]))


def diagonal(entries: Sequence[int]) -> list[list[str | int]]:
    """The matrix i diag(entries)."""
    return [[f"{x}*i" if i == j else 0 for j in range(len(entries))] for i, x in enumerate(entries)]


def su_flag(*sizes: int) -> lh.Pair:
    """SU(n)/S(U(n1) x ... x U(nk)) with the given sizes."""
    n = sum(sizes)
    labels = [a for a, size in enumerate(sizes) for _ in range(size)]
    return flag(lh.defining(lh.su(n)), diagonal([n * a - sum(labels) for a in labels]))


def torus(g: lh.LieAlgebra) -> lh.Pair:
    return lh.Pair(g, g.cartan_subalgebra())


def g2_flag(x: int, y: int) -> lh.Pair:
    g = lh.pair("g2/su(3)").algebra
    a, b = g.cartan_subalgebra().rows()
    return lh.Pair(g, g.centralizer([[x * u + y * v for u, v in zip(a, b, strict=True)]]))


def projective(n: int) -> lh.Pair:
    """CP^(2n-1) = Sp(n)/U(1)Sp(n-1)."""
    pair = lh.pair(f"sp({n})/sp({n - 1})" if n > 1 else "sp(1)/u(1)")
    g = pair.algebra
    normal = g.centralizer(pair.subalgebra)
    return lh.Pair(g, g.centralizer([normal.rows()[0]]))


def stiefel(n: int) -> lh.Pair:
    """V_2(R^n) = SO(n)/SO(n-2)."""
    rho = lh.defining(lh.so(n))
    points = [[int(i == j) for i in range(n)] for j in (n - 2, n - 1)]
    return lh.Pair(rho.algebra, rho.isotropy(points[0]).intersection(rho.isotropy(points[1])))


def aloff_wallach(k: int, l: int) -> lh.Pair:
    """SU(3)/S^1 with the circle of weights (k, l, -k-l)."""
    rho = lh.defining(lh.su(3))
    return lh.Pair(rho.algebra, [rho.element(diagonal([k, l, -k - l]))])


def product_of_spheres(*weights: int) -> lh.Pair:
    """SU(2) x SU(2)/S^1, the circle with two weights."""
    one = lh.su(2).cartan_subalgebra().rows()[0]
    g = lh.direct_sum(lh.su(2), lh.su(2))
    return lh.Pair(g, [[weights[0] * x for x in one] + [weights[1] * x for x in one]])


def three_spheres(a: int, b: int, c: int) -> lh.Pair:
    """SU(2)^3/T^2, where T^2 is orthogonal to (a, b, c) in the maximal torus."""
    one = lh.su(2).cartan_subalgebra().rows()[0]
    g = lh.direct_sum(lh.su(2), lh.su(2), lh.su(2))
    kernel = lh.scalars.QQ.matrix([[a, b, c]]).null_space().to_rows()
    return lh.Pair(g, [[x * t for t in row for x in one] for row in kernel])


def product(one: str, other: str) -> lh.Pair:
    """The product of two spaces with names."""
    p, q = lh.pair(one), lh.pair(other)
    left, right = [0] * p.algebra.dimension, [0] * q.algebra.dimension
    rows = [[*row, *right] for row in p.subalgebra.rows()] + [[*left, *row] for row in q.subalgebra.rows()]
    return lh.Pair(lh.direct_sum(p.algebra, q.algebra), rows)


def ledger_obata(k: int) -> lh.Pair:
    """SU(2)^k/SU(2), the diagonal."""
    g = lh.direct_sum(*[lh.su(2)] * k)
    return lh.Pair(g, [[int(i == j) for _ in range(k) for i in range(3)] for j in range(3)])


def m_space(a: int, b: int) -> lh.Pair:
    """SU(3) x SU(2)/SU(2) x U(1): the circle has weight b on diag(1, 1, -2) and a on the torus of SU(2)."""
    rho = lh.defining(lh.su(3))
    g = lh.direct_sum(lh.su(3), lh.su(2))
    one = lh.su(2).cartan_subalgebra().rows()[0]
    small = rho.isotropy([0, 0, 0, 0, 1, 0])
    central = rho.algebra.centralizer(small).rows()[0]
    rows = [[*row, 0, 0, 0] for row in small.rows()]
    return lh.Pair(g, [*rows, [*(b * x for x in central), *(a * x for x in one)]])


def irreducible_su2() -> lh.Pair:
    """SU(4)/SU(2) with SU(2) irreducible on C^4 = Sym^3 C^2, for the invariant Hermitian form with rational entries."""
    weights = [comb(3, j) for j in range(4)]
    basis = []
    for i in range(4):
        for j in range(i):
            for one, other in (("1", "(-1)"), ("i", "i")):
                m: list[list[str | int]] = [[0] * 4 for _ in range(4)]
                m[i][j], m[j][i] = f"{weights[i]}*{one}", f"{weights[j]}*{other}"
                basis.append(m)
    basis += [diagonal([int(i == j) - int(i == j + 1) for i in range(4)]) for j in range(3)]
    rho = lh.Representation.from_matrices(basis)
    # e - f, i(e + f) and i h on x^3, x^2 y, x y^2, y^3
    raising = [[(j if i == j - 1 else 0) for j in range(4)] for i in range(4)]
    lowering = [[(3 - j if i == j + 1 else 0) for j in range(4)] for i in range(4)]
    real = [[a - b for a, b in zip(r, s, strict=True)] for r, s in zip(raising, lowering, strict=True)]
    imaginary = [[f"{a + b}*i" for a, b in zip(r, s, strict=True)] for r, s in zip(raising, lowering, strict=True)]
    return lh.Pair(rho.algebra, rho.subalgebra([real, imaginary, diagonal([3, 1, -1, -3])]))


named = partial(partial, lh.pair)

IRREDUCIBLE = [
    "so(5)/so(4)",
    "su(3)/u(2)",
    "sp(2)/sp(1)+sp(1)",
    "su(3)/so(3)",
    "g2/su(3)",
    "spin(7)/g2",
    "so(6)/so(3)+so(3)",
    "so(6)/u(3)",
]

# name, pair, number of metrics, number of kinds, source
EINSTEIN: list[tuple[str, Callable[[], lh.Pair], int, int, str]] = [
    *((name, named(name), 1, 1, "Schur") for name in IRREDUCIBLE),
    ("SU(3)/T^2", lambda: su_flag(1, 1, 1), 4, 2, "computed"),
    ("SU(4)/S(U(1)U(1)U(2))", lambda: su_flag(1, 1, 2), 4, 3, "computed"),
    ("SU(5)/S(U(1)U(2)U(2))", lambda: su_flag(1, 2, 2), 4, 3, "computed"),
    ("Sp(3)/Sp(1)^3", named("sp(3)/sp(1)+sp(1)+sp(1)"), 4, 2, "computed"),
    ("SO(5)/T^2", lambda: torus(lh.so(5)), 6, 2, "computed"),
    ("SO(5)/U(2)", named("so(5)/u(2)"), 2, 2, "computed"),
    ("SO(7)/U(3)", named("so(7)/u(3)"), 2, 2, "computed"),
    ("CP^5 = Sp(3)/U(1)Sp(2)", lambda: projective(3), 2, 2, "computed"),
    ("G2/U(2), two summands", lambda: g2_flag(0, 1), 2, 2, "computed"),
    ("G2/U(2), three summands", lambda: g2_flag(1, 1), 3, 3, "computed"),
    ("S^5 = SU(3)/SU(2)", named("su(3)/su(2)"), 1, 1, "computed"),
    ("S^7 = SU(4)/SU(3)", named("su(4)/su(3)"), 1, 1, "Nikonorov s.5, remark"),
    ("S^7 = Sp(2)/Sp(1)", named("sp(2)/sp(1)"), 2, 2, "Nikonorov i.3"),
    ("S^11 = Sp(3)/Sp(2)", named("sp(3)/sp(2)"), 2, 2, "computed"),
    ("S^15 = Spin(9)/Spin(7)", named("spin(9)/spin(7)"), 2, 2, "computed"),
    ("V_2(R^5)", lambda: stiefel(5), 1, 1, "Nikonorov i.2"),
    ("V_2(R^6)", lambda: stiefel(6), 1, 1, "computed"),
    ("N(1,2)", lambda: aloff_wallach(1, 2), 2, 2, "Nikonorov i.6"),
    ("N(1,3)", lambda: aloff_wallach(1, 3), 2, 2, "Nikonorov i.6"),
    ("M(1,1)", lambda: m_space(1, 1), 1, 1, "Nikonorov i.4"),
    ("M(2,3)", lambda: m_space(2, 3), 1, 1, "Nikonorov i.4"),
    ("Q(1,1,1)", lambda: three_spheres(1, 1, 1), 1, 1, "Nikonorov i.5a"),
    ("Q(1,2,3)", lambda: three_spheres(1, 2, 3), 1, 1, "Nikonorov i.5a"),
    ("Q(1,2,0) = T(1,2) x S^2", lambda: three_spheres(1, 2, 0), 1, 1, "Nikonorov i.5b"),
    ("Q(1,1,0) = V_2(R^4) x S^2", lambda: three_spheres(1, 1, 0), 5, 2, "Nikonorov i.5c"),
    ("S^5 x S^2", lambda: product("S^5", "S^2"), 1, 1, "Nikonorov s.2"),
    ("S^4 x S^3", lambda: product("S^4", "S^3"), 1, 1, "Nikonorov s.3"),
    ("SU(3)/SO(3) x S^2", lambda: product("SU(3)/SO(3)", "S^2"), 1, 1, "Nikonorov s.4"),
    ("T(1,2) = S^2 x S^3", lambda: product_of_spheres(1, 2), 1, 1, "computed"),
    ("SU(2)", lambda: lh.Pair(lh.su(2), []), 1, 1, "Boehm-Kerr"),
    ("SU(2)^3/SU(2)", lambda: ledger_obata(3), 4, 2, "Belgun"),
    ("SU(4)/SU(2)_10", irreducible_su2, 0, 0, "Boehm-Kerr"),
]
