"""The jobs of the lecturer with sympy, scipy and matplotlib."""

from __future__ import annotations

import tempfile
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from sympy import Matrix, symbols
from sympy.liealgebras.root_system import RootSystem


def weights(p, q):
    """The weights of a module of sl(3), which sympy does not have."""
    found = Counter()
    for a, b in product(range(q, p + q + 1), range(q + 1)):
        for c in range(b, a + 1):
            found[2 * c - a - b, 2 * (a + b) - c - p - 2 * q] += 1
    return found


def decomposed(one, other):
    """The highest weights of a tensor product."""
    left, parts = Counter(), Counter()
    for (u, k), (v, n) in product(weights(*one).items(), weights(*other).items()):
        left[u[0] + v[0], u[1] + v[1]] += k * n
    while +left:
        highest = max((w for w in +left), key=lambda w: w[0] + w[1])
        parts[highest] += 1
        left.subtract(weights(*highest))
    return dict(parts)


def draw_weights(p, q, path):
    """A picture of the weights, with matplotlib by hand."""
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    for (a, b), n in weights(p, q).items():
        axes.plot(a / 2, (a + 2 * b) / (2 * 3**0.5), "o", markersize=4 + 4 * n)
    axes.set_aspect("equal")
    axes.figure.savefig(path)


def flips():
    """The times between the flips of a body that turns about its middle axis."""

    def middle(_, m):
        return m[1]

    inertia = np.array([1.0, 2.0, 3.0])
    sol = solve_ivp(
        lambda t, m: np.cross(m, m / inertia), (0, 75), [1e-3, 2.0, 0], rtol=1e-10, atol=1e-12, events=middle
    )
    return np.diff(sol.t_events[0])


def invariants(brackets):
    """Dimension of the derived algebra and whether traces vanish; a name has to be looked up in a book."""
    c = np.zeros((3, 3, 3))
    for (i, j), row in brackets.items():
        for k, value in row.items():
            c[i, j, k], c[j, i, k] = value, -value
    x = symbols("x:3")
    ad = sum((x[i] * Matrix(c[i].T) for i in range(3)), Matrix.zeros(3, 3))
    return np.linalg.matrix_rank(c.reshape(9, 3)), ad.trace() == 0


if __name__ == "__main__":
    print(f"{len(RootSystem('A2').all_roots())} roots; 8 x 8 = {decomposed((1, 1), (1, 1))}")
    with tempfile.TemporaryDirectory() as directory:
        draw_weights(2, 2, Path(directory) / "weights.png")
    print(f"flips every {flips()}")
    print("dimension of [g, g], unimodular:", invariants({(0, 1): {1: 1, 2: 1}, (0, 2): {1: -1, 2: 1}}))
