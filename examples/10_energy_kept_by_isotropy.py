"""The energy of the rigid body, kept to round-off: by isotropy, and by the step that lies on the orbit itself."""

import numpy as np

import liehom as lh

body = lh.RigidBody([1.0, 2.0, 3.0])
field = body.field("o")
start = np.array([0.6, 0.48, 0.64])


def drift(sol):
    return np.abs(body.energy(sol.y.T) - body.energy(start)).max()


# Heun's step loses energy at order 3. Isotropy corrects it: Newton's method for sigma in the isotropy subalgebra.
plain = lh.integrate(field, (0, 100), start, step=lh.Heun(), dt=0.1)
kept = lh.integrate(field, (0, 100), start, step=lh.Conserving(lh.Heun(), body.energy), dt=0.1)
print(f"Heun: energy off by {drift(plain):.1e}; conserving it: {drift(kept):.1e}")
print(kept.report)
assert drift(plain) > 1e-6 and drift(kept) < 1e-14

# The updates of the paper by their names, as functions of (m, dt); built from base schemes and the generic corrector.
m = np.broadcast_to(start, (4, 3))
for name in ("eul_o", "eul_i", "rk2_io", "sy4_io"):
    step, there = body.update(name), m
    sizes = np.array([0.8, 0.4, 0.2, 0.1])
    error = np.abs(body.energy(step(there, sizes)) - body.energy(start))
    slopes = np.log2(error[:-1] / error[1:]).round(1)
    print(f"{name:8s} energy error of one step {error[0]:.1e}, slopes {slopes}")

# The motion itself, by Jacobi's elliptic functions.
fine = lh.integrate(field, (0, 10), start, step=lh.Corrected(lh.Euler(), order=6), dt=0.02)
print("distance from the exact motion:", np.abs(fine.y[:, -1] - body.exact(start, 10.0)).max())
assert np.allclose(fine.y[:, -1], body.exact(start, 10.0), atol=1e-9)
