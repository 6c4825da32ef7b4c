"""The pages on the performance of integration, from the measured figures.

docs/performance-integration.md has all tables, and docs/performance.md a summary: the costs of other programs as
multiples of those of liehom. What is generated is between marks.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks.integration_measure import TARGETS, best
from tests.benchmarks.integration_methods import LLVM, SHORT
from tests.benchmarks.integration_pictures import MANY, PEERS, RATIOS, groups, image, multiples, picture_name
from tests.benchmarks.integration_problems import Problem, problems

BEGIN, END = "<!-- integration: begin -->", "<!-- integration: end -->"
EXPONENTS = ("10⁻³", "10⁻⁶", "10⁻⁹", "10⁻¹²")
BY, NARROW = "its cheapest method", "\u00a0"
"""What the row of methods is called, and a space at which no cell is broken."""


def shown(x: float | None, digits: int = 2) -> str:
    if x is None or not math.isfinite(x):
        return "-"
    if x and not 1e-3 <= abs(x) < 1e5:
        mantissa, power = f"{x:.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(power)}"
    return f"{x:.{digits}g}" if abs(x) < 10**digits - 0.5 else f"{x:.0f}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return [*lines, *("| " + " | ".join(row) + " |" for row in rows), ""]


# -- one problem -------------------------------------------------------------------------------------------
def _rows(
    name: str, rows: list[dict[str, Any]], problem: Problem, count: int, kinds: Sequence[tuple[float, bool]]
) -> list[list[str]]:
    """Costs of a program at errors of orbits (True) or trajectories, and below them the methods if they differ."""
    found = [best(problem, rows, count, target, orbit=orbit, call=False) for target, orbit in kinds]
    methods = [SHORT.get(label, label).replace(" ", NARROW) if math.isfinite(cost) else "" for cost, label in found]
    costs = [_call(rows, count), *(shown(cost) for cost, _ in found)]
    named = {method for method in methods if method}
    if len(named) == 1 and len({row["label"] for row in rows}) > 1:
        return [[f"{name}: {named.pop()}", *costs]]
    return [[name, *costs], *([[BY, "", *methods]] if len(named) > 1 else [])]


def _call(rows: list[dict[str, Any]], count: int) -> str:
    measured = [row["costs"][str(count)] for row in rows if str(count) in row.get("costs", {})]
    known = [part["call"] for m in measured for part in m.get("at", {"": m}).values() if "call" in part]
    if not known:
        return "included"
    low, high = shown(min(known)), shown(max(known))
    return low if low == high else f"{low} to {high}"


def _has(rows: list[dict[str, Any]], count: int) -> bool:
    return any(str(count) in row.get("costs", {}) for row in rows)


def _missing(name: str, rows: list[dict[str, Any]], width: int) -> list[str]:
    return [name, "not installed" if all("missing" in row for row in rows) else "not measured", *[""] * (width - 2)]


def problem_part(problem: Problem, data: dict[str, Any]) -> list[str]:
    found = groups(data["methods"])
    title = f"{problem.title[0].upper()}{problem.title[1:]}"
    words = f"errors over CPU time for each program: {problem.title}"
    lines = [f"### {title}", "", *image(picture_name(problem), words)]
    orbit = "energy" if problem.energy is not None else "orbit"
    span = "" if problem.span == problem.trajectory_span else f" to T = {problem.trajectory_span:.0f}"
    wide = [f"{what} to{NARROW}{x}" for what in (orbit, "trajectory") for x in EXPONENTS]
    kinds = [(t, True) for t in TARGETS] + [(t, False) for t in TARGETS]
    if any(_has(rows, MANY) for rows in found.values()):
        lines += [f"10,000 trajectories, µs for each of them to T = {problem.span:.0f}:", ""]
        rows = [
            line
            for name, rows in found.items()
            if _has(rows, MANY) or all("missing" in row for row in rows)
            for line in (
                _rows(name, rows, problem, MANY, kinds) if _has(rows, MANY) else [_missing(name, rows, 2 + len(wide))]
            )
        ]
        lines += table(["program", "call", *wide], rows)
    few = [(1e-6, True), (1e-3, False), (1e-6, False), (1e-12, False)]
    names = [f"{orbit if on_orbit else 'trajectory'} to{NARROW}{EXPONENTS[TARGETS.index(t)]}" for t, on_orbit in few]
    lines += [f"One trajectory, µs to T = {problem.span:.0f} (errors of trajectories{span or ' too'}):", ""]
    one = [line for name, rows in found.items() if _has(rows, 1) for line in _rows(name, rows, problem, 1, few)]
    lines += table(["program", "call", *names], one)
    return lines


# -- the other parts -----------------------------------------------------------------------------------------
def conditions_part(data: dict[str, Any]) -> list[str]:
    c = data["conditions"]
    versions = ", ".join(f"{name} {version}" for name, version in c["versions"].items())
    loads = [p["load"] for p in data["problems"].values()]
    older = [n for n, p in data["problems"].items() if not any(m["label"] == "S8" for m in p["methods"])]
    earlier = f"* The tables of {', '.join(older)} were measured earlier, with a trace of the step in every call."
    return [
        f"Measured {c['date']} on one core of {c['cores']} ({c['processor']}) by `python -m tests.benchmarks.report`, "
        f"with {versions}. All fields are autonomous, and all trajectories of an ensemble have the same parameters.",
        "",
        "* Costs are CPU times of the process. The machine was shared, with a load between "
        f"{min(loads)} and {max(loads)}, so they vary by some ten per cent, and by up to a factor of 2 when other "
        "processes use the same caches and vector units. Ratios within a table are more accurate than its entries.",
        "* An error is the maximum over five times, and 90 % of the trajectories have at most this error.",
        "* The settings of each method are refined until the error of a column is reached, and costs are interpolated "
        "between settings. If a cost is the same for several errors, a setting coarser than the coarsest tested one "
        "might reach the larger of them.",
        "* Compile time and traces are excluded. Costs of whole calls by tolerance, also of 10 trajectories, are in "
        "[](performance.md).",
        '* The column "call" is the cost of a call besides its steps, per trajectory. Each method of liehom is a '
        "`Propagator` that was made once, as the objects of the other programs are.",
        '* The other columns are the cost of the steps. For a program with "included" in the column "call" they '
        "contain the cost of the call too. A dash means that no tested setting reaches the error.",
        *([earlier] if older else []),
        "* Of a program with several methods each cell shows the cheapest one. The next row names it, or the first "
        "column if it is the same in all cells. A number after a name is the order: LieTaylor 4 is `LieTaylor(4)`, "
        "Corrected 2 is `Corrected(Euler(), 2)`, Conserving 2 is `Conserving(LieTaylor(2), energy)`. RK4 and DOP853 "
        'are `RKMK("rk4")` and `RKMK("dop853")`, the latter with an adaptive step size, and "exact orbit" is '
        "`ExactOrbit`, the step of the rigid body that stays on the orbit.",
        "",
        "The other programs run as follows:",
        "",
        "* scipy's DOP853 with all trajectories as one system;",
        "* heyoka.py in batches of 8 with `fast_math`;",
        "* diffrax through `vmap` on ensembles of 1000, with the better one of Tsit5 and Dopri8;",
        '* the classical Runge-Kutta method in numba with the field as straight-line code, "one at a time" or in '
        'blocks of 16 trajectories ("lanes").',
        "",
    ]  # fmt: skip


def targets_part(data: dict[str, Any]) -> list[str]:
    k = data["targets"]

    def verdict(ratio: float, most: float) -> str:
        return "holds" if ratio <= most else f"missed by a factor of {shown(ratio / most)}"

    rows = []
    for kind in ("nominal", "corrected"):
        if kind in k:
            r = k[kind]
            text = f"{shown(r['compiled'])} ns, C {shown(r['C'])} ns, ratio {shown(r['ratio'], 3)} (clock: {kind})"
            rows.append(
                [
                    "compiled `Corrected(Euler(), 2)` at most 1.3 times C",
                    text,
                    verdict(r["ratio"], 1.3),
                ]
            )
    arrays = k["arrays"]["ratio"]
    rows.append(
        ["10⁴ trajectories in numpy at most 10 times numpy by hand", f"ratio {shown(arrays)}", verdict(arrays, 10)]
    )
    first, again = k["compile"]["first"], k["compile"]["again"]
    text = f"{shown(first)} s, with the code on disk {shown(again)} s"
    rows.append(["order 6 on S⁴ compiled in 5 s, and kept", text, verdict(first, 5)])
    text = f"{shown(k['one Euler'])} ns; corrected to order 2 {shown(k['one corrected'])} ns"
    rows.append(["one trajectory: below 100 ns for an Euler step", text, verdict(k["one corrected"], 100)])
    return ["### Compiled steps, numpy and C", "", *table(["target", "measured", ""], rows)]


def growth_part(data: dict[str, Any]) -> list[str]:
    found: dict[tuple[str, str], dict[str, str]] = {}
    calls: dict[str, dict[str, str]] = {}
    for row in data["growth"]:
        if row["what"].endswith((" first call", " a step")):  # of one trajectory on Sᵏ⁻¹, beside heyoka
            calls.setdefault(row["what"].split(" on ")[0], {})[row["unit"]] = ", ".join(shown(y) for y in row["y"])
            continue
        step, way = row["what"].removesuffix(", N = 1024").rsplit(", ", 1)
        last = f", {row['last']:.1f}" if math.isfinite(row["last"]) else ""
        against = f"{row['against']} = {', '.join(str(x) for x in row['x'])}"
        kind = "operations" if row["unit"] == "operations" else way
        cost = ", ".join(shown(y) for y in row["y"]) + ("" if kind == "operations" else f" {row['unit']}")
        found.setdefault((step, against), {})[kind] = f"{cost}: {row['exponent']:.1f}{last}"
    columns = ("operations", "compiled", "numpy")
    return [
        "### Growth of the cost with order, dimension and number of trajectories", "",
        "A cell has the costs of a step and, after the colon, the exponents: slopes by least squares of logarithms, of "
        "all and of the second half. The column numpy is for 1024 trajectories. An expansion to order n needs O(n²) "
        "products of coefficients. A generator that is affine in m on Sᵏ⁻¹ costs O(k dim g) = O((dim g)^1.5). "
        "Long ensembles cost O(N).", "",
        *table(["step", "against", *columns], [
            [*key, *(cells.get(column, "-") for column in columns)] for key, cells in found.items()
        ]),
        *table(["on Sᵏ⁻¹, k = 5, 8, 16, 24, 40", "first call, s", "a step, µs"], [
            [name, cells["s"], cells["µs"]] for name, cells in calls.items()
        ]),
    ]  # fmt: skip


def long_part(data: dict[str, Any]) -> list[str]:
    short = {problem.title: problem.name for problem in problems()}
    rows = [
        [
            short.get(row["problem"], row["problem"]), row["method"], shown(row["setting"]), shown(row["T"]),
            *(["not installed", "", ""] if "missing" in row else map(shown, (row["energy"], row["norm"], row["cost"]))),
        ]
        for row in data["long"]
    ]  # fmt: skip
    head = ["problem", "method", "step or tolerance", "T", "energy error", "norm error", "µs, whole call"]
    return [
        "### Long times, many spins", "",
        "Errors at the end of 16 trajectories to T = 10⁴ and of one closed chain of 10⁴ spins: the median error of the "
        "energy, and the largest error of the norm.", "", *table(head, rows),
    ]  # fmt: skip


def drift_part(data: dict[str, Any]) -> list[str]:
    """Table of the errors of norms and spectra at a trajectory error of 10^-6."""
    columns: list[str] = []
    for content in data["problems"].values():
        columns += [g for g in groups(content["methods"]) if g not in columns]
    columns = [c for c in columns if not c.startswith("liehom")]
    rows = []
    for name, content in data["problems"].items():
        found = groups(content["methods"])
        known = {g: [r["drift"] for r in rs if r.get("drift") is not None] for g, rs in found.items()}
        cells = [shown(max((x for g, xs in known.items() if g.startswith("liehom") for x in xs), default=math.nan))]
        cells += [shown(min(known.get(column, []), default=math.nan)) for column in columns]
        rows.append([name, *cells])
    return [
        "### Distance from the orbit", "",
        "The table shows the largest error of the norm at the end (for Sym(6), of an eigenvalue), at the coarsest "
        "setting whose trajectory error is at most 10⁻⁶. It is that of the worst method of liehom and of the best "
        "method of each other program.", "",
        *table(["problem", "liehom", *columns], rows),
    ]  # fmt: skip


def page_part(data: dict[str, Any]) -> str:
    """The part of docs/performance-integration.md between the markers, as Markdown."""
    lines = ["## Conditions", "", *conditions_part(data), "## Costs by problem", ""]
    for problem in problems():
        if problem.name in data["problems"]:
            lines += problem_part(problem, data["problems"][problem.name])
    lines += ["## Other measurements", "", *drift_part(data)]
    for name, part in (("growth", growth_part), ("long", long_part), ("targets", targets_part)):
        if name in data:
            lines += part(data)
    return "\n".join(lines)


def summary_part(data: dict[str, Any]) -> str:
    """The part of docs/performance.md between the markers, as Markdown."""
    c, target = data["conditions"], 1e-6
    ratios_by = {
        (peer, count): {problem.name: ratio for problem, ratio in multiples(data, peer, count, target)}
        for peer in PEERS
        for count in (1, 10, MANY)
    }
    rows = [
        [peer, *(" to ".join(shown(f(ratios_by[peer, count].values())) for f in (min, max)) for count in (1, 10, MANY))]
        for peer in PEERS
    ]
    return "\n".join([
        "CPU time of other programs as a multiple of that of liehom, smallest and largest of "
        f"{len(data['problems'])} problems, for trajectories to an error of 10⁻⁶. A number above 1 means that liehom "
        f"costs less. Measured {c['date']} on one core ({c['processor']}), with the cost of the call, without "
        "compilation:",
        "",
        *table(["program", "one trajectory", "10 trajectories", "10,000 trajectories"], rows),
        *image(RATIOS, "CPU time of heyoka, scipy, diffrax and numba divided by that of liehom, for each problem"),
        *(f"* {_cheaper(ratios_by, peer)}" for peer in ("heyoka.py", "numba RK4 by hand")),
        f"* Besides its steps, a compiled call of liehom costs {_least_calls(data)}.",
    ])  # fmt: skip


def _cheaper(ratios_by: dict[tuple[str, int], dict[str, float]], peer: str) -> str:
    """A sentence: on which problems a program costs less than liehom."""
    said = []
    for count, which in ((1, "one trajectory"), (MANY, "10,000 trajectories")):
        names = [name.replace(",", "") for name, ratio in ratios_by[peer, count].items() if ratio < 1]
        total = len(ratios_by[peer, count])
        said.append(f"for {which} on {len(names)} of {total} problems" + (f" ({', '.join(names)})" if names else ""))
    return f"{peer} costs less than liehom {', and '.join(said)}."


def _least_calls(data: dict[str, Any]) -> str:
    """The smallest cost of a call for one trajectory, on the problems where it is smallest and largest."""
    found = {}
    for name, content in data["problems"].items():
        costs = [row["costs"].get("1", {}) for row in content["methods"] if row["group"] == LLVM and "costs" in row]
        calls = [cost["call"] for cost in costs if "call" in cost]
        if calls:
            found[name] = min(calls)
    low, high = min(found, key=found.__getitem__), max(found, key=found.__getitem__)
    return f"{shown(found[low])} µs ({low}) to {shown(found[high] / 1000)} ms ({high})"


def write(data: dict[str, Any], docs: Path) -> None:
    """Write the parts between the markers of both pages."""
    for name, part in PARTS.items():
        page = docs / name
        text = page.read_text(encoding="utf-8")
        before, after = text.partition(BEGIN)[0], text.partition(END)[2]
        page.write_text(f"{before}{BEGIN}\n\n{part(data)}\n\n{END}{after}", encoding="utf-8")


PARTS: dict[str, Callable[[dict[str, Any]], str]] = {
    "performance.md": summary_part,
    "performance-integration.md": page_part,
}
"""What is written into which page."""
