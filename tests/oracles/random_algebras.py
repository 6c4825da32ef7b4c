"""Random rational Lie algebras of dimensions 3 to 30, family by family, the same in every process.

A family yields (label, algebra) in a scrambled basis; `FAMILIES` says how many are taken from each.
"""

import random
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import liehom as lh
from liehom.exact.algebra.core.lie_algebra import LieAlgebra

SEED = "structure 1"
LEAST, LARGEST = 3, 30

Named = tuple[str, LieAlgebra]
Family = Callable[[random.Random], Named]


# -- bases -----------------------------------------------------------------------------------------------
def scrambled(algebra: LieAlgebra, rng: random.Random, operations: float = 1.0) -> LieAlgebra:
    """Another basis: row operations, signs, a permutation and, for half of the algebras, small rational factors."""
    n = algebra.dimension
    rows = [[Fraction(i == j) for j in range(n)] for i in range(n)]
    for _ in range(round(operations * n)):
        i, j = rng.sample(range(n), 2)
        c = rng.choice((-2, -1, 1, 2))
        rows[i] = [x + c * y for x, y in zip(rows[i], rows[j], strict=True)]
    rng.shuffle(rows)
    factors = (Fraction(1), Fraction(-1)) if rng.random() < 0.5 else (Fraction(1), Fraction(-2), Fraction(1, 2))
    for i in range(n):
        c = rng.choice(factors)
        rows[i] = [c * x for x in rows[i]]
    return algebra.change_of_basis([[str(x) for x in row] for row in rows])


# -- rational forms ----------------------------------------------------------------------------------------
def orthogonal(diagonal: Sequence[int]) -> LieAlgebra:
    """so of a diagonal rational form: E_ij d_j - E_ji d_i; anisotropic forms give algebras without nilpotents."""
    n = len(diagonal)
    matrices = []
    for i in range(n):
        for j in range(i + 1, n):
            x = [[0] * n for _ in range(n)]
            x[i][j], x[j][i] = diagonal[j], -diagonal[i]
            matrices.append(x)
    return LieAlgebra.from_matrices(matrices)


def quaternion_pure(a: int, b: int) -> LieAlgebra:
    """The quaternions without trace of the algebra i^2 = a, j^2 = b: a rational form of sl(2)."""
    return LieAlgebra({(0, 1): {2: 2}, (1, 2): {0: -2 * b}, (2, 0): {1: -2 * a}}, dimension=3)


def _left(a: int, b: int) -> list[list[list[int]]]:
    """Left multiplication by 1, i, j, k in the basis 1, i, j, k."""
    one = [[int(r == c) for c in range(4)] for r in range(4)]
    i = [[0, a, 0, 0], [1, 0, 0, 0], [0, 0, 0, a], [0, 0, 1, 0]]
    j = [[0, 0, b, 0], [0, 0, 0, -b], [1, 0, 0, 0], [0, -1, 0, 0]]
    return [one, i, j, [[sum(i[r][s] * j[s][c] for s in range(4)) for c in range(4)] for r in range(4)]]


def quaternion_special(a: int, b: int) -> LieAlgebra:
    """sl(2, D) of a quaternion algebra D, dimension 15: a rational form of sl(4)."""
    units, matrices = _left(a, b), []
    for r in range(2):
        for c in range(2):
            for u, unit in enumerate(units):
                if r == c and u == 0:
                    continue
                x = [[0] * 8 for _ in range(8)]
                for s in range(4):
                    x[4 * r + s][4 * c : 4 * c + 4] = unit[s]
                matrices.append(x)
    matrices.append([[(1 if r < 4 else -1) if r == c else 0 for c in range(8)] for r in range(8)])
    return LieAlgebra.from_matrices(matrices)


