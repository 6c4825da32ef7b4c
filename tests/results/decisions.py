"""Decisions of fullness: verdicts, certificates and failure reports of 100 pairs."""

import dataclasses
import random
from collections.abc import Callable
from functools import partial
from typing import Any

import liehom as lh
from tests.results.bases import over, scrambled
from tests.results.values import Long, flat

PLAIN = (
    *("so(4)/so(3)", "so(12)/so(11)", "su(4)/u(3)", "sp(2,1)/sp(2)+sp(1)", "f4/spin(9)", "g2/su(3)", "so(8)/spin(7)"),
    *("e6(6)/P", "sl(3,C)/P1", "affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))", "so(6,1)/P", "su(1,1)/P"),
    *("affine(form(1,2,5))", "affine(sp(2)+sp(1)+R)", "affine(sp(4,C)+u(1))", "affine(spin(7))"),
    *("affine(sl(2,Q(-1,-3)))", "affine(spiral(1,1))", "0/0", "sym(4;3,1)", "so(3,1)/so(2,1)", "so(5)/so(3)+so(2)"),
    *("su(4)/s(u(2)+u(2))", "sp(4)/sp(2)+sp(2)", "sl(4)/P2", "sl(3)/B", "su(2,1)/P", "g2(2)/P1", "spin(9)/spin(7)"),
    *("heisenberg(1)/R", "affine(form(1,-2)+R)", "affine(so(4,C)+R)", "affine(so*(4))"),
    *("affine(tensor(sl(2),sl(3)))", "affine(sl(2,Q(-1,3)))", "affine(field(1,1,1,1))", "affine(S3(gl(2)))"),
    *("affine(copies(2,sl(2)))", "affine(spiral(1,1,2))", "sym(4;2,2)"),
)
SCRAMBLED = (
    *("so(5)/so(4)", "su(3)/u(2)", "su(2,1)/u(2)", "sp(1,1)/sp(1)+sp(1)", "sl(3)/P1", "sl(2,C)/P1", "so(4,1)/P"),
    *("affine(u(2))", "affine(sl(2,C))", "affine(gl(3))", "affine(sp(4,R))", "e(3)/so(3)", "affine(gl(1,H))"),
    *("sym(3;2,1)", "so(3,2)/so(2,2)", "so(4)/0", "su(3)/so(3)", "su(2,1)/u(1,1)", "sp(4,R)/gl(2)"),
    *("sl(3)/s(gl(2)+gl(1))", "sp(4,R)/P2", "affine(form(1,1,-3))", "affine(su(1,1))", "affine(field(-2,0,0))"),
    *("affine(S2(gl(2)))", "affine(L2(sl(4)))", "affine(upper(3))", "affine(tensor(sl(2),sl(2)))"),
    *("affine(diag(1,2))", "affine(so(3,C))"),
)
OVER_FIELDS = (
    ("so(4)/so(3)", "sqrt(2)"),
    ("su(2,1)/u(2)", "sqrt(2)"),
    ("sl(3)/P1", "sqrt(5)"),
    ("affine(form(1,-2))", "sqrt(2)"),
    ("affine(form(1,-2)+R)", "sqrt(3)"),
    ("affine(field(-2,0,0))", "cbrt(2)"),
    ("affine(gl(1,C))", "cbrt(2)"),
    ("affine(sl(2,Q(sqrt(2))))", "sqrt(2)"),
    ("affine(su(2))", "heptagon"),
    ("so(3,1)/so(2,1)", "heptagon"),
    ("affine(tensor(sl(2),sl(2)))", "sqrt(2)"),
    ("affine(upper(2))", "cbrt(2)"),
)
EMBEDDED = ((2, 1), (2, -1), (3, 1), (3, -1), (4, 1), (4, -1))
"""diag(1, ..., 1, a) with a the positive or the negative square root of 2: definite in one embedding only."""
LINEAR = range(10)
FLOATS = ("so(4)/so(3)", "so(3,1)/so(2,1)")


def number_field(name: str) -> Any:
    if name == "cbrt(2)":
        return lh.scalars.NumberField("a", [-2, 0, 0, 1], (1, 2))
    if name == "heptagon":
        return lh.scalars.NumberField("a", [-1, -2, 1, 1], (1, 2))
    return lh.number_field(name)


