"""Lie algebras of affine and kinematical groups: Euclidean, Poincaré, Galilei, Schrödinger, conformal, gl(n) + R^n.

Each is over QQ, with named basis elements.
"""

from __future__ import annotations

import itertools

import numpy as np

from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.constructions.classical_algebras import so
from liehom.algebra.constructions.form_algebras import form_brackets, index_name
from liehom.algebra.constructions.solvable_families import heisenberg
from liehom.algebra.constructions.sums import direct_sum, semidirect_sum
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices.matrix_basis import require_basis, require_size
from liehom.algebra.matrices.named_matrices import classical_matrices, linear_lie_algebra
from liehom.budget import within
from liehom.scalars import QQ
from liehom.scalars.fields.field import MatricesLike
from liehom.typing import IntegerArray


def euclidean(n: int) -> LieAlgebra:
    """The Euclidean algebra e(n) = so(n) + R^n: first the rotations, then the translations.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.euclidean(3), lh.euclidean(3).center().dimension
    (<Lie algebra e(3) of dimension 6 over QQ>, 0)
    """
    matrices = classical_matrices("so", n)
    # The matrices are the basis of so(n) itself: a representation.
    return semidirect_sum(so(n), matrices, size=n, name=f"e({n})", check=False)


def poincare(p: int, q: int = 1) -> LieAlgebra:
    """The Poincaré algebra iso(p, q) = so(p, q) + R^(p+q): rotations m_ij (i < j), then translations p_i.

    Parameters
    ----------
    p, q : int
        The signature of the quadratic form; not negative, with p + q at least 1. ``poincare(3)`` is the
        algebra of dimension 10 of special relativity.

    Raises
    ------
    InputError
        If p or q is negative or both are zero.

    Notes
    -----
    [m_ij, p_i] = e_i p_j and [m_ij, p_j] = -e_j p_i, where e_i is 1 for i <= p, else -1 (for p = 0 all are 1).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.poincare(3)
    >>> g, g.center().dimension, [s.dimension for s in g.derived_series()]
    (<Lie algebra iso(3,1) of dimension 10 over QQ>, 0, [10])
    """
    matrices = classical_matrices("so", p, q)
    names = [*_rotations(p + q), *(index_name("p", i) for i in range(p + q))]
    # The matrices are the basis of so(p, q) itself: a representation.
    return semidirect_sum(so(p, q), matrices, size=p + q, basis=names, name=f"iso({p},{q})", check=False)


def galilei(n: int) -> LieAlgebra:
    """The Galilei algebra of R^n: rotations m_ij, boosts k_i, translations p_i, time translation h.

    The boosts satisfy [k_i, h] = p_i.

    Parameters
    ----------
    n : int
        Dimension of space, at least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.galilei(3)
    >>> g, g.center().dimension, [s.dimension for s in g.derived_series()]
    (<Lie algebra galilei(3) of dimension 10 over QQ>, 0, [10, 9])
    """
    return _galilean(n, massive=False)


def bargmann(n: int) -> LieAlgebra:
    """The Bargmann algebra, the central extension of `galilei` by the mass: [k_i, p_i] = mass.

    Parameters
    ----------
    n : int
        Dimension of space, at least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.bargmann(3)
    >>> g, g.center().rows() == [[0] * 10 + [1]]
    (<Lie algebra bargmann(3) of dimension 11 over QQ>, True)
    """
    return _galilean(n, massive=True)


def schroedinger(n: int) -> LieAlgebra:
    """The Schrödinger algebra of R^n with mass: `bargmann`, with dilations d and expansions c.

    Its basis is: rotations m_ij, then h, d, c, boosts k_i, translations p_i, mass.

    Parameters
    ----------
    n : int
        Dimension of space, at least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Notes
    -----
    It is (so(n) + sl(2)) + heisenberg(n), a semidirect sum, with [k_i, h] = p_i, [k_i, p_i] = mass, [d, h] = -2 h,
    [d, c] = 2 c, [c, h] = d, [d, k_i] = k_i, [d, p_i] = -p_i and [c, p_i] = -k_i: the symmetries of the free
    Schrödinger equation.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.schroedinger(3)
    >>> g, g.semisimple_type(), g.radical().dimension
    (<Lie algebra schroedinger(3) of dimension 13 over QQ>, 'A1 + A1', 7)
    """
    require_size("n", n)
    sl2 = LieAlgebra({(1, 0): {0: -2}, (1, 2): {2: 2}, (2, 0): {1: 1}})
    matrices = _rotations_of_vectors(n, 2 * n + 1)
    for block in ([[0, 0], [-1, 0]], [[1, 0], [0, -1]], [[0, -1], [0, 0]]):  # h, d, c on the pairs (k_i, p_i)
        matrices.append(np.pad(np.kron(np.array(block, dtype=np.int64), np.eye(n, dtype=np.int64)), (0, 1)))
    names = [*_rotations(n), *"hdc", *(index_name(letter, i) for letter in "kp" for i in range(n)), "mass"]
    acting = direct_sum(so(n), sl2)
    # Rotations and sl(2) = sp(2, R) preserve the form of the Heisenberg algebra, and commute with each other.
    return semidirect_sum(acting, matrices, heisenberg(n), basis=names, name=f"schroedinger({n})", check=False)


