"""The tasks of the structure theory that are timed, here and in GAP, with the figures that other programs have.

A task prepares fresh objects (nothing is cached in them), does one thing that is timed, and says what must come out.
`gap` asks the same of GAP: statements that set the data up, an expression that makes a fresh object, and a function
of it that is timed.  Figures of Sage and dgcv were taken beside GAP's on one machine, and are scaled by GAP's.
"""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from typing import Any

import liehom as lh
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import products
from liehom.exact.algebra.linear.closure import lie_closure

Action = Callable[[], Any]
Question = Callable[[LieAlgebra], Any]
InGap = tuple[str, str, str]
DIMENSIONS = (10, 20, 50)


@dataclass(frozen=True)
class Task:
    """One row of the table."""

    name: str
    prepare: Callable[[], Action]
    expected: Any
    gap: InGap
    limit: float = 60.0  # GAP is stopped after so many seconds by the clock
    factor: float | None = None  # demanded are at most factor times the seconds of GAP
    others: Mapping[str, tuple[float, float]] = field(default_factory=dict)  # program: its seconds, GAP's beside it

    @property
    def large(self) -> bool:
        """Whether the algebra has at least 20 dimensions, so that demands hold against Sage and dgcv."""
        return not self.name.endswith(("dim 10", "n = 6"))


# -- algebras --------------------------------------------------------------------------------------------
def scrambled(algebra: LieAlgebra, seed: int) -> LieAlgebra:
    """The algebra in another basis: n row operations with small coefficients, some of them fractions."""
    rng, n = random.Random(seed), algebra.dimension
    rows = [[Fraction(i == j) for j in range(n)] for i in range(n)]
    for _ in range(n):
        i, j = rng.sample(range(n), 2)
        c = rng.choice((Fraction(1), Fraction(-1), Fraction(2), Fraction(1, 2), Fraction(-1, 3)))
        rows[i] = [x + c * y for x, y in zip(rows[i], rows[j], strict=True)]
    return algebra.change_of_basis([[str(x) for x in row] for row in rows])


@cache
def mixed(dimension: int) -> LieAlgebra:
    """A Lie algebra with a radical, of dimension 20 and 50 with several direct summands, in a scrambled basis.

    10: so(4) with R^4. 20: sl(3) with R^3, sl(2) with the Heisenberg algebra, so(3). 50: so(5) with R^5, sl(4) with
    R^4, so(4) with R^4, sl(2) with the Heisenberg algebra.
    """
    planar = [_on_heisenberg(a) for a in lh.defining(lh.sl(2)).matrices]
    schroedinger = lh.semidirect_sum(lh.sl(2), planar, lh.heisenberg(1))
    affine = {n: lh.affine_of(lh.defining(lh.sl(n)).matrices) for n in (3, 4)}
    parts = {
        10: [lh.euclidean(4)],
        20: [affine[3], schroedinger, lh.so(3)],
        50: [lh.euclidean(5), affine[4], lh.euclidean(4), schroedinger],
    }[dimension]
    return scrambled(lh.direct_sum(*parts), dimension)


def _on_heisenberg(matrix: Any) -> list[list[Any]]:
    """A matrix of sl(2) as a derivation of the Heisenberg algebra, basis x, y, z."""
    (a, b), (c, d) = matrix.to_rows()
    return [[a, b, 0], [c, d, 0], [0, 0, 0]]


def fresh(algebra: LieAlgebra) -> LieAlgebra:
    """The same algebra with nothing computed yet."""
    t = algebra.table
    table = StructureConstants.from_integers(t.field, t.dimension, t.i, t.j, t.k, list(t.parts[0]), t.den)
    return LieAlgebra(table, basis=algebra.basis_names, check=False)


@cache
def exceptional(name: str) -> LieAlgebra:
    return lh.chevalley(name)


@cache
def module(kind: str, weight: tuple[int, ...]) -> lh.Representation:
    return lh.highest_weight_module(kind, weight).representation


@cache
def quadratic_forms(n: int) -> lh.Representation:
    return lh.sym_conjugation(n)


def skew_pair(n: int) -> list[list[list[int]]]:
    """Two skew matrices with random entries of one digit; they generate so(n)."""
    rng, made = random.Random(n), []
    for _ in range(2):
        a = [[0] * n for _ in range(n)]
        for i in range(n):
            for j in range(i):
                a[i][j] = rng.randint(-3, 3)
                a[j][i] = -a[i][j]
        made.append(a)
    return made


def generic(n: int) -> list[int]:
    """A vector with entries of one digit that no small subspace holds."""
    rng = random.Random(n)
    return [rng.randint(-9, 9) for _ in range(n)]


def squares(n: int) -> list[int]:
    """The symmetric matrix diag(1, 4, 9, ...) as coordinates of Sym(n)."""
    return [(i + 1) ** 2 if i == j else 0 for i in range(n) for j in range(i, n)]


