"""Spins on a chain, each kept on its sphere; and symmetric matrices that are sorted by a flow."""

import numpy as np

import liehom as lh
from liehom.studies.isospectral import double_bracket_flow

# Five coupled spins with damping: the energy falls, no spin changes its length.
chain = lh.LandauLifshitz((5,), exchange=1.0, anisotropy=0.5, damping=0.1)
spins = np.random.default_rng(3).normal(size=(5, 3))
spins /= np.linalg.norm(spins, axis=-1, keepdims=True)
sol = chain.integrate((0, 20), spins, step=lh.RKMK("rk4"), dt=0.05)
energies = [chain.energy(sol.y[..., k]) for k in range(0, sol.y.shape[-1], 40)]
print("energy:", np.round(energies, 4))
assert all(np.diff(energies) < 0)
assert np.allclose(np.linalg.norm(sol.y[..., -1], axis=-1), 1, atol=1e-13)

# The double bracket flow S' = [S, [S, N]] sorts the eigenvalues along the diagonal, and keeps them.
matrices = lh.instances.SymmetricMatrices(3)
start = np.array([[2.0, 0.5, 0.3], [0.5, 1.0, 0.2], [0.3, 0.2, 3.0]])
sol = lh.integrate(double_bracket_flow(np.diag([3.0, 2.0, 1.0])), (0, 20), matrices.to_vector(start), rtol=1e-8)
end = matrices.to_matrix(sol.y[:, -1])
print(end.round(6))
assert np.allclose(np.diag(end), np.sort(np.linalg.eigvalsh(start))[::-1], atol=1e-5)
assert np.allclose(np.linalg.eigvalsh(end), np.linalg.eigvalsh(start), atol=1e-13)
