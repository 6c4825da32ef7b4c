"""Symmetric matrices under conjugation: with eigenvalues 1, 1, 2 isotropy suffices, with 1, 2, 3 there is none."""

import warnings

import numpy as np

import liehom as lh

rho = lh.sym_conjugation(3)  # S -> A S - S A on the six entries of a symmetric matrix
field = lh.GeneratorField(rho, lambda s: s[..., :3] + 0.5)


def matrix(s):
    return np.array([[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]])


step = lh.Corrected(lh.Euler(), order=4)
for eigenvalues in ([1, 1, 2], [1, 2, 3]):
    turn = np.linalg.qr(np.array([[2.0, 1, 0], [1, 3, 1], [0, 1, 4]]))[0]
    start = lh.representations.symmetric_to_vector((turn @ np.diag(eigenvalues) @ turn.T).round(15))
    with warnings.catch_warnings(record=True) as told:  # a run that does not keep its order says so
        warnings.simplefilter("always")
        sol = lh.integrate(field, (0, 1), start, step=step, dt=0.05)
    assert [w.category for w in told] == ([] if eigenvalues == [1, 1, 2] else [lh.OrderWarning])
    print(f"\neigenvalues {eigenvalues}\n{sol.report}")
    # the orbit is kept in any case: the eigenvalues do not move
    assert np.allclose(np.linalg.eigvalsh(matrix(sol.y[:, -1])), eigenvalues, atol=1e-13)
    assert sol.report.range_condition is (eigenvalues == [1, 1, 2])

# Without the range condition, a series of the flow itself has the order all the same.
sol = lh.integrate(field, (0, 1), start, step=lh.LieTaylor(4), dt=0.05)
assert sol.report.order == 4
