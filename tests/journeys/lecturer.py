"""A lecturer who prepares a course on Lie algebras: an exercise sheet, a slide, and a table to decide from.

Three jobs that no page of the documentation contains. Every number is compared with numpy and scipy.
"""

from __future__ import annotations

import itertools
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import liehom as lh


def dimension(p, q):
    """Weyl's formula for sl(3)."""
    return (p + 1) * (q + 1) * (p + q + 2) // 2


def weights(p, q):
    """The weights of the module (p, q) of sl(3), by counting the triangles of Gelfand and Tsetlin."""
    top, found = (p + q, q, 0), Counter()
    for a, b in itertools.product(range(q, p + q + 1), range(q + 1)):
        for c in range(b, a + 1):
            w = c, a + b - c, sum(top) - a - b
            found[w[0] - w[1], w[1] - w[2]] += 1
    return found


def product(one, other):
    """The decomposition of a tensor product, by taking highest weights away from the product of characters."""
    left, parts = Counter(), Counter()
    for (u, k), (v, n) in itertools.product(weights(*one).items(), weights(*other).items()):
        left[u[0] + v[0], u[1] + v[1]] += k * n
    while +left:
        highest = max((w for w in +left), key=lambda w: w[0] + w[1])
        parts[highest] += 1
        left.subtract(weights(*highest))
    return dict(parts)


def sheet_on_sl3(folder):
    """Exercises with solutions: roots, a tensor product, symmetric and skew parts, a picture of weights."""
    g = lh.sl(3)
    rho = lh.defining(g)
    matrices = [m.to_numpy().astype(float) for m in rho.matrices]
    diagonal = np.diag([1.0, 10.0, -11.0])
    flat = np.array([m.ravel() for m in matrices]).T
    ad = np.array([np.linalg.lstsq(flat, (diagonal @ m - m @ diagonal).ravel())[0] for m in matrices])
    roots = lh.root_system("A2").roots
    values = sorted(np.linalg.eigvals(ad).real.round(6))
    # (p, q) has the value p omega_1 + q omega_2 on diag(1, 10, -11)
    adjoint = lh.adjoint(g).weights()
    ours = sorted(p * 1 + q * 11 for (p, q), k in adjoint.items() for _ in range(k))
    print(f"1. {len(roots)} roots; weights of the adjoint module: {adjoint}")
    assert np.allclose(values, ours)
    assert dict(weights(1, 1)) == adjoint
    for one, other in (((1, 1), (1, 1)), ((2, 0), (1, 1)), ((2, 1), (0, 2))):
        parts = lh.tensor_product_decomposition("A2", one, other)
        print(f"2. {one} x {other} =", " + ".join(f"{n} x {dimension(*w)} {w}" for w, n in parts.items()))
        assert parts == product(one, other)
        assert sum(n * dimension(*w) for w, n in parts.items()) == dimension(*one) * dimension(*other)
    square, skew = (lh.adjoint(g).symmetric_power(2), lh.adjoint(g).exterior_power(2))
    print(f"3. symmetric square {square.decomposition()}, exterior square {skew.decomposition()}")
    assert sorted(c.dimension for c in square.decomposition()) == [1, 8, 27]
    assert sorted(c.dimension for c in skew.decomposition()) == [8, 10, 10]
    lh.plotting.plot_weights("A2", (2, 2), path=folder / "weights_of_27.png")
    lh.plotting.plot_root_system("A2", path=folder / "roots.png")
    module = lh.highest_weight_module("A2", (2, 2))
    assert set(module.weights) == set(weights(2, 2))
    assert all((folder / name).stat().st_size > 5_000 for name in ("weights_of_27.png", "roots.png"))


