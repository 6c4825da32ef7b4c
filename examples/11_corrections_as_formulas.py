"""From symbols to a formula: the correction of Euler's step for the rigid body, derived and proved."""

import numpy as np
import sympy

import liehom as lh

m0, m1, m2, w1, w2, w3 = sympy.symbols("m0 m1 m2 w1 w2 w3")
m, w = (m0, m1, m2), (w1, w2, w3)
h = sum(a * x * x for a, x in zip(w, m, strict=True))  # twice the energy

# so(3) by cross products: e_i x m; the generator of the paper that is orthogonal to m
hat = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
rho = lh.Representation.from_matrices(hat)
psi = [(h - a) * x for a, x in zip(w, m, strict=True)]

form = lh.closed_form(rho, psi, lh.Euler(), 2, isotropy=m)
print(form)
assert form.residual_is_zero

# It is the paper's sigma_i = (h - w1)(h - w2)(h - w3) / |X|^2 on the unit sphere.
x = sympy.Matrix(m).cross(sympy.Matrix([a * b for a, b in zip(w, m, strict=True)]))
assert form.equal(form.factor[1], (h - w1) * (h - w2) * (h - w3) / x.dot(x))

# Compiled, it is what the numerical corrector finds.
point, moments = np.array([0.6, 0.48, 0.64]), {"w1": 1.0, "w2": 0.5, "w3": 0.25}
values = np.array([1.0, 0.5, 0.25])
field = lh.GeneratorField(rho, lambda m: (np.sum(m * m * values, -1, keepdims=True) - values) * m)
found = lh.steps.correction(field, lh.Euler(), point, 2)
print(form.function(1)(point, **moments), found.zeta[1])
assert np.allclose(form.function(1)(point, **moments), found.zeta[1])