def unitary(diagonal: Sequence[int], d: int) -> LieAlgebra:
    """su of a diagonal Hermitian form over QQ(sqrt(-d))."""
    n = len(diagonal)

    def real(entries: dict[tuple[int, int], tuple[int, int]]) -> list[list[int]]:
        x = [[0] * (2 * n) for _ in range(2 * n)]
        for (r, c), (u, v) in entries.items():  # u + v sqrt(-d) acts on (1, sqrt(-d))
            x[2 * r][2 * c], x[2 * r][2 * c + 1], x[2 * r + 1][2 * c], x[2 * r + 1][2 * c + 1] = u, -d * v, v, u
        return x

    matrices = [real({(i, i): (0, 1), (i + 1, i + 1): (0, -1)}) for i in range(n - 1)]
    for i in range(n):
        for j in range(i + 1, n):
            p, q = diagonal[i], diagonal[j]
            matrices += [real({(i, j): (q, 0), (j, i): (-p, 0)}), real({(i, j): (0, q), (j, i): (0, p)})]
    return LieAlgebra.from_matrices(matrices)


def extended(algebra: LieAlgebra, modulus: Sequence[int]) -> LieAlgebra:
    """g tensor QQ[t]/(t^m + ... ), with ascending coefficients: restriction of scalars, or jets where it is t^m."""
    m, n = len(modulus) - 1, algebra.dimension
    power = [[int(i == e) for i in range(m)] for e in range(m)]
    for _ in range(m, 2 * m - 1):
        last = power[-1]
        power.append([(last[i - 1] if i else 0) - last[-1] * modulus[i] for i in range(m)])
    table: dict[tuple[int, int], dict[int, Any]] = {}
    for i, j, k, v in algebra.structure_constants():
        for a in range(m):
            for b in range(m):
                row = table.setdefault((a * n + i, b * n + j), {})
                for c, x in enumerate(power[a + b]):
                    if x:
                        row[c * n + k] = row.get(c * n + k, 0) + x * v
    return LieAlgebra(table, dimension=m * n)


# -- modules and derivations ---------------------------------------------------------------------------------
def with_module(name: str, *modules: Callable[[lh.Representation], lh.Representation]) -> LieAlgebra:
    """The semidirect sum of a catalogue algebra with modules made from its defining representation."""
    rho = lh.catalog.representation(name)
    total = modules[0](rho)
    for module in modules[1:]:
        total = total.direct_sum(module(rho))
    return lh.semidirect_sum(total.algebra, total.matrices)


def on_heisenberg(name: str, n: int, *, dilation: bool = False) -> LieAlgebra:
    """A subalgebra of sp(2n, R), perhaps with a dilation, acting on the Heisenberg algebra of dimension 2n + 1."""
    rho = lh.catalog.representation(name)
    blocks = [[*([*row, 0] for row in matrix.to_rows()), [0] * (2 * n + 1)] for matrix in rho.matrices]
    algebra = rho.algebra
    if dilation:
        algebra = lh.direct_sum(algebra, lh.abelian(1))
        blocks.append([[(2 if i == 2 * n else 1) if i == j else 0 for j in range(2 * n + 1)] for i in range(2 * n + 1)])
    return lh.semidirect_sum(algebra, blocks, lh.heisenberg(n))


def polynomials_in(matrix: Any, count: int) -> list[Any]:
    """The first powers of a matrix, which commute."""
    field_matrix = lh.QQ.matrix(matrix)
    found = [field_matrix]
    while len(found) < count:
        found.append(found[-1] @ field_matrix)
    return found


def companion(coefficients: Sequence[int]) -> list[list[int]]:
    """The matrix whose characteristic polynomial is t^n + sum of coefficients[i] t^i."""
    n = len(coefficients)
    return [[int(i == j + 1) if j < n - 1 else -coefficients[i] for j in range(n)] for i in range(n)]


