"""The costs in docs/which-step.md: `python -m tests.benchmarks.which_step`.

They are from the figures of docs/performance-integration.md. The costs are those of compiled steps without the call,
for each of 10,000 trajectories to T = 100.
"""

import json
from pathlib import Path

from tests.benchmarks.integration_measure import best
from tests.benchmarks.integration_methods import LLVM
from tests.benchmarks.integration_page import shown, table
from tests.benchmarks.integration_problems import problems

DATA = Path(__file__).resolve().parents[2] / "docs" / "_static" / "integration.json"
STEPS = {
    "E4": "`Corrected(Euler(), 4)`", "T4": "`LieTaylor(4)`", "T8": "`LieTaylor(8)`", "RK4": '`RKMK("rk4")`',
    "DOP853": '`RKMK("dop853")`, adaptive', "S8": "`Taylor(8)`", "S12": "`Taylor(12)`",
    "adaptive": "the default, adaptive", "C2": "`Conserving(LieTaylor(2), energy)`",
}  # fmt: skip
COLUMNS = (
    ("rigid body", True, 1e-6, "body, energy to 10⁻⁶"),
    *(
        ("rigid body", False, error, f"body to {name}")
        for error, name in ((1e-3, "10⁻³"), (1e-6, "10⁻⁶"), (1e-9, "10⁻⁹"))
    ),
    *(("S³", False, error, f"S³ to {name}") for error, name in ((1e-3, "10⁻³"), (1e-6, "10⁻⁶"), (1e-9, "10⁻⁹"))),
)
"""Problem, error of the energy or of the trajectory, error, heading."""


def lines() -> list[str]:
    data = json.loads(DATA.read_text(encoding="utf-8"))
    rows: dict[str, list[str]] = {label: [] for label in STEPS}
    for name, orbit, error, _ in COLUMNS:
        problem = next(p for p in problems() if p.name == name)
        measured = {row["label"]: row for row in data["problems"][name]["methods"] if row["group"] == LLVM}
        for label, cells in rows.items():
            row = measured.get(label)
            cells.append(shown(best(problem, [row], 10_000, error, orbit=orbit, call=False)[0] if row else None))
    head = [heading for *_, heading in COLUMNS]
    conditions = data["conditions"]
    where = f"Measured {conditions['date']} on one core of {conditions['cores']} ({conditions['processor']})."
    return [where, "", *table(["step", *head], ([STEPS[label], *cells] for label, cells in rows.items()))]


if __name__ == "__main__":
    print("\n".join(lines()))
