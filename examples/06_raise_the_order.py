"""Forward Euler on the sphere, raised to any order by isotropy: the free rigid body."""

import numpy as np

import liehom as lh

# m' = rho(psi(m)) m = psi(m) x m, with psi(m) = -m / inertia: the sphere |m| = const is never left.
inertia = np.array([1.0, 2.0, 3.0])
field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / inertia)
start = np.array([0.6, 0.0, 0.8])


def energy(m):
    return 0.5 * np.sum(m * m / inertia, axis=-1)


for order in (1, 2, 4, 6):
    sol = lh.integrate(field, (0, 20), start, step=lh.Corrected(lh.Euler(), order=order), dt=0.1)
    drift = abs(energy(sol.y[:, -1]) - energy(start))
    print(f"order {order}: energy off by {drift:.1e}, |m| - 1 = {np.linalg.norm(sol.y[:, -1]) - 1:+.0e}")
    assert abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-13
assert drift < 1e-6

# What the corrector has to say: the range condition holds at every step, since so(2) is full in so(3).
print(sol.report)
assert sol.report.order == 6 and sol.report.range_condition

# The order is measured, not declared.
table = lh.observed_order(field, start, lh.Corrected(lh.Euler(), order=4), [0.1, 0.05, 0.025])
print(table)
