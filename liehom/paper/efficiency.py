"""Figures 6 and 7: orders and costs of the 13 updates, cost over accuracy, and the intersection of two fits.

    ln cost = a x + b,   x = -ln (average energy error on [0, 100]),   cost = steps times cost of a step

over the step sizes of Figures 3 to 5; the unit of cost is a step of xi_b^Eul.  Costs are arithmetic operations, so that
conclusions do not depend on the machine; measured times are listed next to them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

import numpy as np

from liehom.paper.costs import Cost, costs
from liehom.paper.energy_errors import (
    SETTINGS,
    Scale,
    batch_averages,
    kernels_agree,
    scale,
)
from liehom.paper.orders import Orders, measured_orders
from liehom.paper.plots import draw_costs
from liehom.paper.printed_data import CROSSOVER, EULER, FIGURE_6, UPDATES
from liehom.paper.reproduction import Check, Reproduction
from liehom.paper.samples import MOMENTS, SEED, described, spread
from liehom.paper.table import Table
from liehom.typing import Array

PANELS = (
    ("Euler", EULER),
    ("Heun", ("rk2_b", "rk2_o", "rk2_ib")),
    ("order 4, by symbols", ("sy4_b", "sy4_o", "sy4_ib")),
    ("the most efficient of each order", ("eul_i", "rk2_ib", "sy4_o")),
)
IMPROVEMENTS = (("eul_i", "eul_o"), ("rk2_io", "rk2_o"), ("sy4_io", "sy4_o"))
LOW, HIGH = "eul_i", "sy4_o"  # the updates whose fits intersect
ORDER_NEAR, OSCILLATING = 0.15, 0.25
ERRORS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
"""Energy errors at which the costs of all updates are compared."""
LOW_ACCURACY, HIGH_ACCURACY = 1e-3, 1e-6
"""Errors from which on, and up to which, the paper names a most efficient update."""
COMPARABLE = 1.5
"""Ratio of costs below which two updates cost about the same."""
Fit: TypeAlias = tuple[float, float]
"""The coefficients a and b of a x + b."""


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Average energy errors of an update for the step sizes of its figure.

    Attributes
    ----------
    steps : array of shape (sizes,)
        Number of steps in a run.
    errors : array of shape (sizes, batches)
    """

    steps: Array
    errors: Array

    def fits(self, cost: float) -> Array:
        """Coefficients a and b of the fit for each batch, shape (2, batches)."""
        x, y = -np.log(self.errors), np.log(cost * self.steps)[:, None]
        x0, y0 = x.mean(axis=0), y.mean(axis=0)
        a = ((x - x0) * (y - y0)).sum(axis=0) / ((x - x0) ** 2).sum(axis=0)
        coefficients: Array = np.stack([a, y0 - a * x0])
        return coefficients


def accuracy(size: Scale, name: str, quick: bool) -> Accuracy:
    """Accuracy of an update on batches of ten triaxial bodies, on [0, 100].

    Examples
    --------
    >>> accuracy(scale(True), "eul_i", True).errors.shape
    (3, 3)
    """
    setting = next(s for s in SETTINGS if name in s.updates)
    dts = setting.dts[:3] if quick else setting.dts
    errors = np.stack([batch_averages(size, "triaxial", name, dt) for dt in dts])
    return Accuracy(size.span / np.array(dts), errors)


@cache
def measured_costs(quick: bool) -> dict[str, Cost]:
    """Costs of the 13 updates, measured once per process."""
    return costs(rounds=3) if quick else costs()


