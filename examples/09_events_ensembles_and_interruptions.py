"""An ensemble with adapted steps, an event located on the dense output, and a run that survives a kill."""

import tempfile
from pathlib import Path

import numpy as np

import liehom as lh

field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
rng = np.random.default_rng(1)
starts = rng.normal(size=(100, 3))
starts /= np.linalg.norm(starts, axis=-1, keepdims=True)


def crosses_the_equator(t, m):
    return m[..., 2]


crosses_the_equator.direction = 1

options = {"step": lh.Corrected(lh.Euler(), order=6), "rtol": 1e-9, "atol": 1e-12, "t_eval": np.linspace(0, 20, 101)}
sol = lh.integrate(field, (0, 20), starts, events=crosses_the_equator, **options)
print(sol)
print("steps per trajectory:", sol.n_steps.min(), "to", sol.n_steps.max())
assert sol.y.shape == (100, 3, 101)

times = sol.t_events[0][0]  # of trajectory 0
print("crossings of trajectory 0:", np.round(times, 6))
assert all(abs(point[2]) < 1e-10 for point in sol.y_events[0][0])

# The same run, interrupted after some steps and continued from its checkpoint: the same numbers, bit for bit.
calls = 0


def interrupted(m):
    global calls
    calls += 1
    if calls == 100:
        raise KeyboardInterrupt
    return -m / [1.0, 2.0, 3.0]


with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "run.npz"
    same = lh.GeneratorField(lh.adjoint(lh.so(3)), interrupted)
    try:
        lh.integrate(same, (0, 20), starts, checkpoint=path, **options)
    except KeyboardInterrupt:
        print("interrupted; kept", path.name)
    again = lh.integrate(same, (0, 20), starts, checkpoint=path, **options)
assert np.array_equal(again.y, sol.y)