def conformal(p: int, q: int = 0) -> LieAlgebra:
    """The conformal algebra of R^(p,q), isomorphic to so(p+1, q+1).

    Its basis is: translations p_i, rotations m_ij, the dilation d, special conformal transformations k_i.

    Parameters
    ----------
    p, q : int
        The signature of the quadratic form e; not negative, with p + q at least 1.

    Raises
    ------
    InputError
        If p or q is negative or both are zero.

    Notes
    -----
    [d, p_i] = p_i, [d, k_i] = -k_i, [k_i, p_j] = m_ij + e_ij d, [m_ij, p_i] = e_ii p_j, [m_ij, p_j] = -e_jj p_i, and
    likewise with k for p. The p_i, m_ij, d span the similarities of R^(p,q).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.conformal(3, 1)
    >>> g, g.killing_signature() == lh.so(4, 2).killing_signature()
    (<Lie algebra conformal(3,1) of dimension 15 over QQ>, True)
    """
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q)
    n = p + q
    within("dimension", (n + 1) * (n + 2) // 2, "the algebra has dimension {}")
    rows = [[int(i == j) * (1 if i < p else -1) for j in range(n + 2)] for i in range(n)]
    form = QQ.matrix([*rows, [0] * (n + 1) + [1], [0] * n + [1, 0]])
    pairs = [(i, n) for i in range(n)] + list(itertools.combinations(range(n), 2)) + [(n + 1, n)]
    pairs += [(i, n + 1) for i in range(n)]
    positions = {pair: (k, 1) for k, pair in enumerate(pairs)}
    positions |= {(b, a): (k, -1) for k, (a, b) in enumerate(pairs)}
    names = [*(index_name("p", i) for i in range(n)), *_rotations(n), "d", *(index_name("k", i) for i in range(n))]
    table = StructureConstants(QQ, len(pairs), form_brackets(form, -1, positions))
    # The brackets are those of the orthogonal matrices of a form that is not degenerate.
    return LieAlgebra(table, basis=names, name=f"conformal({p},{q})" if q else f"conformal({p})", check=False)


def affine(n: int) -> LieAlgebra:
    """The affine algebra aff(n) = gl(n) + R^n: elementary matrices e_ij row by row, then translations t_i.

    Parameters
    ----------
    n : int
        At least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.affine(1))
    Lie algebra aff(1) over QQ, dimension 2
      basis e11, t1
      [e11, t1] = t1
    """
    matrices = classical_matrices("gl", n)
    names = [*(index_name("e", i, j) for i in range(n) for j in range(n)), *(index_name("t", i) for i in range(n))]
    # The matrices are the basis of gl(n) itself: a representation.
    return semidirect_sum(linear_lie_algebra(matrices), matrices, basis=names, name=f"aff({n})", check=False)


def affine_of(matrices: MatricesLike, *, name: str | None = None) -> LieAlgebra:
    """The affine algebra h + V of a linear Lie algebra h: first the matrices, then the translations of V.

    Parameters
    ----------
    matrices : sequence of (N, N) array_like
        A basis of h, closed under commutators; at least one matrix.
    name : str, optional

    Raises
    ------
    DependentRowsError, NotClosedError, ShapeError, InputError
        If there is no matrix, the matrices are dependent or not square of one size, or their span is not closed.

    Notes
    -----
    [x, v] = x v. Use `semidirect_sum` for a representation that is not faithful or an ideal that is not abelian.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.affine_of([[[0, -1], [1, 0]], [[1, 0], [0, 1]]])
    <Lie algebra of dimension 4 over QQ>
    """
    made = lie_closure(matrices, close=False)
    # The matrices have the brackets of the algebra: a representation.
    return semidirect_sum(made.algebra, made.matrices, name=name, check=False)


def _rotations(n: int) -> list[str]:
    return [index_name("m", i, j) for i, j in itertools.combinations(range(n), 2)]


def _rotations_of_vectors(n: int, size: int) -> list[IntegerArray]:
    """The matrices of so(n) on two vectors, the first 2n of `size` coordinates."""
    require_basis(n * (n - 1) // 2, size)
    twice = np.eye(2, dtype=np.int64)
    return [np.pad(np.kron(twice, matrix), (0, size - 2 * n)) for matrix in classical_matrices("so", n)]


def _galilean(n: int, massive: bool) -> LieAlgebra:
    """so(n) acting by rotations on the nilpotent ideal of boosts, translations, time and, if massive, mass."""
    require_size("n", n)
    brackets = {(i, 2 * n): {n + i: 1} for i in range(n)}
    if massive:
        brackets |= {(i, n + i): {2 * n + 1: 1} for i in range(n)}
    d = 2 * n + 1 + massive
    ideal = LieAlgebra(brackets, dimension=d)
    rotations = _rotations_of_vectors(n, d)
    vectors = [index_name(letter, i) for letter in "kp" for i in range(n)]
    names = [*_rotations(n), *vectors, "h", *(["mass"] if massive else [])]
    name = f"{'bargmann' if massive else 'galilei'}({n})"
    # Rotations preserve the brackets of the ideal, and the matrices are those of so(n).
    return semidirect_sum(so(n), rotations, ideal, basis=names, name=name, check=False)
