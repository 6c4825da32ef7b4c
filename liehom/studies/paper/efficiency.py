"""Figures 6 and 7: orders and costs of the 13 updates."""

from __future__ import annotations

import math
import operator
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.typing import Array
from liehom.studies.paper.energy_errors import (
    MOMENTS,
    NARROW_MOMENTS,
    SEED,
    SETTINGS,
    Scale,
    batch_averages,
    described,
    kernels_agree,
    random_bodies,
    run,
    scale,
    spread,
)
from liehom.studies.paper.kernels import Body, Update, Vector, kernel
from liehom.studies.paper.plots import draw_costs
from liehom.studies.paper.reproduction import Check, Reproduction
from liehom.studies.paper.table import CROSSOVER, EULER, FIGURE_6, UPDATES, Table
from liehom.studies.rigid_body import RigidBody

# Cost of a step: the number of arithmetic operations, and the time relative to a step of Euler.

LANES, ROUNDS = 1000, 21  # Bodies in the arrays, and rounds of all updates in which times are measured
DT = 0.1


class Cost(NamedTuple):
    """Cost of a step: operations, and time relative to xi_b^Eul on arrays of 1000 bodies and on one body."""

    operations: int
    arrays: float
    numbers: float


def _counting(operation: Callable[[float, float], float]) -> Callable[[Counted, Counted | float], Counted]:
    """A method of `Counted` for an operation."""

    def counted(x: Counted, y: Counted | float) -> Counted:
        x.counter[0] += 1
        return Counted(operation(x.value, y.value if isinstance(y, Counted) else float(y)), x.counter)

    return counted


class Counted:
    """Number that counts the arithmetic operations on it."""

    counter: list[int]
    value: float

    __slots__ = ("counter", "value")

    def __init__(self, value: float, counter: list[int]) -> None:
        self.value, self.counter = value, counter

    __add__ = __radd__ = _counting(operator.add)
    __mul__ = __rmul__ = _counting(operator.mul)
    __sub__, __rsub__ = _counting(operator.sub), _counting(lambda x, y: y - x)
    __truediv__, __rtruediv__ = _counting(operator.truediv), _counting(lambda x, y: y / x)


def operations(name: str) -> int:
    """Number of sums, products and quotients in a step of an update, without powers of dt and constants of the body."""
    counter = [0]
    w = tuple(Counted(x, counter) for x in (1.0, 0.5, 0.25))
    update = kernel(name, Body((w[0], w[1], w[2])))
    counter[0] = 0
    m = tuple(Counted(x, counter) for x in (0.6, 0.48, 0.64))
    update((m[0], m[1], m[2]), DT)
    return counter[0]


def costs(lanes: int = LANES, rounds: int = ROUNDS, seed: int = SEED) -> dict[str, Cost]:
    """Costs of the 13 updates, by name; times are medians of ratios within one round of all updates."""
    sample = random_bodies("triaxial", lanes, seed=seed)
    w, m = (tuple(float(x) for x in column) for column in (1 / sample.moments[:, 0], sample.start[:, 0]))
    one = Body((w[0], w[1], w[2])), (m[0], m[1], m[2])
    arrays = _ratios(sample.body, sample.points, rounds, 10)
    numbers = _ratios(*one, rounds, 100)
    return {name: Cost(operations(name), arrays[name], numbers[name]) for name in UPDATES}


def _ratios(body: Body, m: Vector, rounds: int, repeats: int) -> dict[str, float]:
    updates = {name: kernel(name, body) for name in UPDATES}
    taken = np.array([[_seconds(update, m, repeats) for update in updates.values()] for _ in range(rounds)])
    ratios = np.median(taken / taken[:, :1], axis=0)
    return {name: float(ratio) for name, ratio in zip(updates, ratios, strict=True)}


def _seconds(update: Update, m: Vector, repeats: int) -> float:
    """Shortest of three times for `repeats` steps, in seconds."""
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        for _ in range(repeats):
            update(m, DT)
        times.append(time.perf_counter() - begin)
    return min(times)


# Measured orders of the solution and of the energy for Figure 6: T = 6, dt = 1/16 .. 1/64, extended precision.

Longdoubles: TypeAlias = npt.NDArray[np.longdouble]

SPAN = 6.0
SIZES = (1 / 16, 1 / 32, 1 / 64)
BODIES = 20


class Orders(NamedTuple):
    """Measured orders of an update, for averages over the bodies."""

    solution: float
    energy: float


def measured_orders(bodies: int = BODIES, sizes: tuple[float, ...] = SIZES, seed: int = SEED) -> dict[str, Orders]:
    """Orders of the 13 updates by name: slopes, in longdouble, of the error at T and of the largest energy error."""
    sample = random_bodies("triaxial", bodies, NARROW_MOMENTS, seed)
    moments, start = sample.moments.astype(np.longdouble), sample.start.astype(np.longdouble)
    start /= np.sqrt((start**2).sum(axis=0))
    w = 1 / moments
    body = Body((w[0], w[1], w[2]))
    exact: Any = np.stack([RigidBody(sample.moments[:, i]).exact(start[:, i], SPAN) for i in range(bodies)], axis=-1)
    orders = {}
    for name in UPDATES:
        errors = [_errors(name, body, start, exact, dt) for dt in sizes[-2:]]
        slopes = np.log(np.array(errors[0]) / np.array(errors[1])) / np.log(sizes[-2] / sizes[-1])
        orders[name] = Orders(float(slopes[0]), float(slopes[1]))
    return orders