# -- families ------------------------------------------------------------------------------------------------
SIMPLE = (
    *("so(3)", "sl(2)", "sl(3)", "su(3)", "su(2,1)", "so(3,1)", "so(5)", "so(4,1)", "so(3,2)", "sp(1,1)", "sp(4,R)"),
    *("g2", "g2(2)", "sl(4)", "su(4)", "su(3,1)", "su(2,2)", "sl(2,H)", "so*(6)", "so(5,1)", "sl(3,C)", "so(5,C)"),
    *("so(7)", "so(6,1)", "so(5,2)", "so(4,3)", "sp(3)", "sp(2,1)", "sp(6,R)", "sl(5)", "su(3,2)", "su(4,1)"),
    *("so(8)", "so(7,1)", "so(6,2)", "so(5,3)", "so(4,4)", "so*(8)"),
)


def semisimple_sum(rng: random.Random) -> Named:
    wanted, names, total = rng.randint(LEAST, LARGEST), [], 0
    while total < wanted:
        name = rng.choice(SIMPLE)
        dimension = lh.catalog.algebra(name).dimension
        if total + dimension <= LARGEST:
            names.append(name)
            total += dimension
        elif total:
            break
    return "+".join(names), lh.direct_sum(*map(lh.catalog.algebra, names))


def hard_form(rng: random.Random) -> Named:
    """Forms that are not split over QQ: anisotropic, quaternionic, Hermitian, restriction of scalars."""
    primes = (1, 2, 3, 5, 7, 11)
    kind = rng.randrange(6)
    signs = [rng.choice((-1, 1)) for _ in range(6)]
    if kind == 0:
        diagonal = [s * rng.choice(primes) for s, _ in zip(signs, range(rng.randint(3, 6)), strict=False)]
        return f"so of diag{tuple(diagonal)}", orthogonal(diagonal)
    if kind == 1:
        a, b = signs[0] * rng.choice(primes[1:]), signs[1] * rng.choice(primes[1:])
        other = lh.catalog.algebra(rng.choice(("su(2,1)", "sl(2,H)", "so(4,1)", "so(3)")))
        return f"pure quaternions ({a},{b}) + {other.name}", lh.direct_sum(quaternion_pure(a, b), other)
    if kind == 2:
        a, b = signs[0] * rng.choice(primes[1:4]), signs[1] * rng.choice(primes[1:4])
        return f"sl(2) over the quaternions ({a},{b})", quaternion_special(a, b)
    if kind == 3:
        diagonal = [s * rng.choice(primes[:3]) for s, _ in zip(signs, range(rng.randint(2, 4)), strict=False)]
        d = rng.choice((1, 2, 3, 7))
        return f"su of diag{tuple(diagonal)} over QQ(sqrt({-d}))", unitary(diagonal, d)
    modulus = rng.choice(([-2, 0, 1], [-3, 0, 1], [1, 0, 1], [7, 0, 1], [-2, 0, 0, 1], [1, -3, 0, 1], [1, 1, 1, 1, 1]))
    inner = rng.choice((lh.sl(2), lh.so(3), quaternion_pure(-1, -3), quaternion_pure(2, 5), lh.so(4)))
    inner = inner if (len(modulus) - 1) * inner.dimension <= LARGEST else lh.sl(2)
    return f"{inner.name or 'quaternions'} over QQ[t]/{tuple(modulus)}", extended(inner, modulus)


def identity(rho: lh.Representation) -> lh.Representation:
    return rho


def dual(rho: lh.Representation) -> lh.Representation:
    return rho.dual()


def square(rho: lh.Representation) -> lh.Representation:
    return rho.symmetric_power(2)


def cube(rho: lh.Representation) -> lh.Representation:
    return rho.symmetric_power(3)


def wedge(rho: lh.Representation) -> lh.Representation:
    return rho.exterior_power(2)


