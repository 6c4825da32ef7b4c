"""A satellite that is driven, a glider in water, and a heavy top: each in a few lines."""

import numpy as np

import liehom as lh

# A satellite with a wheel that is driven for a while, and a damper.
satellite = lh.bodies.AttitudeBody(
    [1.0, 2.0, 3.0], lambda s, t: [0.0, 0.0, 1.0] * np.exp(-t)[..., None] - 0.1 * s.velocity
)
sol = satellite.integrate((0, 30), satellite.start([1, 0, 0, 0], velocity=[0.1, 0.2, 1.0]))
q = satellite.attitude(sol)
print("attitude:", satellite.quaternion(sol)[-1].round(4), "spin:", satellite.velocity(sol)[-1].round(4))
assert np.abs(q @ np.swapaxes(q, -1, -2) - np.eye(3)).max() < 1e-13

# A glider in water has different masses along its axes. Its momentum in space is constant.
glider = lh.bodies.SE3Body(np.diag([0.5, 0.6, 0.7, 1.0, 2.0, 4.0]))
sol = glider.integrate((0, 30), glider.start(velocity=[0.1, 0.5, 0.0, 1.0, 0.0, 0.2]), rtol=1e-8)
print("position:", glider.position(sol)[-1].round(4))
assert np.ptp(glider.space_momentum(sol), axis=0).max() == 0
assert np.ptp(glider.energy(sol)) < 1e-5

# A heavy top: isotropy conserves its energy, the action the two Casimirs.
top = lh.bodies.HeavyTop([1, 1, 2], centre=[0, 0, 1])
start = top.start(momentum=[0.3, 0, 4.0], vertical=[0.6, 0, 0.8])
sol = top.integrate((0, 50), start, step=lh.Conserving(lh.Heun(), top.energy), dt=0.1)
print("drift of the energy:", np.ptp(top.energy(sol)))
assert np.ptp(top.energy(sol)) < 1e-11
assert np.ptp(top.vertical_momentum(sol)) < 1e-12