# -- in GAP ----------------------------------------------------------------------------------------------
def simple_in_gap(name: str) -> str:
    return f'SimpleLieAlgebra( "{name[0]}", {name[1:]}, Rationals )'


def module_in_gap(kind: str, weight: tuple[int, ...]) -> str:
    """[ g, V ]; GAP numbers the simple roots of F4 in another order than Bourbaki."""
    order = (1, 3, 2, 0) if kind == "F4" else range(len(weight))
    shown = [weight[i] for i in order]
    return (
        f"CallFuncList( function( g ) return [ g, HighestWeightModule( g, {shown} ) ]; end, [ {simple_in_gap(kind)} ] )"
    )


def stabilizer_in_gap(size: int) -> str:
    """{x : x v = 0} in a module: one null space."""
    return (
        f"function( p ) local v; v := Sum( [ 1 .. {size} ], i -> {generic(size)}[i] * Basis( p[2] )[i] );; "
        "return Length( NullspaceMat( List( BasisVectors( Basis( p[1] ) ), "
        "x -> Coefficients( Basis( p[2] ), x^v ) ) ) ); end"
    )


FORMS_IN_GAP = (
    "B_ := [];; for i_ in [ 1 .. 20 ] do for j_ in [ 1 .. i_ - 1 ] do A_ := NullMat( 20, 20 ); A_[i_][j_] := 1; "
    "A_[j_][i_] := -1; Add( B_, A_ ); od; od;; S_ := DiagonalMat( List( [ 1 .. 20 ], i -> i ^ 2 ) );;"
)


# -- rows ------------------------------------------------------------------------------------------------
def of_mixed(name: str, question: Question, in_gap: str, expected: Mapping[int, Any], **more: Any) -> list[Task]:
    """A question about the mixed algebras; a mapping among the rest is read by dimension."""
    made = []
    for n in expected:
        chosen = {key: v[n] for key, v in more.items() if isinstance(v, Mapping) and n in v}
        chosen |= {key: v for key, v in more.items() if not isinstance(v, Mapping)}

        def prepare(n: int = n) -> Action:
            algebra = fresh(mixed(n))
            return lambda: question(algebra)

        gap = (lh.io.to_gap(mixed(n)), "LieAlgebraByStructureConstants( Rationals, L_T )", in_gap)
        made.append(Task(f"{name}, dim {n}", prepare, expected[n], gap, **chosen))
    return made


def of_e8(name: str, question: Question, in_gap: str, expected: Any, **more: Any) -> Task:
    def prepare() -> Action:
        algebra = fresh(exceptional("E8"))
        return lambda: question(algebra)

    return Task(f"{name}, E8", prepare, expected, ("", simple_in_gap("E8"), in_gap), **more)


def of_module(kind: str, weight: tuple[int, ...], size: int, dimension: int) -> list[Task]:
    """Making a module, and the stabilizer of a generic vector in it."""

    def make() -> Action:
        return lambda: lh.highest_weight_module(kind, weight).dimension

    def stabilizer() -> Action:
        rho, point = module(kind, weight), generic(size)
        return lambda: rho.isotropy(point).dimension

    made, in_gap = f"{kind} on {size}", module_in_gap(kind, weight)
    matrices = "p -> Length( List( BasisVectors( Basis( p[1] ) ), x -> MatrixOfAction( Basis( p[2] ), x ) ) )"
    return [
        Task(f"{made}: matrices", make, size, ("", in_gap, matrices)),
        Task(f"{made}: stabilizer of a generic vector", stabilizer, dimension, ("", in_gap, stabilizer_in_gap(size))),
    ]