def semidirect(rng: random.Random) -> Named:
    """A semisimple or reductive algebra acting on modules, or on a Heisenberg algebra."""
    if rng.random() < 0.25:
        name, n = rng.choice((("sl(2)", 1), ("sp(4,R)", 2), ("u(2)", 2), ("so(3,1)", 2), ("u(1,1)", 2)))
        if name == "so(3,1)":
            name = "sl(2,C)"
            rho = lh.catalog.representation(name)
            return "sl(2,C) on R^4", lh.semidirect_sum(rho.algebra, rho.matrices)
        dilation = rng.random() < 0.5
        if name.startswith("u"):
            rho = lh.catalog.representation(name)
            return f"{name} on R^4", lh.semidirect_sum(rho.algebra, rho.matrices)
        return f"{name} on heisenberg({n}){' with dilation' * dilation}", on_heisenberg(name, n, dilation=dilation)
    name = rng.choice(("sl(2)", "so(3)", "sl(2)", "so(3)", "sl(3)", "so(2,1)", "so(4)", "so(3,1)", "su(2)", "su(2,1)",
                       "so(4,1)", "so(5)", "sp(4,R)", "gl(2)", "gl(3)", "sl(4)", "g2", "su(3)", "sl(2,H)"))  # fmt: skip
    rho = lh.catalog.representation(name)
    room = LARGEST - rho.algebra.dimension
    known = (identity, dual, square, cube, wedge)
    chosen = [m for m in rng.sample(known, len(known)) if m(rho).size <= room][: rng.randint(1, 2)]
    while sum(m(rho).size for m in chosen) > room:
        chosen.pop()
    return f"{name} on {'+'.join(m.__name__ for m in chosen)}", with_module(name, *chosen)


def solvable(rng: random.Random) -> Named:
    """Tori acting on abelian or nilpotent ideals, with rational, irrational and complex weights."""
    kind = rng.randrange(4)
    if kind == 0:
        n = rng.randint(2, 8)
        matrix = [[rng.choice((0, 0, 0, 1, -1, 2)) for _ in range(n)] for _ in range(n)]
        return f"R on R^{n}, a random matrix", lh.semidirect_sum(lh.abelian(1), [matrix])
    if kind == 1:
        n, k = rng.randint(3, 9), rng.randint(1, 3)
        matrix = companion([rng.choice((-3, -2, -1, 0, 1, 2)) for _ in range(n)])
        return f"R^{k} on R^{n}, powers of a companion matrix", lh.semidirect_sum(
            lh.abelian(k), polynomials_in(matrix, k)
        )
    if kind == 2:
        n = rng.randint(3, 6)
        name = f"upper({n})"
        return name, lh.catalog.algebra(name)
    parts = [rng.choice(("aff(1)", "e(2)", "heisenberg(1)", "R^2", "upper(2)", "upper(3)")) for _ in range(3)]
    return "+".join(parts), lh.direct_sum(*map(lh.catalog.algebra, parts))


def nilpotent(rng: random.Random) -> Named:
    """Two-step algebras, filiform ones, strictly triangular matrices, jets of simple algebras without constants."""
    kind = rng.choice((0, 0, 0, 1, 2, 2, 2, 3))
    if kind == 0:
        m, z = rng.randint(3, 12), rng.randint(1, 6)
        table = {
            (i, j): {m + k: rng.choice((0, 0, 1, -1, 2)) for k in range(z)} for i in range(m) for j in range(i + 1, m)
        }
        return f"two-step, {m} generators, {z} brackets", LieAlgebra(table, dimension=m + z)
    if kind == 1:
        n = rng.randint(3, 12)
        return f"filiform of dimension {n}", LieAlgebra({(0, i): {i + 1: 1} for i in range(1, n - 1)}, dimension=n)
    if kind == 2:
        n = rng.randint(4, 8)
        chosen = []
        while len(chosen) < rng.randint(2, 4):
            x = [[rng.choice((0, 0, 1, -1)) if i < j else 0 for j in range(n)] for i in range(n)]
            if any(map(any, x)) and lh.QQ.matrix([[v for row in y for v in row] for y in [*chosen, x]]).rank() > len(
                chosen
            ):
                chosen.append(x)
        return f"strictly triangular in gl({n})", LieAlgebra.from_matrices(chosen)
    m = rng.randint(3, 4)
    jets = extended(rng.choice((lh.so(3), lh.sl(2), lh.gl(2))), [0] * m + [1])
    n = jets.dimension // m
    rows = [[int(i + n == j) for j in range(jets.dimension)] for i in range(jets.dimension - n)]
    return f"jets of order {m - 1} without constants", jets.subalgebra(rows).as_algebra()


