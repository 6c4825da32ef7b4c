"""A representation, a step and an exponential that the library does not know, in a few lines each."""

import numpy as np

import liehom as lh


# A step: the midpoint method with one exponential.
class Midpoint(lh.steps.OneExponential):
    order = 2

    def generator(self, action, psi, m, t, h):
        middle = action.act(h / 2 * psi(m, t), m)
        return h * psi(middle, t + h / 2)


# A representation: so(3) on the tensors of rank two, R^9.
vectors = lh.defining(lh.so(3))
tensors = vectors.tensor(vectors)

# A generator as texts, in m0 ... m8 and t; the point is a rank-one tensor, its orbit a projective plane.
field = lh.GeneratorField(tensors, ["m0 + sin(t)", "m4", "1/2 - m8"])
v = np.array([1.0, 2.0, 2.0]) / 3
start = np.outer(v, v).ravel()

sol = lh.integrate(field, (0, 2), start, step=lh.Corrected(Midpoint(), order=5), dt=0.05)
print(sol.report)
assert sol.report.order == 5 and sol.report.base_order == 2
assert np.isclose(np.trace(sol.y[:, -1].reshape(3, 3)), 1, atol=1e-13)


# An exponential: a rational map that agrees with exp to second order and stays in the rotations.
def pade(x, m):
    """(1 - x/2 + x^2/12)^-1 (1 + x/2 + x^2/12) m: one more order of exp than the Cayley transform."""
    a = np.einsum("...a,aij->...ij", x, matrices)
    square = a @ a / 12
    one = np.eye(3)
    return np.linalg.solve(one - a / 2 + square, (one + a / 2 + square) @ m[..., None])[..., 0]


matrices = np.array([a.to_numpy() for a in vectors.matrices])
turning = lh.GeneratorField(vectors, lambda m: m * [1.0, 2.0, 3.0])
step = lh.Corrected(lh.Euler(), order=4)
ends = [
    lh.integrate(turning, (0, 1), [0.6, 0.0, 0.8], step=step, dt=1 / 64, exponential=exponential).y[:, -1]
    for exponential in ("exp", pade)
]
print(ends)
assert np.allclose(*ends, atol=1e-6)
