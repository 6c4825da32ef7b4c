"""Jobs 1 to 3 of the differential geometer with numpy and sympy alone."""

import itertools

import numpy as np
import sympy as sp


def ricci(brackets, gram):
    """Ricci tensor of the left-invariant metric with this Gram matrix; brackets[i, j] is [e_i, e_j]."""
    lowered = np.einsum("ijl,lk->ijk", brackets, gram)
    koszul = lowered - np.einsum("jki->ijk", lowered) + np.einsum("kij->ijk", lowered)
    nabla = np.einsum("ijk,kl->ilj", koszul / 2, np.linalg.inv(gram))
    curvature = (
        np.einsum("iab,jbc->ijac", nabla, nabla)
        - np.einsum("jab,ibc->ijac", nabla, nabla)
        - np.einsum("ijk,kab->ijab", brackets, nabla)
    )
    return np.einsum("ijik->jk", curvature)


def null_space(matrix):
    """Orthonormal rows that span the kernel."""
    _, sigma, v = np.linalg.svd(matrix)
    rank = int((sigma > 1e-9).sum())
    return v[rank:]


def wolf_space():
    """Symmetry and number of Einstein metrics of G2/SO(4), and those of S^3 x S^3; which are isometric is left out."""
    phi = np.zeros((7, 7, 7))
    for i, j, k in [(0, 1, 2), (0, 3, 4), (0, 6, 5), (1, 3, 5), (1, 4, 6), (2, 3, 6), (2, 5, 4)]:
        for a, b, c in [(i, j, k), (j, k, i), (k, i, j)]:
            phi[a, b, c], phi[b, a, c] = 1, -1
    eye = np.eye(7)
    derivative = np.einsum("ax,ybc->abcxy", eye, phi) + np.einsum("bx,ayc->abcxy", eye, phi)
    derivative += np.einsum("cx,aby->abcxy", eye, phi)
    g2 = null_space(derivative.reshape(343, 49)).reshape(-1, 7, 7)
    mixing = g2[:, :3, 3:].reshape(len(g2), -1)
    h = np.einsum("ka,aij->kij", null_space(mixing.T), g2)
    form = np.einsum("aij,bji->ab", h, g2)
    m = np.einsum("ka,aij->kij", null_space(form), g2)
    in_m = [np.abs(np.einsum("kij,ji->k", m, x @ y - y @ x)).max() for x in m for y in m]
    isotropy = [[np.einsum("kij,ij->k", m, z @ x - x @ z) for x in m] for z in h]
    one = np.eye(len(m))
    invariance = np.vstack([np.kron(a, one) + np.kron(one, a) for a in np.array(isotropy)])
    symmetric = max(in_m) < 1e-9
    metrics = len(null_space(invariance))

    b, c = sp.symbols("b c", real=True)
    gram = sp.Matrix([[1, b], [b, c]])
    p = gram.inv()
    terms = sum(p[i, j] ** 2 * gram[i, j] for i in range(2) for j in range(2))
    scalar = 3 * (p[0, 0] + p[1, 1]) - sp.Rational(3, 2) * terms
    det = gram.det()
    critical = [2 * det * sp.diff(scalar, x) + scalar * sp.diff(det, x) for x in (b, c)]
    equations = [sp.numer(sp.cancel(equation)) for equation in critical]
    solutions = [s for s in sp.solve(equations, [b, c]) if s[1].is_real and s[1] > s[0] ** 2]

    brackets = np.zeros((6, 6, 6))
    for s in (0, 3):
        for i, j, k in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]:
            brackets[s + i, s + j, s + k], brackets[s + j, s + i, s + k] = 1, -1
    ratios = []
    for beta, gamma in solutions:
        metric = np.kron(np.array([[1, beta], [beta, gamma]], float), np.eye(3))
        tensor = ricci(brackets, metric)
        constant = tensor[0, 0] / metric[0, 0]
        ratios.append((np.trace(np.linalg.solve(metric, tensor)) / constant, np.abs(tensor - constant * metric).max()))
    return symmetric, metrics, solutions, ratios


def nilmanifold():
    """Jordan blocks of ad e4, from which the table is read by hand; Ricci and Betti numbers of the Heisenberg group."""
    jordan = sp.Matrix([[1, 1, 0], [0, 1, 0], [0, 0, -2]]).T.jordan_form()[1]
    brackets = np.zeros((3, 3, 3))
    brackets[0, 1, 2], brackets[1, 0, 2] = 1, -1
    differentials = []
    for k in range(3):
        source = list(itertools.combinations(range(3), k))
        target = list(itertools.combinations(range(3), k + 1))
        matrix = np.zeros((len(target), len(source)))
        for row, indices in enumerate(target):
            for s, t in itertools.combinations(range(k + 1), 2):
                rest = [x for n, x in enumerate(indices) if n not in (s, t)]
                for new in set(range(3)) - set(rest):
                    sign = (-1) ** (s + t + sum(x < new for x in rest))
                    value = sign * brackets[indices[s], indices[t], new]
                    matrix[row, source.index(tuple(sorted([*rest, new])))] += value
        differentials.append(np.linalg.matrix_rank(matrix))
    ranks = [0, *differentials, 0]
    betti = [len(list(itertools.combinations(range(3), k))) - ranks[k] - ranks[k + 1] for k in range(4)]
    return jordan, ricci(brackets, np.eye(3)), betti


def special_lagrangians():
    """Symmetry, Einstein constant, dimension of the holonomy and a witness against fullness of SU(3)/SO(3)."""
    units = np.eye(9).reshape(9, 3, 3)
    pairs = [(0, 1), (0, 2), (1, 2)]
    h = [units[3 * i + j] - units[3 * j + i] for i, j in pairs]
    m = [1j * (units[3 * i + j] + units[3 * j + i]) for i, j in pairs]
    m += [1j * (units[4 * i] - units[4 * i + 4]) for i in (0, 1)]
    basis = np.array([*m, *h])
    flat = np.hstack([basis.real.reshape(8, 9), basis.imag.reshape(8, 9)])
    commutators = np.einsum("aij,bjk->abik", basis, basis)
    commutators = (commutators - commutators.swapaxes(0, 1)).reshape(8, 8, 9)
    commutators = np.concatenate([commutators.real, commutators.imag], axis=2)
    brackets = commutators @ np.linalg.pinv(flat)
    symmetric = np.abs(brackets[:5, :5, :5]).max() < 1e-9
    killing = np.einsum("iab,jba->ij", brackets, brackets)[:5, :5]
    metric = -killing / 6
    curvature = -np.einsum("ija,akl->ijkl", brackets[:5, :5, 5:], brackets[5:, :5, :5])
    constant = np.einsum("ijki->jk", curvature)[0, 0] / metric[0, 0]
    holonomy = np.linalg.matrix_rank(curvature.reshape(25, 25))
    eta = np.arange(1.0, 6.0)
    rank = np.linalg.matrix_rank([*(eta @ brackets[5:, :5, :5]), eta])
    return symmetric, constant, holonomy, bool(rank == 5)


JOBS = (wolf_space, nilmanifold, special_lagrangians)

if __name__ == "__main__":
    for job in JOBS:
        print(job.__name__, *job(), sep="\n  ")