def figure6(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Figure 6: orders, relative costs, fits, and the crossover of two fits.

    Examples
    --------
    >>> sorted(figure6(quick=True).tables)
    ['', 'cost', 'crossover', 'fits', 'own']
    """
    size, cost = scale(quick, seed), measured_costs(quick)
    orders = measured_orders(seed=seed)
    far = [name for name in UPDATES if not _as_printed(name, orders[name])]
    worst = {n: f"{orders[n].solution:.2f}/{orders[n].energy:.2f}" for n in far or UPDATES}
    io = cost["rk2_io"].operations / cost["eul_b"].operations
    own = own_consistency()
    tables = {
        "": _order_table(orders),
        "cost": _cost_table(cost),
        "fits": _fit_table(size, cost, quick),
        "crossover": _crossover_table(size, cost, quick),
        "own": own,
    }
    printed = _crossing(FIGURE_6[LOW][4:], FIGURE_6[HIGH][4:])
    checks = (
        Check(
            "orders of solution and energy are those of the paper",
            ", ".join(f"{name} {text}" for name, text in worst.items()),
            not far,
        ),
        Check(
            "xi_io^RK2 costs far less than 17.14 steps of xi_b^Eul",
            f"{io:.2f} in operations",
            io < 5,
            "xi_io^RK2 costs 17.14 steps of xi_b^Eul",
            "cost",
        ),
        Check(
            "the printed fits intersect at 7.16e-6",
            f"{printed:.2e} from their three printed digits",
            bool(abs(printed / CROSSOVER - 1) < 0.05),
        ),
        Check(
            "x = -ln error: the fits for xi_b^Eul and xi_i^Eul follow from the errors in Figure 3",
            ", ".join(f"{row[0]} {row[1]:.3f} for {row[2]:.3f}" for row in own.rows if row[0] in ("eul_b", "eul_i")),
            all(abs(row[1] - row[2]) < 0.005 for row in own.rows if row[0] in ("eul_b", "eul_i")),
        ),
        kernels_agree(size, UPDATES),
    )
    text = f"{described(MOMENTS, size.batches, seed)} Orders: 20 bodies with moments uniform on (1, 3)."
    return Reproduction("fig6", "Figure 6: orders and costs of the 13 updates", text, tables, checks)


def figure7(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Figure 7: cost over orbit accuracy, with the fits and the paper's fits, and the most efficient updates.

    Costs are numbers of operations; the tables have measured times next to them, on which no claim depends.

    Examples
    --------
    >>> figure7(quick=True).tables[""].columns[:2]
    ('update', 'dt')
    """
    size, cost = scale(quick, seed), measured_costs(quick)
    unit = relative_operations(cost)
    names = tuple(dict.fromkeys(name for _, panel in PANELS for name in panel))
    fits, rows = [], []
    for name in names:
        found = accuracy(size, name, quick)
        error, y = np.median(found.errors, axis=1), np.log(unit[name] * found.steps)
        a, b = (float(v) for v in np.median(found.fits(unit[name]), axis=1))
        fits.append((name, a, b, FIGURE_6[name][4], FIGURE_6[name][5] - paper_unit()))
        times = np.log(cost[name].arrays * found.steps)
        rows += [
            (name, float(size.span / n), float(e), float(-np.log(e)), float(v), float(s))
            for n, e, v, s in zip(found.steps, error, y, times, strict=True)
        ]
    columns = ("update", "dt", "average error", "-ln error", "ln cost", "ln cost (measured time)")
    points = Table("Points", columns, rows)
    lines = Table("Fits ln cost = a x + b, x = -ln error", ("update", "a", "b", "a paper", "b paper"), fits)
    at_equal_error = costs_at_equal_error(size, unit, quick)
    timed = costs_at_equal_error(size, {name: cost[name].arrays for name in UPDATES}, quick)
    return Reproduction(
        "fig7",
        "Figure 7: cost over orbit accuracy",
        described(MOMENTS, size.batches, seed)
        + " Cost: steps times arithmetic operations of a step, in steps of xi_b^Eul.",
        {"": points, "lines": lines, "cheapest": _cheapest_table(at_equal_error, timed)},
        _conclusions({row[0]: row[1] for row in fits}, at_equal_error),
        draw=lambda: draw_costs(points, lines, PANELS),
        shows="Lines are affine fits, dashed lines those of the paper; the numbers are slopes.",
    )


def relative_operations(cost: Mapping[str, Cost]) -> dict[str, float]:
    """Operations of a step of each update, relative to those of xi_b^Eul.

    Examples
    --------
    >>> round(relative_operations(measured_costs(quick=True))["rk2_io"], 2)
    3.52
    """
    return {name: found.operations / cost["eul_b"].operations for name, found in cost.items()}


def costs_at_equal_error(size: Scale, unit: Mapping[str, float], quick: bool) -> dict[float, dict[str, Array]]:
    """Costs that the fits of each batch give for an energy error, by error and update.

    Examples
    --------
    >>> unit = relative_operations(measured_costs(quick=True))
    >>> costs_at_equal_error(scale(True), unit, True)[1e-3]["eul_i"].shape
    (3,)
    """
    fits = {name: accuracy(size, name, quick).fits(unit[name]) for name in UPDATES}
    return {error: {name: np.exp(b - a * math.log(error)) for name, (a, b) in fits.items()} for error in ERRORS}


def _cheapest(costs: Mapping[str, Array]) -> tuple[str, float]:
    """The update with the smallest median cost, and the fraction of batches in which it is the cheapest."""
    name = min(costs, key=lambda other: float(np.median(costs[other])))
    return name, float(np.mean(costs[name] == np.min(list(costs.values()), axis=0)))


def _ratio(costs: Mapping[str, Array], first: str, second: str) -> float:
    return float(np.median(costs[first] / costs[second]))


def _cheapest_table(
    by_operations: Mapping[float, Mapping[str, Array]], by_time: Mapping[float, Mapping[str, Array]]
) -> Table:
    rows = [
        (
            error,
            *_cheapest(costs),
            _ratio(costs, "sy4_o", "sy4_b"),
            _ratio(costs, "rk2_io", "rk2_ib"),
            _cheapest(by_time[error])[0],
        )
        for error, costs in by_operations.items()
    ]
    columns = ("error", "cheapest", "in so many of the batches", "xi_o^sy4 : xi_b^sy4", "xi_io^RK2 : xi_ib^RK2",
               "cheapest by measured time")  # fmt: skip
    return Table("The cheapest of the 13 updates at an energy error", columns, rows)


def _conclusions(slopes: Mapping[str, float], costs: Mapping[float, Mapping[str, Array]]) -> tuple[Check, ...]:
    """The conclusions of the paper from Figure 7, two of them corrected."""
    low = [_cheapest(costs[error])[0] for error in ERRORS if error >= LOW_ACCURACY]
    high = {
        error: float(np.mean(found["sy4_o"] == np.min(list(found.values()), axis=0)))
        for error, found in costs.items()
        if error <= HIGH_ACCURACY
    }
    heun = [_ratio(found, "rk2_io", "rk2_ib") for found in costs.values()]
    gains = [_ratio(costs[1e-4], improved, base) for improved, base in IMPROVEMENTS]
    return (
        Check(
            "the higher the order, the flatter the line",
            ", ".join(f"{n} {slopes[n]:.2f}" for n in ("eul_o", "eul_i", "sy4_o")),
            slopes["sy4_o"] < slopes["eul_i"] < slopes["eul_o"],
        ),
        Check(
            f"xi_i^Eul is the most efficient update for errors of {LOW_ACCURACY:.0e} and above",
            ", ".join(low),
            set(low) == {"eul_i"},
        ),
        Check(
            "improvements gain most for low orders (cost of the improved update relative to its base, error 1e-4)",
            ", ".join(f"{pair[0]} {gain:.2g}" for pair, gain in zip(IMPROVEMENTS, gains, strict=True)),
            gains == sorted(gains),
        ),
        Check(
            "against the paper: xi_o^sy4 is not the most efficient update for high accuracy",
            ", ".join(f"cheapest in {share:.0%} of the batches at {error:.0e}" for error, share in high.items()),
            max(high.values()) < 0.5,
            "xi_o^sy4 is the most efficient update for high accuracy",
            "cheapest",
        ),
        Check(
            "against the paper: xi_io^RK2 and xi_ib^RK2 cost about the same at equal error",
            "xi_io : xi_ib " + ", ".join(f"{x:.2f}" for x in heun),
            max(heun) < COMPARABLE,
            "xi_ib^RK2 is the most efficient of the Heun updates, since xi_io^RK2 takes substantially longer",
            "cheapest",
        ),
    )


# -- consistency of the paper ---------------------------------------------------------------------------------
def _printed_points(name: str) -> tuple[Array, Array]:
    """Points x and ln(steps) from the triaxial errors of Figures 3 to 5."""
    setting = next(s for s in SETTINGS if name in s.updates)
    errors = np.array([setting.printed["triaxial", dt, name] for dt in setting.dts])
    return -np.log(errors), np.log(100 / np.array(setting.dts))


def paper_unit() -> float:
    """Logarithm of the paper's time for a step of xi_b^Eul, from its fit and the errors of Figure 3.

    Examples
    --------
    >>> round(paper_unit(), 2)
    -8.21
    """
    x, y = _printed_points("eul_b")
    a, b = FIGURE_6["eul_b"][4:]
    return float(np.mean(a * x + b - y))


def own_consistency() -> Table:
    """Table that compares the paper's fits with its own errors: slopes, and relative costs implied by a and b.

    Examples
    --------
    >>> [f"{x:.2f}" for x in own_consistency().rows[2][1:]]
    ['0.49', '0.49', '1.40', '1.45']
    """
    rows = []
    for name in UPDATES:
        x, y = _printed_points(name)
        a, b = FIGURE_6[name][4:]
        implied = math.exp(float(np.mean(a * x + b - y)) - paper_unit())
        rows.append((name, float(np.polyfit(x, y, 1)[0]), a, implied, FIGURE_6[name][2]))
    return Table(
        "The last column of the paper against its own Figures 3 to 5",
        ("update", "slope from its errors", "slope printed", "relative cost implied", "relative cost printed"),
        rows,
    )


def _as_printed(name: str, found: Orders) -> bool:
    """Whether measured orders agree with the paper's; an oscillating leading term may look one order higher."""
    solution, energy = FIGURE_6[name][:2]
    more = OSCILLATING if energy == 4 else 0
    return abs(found.solution - solution) < ORDER_NEAR and -ORDER_NEAR < found.energy - energy < ORDER_NEAR + more


# -- tables ----------------------------------------------------------------------------------------------
def _order_table(orders: Mapping[str, Orders]) -> Table:
    rows = [
        (name, orders[name].solution, FIGURE_6[name][0], orders[name].energy, FIGURE_6[name][1]) for name in UPDATES
    ]
    columns = ("update", "order of the solution", "paper", "order of the energy", "paper (energy)")
    return Table("Orders, global", columns, rows)


def _cost_table(cost: Mapping[str, Cost]) -> Table:
    fastest = {order: min(cost[n].operations for n in UPDATES if FIGURE_6[n][0] == order) for order in (1, 2, 4)}
    rows = [
        (
            name,
            cost[name].operations,
            cost[name].operations / cost["eul_b"].operations,
            cost[name].arrays,
            cost[name].numbers,
            FIGURE_6[name][2],
            cost[name].operations / fastest[FIGURE_6[name][0]],
            FIGURE_6[name][3],
        )
        for name in UPDATES
    ]
    columns = (
        "update", "operations", "relative operations", "relative time (arrays)", "relative time (numbers)", "paper",
        "operations within class", "paper (within class)",
    )  # fmt: skip
    return Table("Costs of a step relative to xi_b^Eul, in one run", columns, rows)


def _fit_table(size: Scale, cost: Mapping[str, Cost], quick: bool) -> Table:
    rows = []
    for name in UPDATES:
        fits = accuracy(size, name, quick).fits(relative_operations(cost)[name])
        a, b = spread(fits[0]), spread(fits[1])
        rows.append((name, *a, FIGURE_6[name][4], *b, FIGURE_6[name][5] - paper_unit()))
    columns = ("update", "a", "a low", "a high", "a paper", "b", "b low", "b high", "b paper (same unit)")
    return Table("Fits ln cost = a x + b, x = -ln error", columns, rows)


def _crossover_table(size: Scale, cost: Mapping[str, Cost], quick: bool) -> Table:
    """Table of the intersections of the fits of xi_i^Eul and xi_o^sy4, for three kinds of cost."""
    kinds: dict[str, Callable[[str], float]] = {
        "operations": lambda name: float(cost[name].operations),
        "measured time (arrays)": lambda name: cost[name].arrays,
        "the paper's CPU times": lambda name: FIGURE_6[name][2],
    }
    rows = []
    for kind, of in kinds.items():
        low, high = (accuracy(size, name, quick).fits(of(name)) for name in (LOW, HIGH))
        rows.append((kind, *spread(_crossing(low, high)), CROSSOVER))
    columns = ("cost", "error at the crossover", "low", "high", "paper")
    return Table("Below this error xi_o^sy4 is cheaper than xi_i^Eul", columns, rows)


def _crossing(first: Sequence[float] | Array, second: Sequence[float] | Array) -> Array:
    """Error at which two fits (a, b) agree, one for each batch."""
    error: Array = np.exp(-(second[1] - first[1]) / (first[0] - second[0]))
    return error
