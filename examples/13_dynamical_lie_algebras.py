"""Dynamical Lie algebras of spin chains from Pauli words: their dimensions and names, and what controls can reach."""

import liehom as lh

pauli = lh.pauli
models = {
    "Ising": pauli.ising,
    "XY": pauli.xy,
    "Heisenberg": pauli.heisenberg,
    "Kitaev": pauli.kitaev,
}
for name, model in models.items():
    for periodic in (False, True):
        made = pauli.closure(model(pauli.chain(6, periodic=periodic)))
        print(f"{name}, 6 sites, {'periodic' if periodic else 'open'}: dimension {made.dimension}, {made.name}")

# On an open chain of n sites the Ising model in a transverse field is free: so(2n).
assert pauli.closure(pauli.ising(pauli.chain(10))).name == "so(20)"
assert pauli.closure(pauli.heisenberg(pauli.chain(6))).dimension == 4 * (16**2 - 1)

# Two global controls, the couplings and the field, generate less than all the words one by one.
controls = ["ZZII + IZZI + IIZZ", "XIII + IXII + IIXI + IIIX"]
made = pauli.closure(controls)
print(f"\n{made.describe()}")
assert (made.dimension, pauli.closure(pauli.ising(pauli.chain(4))).dimension) == (16, 28)

# Which Hamiltonians do they generate? Coefficients in the basis, or an error.
print(f"\ncoefficients of the field: {made.element('XIII + IXII + IIXI + IIIX')}")
try:
    made.element("XIII")
except lh.errors.InputError as error:
    print(f"XIII: {error}")

# The isotropy of a state: the dimension of the orbit of |0000> under the controls.
state = [1] + 15 * [0]
rho = made.representation()
print(f"\norbit of |0000>: dimension {made.dimension - rho.isotropy(state).dimension}")
assert rho.orbit_dimension(state) == made.dimension - rho.isotropy(state).dimension