def of_closure(n: int, **more: Any) -> Task:
    def prepare() -> Action:
        pair = skew_pair(n)
        return lambda: lie_closure(pair).algebra.dimension

    in_gap = ("", str(skew_pair(n)), "m -> Dimension( LieAlgebra( Rationals, m ) )")
    return Task(f"Lie closure of two skew matrices, n = {n}", prepare, n * (n - 1) // 2, in_gap, **more)


def _of_forms() -> Task:
    def prepare() -> Action:
        rho, point = quadratic_forms(20), squares(20)
        return lambda: rho.isotropy(point).dimension

    in_gap = "m -> Length( NullspaceMat( List( m, x -> Concatenation( x * S_ - S_ * x ) ) ) )"
    return Task("so(20) on Sym(20): stabilizer", prepare, 0, (FORMS_IN_GAP, "ShallowCopy( B_ )", in_gap))


def _jacobi() -> Task:
    def prepare() -> Action:
        algebra = fresh(exceptional("E8"))
        return lambda: prove_jacobi(algebra.table, algebra.basis_names)

    in_gap = (f"T_ := StructureConstantsTable( Basis( {simple_in_gap('E8')} ) );;", "T_", "TestJacobi")
    return Task("Jacobi identity of all triples, E8", prepare, None, in_gap, factor=1 / 5)


def _derived(algebra: LieAlgebra) -> int:
    whole = algebra.field.identity(algebra.dimension)
    return int(products(algebra, whole, whole).nrows)


def tasks() -> list[Task]:
    build = Task(
        "build, E8", lambda: lambda: lh.chevalley("E8").dimension, 248, ("", '"E"', BUILD), others=SEEN["build"]
    )
    e8 = [
        of_e8("Killing form", lambda g: g.killing_form().nrows, "L -> Length( KillingMatrix( Basis( L ) ) )", 248,
              factor=1 / 5, others=SEEN["killing"]),
        _jacobi(),
        of_e8("stabilizer of a generic element", lambda g: g.centralizer([generic(248)]).dimension, CENTRALIZER, 8,
              factor=1 / 5),
        of_e8("Cartan subalgebra", lambda g: g.cartan_subalgebra().dimension,
              "L -> Dimension( CartanSubalgebra( L ) )", 8),
        of_e8("type", lambda g: g.semisimple_type(), "SemiSimpleType", "E8"),
    ]  # fmt: skip
    general = [
        *of_mixed("radical", lambda g: g.radical().dimension, "L -> Dimension( LieSolvableRadical( L ) )",
                  {10: 4, 20: 6, 50: 16}, factor=3, others=SEEN["radical"]),
        *of_mixed("Levi factor", lambda g: g.levi_decomposition().levi.dimension,
                  "L -> Dimension( LeviMalcevDecomposition( L )[1] )", {10: 6, 20: 14, 50: 34}, factor=3,
                  others=SEEN["levi"]),
        *of_mixed("Cartan subalgebra", lambda g: g.cartan_subalgebra().dimension,
                  "L -> Dimension( CartanSubalgebra( L ) )", {10: 2, 20: 5, 50: 10}, factor=3),
        *of_mixed("Levi factor and its type", lambda g: g.semisimple_type(),
                  "L -> SemiSimpleType( LeviMalcevDecomposition( L )[1] )",
                  {10: "A1 + A1", 20: "A1 + A1 + A2", 50: "A1 + A1 + A1 + A3 + B2"}, factor=3),
        *of_mixed("centre", lambda g: g.center().dimension, "L -> Dimension( LieCentre( L ) )",
                  {10: 0, 20: 1, 50: 1}, others=SEEN["centre"]),
        *of_mixed("derived algebra", _derived,
                  "L -> Dimension( LieDerivedSubalgebra( L ) )", {10: 10, 20: 20, 50: 50}, others=SEEN["derived"]),
        *of_mixed("direct sum decomposition", lambda g: len(g.direct_sum_decomposition()),
                  "L -> Length( DirectSumDecomposition( L ) )", {20: 3, 50: 4}, factor={50: 1 / 5}),
    ]  # fmt: skip
    modules = [_of_forms(), *of_module("F4", (0, 0, 0, 1), 26, 28), *of_module("E7", (0, 0, 0, 0, 0, 0, 1), 56, 78)]
    closures = [
        of_closure(6, others={"Sage": (0.42, 0.006)}),
        of_closure(10, others={"Sage": (11.0, 0.98)}),
        of_closure(15, factor=1 / 5),
    ]
    return [build, *e8, *general, *modules, *closures]


BUILD = "name -> Dimension( SimpleLieAlgebra( name, 8, Rationals ) )"
CENTRALIZER = (
    f"function( L ) local x; x := LinearCombination( Basis( L ), {generic(248)} ); "
    'return Dimension( LieCentralizer( L, Subalgebra( L, [ x ], "basis" ) ) ); end'
)
# passagemath 10.8.13 and dgcv 0.6.0 beside GAP 4.12 on one machine: (its seconds, GAP's); Sage's Killing form: more
SEEN: dict[str, Any] = {
    "build": {"Sage": (1.0, 0.09), "dgcv": (0.66, 0.09)},
    "killing": {"Sage": (60.0, 0.83), "dgcv": (0.22, 0.83)},
    "levi": {10: {"dgcv": (0.10, 0.006)}, 20: {"dgcv": (1.9, 0.035)}, 50: {"dgcv": (52.0, 1.6)}},
    "radical": {
        10: {"Sage": (0.055, 0.0016), "dgcv": (0.029, 0.0016)},
        20: {"Sage": (0.41, 0.0056), "dgcv": (0.22, 0.0056)},
        50: {"Sage": (14.0, 0.055), "dgcv": (1.4, 0.055)},
    },
    "centre": {50: {"Sage": (5.4, 0.017), "dgcv": (0.64, 0.017)}},
    "derived": {50: {"Sage": (14.0, 0.030), "dgcv": (0.96, 0.030)}},
}
