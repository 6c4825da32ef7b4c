"""Figures 3, 4 and 5: average errors of the energy."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from liehom.base.errors import InputError
from liehom.base.typing import Array
from liehom.studies.paper.kernels import Body, Update, Vector, kernel
from liehom.studies.paper.plots import draw_errors
from liehom.studies.paper.reproduction import Check, Reproduction
from liehom.studies.paper.table import EULER, FIGURE_3, FIGURE_4, FIGURE_5, FOURTH, HEUN, Errors, Table
from liehom.studies.rigid_body import RigidBody

# Random bodies and initial points, and the largest error of the energy in a run. The paper averages over ten runs and
# does not give their data. A reproduction therefore computes many such averages, each over a batch of ten new bodies,
# and shows their median with the range from the 5th to the 95th percentile.

RUNS = 10  # Bodies in a batch
SEED = 2001
MOMENTS = (1.0, 20.0)  # Interval of the principal moments
NARROW_MOMENTS = (1.0, 3.0)  # Interval for orders of convergence: all bodies rotate at about the same rate
KINDS = ("triaxial", "axisymmetric")


@dataclass(frozen=True, slots=True)
class Sample:
    """Bodies in their principal axes, one per column, and an initial point for each.

    Attributes
    ----------
    moments : array of shape (3, N)
    start : array of shape (3, N)
        Unit vectors.

    Examples
    --------
    >>> random_bodies("axisymmetric", 20).moments.shape
    (3, 20)
    """

    kind: str
    moments: Array
    start: Array

    @property
    def body(self) -> Body:
        """Bodies in the form that the kernels use."""
        w = 1 / self.moments
        return Body((w[0], w[1], w[2]))

    @property
    def points(self) -> Vector:
        """Initial points as three arrays of coordinates."""
        return self.start[0], self.start[1], self.start[2]


def random_bodies(kind: str, count: int, law: tuple[float, float] = MOMENTS, seed: int = SEED) -> Sample:
    """Bodies with independent principal moments, uniform on `law`, and initial points uniform on the unit sphere.

    Axisymmetric bodies have I_1 = I_2. A random rotation of the inertia tensor would only rename the axes, because
    updates commute with rotations and the initial points are uniform.

    Examples
    --------
    >>> sample = random_bodies("triaxial", 3)
    >>> bool(np.allclose(np.linalg.norm(sample.start, axis=0), 1)), bool((sample.moments > 1).all())
    (True, True)
    """
    if kind not in KINDS:
        raise InputError(f"the kind of a body is {kind!r}, expected one of {', '.join(KINDS)}")
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    moments = rng.uniform(*law, (3, count))
    if kind == "axisymmetric":
        moments[1] = moments[0]
    start = rng.standard_normal((3, count))
    return Sample(kind, moments, start / np.linalg.norm(start, axis=0))


def described(law: tuple[float, float], batches: int, seed: int) -> str:
    """Sentence that describes the random data of the tables of errors."""
    return (
        f"Principal moments independent and uniform on ({law[0]:g}, {law[1]:g}), I_1 = I_2 for axisymmetric bodies; "
        f"starting points uniform on the unit sphere; seed {seed}. Errors are averages over {RUNS} runs: medians of "
        f"{batches} such averages with the range from the 5th to the 95th percentile, {RUNS * batches} bodies in all."
    )


def largest_energy_error(update: Update, body: Body, m: Vector, dt: float, span: float) -> Array:
    """Largest |H(m_k) - H(m_0)| over the steps of a run, for each body.

    Examples
    --------
    >>> from liehom.studies.paper.kernels import kernel
    >>> sample = random_bodies("axisymmetric", 5)
    >>> update = kernel("eul_i", sample.body)
    >>> bool(largest_energy_error(update, sample.body, sample.points, 0.5, 10.0).max() < 1e-14)
    True
    """
    return run(update, body, m, dt, span)[0]


def run(update: Update, body: Body, m: Vector, dt: float, span: float) -> tuple[Array, Vector]:
    """The largest |H(m_k) - H(m_0)| over the steps of a run, for each body, and the points at its end."""
    start = body.energy(m)
    largest: Array = np.zeros_like(start)
    for _ in range(round(span / dt)):
        m = update(m, dt)
        np.maximum(largest, np.abs(body.energy(m) - start), out=largest)
    return largest, m


class Spread(NamedTuple):
    """Median, 5th and 95th percentile."""

    median: float
    low: float
    high: float

    def has(self, value: float) -> bool:
        """Whether a value is between the 5th and the 95th percentile."""
        return self.low <= value <= self.high


def spread(values: Array) -> Spread:
    """Median, 5th and 95th percentile of numbers."""
    return Spread(*(float(np.quantile(values, q)) for q in (0.5, 0.05, 0.95)))


def averages(errors: Array) -> Array:
    """Averages over batches of ten runs, shape (N / 10,)."""
    return errors.reshape(-1, RUNS).mean(axis=1)


def slope(coarse: Array, fine: Array, ratio: float, floor: float = 1e-13) -> float:
    """Median of log(coarse / fine) / log(ratio) over the runs with errors above round-off; NaN if there are none."""
    above = fine > floor
    if not above.any():
        return float("nan")
    return float(np.median(np.log(coarse[above] / fine[above])) / np.log(ratio))


# Figures 3, 4 and 5: average errors of the energy over [0, 100], for Euler, Heun and the methods of order four.

SPAN, BATCHES = 100.0, 40
QUICK_SPAN, QUICK_BATCHES = 25.0, 3
ZERO = 1e-13
# orders of the energy on [0, T]; a leading term that is odd in D = <X, Om^2 m> only oscillates, and long runs then show
# up to one order higher
ENERGY_ORDERS: dict[str, dict[str, int | None]] = {
    "triaxial": dict(zip((*EULER, *HEUN, *FOURTH), (1, 1, 2, 3, 3, 4, 4, 4, 4, 5, 5, 4, 4), strict=True)),
    "axisymmetric": dict(zip((*EULER, *HEUN, *FOURTH), (1, 1, None, 3, 3, 5, 5, 5, 5, 5, 5, 5, 5), strict=True)),
}
NEAR = 0.2
PRINTED_SIZES = (10.0, 1.0, 0.1)  # Step sizes for the formulas as the paper prints them


@dataclass(frozen=True, slots=True)
class Setting:
    """Data of a table of errors: updates, step sizes, and for each kind of body the two sizes that give the slope."""

    figure: int
    updates: tuple[str, ...]
    printed: Errors
    dts: tuple[float, ...]
    pairs: dict[str, tuple[float, float]]


SETTINGS = (
    Setting(3, EULER, FIGURE_3, (10.0, 1.0, 0.1, 0.01), {"triaxial": (0.02, 0.01), "axisymmetric": (0.02, 0.01)}),
    Setting(4, HEUN, FIGURE_4, (10.0, 1.0, 0.1, 0.01), {"triaxial": (0.2, 0.1), "axisymmetric": (0.2, 0.1)}),
    Setting(5, FOURTH, FIGURE_5, (10.0, 1.0, 0.1), {"triaxial": (0.4, 0.2), "axisymmetric": (0.8, 0.4)}),
)


@dataclass(frozen=True, slots=True)
class Misprint:
    """Update that fails with a formula as printed, with the order of the energy that it has then."""

    update: str
    what: str
    order: int
    kind: str = "triaxial"


@dataclass(frozen=True, slots=True)
class Scale:
    """Size of a sample in batches of ten bodies, time span of a run, and seed."""

    batches: int
    span: float
    seed: int

    def sample(self, kind: str) -> Sample:
        """Bodies of a kind, ten per batch."""
        return random_bodies(kind, 10 * self.batches, seed=self.seed)


def scale(quick: bool, seed: int = SEED) -> Scale:
    """Scale of the figures, or with `quick` a small one."""
    return Scale(QUICK_BATCHES, QUICK_SPAN, seed) if quick else Scale(BATCHES, SPAN, seed)


@cache
def energy_errors(scale: Scale, kind: str, name: str, dt: float, printed: bool = False) -> Array:
    """Largest energy error of each run, shape (10 batches,), for an update of Figure 6 or its misprint."""
    sample = scale.sample(kind)
    update = kernel(name, sample.body, printed=printed)
    errors = largest_energy_error(update, sample.body, sample.points, dt, scale.span)
    errors.setflags(write=False)
    return errors


def batch_averages(scale: Scale, kind: str, name: str, dt: float) -> Array:
    """Average over the ten runs of each batch, shape (batches,)."""
    return averages(energy_errors(scale, kind, name, dt))


def figure3(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Figure 3: Euler's method with omega_b, omega_o and the isotropy correction.

    Examples
    --------
    >>> figure3(quick=True).holds
    True
    """
    size, setting = scale(quick, seed), SETTINGS[0]
    largest = max(float(energy_errors(size, "axisymmetric", "eul_i", dt).max()) for dt in _sizes(setting, quick))
    zero = Check("axisymmetric, xi_i^Eul: 0.00", f"largest error of all runs {largest:.1e}", largest < ZERO)
    return _reproduction(setting, size, quick, (zero,))


