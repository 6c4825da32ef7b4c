"""Every program of the integration benchmarks once, tiny; that they solve the same problems; and what reports show."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from tests.benchmarks import gpu, integration_measure as measure, straight_line, which_step
from tests.benchmarks.integration_growth import slope
from tests.benchmarks.integration_long import long_runs
from tests.benchmarks.integration_measure import best
from tests.benchmarks.integration_methods import integrate, under_jit
from tests.benchmarks.integration_page import BEGIN, END, PARTS, shown
from tests.benchmarks.integration_peers import LADDER, PEERS, Solver
from tests.benchmarks.integration_pictures import DATA, KINDS, RATIOS, draw, multiples
from tests.benchmarks.integration_problems import Problem, chain, problems, quartic, rigid_body, sphere4
from tests.benchmarks.integration_targets import compile_time, kernels
from tests.benchmarks.report import DOCS

SPAN = 0.5


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Machine code of the tests, apart from the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LIEHOM_CACHE_DIR", str(tmp_path_factory.mktemp("code")))
        yield


@pytest.mark.parametrize("problem", problems(), ids=lambda problem: problem.name)
def test_terms_and_rows_are_the_field_of_the_generator(problem: Problem) -> None:
    m = problem.starts(3)
    flat = m.reshape(3, -1)
    x = np.asarray(problem.field.vector(m)).reshape(3, -1)
    assert np.abs(x).max() > 0.01
    np.testing.assert_allclose(problem.rows(np, flat.T).T, x, rtol=0, atol=1e-13)
    np.testing.assert_allclose([problem.rates(list(point)) for point in flat], x, rtol=0, atol=1e-13)
    if problem.energy is not None:
        h = 1e-5
        ahead, behind = (problem.energy(m + s * h * x.reshape(m.shape)) for s in (1, -1))
        assert np.abs(ahead - behind).max() / (2 * h) < 1e-8


def test_straight_line_code_is_the_field_and_its_runge_kutta_step() -> None:
    space: dict[str, Any] = {"np": np}
    problem = quartic()
    for text in (straight_line.source(problem.rates, 3), straight_line.rk4_source(3), straight_line.loop_source(3, 2)):
        exec(text, space)
    m = problem.starts(4)
    np.testing.assert_allclose(np.array(space["field"](*m.T)), problem.rows(np, m.T), rtol=0, atol=1e-15)
    x = np.ascontiguousarray(m.T)
    space["run"](x, 0.1, 2)
    fine = np.ascontiguousarray(m.T)
    space["run"](fine, 0.05, 4)
    finest = np.ascontiguousarray(m.T)
    space["run"](finest, 0.025, 8)
    assert 12 < np.abs(x - fine).max() / np.abs(fine - finest).max() < 20


def end(problem: Problem) -> Any:
    starts = problem.starts(2)
    sol = lh.integrate(problem.field, (0, SPAN), starts, step=lh.LieTaylor(8), dt=0.05, t_eval=[SPAN])
    return starts.reshape(2, -1), sol.y[..., -1].reshape(2, -1)


def settings_of(solver: Solver) -> float:
    return 0.01 if solver.fixed else 1e-9


@pytest.mark.parametrize(
    "peer",
    [
        # those that are another one in a few places take long to compile
        pytest.param(x, id=x.name, marks=[pytest.mark.slow] if x.label in ("Dopri8", "one at a time") else [])
        for x in PEERS
    ],
)
def test_a_peer_solves_the_rigid_body(benchmark: Any, peer: Solver) -> None:
    pytest.importorskip(peer.needs)
    starts, wanted = end(rigid_body())
    made = benchmark.pedantic(peer.solve, (rigid_body(), starts, SPAN, settings_of(peer), 2), rounds=1)
    assert made.shape == (2, 2, 3)
    np.testing.assert_allclose(made[-1], wanted, rtol=0, atol=1e-7)


@pytest.mark.parametrize("group", ["scipy DOP853", "heyoka.py"])
def test_peers_solve_a_field_on_the_four_sphere(group: str) -> None:
    peer = next(x for x in PEERS if x.group == group)
    pytest.importorskip(peer.needs)
    starts, wanted = end(sphere4())
    np.testing.assert_allclose(peer.solve(sphere4(), starts, SPAN, 1e-9, 1)[0], wanted, rtol=0, atol=1e-7)


def test_a_chain_of_spins_by_all_its_programs() -> None:
    problem = chain(4)
    starts, wanted = end(problem)
    for solver in [Solver("", "RK4", integrate("RK4", "numpy"), (), fixed=True), *PEERS[:2], *PEERS[-2:-1]]:
        if solver.installed:
            made = solver.solve(problem, starts, SPAN, settings_of(solver), 1)[0]
            np.testing.assert_allclose(made, wanted, rtol=0, atol=1e-7)


def test_a_step_under_jit_is_the_step() -> None:
    problem = chain(4)
    starts, wanted = end(problem)
    np.testing.assert_allclose(under_jit("T4")(problem, starts, SPAN, 0.01, 1)[0], wanted, rtol=0, atol=1e-7)


@pytest.mark.parametrize("engine", ["numpy", "llvm", "jax"])
def test_liehom_is_measured(benchmark: Any, engine: str) -> None:
    solver = Solver("liehom", "E2", integrate("E2", engine), LADDER, fixed=True)
    starts, wanted = end(rigid_body())
    made = benchmark.pedantic(solver.solve, (rigid_body(), starts, SPAN, 0.001, 1), rounds=1)
    np.testing.assert_allclose(made[0], wanted, rtol=0, atol=1e-6)
    found = measure.cost(rigid_body(), solver, 1, [], enough=1e-4)
    assert found["call"] >= 0 and found["step"] > 0


def test_errors_and_costs_at_an_accuracy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure, "sample_of", lambda problem: problem.starts(2))
    short = replace(sphere4(), span=2.0, trajectory_span=2.0)
    peer = PEERS[0]
    points = measure.accuracy(short, peer, (1e-5, 1e-8, 1e-11))
    assert [p[0] for p in points] == [1e-5, 1e-8, 1e-11]
    assert points[0][2] > points[1][2] > points[2][2]
    assert all(orbit <= trajectory * (1 + 1e-9) for _, orbit, trajectory in points)
    taken = measure.cost(short, peer, 2, points)
    values = [measure.matched(short, points, taken, 10.0**-k, orbit=False) for k in (5, 8, 15)]
    assert 0 < values[0] < math.inf and 0 < values[1] < math.inf and values[2] == math.inf


def test_cost_at_an_error_is_interpolated() -> None:
    problem = rigid_body()
    points = [(1.0, 1e-2, 1e-1), (0.1, 1e-4, 1e-3), (0.01, 1e-6, 1e-5)]
    taken = {"call": 7.0, "step": 1.0}
    found = {
        error: measure.matched(problem, points, taken, error, orbit=True, call=False)
        for error in (1.0, 1e-3, 1e-4, 1e-9)
    }
    assert found[1.0] == pytest.approx(100)
    assert found[1e-3] == pytest.approx(100 * math.sqrt(10))
    assert found[1e-4] == pytest.approx(1000)
    assert found[1e-9] == math.inf
    assert measure.matched(problem, points, taken, 1e-4, orbit=True) == pytest.approx(1007)


def test_targets_are_measured() -> None:
    found = kernels(tiny=True)
    assert found["arrays"]["ratio"] > 0 and found["compile"]["first"] > 0 and found["compile"]["again"] > 0
    assert found["one corrected"] > 0


def test_the_least_cost_at_an_error_contains_the_call_if_asked() -> None:
    points = [(1.0, 1e-13, 1e-13)]
    rows = [
        {"label": "T4", "points": points, "costs": {"10": {"call": 150.0, "step": 0.1}}},
        {
            "label": "T8",
            "points": points,
            "costs": {"10": {"call": 100.0, "step": 0.3}, "1": {"call": 1.0, "step": 1.0}},
        },
    ]
    cheapest = [best(rigid_body(), rows, 10, 1e-6, orbit=True, call=call) for call in (False, True)]
    assert [(pytest.approx(cost), label) for cost, label in cheapest] == [(10.0, "T4"), (130.0, "T8")]
    assert best(rigid_body(), rows, 100, 1e-6, orbit=True, call=True) == (math.inf, "")


@pytest.mark.slow
def test_code_on_disk_is_read_in_less_time_than_it_is_compiled() -> None:
    """Order 6, since the code of a step of low order compiles in the time that its trace takes."""
    found = compile_time(6)
    assert found["first"] > found["again"] > 0


def test_exponents() -> None:
    assert slope([1, 2, 4], [3, 12, 48]) == pytest.approx(2)


@pytest.mark.slow
def test_growth_and_long_runs_are_measured() -> None:
    from tests.benchmarks.integration_growth import growth

    rows = growth(tiny=True)
    assert {row["against"] for row in rows} == {"order", "dim g", "N"}
    assert all(min(row["y"]) > 0 for row in rows)
    assert max(row["energy"] for row in long_runs(span=1.0, spins=8) if "missing" not in row) < 1e-4


def test_many_bodies_and_a_grid_of_spins_by_jax() -> None:
    lines = gpu.measured(16, 4, 4, (lh.Euler(),), (lh.Heun(),))
    assert len(lines) == 5 and all("operations" in line for line in lines[2:])


def test_the_page_shows_the_figures() -> None:
    data = json.loads(DATA.read_text(encoding="utf-8"))
    for name, part in PARTS.items():
        text = (DOCS / name).read_text(encoding="utf-8")
        assert text.partition(BEGIN)[2].partition(END)[0].strip() == part(data).strip()
    assert set(data["problems"]) == {problem.name for problem in problems()}
    assert re.fullmatch(r"20\d\d-\d\d-\d\d", data["conditions"]["date"])


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the pictures of one problem and of the ratios, drawn from the figures alone."""
    pytest.importorskip("matplotlib")
    folder = tmp_path_factory.mktemp("pictures")
    data = json.loads(DATA.read_text(encoding="utf-8"))
    draw({**data, "problems": {"S³": data["problems"]["S³"]}}, folder)
    return folder


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_have_letters_that_a_phone_shows(kind: str, drawn: Path) -> None:
    """On 380 px most letters have 8 px and more, and exponents 6; text is light in the dark version."""
    for name in ("work_precision_s3", RATIOS):
        text = (drawn / f"{name}_{kind}.svg").read_text(encoding="utf-8")
        width = float(re.search(r'width="([0-9.]+)pt"', text)[1])  # type: ignore[index]
        sizes = sorted(float(size) * 380 / width for size in re.findall(r"font-size: ([0-9.]+)px", text))
        assert "heyoka.py" in text and sizes[0] > 6 and sizes[len(sizes) // 2] > 8
        assert ("#dddddd" in text) == (kind == "dark")


def test_multiples_are_ratios_of_whole_calls() -> None:
    points = [(1.0, 1e-13, 1e-13)]
    ours = {"group": "liehom", "label": "T4", "points": points, "costs": {"10": {"call": 150.0, "step": 0.1}}}
    peer = {"group": "heyoka.py", "label": "", "points": points, "costs": {"10": {"settings": {"1.0": 40.0}}}}
    data = {"problems": {rigid_body().name: {"methods": [ours, peer]}}}
    [(problem, ratio)] = multiples(data, "heyoka.py", 10, 1e-6)
    assert (problem.name, ratio) == (rigid_body().name, pytest.approx(40 / 160))


def test_the_costs_of_steps_are_those_of_the_figures() -> None:
    text = (DOCS / "which-step.md").read_text(encoding="utf-8")
    shown_costs = text.partition("<!-- costs: begin -->")[2].partition("<!-- costs: end -->")[0]
    assert shown_costs.strip() == "\n".join(which_step.lines()).strip()


def test_numbers_are_shown_with_two_digits() -> None:
    assert [shown(x) for x in (0.123, 12.34, 123.4, 1.23e6, 1e-7, math.inf, None)] == [
        "0.12", "12", "123", "1.2e6", "1.0e-7", "-", "-",
    ]  # fmt: skip