def _errors(name: str, body: Body, start: Longdoubles, exact: Array, dt: float) -> tuple[float, float]:
    """Averages over the bodies of |m(T) - exact| and of the largest |H - H_0|."""
    largest, m = run(kernel(name, body), body, (start[0], start[1], start[2]), dt, SPAN)
    away = np.sqrt(((np.stack(m) - exact) ** 2).sum(axis=0))
    return float(away.mean()), float(largest.mean())


# Figures 6 and 7: orders and costs of the 13 updates, cost over accuracy, and the intersection of two fits.
#     ln cost = a x + b,   x = -ln (average energy error on [0, 100]),   cost = steps times cost of a step
# over the step sizes of Figures 3 to 5; the unit of cost is a step of xi_b^Eul. Costs are arithmetic operations, so
# that conclusions do not depend on the machine; measured times are listed next to them.

PANELS = (
    ("Euler", EULER),
    ("Heun", ("rk2_b", "rk2_o", "rk2_ib")),
    ("order 4, by symbols", ("sy4_b", "sy4_o", "sy4_ib")),
    ("the most efficient of each order", ("eul_i", "rk2_ib", "sy4_o")),
)
IMPROVEMENTS = (("eul_i", "eul_o"), ("rk2_io", "rk2_o"), ("sy4_io", "sy4_o"))
LOW, HIGH = "eul_i", "sy4_o"  # the updates whose fits intersect
ORDER_NEAR, OSCILLATING = 0.15, 0.25
ERRORS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10)  # Energy errors at which the costs of all updates are compared
# Errors from which on, and up to which, the paper names a most efficient update
LOW_ACCURACY, HIGH_ACCURACY = 1e-3, 1e-6
COMPARABLE = 1.5  # Ratio of costs below which two updates cost about the same
Fit: TypeAlias = tuple[float, float]  # The coefficients a and b of a x + b


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Average energy errors (sizes, batches) of an update for the numbers of steps (sizes,) of its figure."""

    steps: Array
    errors: Array

    def fits(self, cost: float) -> Array:
        """Coefficients a and b of the fit for each batch, shape (2, batches)."""
        x, y = -np.log(self.errors), np.log(cost * self.steps)[:, None]
        x0, y0 = x.mean(axis=0), y.mean(axis=0)
        a = ((x - x0) * (y - y0)).sum(axis=0) / ((x - x0) ** 2).sum(axis=0)
        return np.stack([a, y0 - a * x0])


def accuracy(size: Scale, name: str, quick: bool) -> Accuracy:
    """Accuracy of an update on batches of ten triaxial bodies, on [0, 100]."""
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
        measured = accuracy(size, name, quick)
        error, y = np.median(measured.errors, axis=1), np.log(unit[name] * measured.steps)
        a, b = (float(v) for v in np.median(measured.fits(unit[name]), axis=1))
        fits.append((name, a, b, FIGURE_6[name][4], FIGURE_6[name][5] - paper_unit()))
        times = np.log(cost[name].arrays * measured.steps)
        rows += [
            (name, float(size.span / n), float(e), float(-np.log(e)), float(v), float(s))
            for n, e, v, s in zip(measured.steps, error, y, times, strict=True)
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
    """Operations of a step of each update, relative to those of xi_b^Eul."""
    return {name: own.operations / cost["eul_b"].operations for name, own in cost.items()}


def costs_at_equal_error(size: Scale, unit: Mapping[str, float], quick: bool) -> dict[float, dict[str, Array]]:
    """Costs that the fits of each batch give for an energy error, by error and update."""
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
        error: float(np.mean(own["sy4_o"] == np.min(list(own.values()), axis=0)))
        for error, own in costs.items()
        if error <= HIGH_ACCURACY
    }
    heun = [_ratio(own, "rk2_io", "rk2_ib") for own in costs.values()]
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
    """Logarithm of the paper's time for a step of xi_b^Eul, from its fit and the errors of Figure 3."""
    x, y = _printed_points("eul_b")
    a, b = FIGURE_6["eul_b"][4:]
    return float(np.mean(a * x + b - y))


def own_consistency() -> Table:
    """Table that compares the paper's fits with its own errors: slopes, and relative costs implied by a and b."""
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


def _as_printed(name: str, measured: Orders) -> bool:
    """Whether measured orders agree with the paper's; an oscillating leading term may look one order higher."""
    solution, energy = FIGURE_6[name][:2]
    more = OSCILLATING if energy == 4 else 0
    return abs(measured.solution - solution) < ORDER_NEAR and -ORDER_NEAR < measured.energy - energy < ORDER_NEAR + more


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
    return np.exp(-(second[1] - first[1]) / (first[0] - second[0]))
