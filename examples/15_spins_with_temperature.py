"""A spiral in a chain of spins, and spins at a temperature, whose mean is Langevin's function."""

import numpy as np

import liehom as lh

# Exchange and Dzyaloshinskii-Moriya interaction: neighbours turn by arctan(D/J).
n = 12
chain = lh.LandauLifshitz((n,), exchange=1.0, dmi=np.tan(2 * np.pi / n), damping=0.5)
m = np.random.default_rng(0).normal(size=(n, 3)) * [0.1, 1, 1]
m /= np.linalg.norm(m, axis=-1, keepdims=True)
sol = chain.integrate((0, 400), m, t_eval=[400])
end = sol.y[..., -1]
cosines = np.sum(end * np.roll(end, 1, axis=0), axis=-1)
print("angles between neighbours:", np.degrees(np.arccos(cosines)).round(2))
assert chain.energy(end) < chain.energy(m)

# 4000 spins at a temperature.
for ratio in (0.5, 2.0):
    warm = lh.LandauLifshitz(applied=[0, 0, 1.0], damping=0.5, temperature=1 / ratio)
    sol = warm.integrate((0, 12), np.tile([0.0, 0.0, 1.0], (4000, 1)), dt=0.05, seed=1, t_eval=[12])
    mean, langevin = sol.y[:, 2, -1].mean(), 1 / np.tanh(ratio) - 1 / ratio
    print(f"H/T = {ratio}: mean {mean:.3f}, Langevin's function {langevin:.3f}")
    assert abs(mean - langevin) < 0.04