def figure4(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Figure 4: Heun's method, compared with the printed forms, which cannot have been used.

    Examples
    --------
    >>> sorted(figure4(quick=True).tables)
    ['', 'as_printed', 'printed', 'slopes']
    """
    size, setting = scale(quick, seed), SETTINGS[1]
    misprints = (
        Misprint("rk2_b", "minus sign between the stages: xi = O(dt^2), nothing moves", 1),
        Misprint("rk2_ib", "sigma_ib of the convention omega_b = +Om m, with omega_b = -Om m", 3),
    )
    return _reproduction(setting, size, quick, (), misprints)


def figure5(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Figure 5: methods of order four, with the printed forms of xi_b^sy4 and xi_o^sy4.

    Examples
    --------
    >>> figure5(quick=True).holds
    True
    """
    size, setting = scale(quick, seed), SETTINGS[2]
    misprints = (
        Misprint("sy4_b", "omega_b = +Om m, in the formula of the convention omega_b = -Om m", 2),
        Misprint("sy4_o", "<omega', m> m in place of <omega'', m> m", 3),
        Misprint("sy4_o", "<omega', m> m in place of <omega'', m> m", 3, "axisymmetric"),
    )
    same = max(
        float(np.abs(energy_errors(size, "axisymmetric", f"sy4_i{g}", dt)
                     - energy_errors(size, "axisymmetric", f"sy4_{g}", dt)).max())
        for g in "bo"
        for dt in (1.0, 0.1)
    )  # fmt: skip
    paper = math.log10(FIGURE_5["axisymmetric", 1, "sy4_o"] / FIGURE_5["axisymmetric", 0.1, "sy4_o"])
    printed, corrected = (_slope(size, setting, "axisymmetric", "sy4_o", flag) for flag in (True, False))
    checks = (
        Check(
            "axisymmetric: the improvements of sy4_b and sy4_o vanish",
            f"largest difference {same:.1e}",
            same < ZERO,
            "axisymmetric: xi_o^sy4 and xi_io^sy4 have different errors at dt = 10, xi_b^sy4 and xi_ib^sy4 at dt = 0.1",
        ),
        Check(
            "axisymmetric xi_o^sy4: the paper's column has the slope of the misprint, not that of the correction",
            f"paper {paper:.2f}, misprinted {printed:.2f}, corrected {corrected:.2f}",
            abs(paper - printed) < NEAR < abs(paper - corrected),
            "axisymmetric: the errors of xi_o^sy4 and xi_io^sy4 have slope 3",
        ),
    )
    return _reproduction(setting, size, quick, checks, misprints)


def kernels_agree(size: Scale, names: tuple[str, ...], bodies: int = 3, dt: float = 0.5) -> Check:
    """Check that the kernels agree with base scheme and generic corrector."""
    sample, worst = size.sample("triaxial"), 0.0
    for i in range(bodies):
        body = RigidBody(sample.moments[:, i])
        start = sample.start[:, :5].T
        one = Sample("triaxial", sample.moments[:, i], sample.start)
        for name in names:
            lanes = kernel(name, one.body)((start[:, 0], start[:, 1], start[:, 2]), dt)
            worst = max(worst, float(np.abs(np.stack(lanes, axis=-1) - body.update(name)(start, dt)).max()))
    return Check(
        "the formulas used are base scheme and generic corrector", f"they differ by {worst:.0e}", worst < 1e-14
    )


# -- the tables ------------------------------------------------------------------------------------------
def _sizes(setting: Setting, quick: bool) -> tuple[float, ...]:
    return setting.dts[:-1] if quick and len(setting.dts) > 3 else setting.dts


def _reproduction(
    setting: Setting, size: Scale, quick: bool, checks: tuple[Check, ...], misprints: tuple[Misprint, ...] = ()
) -> Reproduction:
    names = {3: "the forward Euler method", 4: "the Heun method", 5: "methods of order four"}
    rows = [
        _error_row(size, setting, kind, dt, name)
        for kind in KINDS
        for dt in _sizes(setting, quick)
        for name in setting.updates
    ]
    columns = ("body", "dt", "update", "average error", "low", "high", "paper", "paper in range")
    slopes = _slopes(size, setting)
    wrong = [row for row in slopes if not row[6]]
    evidence = "; ".join(f"{row[0]} {row[1]} {row[4]:.2f}" for row in (wrong or slopes) if row[4] == row[4])
    printed = [_printed_row(size, misprint) for misprint in misprints]
    tables = {
        "": Table("Average of the largest energy errors of ten runs", columns, rows),
        "slopes": Table(
            "Slopes over the step size (medians over the runs)",
            ("body", "update", "from dt", "to dt", "slope", "order of the energy", "as expected", "slope in the paper"),
            [(*row[:6], "yes" if row[6] else "NO", row[7]) for row in slopes],
        ),
    }
    if misprints:
        tables |= {"printed": _printed_table(printed), "as_printed": _printed_errors(size, misprints)}
    every = (Check("slopes are the orders of the energy (odd leading terms: up to one more)", evidence, not wrong),)
    checks = (*every, *_printed_checks(printed), *checks, kernels_agree(size, setting.updates))
    return Reproduction(
        f"fig{setting.figure}",
        f"Figure {setting.figure}: energy errors of {names[setting.figure]} on [0, {size.span:g}]",
        described(MOMENTS, size.batches, size.seed),
        tables,
        checks,
        () if quick else (_in_range(rows),),
        draw=lambda: draw_errors(tables[""], tables["slopes"], tables.get("as_printed")),
        shows="Lines are medians of averages over ten bodies, bands their 5th to 95th percentile.",
    )


def _error_row(size: Scale, setting: Setting, kind: str, dt: float, name: str) -> tuple[Any, ...]:
    paper = setting.printed[kind, dt, name]
    range_: Spread = spread(batch_averages(size, kind, name, dt))
    exact_zero = range_.high < ZERO and paper < ZERO
    return kind, dt, name, *range_, paper, "yes" if exact_zero or range_.has(paper) else "no"


def _slope(size: Scale, setting: Setting, kind: str, name: str, printed: bool = False) -> float:
    coarse, fine = setting.pairs[kind]
    before, after = (energy_errors(size, kind, name, dt, printed) for dt in (coarse, fine))
    return slope(before, after, coarse / fine)


def _slopes(size: Scale, setting: Setting) -> list[tuple[Any, ...]]:
    """Rows (body, update, dt, dt, slope, order, as expected, slope of the paper)."""
    rows: list[tuple[Any, ...]] = []
    for kind in KINDS:
        for name in setting.updates:
            order = ENERGY_ORDERS[kind][name]
            measured = _slope(size, setting, kind, name)
            oscillates = kind == "triaxial" and order is not None and order % 2 == 0
            expected = order is None or order - NEAR < measured < order + NEAR + oscillates
            rows.append(
                (kind, name, *setting.pairs[kind], measured, order, expected, _printed_slope(setting, kind, name))
            )
    return rows


def _printed_slope(setting: Setting, kind: str, name: str) -> float:
    """Slope between the two smallest step sizes at which the paper's error exceeds round-off; NaN if there is one."""
    errors = [(dt, setting.printed[kind, dt, name]) for dt in setting.dts]
    above = [(dt, error) for dt, error in errors if error > 2e-13]
    if len(above) < 2:
        return math.nan
    (coarse, large), (fine, small) = above[-2:]
    return math.log(large / small) / math.log(coarse / fine)


def _in_range(rows: list[tuple[Any, ...]]) -> str:
    """Sentence on the averages of the paper that lie in the range."""
    answers = [(kind, [row[7] for row in rows if row[0] == kind]) for kind in KINDS]
    counts = " and ".join(f"{inside.count('yes')} of {len(inside)} {kind}" for kind, inside in answers)
    return f"{counts} averages of the paper lie in the range."


def _printed_row(size: Scale, misprint: Misprint) -> tuple[Any, ...]:
    name, kind = misprint.update, misprint.kind
    setting = next(s for s in SETTINGS if name in s.updates)
    coarse, fine = setting.pairs[kind]
    as_printed, corrected = (_slope(size, setting, kind, name, flag) for flag in (True, False))
    return kind, name, misprint.what, coarse, fine, as_printed, misprint.order, corrected


def _printed_errors(size: Scale, misprints: tuple[Misprint, ...]) -> Table:
    rows = [
        (m.kind, dt, m.update, *spread(averages(energy_errors(size, m.kind, m.update, dt, printed=True))))
        for m in misprints
        for dt in PRINTED_SIZES
    ]
    columns = ("body", "dt", "update", "average error", "low", "high")
    return Table("Average of the largest energy errors of the formulas as printed", columns, rows)


def _printed_table(rows: list[tuple[Any, ...]]) -> Table:
    columns = ("body", "update", "as printed", "from dt", "to dt", "slope as printed", "expected", "slope corrected")
    return Table("Formulas as the paper prints them", columns, rows)


def _printed_checks(rows: list[tuple[Any, ...]]) -> tuple[Check, ...]:
    return tuple(
        Check(
            f"{kind} {name}: as printed ({what}) the energy has order {order}",
            f"{measured:.2f}, corrected {corrected:.2f}",
            abs(measured - order) < 2 * NEAR and corrected > order + 0.5,
            f"{kind} {name}: the formula as printed has energy order {ENERGY_ORDERS[kind][name]}",
            "printed",
        )
        for kind, name, what, _, _, measured, order, corrected in rows
    )