def rigid_body_slide(folder):
    """The racket that flips: the times of the flips, and four orbits in one picture."""
    inertia, start = np.array([1.0, 2.0, 3.0]), np.array([1e-3, 2.0, 0.0])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / inertia)
    sol = lh.integrate(field, (0, 75), start, rtol=1e-10, atol=1e-12, events=lambda t, m: m[1])
    twice, square = (start**2 / inertia).sum(), (start**2).sum()
    a, b, c = inertia
    rate = np.sqrt((c - b) * (square - twice * a) / (a * b * c))
    modulus = (b - a) * (twice * c - square) / ((c - b) * (square - twice * a))
    if modulus > 1:
        rate, modulus = rate * np.sqrt(modulus), 1 / modulus
    flips = np.diff(sol.t_events[0])
    print(f"flips every {flips.round(6)}; by elliptic integrals every {2 * ellipk(modulus) / rate:.6f}")
    assert np.allclose(flips, 2 * ellipk(modulus) / rate, rtol=0, atol=1e-5)
    exact = solve_ivp(lambda t, m: np.cross(m, m / inertia), (0, 20), start, rtol=1e-12, atol=1e-13)
    end = lh.integrate(field, (0, 20), start, rtol=1e-11, atol=1e-13).y[:, -1]
    assert np.allclose(end, exact.y[:, -1], rtol=0, atol=1e-7)
    angles = np.array([0.2, 0.7, 1.2])
    starts = np.stack([np.sin(angles), 0.05 + 0 * angles, np.cos(angles)], axis=-1)
    starts = np.vstack([starts / np.linalg.norm(starts, axis=1)[:, None], [start / np.linalg.norm(start)]])
    four = lh.integrate(field, (0, 40), starts, dt=0.2)
    drift = np.ptp((four.y**2 / inertia[:, None]).sum(axis=1), axis=-1).max()
    print(f"four orbits: energies drift by {drift:.1e}")
    assert drift < 1e-6
    lh.plotting.plot_trajectory(four, folder / "slide.png")
    lh.plotting.plot_phase_portrait(lambda m: (m**2 / (2 * inertia)).sum(-1), path=folder / "portrait.png")
    assert all((folder / name).stat().st_size > 10_000 for name in ("slide.png", "portrait.png"))
    body = lh.bodies.AttitudeBody(inertia)
    turned = body.integrate((0, 20), body.start(momentum=start), step=lh.LieTaylor(8), dt=0.1)
    assert np.allclose(body.momentum(turned)[-1], end, rtol=0, atol=1e-7)


TYPES = ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "VI;1/2", "VI;3", "VII;1/2"]
NAMES = [
    "R^3",
    "A3,1",
    "A2,1+R",
    "A3,2",
    "A3,3",
    "A3,4",
    "A3,6",
    "A3,8",
    "A3,9",
    "A3,5(-1/3)",
    "A3,5(1/2)",
    "A3,7(1/2)",
]


def bianchi_type(constants):
    """Bianchi's type of structure constants c[i, j, k], and his parameter, by numpy: c = epsilon n + delta a."""
    levi_civita = np.zeros((3, 3, 3))
    for i, j, k in itertools.permutations(range(3)):
        levi_civita[i, j, k] = np.linalg.det(np.eye(3)[[i, j, k]])
    mixed = np.einsum("jkl,jki->li", levi_civita, constants) / 2
    n, vector = (mixed + mixed.T) / 2, np.einsum("jkk->j", constants) / 2
    values = np.linalg.eigvalsh(n)
    values = values[abs(values) > 1e-9]
    rank, definite = len(values), abs(np.sign(values).sum()) == len(values)
    if np.allclose(vector, 0):
        return {0: "I", 1: "II", 2: "VII" if definite else "VI", 3: "IX" if definite else "VIII"}[rank], 0.0
    if rank < 2:
        return ["V", "IV"][rank], 1.0
    minors = (np.trace(n) ** 2 - np.trace(n @ n)) / 2  # a a^T = h adj(n), so |a|^2 = h tr adj(n)
    ratio = vector @ vector / minors
    return ("VII" if definite else "III" if np.isclose(ratio, -1) else "VI"), float(np.sqrt(abs(ratio)))


def three_dimensional(seed=3):
    """A table of all real Lie algebras of dimension 3, and the row of brackets in an ugly basis."""
    rng = np.random.default_rng(seed)
    print("type     name        derived  centre  derivations  Killing form  unimodular")
    for kind, name in zip(TYPES, NAMES, strict=True):
        g = lh.catalog.algebra(f"bianchi({kind})")
        series = [space.dimension for space in g.derived_series()]
        row = f"{kind:8} {g.identify().name:11} {series!s:10} {g.center().dimension}  {g.derivations().dimension}"
        print(row, g.killing_signature(), g.is_unimodular())
        upper, lower = (np.triu(rng.integers(-2, 3, (3, 3)), 1) + np.eye(3, dtype=int) for _ in range(2))
        ugly = g.change_of_basis((upper @ lower.T).tolist())
        constants = np.zeros((3, 3, 3))
        for i, j, k, value in ugly.structure_constants():
            constants[i, j, k], constants[j, i, k] = float(value), -float(value)
        expected, parameter = bianchi_type(constants)
        identified = ugly.identify()
        assert identified.name == name, (identified.name, name)
        assert identified.homomorphism.is_isomorphism()
        assert g.is_unimodular() == ugly.is_unimodular() == np.allclose(np.einsum("jkk->j", constants), 0)
        wanted, _, number = kind.partition(";")
        assert expected == wanted, (expected, kind)
        if number:
            assert np.isclose(parameter, {"1/2": 0.5, "3": 3.0}[number])
        killing = np.einsum("iab,jba->ij", constants, constants)
        signs = np.sign(np.linalg.eigvalsh(killing).round(9))
        assert g.killing_signature() == tuple(int((signs == s).sum()) for s in (1, -1, 0))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as directory:
        sheet_on_sl3(Path(directory))
        rigid_body_slide(Path(directory))
    three_dimensional()