def generated(rng: random.Random) -> Named:
    """Subalgebras of gl(n) generated by sparse random matrices."""
    while True:
        n, count = rng.randint(3, 6), rng.randint(2, 3)
        matrices = []
        for _ in range(count):
            x = [[0] * n for _ in range(n)]
            for _ in range(rng.randint(1, n)):
                x[rng.randrange(n)][rng.randrange(n)] = rng.choice((1, -1, 1, 2))
            matrices.append(x)
        if lh.QQ.matrix([[v for row in x for v in row] for x in matrices]).rank() < count:
            continue
        algebra = LieAlgebra.from_matrices(matrices)
        if LEAST <= algebra.dimension <= LARGEST:
            return f"{count} sparse matrices in gl({n})", algebra


def with_radical(rng: random.Random) -> Named:
    """Direct sums of semisimple, solvable and nilpotent algebras, and jets g tensor QQ[t]/(t^m)."""
    if rng.random() < 0.3:
        m = rng.randint(2, 3)
        name = rng.choice(("so(3)", "sl(2)", "so(3,1)", "su(2,1)"))
        return f"jets of {name}, order {m - 1}", extended(lh.catalog.algebra(name), [0] * m + [1])
    parts = [rng.choice(SIMPLE[:13]), rng.choice(("R", "R^3", "gl(2)", "so(3)", "e(3)", "e(4)"))]
    parts.append(rng.choice(("heisenberg(1)", "heisenberg(2)", "upper(3)", "aff(1)", "e(2)", "affine(so(3))")))
    return "+".join(parts), lh.direct_sum(*map(lh.catalog.algebra, parts))


PARABOLIC = (
    *("sl(3)/B", "sl(4)/P1", "sl(4)/P2", "sl(4)/B", "sl(5)/P2", "so(4,1)/P", "so(3,2)/P1", "so(3,2)/P2", "su(2,1)/P"),
    *("sp(4,R)/P1", "sp(4,R)/P2", "g2(2)/P", "so(5,1)/P", "sl(2,H)/P1", "sp(1,1)/P", "su(2,2)/P2", "so(4,2)/P2"),
    *("sp(6,R)/P1", "sp(2,1)/P", "sl(5)/P1", "sl(6)/P2", "so(4,3)/P1"),
)


def parabolic(rng: random.Random) -> Named:
    name = rng.choice(PARABOLIC)
    return f"the parabolic of {name}", lh.pair(name).subalgebra.as_algebra()


FAMILIES: dict[str, tuple[Family, int]] = {
    "semisimple": (semisimple_sum, 26),
    "hard_forms": (hard_form, 34),
    "semidirect": (semidirect, 36),
    "solvable": (solvable, 22),
    "nilpotent": (nilpotent, 22),
    "generated": (generated, 24),
    "with_radical": (with_radical, 20),
    "parabolic": (parabolic, 16),
}


def random_algebras(family: str) -> Iterator[Named]:
    """The algebras of a family, each in its own random basis."""
    make, count = FAMILIES[family]
    for index in range(count):
        rng = random.Random(f"{SEED} {family} {index}")
        label, algebra = make(rng)
        while not LEAST <= algebra.dimension <= LARGEST:
            label, algebra = make(rng)
        yield label, scrambled(algebra, rng)