def affine(matrices: Any) -> lh.Pair:
    """h + V over h, for matrices that span a Lie algebra h."""
    rho = lh.Representation.from_matrices(matrices)
    g = lh.semidirect_sum(rho.algebra, rho.matrices)
    return lh.Pair(g, g.field.identity(g.dimension).select(rows=range(rho.algebra.dimension)))


def embedded(size: int, sign: int) -> lh.Pair:
    """so of the form diag(1, ..., 1, a) over the field of a, on its vectors."""
    field = lh.scalars.NumberField("a", [-2, 0, 1], (1, 2) if sign > 0 else (-2, -1))
    diagonal = [field.one] * (size - 1) + [field.generator]
    maps = []
    for i in range(size):
        for j in range(i):
            rows = [[field.zero] * size for _ in range(size)]
            rows[i][j], rows[j][i] = 1 / diagonal[i], -1 / diagonal[j]
            maps.append(field.matrix(rows))
    return affine(maps)


def commuting(seed: int) -> lh.Pair:
    """Powers of a random matrix, with denominators: an abelian h on R^3 to R^5."""
    rng = random.Random(f"powers {seed}")
    n = rng.randint(3, 5)
    x = lh.QQ.matrix([[f"{rng.randint(-2, 2)}/{rng.randint(1, 3)}" for _ in range(n)] for _ in range(n)])
    powers, flat_rows = [x], [x.reshape(1, n * n)]
    while len(powers) < rng.randint(1, n):
        powers.append(powers[-1] @ x)
        flat_rows.append(powers[-1].reshape(1, n * n))
        if lh.QQ.stack_rows(flat_rows, n * n).rank() < len(powers):
            powers.pop()
            break
    return affine(powers)


def decided(make: Callable[[], lh.Pair]) -> dict[str, Any]:
    pair = make()
    verdict = lh.decide_fullness(pair)
    data = verdict.to_json()
    made: dict[str, Any] = {
        "pair": f"{pair.algebra.dimension}/{pair.subalgebra.dimension} over {pair.field.name}",
        "full": verdict.full,
        "verdict": str(verdict),
    }
    if data["certificate"] is not None:
        made["certificate"] = Long(data["certificate"], data["certificate"]["kind"])
        made["verified"] = verdict.verify()
    for key in ("eta", "eta_field", "rank", "rank_defect"):
        if key in data:
            made[key] = Long(data[key]) if isinstance(data[key], list) else data[key]
    for key in ("eta_numerical", "smallest_singular_value", "gap"):
        if key in data:
            made[key] = Long(list(flat([data[key]])))
    if not verdict.full and pair.field.exact and pair.dimension <= 12:
        report = verdict.where_it_fails()
        made["failure"] = failure_in_words_of_0_1_0(report)
        made["failure holds generically"] = str(report.generic.holds)
        made["failure parts"] = " ".join(part.kind for part in report.parts)
    return made


def failure_in_words_of_0_1_0(report: lh.fullness.FailureReport) -> str:
    """The sentence of a report without what was searched; 0.1.0 said it of the hypersurface only."""
    bare = dataclasses.replace(report, searched=(), not_searched=())
    hypersurface = next((part.description for part in report.parts if part.covers), None)
    text = str(bare)
    return text.replace(hypersurface, f"{hypersurface}, and nothing else up to codimension 2") if hypersurface else text


CASES: dict[str, Callable[[], dict[str, Any]]] = {
    **{name: partial(decided, partial(lh.pair, name)) for name in PLAIN},
    **{
        f"{name}, random basis": partial(decided, lambda name=name: scrambled(lh.pair(name), name))
        for name in SCRAMBLED
    },
    **{
        f"{name} over {field}": partial(
            decided, lambda name=name, field=field: scrambled(over(lh.pair(name), number_field(field)), name)
        )
        for name, field in OVER_FIELDS
    },
    **{
        f"diag(1, ..., {sign} * sqrt(2)) of size {size}": partial(decided, partial(embedded, size, sign))
        for size, sign in EMBEDDED
    },
    **{f"{name} over RR": partial(decided, lambda name=name: over(lh.pair(name), lh.RR)) for name in FLOATS},
    **{f"powers of a matrix, {seed}": partial(decided, partial(commuting, seed)) for seed in LINEAR},
}
