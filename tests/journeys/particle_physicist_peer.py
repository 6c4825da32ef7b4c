"""Jobs 1 to 3 of the particle physicist with numpy and the standard library alone."""

import itertools
from collections import Counter
from fractions import Fraction

import numpy as np


def half_spinor():
    """Weights of the 16 of SO(10) in the orthogonal basis, times 2."""
    return [w for w in itertools.product((1, -1), repeat=5) if w.count(-1) % 2 == 0]


def pati_salam():
    """The 16 by chirality in so(6) + so(4) and by charge in su(5) + u(1), cubic anomaly; names are left out."""
    chirality, charge = Counter(), Counter()
    for w in half_spinor():
        chirality[w[:3].count(-1) % 2, w[3:].count(-1) % 2] += 1
        charge[sum(w)] += 1
    return dict(chirality), dict(charge), sum(n * q**3 for q, n in charge.items())


def running():
    """Coefficients b of SU(3) and SU(2), with the standard model's multiplets of 5bar + 10 typed in."""
    family = [(3, 2), (3, 1), (3, 1), (1, 2), (1, 1)]
    higgs = [(1, 2)]
    coefficients = {}
    for n, factor in ((3, 0), (2, 1)):
        doubled = [sum(f[1 - factor] for f in fields if f[factor] == n) for fields in (3 * family, higgs)]
        fermions, scalars = Fraction(doubled[0], 2), Fraction(doubled[1], 2)
        coefficients[n] = Fraction(11, 3) * n - Fraction(2, 3) * fermions - Fraction(1, 3) * scalars
    return coefficients


def yukawas():
    """Invariants in Sym^3 27 and 16 x 16 x 10, and the modules in 16 x 16, as the 16 is minuscule."""
    cartan = 2 * np.eye(6, dtype=int)
    for i, j in [(0, 2), (2, 3), (3, 4), (4, 5), (1, 3)]:
        cartan[i, j] = cartan[j, i] = -1
    weights = [(1, 0, 0, 0, 0, 0)]
    for w in weights:
        lower = [tuple(np.subtract(w, cartan[i]).tolist()) for i in range(6) if w[i] == 1]
        weights += [x for x in lower if x not in weights]
    triples = itertools.combinations_with_replacement(weights, 3)
    cubics = [t for t in triples if not np.sum(t, axis=0).any()]
    equations = {}
    for column, t in enumerate(cubics):
        for i, w in itertools.product(range(6), set(t)):
            if w[i] == -1:
                rest = list(t)
                rest.remove(w)
                raised = tuple(sorted([*rest, tuple(np.add(w, cartan[i]).tolist())]))
                row = equations.setdefault((i, raised), np.zeros(len(cubics)))
                row[column] += t.count(w)
    e6 = len(cubics) - np.linalg.matrix_rank(list(equations.values()))

    positive = [(i, j, s) for i in range(5) for j in range(i) for s in (1, -1)]
    roots = [np.eye(5)[j] + s * np.eye(5)[i] for i, j, s in positive]
    rho = np.arange(4, -1, -1)
    sums = [np.array(w) / 2 + 0.5 for w in half_spinor()]
    dominant = [v for v in sums if (np.diff(v) <= 0).all() and v[3] >= -v[4]]
    modules = {tuple(v.tolist()): round(np.prod([r @ (v + rho) / (r @ rho) for r in roots])) for v in dominant}
    vector = [v for v in dominant if v.tolist() == [1, 0, 0, 0, 0]]
    return int(e6), len(vector), modules


JOBS = (pati_salam, running, yukawas)

if __name__ == "__main__":
    for job in JOBS:
        print(job.__name__, job())
