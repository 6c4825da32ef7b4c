"""The state of a run: what a checkpoint keeps, what an interrupted step is undone to, and what tells problems apart."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from liehom.integrators.run.checkpoint import digest

if TYPE_CHECKING:
    from liehom.integrators.run.run import Run

REPLACED = ("t", "m", "active", "code", "ended_at", "h", "taken", "calls", "before")
"""Attributes whose arrays are replaced in a step, never written into."""


def mark(run: Run) -> tuple[Any, ...]:
    """The state between two steps, without copies."""
    kept = {name: getattr(run, name) for name in REPLACED}
    done = None if run.samples is None else run.samples.done
    return kept, len(run.path), run.account.arrays(), run.found.occurrences, len(run.found.rows), done


def back_to(run: Run, mark: tuple[Any, ...]) -> None:
    """Undo what an interrupted step has done."""
    kept, points, account, run.found.occurrences, rows, done = mark
    for name, value in kept.items():
        setattr(run, name, value)
    run.path.cut(points)
    del run.found.rows[rows:]
    run.account.restore(account)
    if run.samples is not None:
        run.samples.done = done


def arrays(run: Run) -> dict[str, Any]:
    """All that `restore` needs, as arrays."""
    made = {name: np.asarray(getattr(run, name)) for name in REPLACED if name != "before"}
    made |= {f"before_{i}": g for i, g in enumerate(run.before)}
    for part, record in _records(run).items():
        made |= {f"{part}_{name}": value for name, value in record.arrays().items()}
    return made


def restore(run: Run, made: dict[str, Any]) -> None:
    """Take a state back, bit for bit."""
    for name in REPLACED:
        if name != "before":
            setattr(run, name, made[name])
    run.calls = int(run.calls)
    run.before = [made[f"before_{i}"] for i in range(len(run.before))]
    for part, record in _records(run).items():
        start = f"{part}_"
        record.restore({name[len(start) :]: x for name, x in made.items() if name.startswith(start)})


def fingerprint(run: Run) -> str:
    """What tells the problem from others: numbers, texts, and psi at the start and next to it."""
    o, events, field = run.options, run.events, run.field
    texts = f"{re.sub(' at 0x[0-9a-f]+', '', repr(run.step))} {run.action.exponential.name} {o.texts()}"
    texts += "" if events is None else f" {events.directions} {events.terminal}"
    matrices = [a.to_numpy() for a in field.representation.matrices]
    t = np.full(run.shape, run.span[0])
    here = np.asarray(field.psi(run.start, t))
    ahead = 1e-3 * (run.end - run.span[0])
    near = run.action.act((ahead * here).astype(run.dtype), run.start)
    there = np.asarray(field.psi(near, t + ahead))
    numbers = [np.array(run.span), o.dt if o.dt is not None else 0, o.t_eval if o.t_eval is not None else 0]
    return digest(texts, run.start, *numbers, *matrices, here, near, there, *run.before)


def _records(run: Run) -> dict[str, Any]:
    found = {"path": run.path, "account": run.account, "found": run.found}
    return found if run.samples is None else {**found, "samples": run.samples}
