"""Lie algebras by name: kinematical, conformal, solvable and nilpotent families."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Sequence
from functools import cached_property
from itertools import combinations
from typing import final

import numpy as np

from liehom.base.budget import current_limits, within
from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import IntegerArray, ScalarLike
from liehom.exact.algebra.constructions.classical import form_brackets, index_name, so
from liehom.exact.algebra.constructions.sums import direct_sum, semidirect_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.tables import ConstantsMapping, field_of_values
from liehom.exact.algebra.linear.closure import lie_closure, square_matrices
from liehom.exact.algebra.linear.linear_bases import require_basis, require_size, triangular
from liehom.exact.algebra.linear.named_matrices import classical_matrices, linear_lie_algebra
from liehom.exact.scalars.field import MatricesLike, Matrix, MatrixLike, Scalar
from liehom.exact.scalars.rational import QQ

# Solvable Lie algebras by name: abelian, Heisenberg, triangular, filiform, oscillator, almost abelian, Bianchi.
# Bianchi's list of all algebras of dimension three includes two simple ones, types VIII and IX.


def abelian(n: int) -> LieAlgebra:
    """The abelian Lie algebra R^n; n may be 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.abelian(2), lh.abelian(2).is_abelian()
    (<Lie algebra R^2 of dimension 2 over QQ>, True)
    """
    require_size("n", n, 0)
    name = f"R^{n}" if n > 1 else "R" if n else "0"
    return LieAlgebra(StructureConstants(QQ, n, []), name=name, check=False)  # no bracket, nothing to prove


def heisenberg(n: int) -> LieAlgebra:
    """The Heisenberg algebra of dimension 2n + 1, with [x_i, y_i] = z and basis x_1, ..., x_n, y_1, ..., y_n, z.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.heisenberg(1))
    Lie algebra heisenberg(1) over QQ, dimension 3
      basis x1, y1, z
      [x1, y1] = z
    """
    require_size("n", n, 0)
    table = StructureConstants(QQ, 2 * n + 1, [(i, n + i, 2 * n, QQ.one) for i in range(n)])
    # All double brackets vanish: z is central.
    return LieAlgebra(table, basis=[*_pairs(n), "z"], name=f"heisenberg({n})", check=False)


def _pairs(n: int) -> list[str]:
    return [f"{letter}{i + 1}" for letter in "xy" for i in range(n)]


def upper_triangular(n: int) -> LieAlgebra:
    """The Lie algebra of upper triangular matrices, with basis e_ij (i <= j) row by row; n is at least 1.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.upper_triangular(3)
    >>> g, g.center().dimension, [s.dimension for s in g.derived_series()]
    (<Lie algebra upper(3) of dimension 6 over QQ>, 1, [6, 3, 1, 0])
    """
    return _triangular(n, 0, "upper({})")


def strictly_upper_triangular(n: int) -> LieAlgebra:
    """The Lie algebra of strictly upper triangular matrices, with basis e_ij (i < j) row by row; n is at least 1.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.strictly_upper_triangular(4)
    >>> g, [s.dimension for s in g.lower_central_series()]
    (<Lie algebra strict(4) of dimension 6 over QQ>, [6, 3, 1, 0])
    """
    return _triangular(n, 1, "strict({})")


def filiform(n: int) -> LieAlgebra:
    """The standard filiform algebra, n > 2, nilpotent of maximal step n - 1: [x_1, x_i] = x_{i+1} for 1 < i < n.

    Examples
    --------
    >>> import liehom as lh
    >>> [s.dimension for s in lh.algebra.filiform(5).lower_central_series()]
    [5, 3, 2, 1, 0]
    """
    require_size("n", n, 3)
    brackets = {(0, i): {i + 1: 1} for i in range(1, n - 1)}
    return LieAlgebra(brackets, dimension=n, basis=[f"x{i + 1}" for i in range(n)], name=f"filiform({n})")


def oscillator(n: int = 1, frequencies: Sequence[ScalarLike] | None = None) -> LieAlgebra:
    """The oscillator algebra R + heisenberg(n): [t, x_i] = w_i y_i, [t, y_i] = -w_i x_i, [x_i, y_i] = z.

    Parameters
    ----------
    n : int
        Number of oscillators, at least 1; the dimension is 2n + 2, the basis t, x_1, ..., x_n, y_1, ..., y_n, z.
    frequencies : sequence of n numbers, optional
        The non-zero w_i; by default all 1. ``oscillator()`` is the diamond algebra.

    Notes
    -----
    The quadratic form sum_i (x_i**2 + y_i**2) / w_i + 2 t z is invariant. For positive w_i it is Lorentzian, so the
    group is a Lorentzian symmetric space that is not semisimple.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.oscillator()
    >>> g, [s.dimension for s in g.derived_series()], g.center().rows()
    (<Lie algebra oscillator(1) of dimension 4 over QQ>, [4, 3, 1, 0], [[0, 0, 0, 1]])
    """
    require_size("n", n)
    numbers = [1] * n if frequencies is None else list(frequencies)
    if len(numbers) != n:
        raise ShapeError(f"{len(numbers)} frequencies for {n} oscillators")
    field = field_of_values(numbers)
    values = [field.convert(w) for w in numbers]
    shown = list(map(field.format, values))
    if any(w == 0 for w in values):
        raise InputError(f"the frequencies of an oscillator are not zero, got {', '.join(shown)}")
    brackets: dict[tuple[int, int], dict[int, Scalar | int]] = {}
    for x, w in enumerate(values, 1):
        y = n + x
        brackets |= {(0, x): {y: w}, (0, y): {x: -w}, (x, y): {2 * n + 1: 1}}
    name = f"oscillator({n})" if frequencies is None else f"oscillator({n};{','.join(shown)})"
    return LieAlgebra(brackets, field, dimension=2 * n + 2, basis=["t", *_pairs(n), "z"], name=name)


def almost_abelian(matrix: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The Lie algebra R + R^n with [t, x_j] = sum_i A_ij x_i for a matrix A (n, n), in which R^n is an abelian ideal.

    Two such algebras are isomorphic if and only if one matrix is conjugate to a non-zero multiple of the other. The
    algebra is abelian, nilpotent or unimodular if and only if A = 0, A is nilpotent or tr A = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.algebra.almost_abelian([[1, 0], [0, "-1/2"]]))
    Lie algebra over QQ, dimension 3
      basis t, x1, x2
      [t, x1] = x1
      [t, x2] = -1/2*x2
    """
    action: Matrix = matrix if isinstance(matrix, Matrix) else square_matrices([matrix])[0]
    n = action.nrows
    if action.ncols != n or n == 0:
        raise ShapeError(f"an almost abelian algebra needs a square matrix of size at least 1, got {action.shape}")
    rows = action.T.to_rows()
    brackets = {(0, 1 + j): {1 + i: v for i, v in enumerate(row) if v != 0} for j, row in enumerate(rows)}
    names = ["t", *(index_name("x", i) for i in range(n))]
    return LieAlgebra(brackets, action.field, dimension=n + 1, basis=names, name=name)


def bianchi(kind: str, a: ScalarLike | None = None) -> LieAlgebra:
    """The real Lie algebra of dimension 3 of a Bianchi type, 'I' to 'IX'.

    Parameters
    ----------
    kind : str
        A Roman numeral from 'I' to 'IX', in upper or lower case.
    a : number, optional
        The non-negative parameter of 'VI' and 'VII', by default 0. These are VI_h with h = -a**2 and VII_h with
        h = a**2. ``bianchi('VI', 1)`` is type III.

    Notes
    -----
    [e2, e3] = n1 e1, [e3, e1] = n2 e2 - a e3, [e1, e2] = n3 e3 + a e2 with

    =====  ============  ===  =========  ==============================
    I      (0, 0, 0)     0    R^3        abelian
    II     (1, 0, 0)     0    A3,1       heisenberg(1)
    III    (0, 1, -1)    1    A2,1+R     R + aff(1)
    IV     (0, 0, 1)     1    A3,2
    V      (0, 0, 0)     1    A3,3       acts on hyperbolic space
    VI     (0, 1, -1)    a    A3,5(b)    a = 0: A3,4 = iso(1, 1)
    VII    (0, 1, 1)     a    A3,7(a)    a = 0: A3,6 = e(2)
    VIII   (1, 1, -1)    0    A3,8       sl(2)
    IX     (1, 1, 1)     0    A3,9       so(3)
    =====  ============  ===  =========  ==============================

    The fourth column is the name that `LieAlgebra.identify` gives, with b = (a - 1) / (a + 1) for type VI.
    I, II, VI with a = 0, VII with a = 0, VIII and IX are unimodular.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.bianchi("VII", "1/2"))
    Lie algebra bianchi(VII;1/2) over QQ, dimension 3
      basis e1, e2, e3
      [e1, e2] = 1/2*e2 + e3
      [e1, e3] = -e2 + 1/2*e3
    """
    wanted = kind.strip().upper() if isinstance(kind, str) else ""
    if wanted not in _BIANCHI:
        raise InputError(f"there is no Bianchi type {displayed(kind)}; the types are {', '.join(_BIANCHI)}")
    (n1, n2, n3), fixed = _BIANCHI[wanted]
    if fixed is not None and a is not None:
        raise InputError(f"type {wanted} of Bianchi has no parameter, got {displayed(a)}; only VI and VII have one")
    parameter = fixed if fixed is not None else 0 if a is None else a
    field = field_of_values([parameter])
    value = field.convert(parameter)
    if field.sign(value) < 0:
        raise InputError(f"the parameter of Bianchi's type {wanted} is not negative, got {field.format(value)}")
    name = f"bianchi({wanted})" if a is None else f"bianchi({wanted};{field.format(value)})"
    brackets: ConstantsMapping = {(1, 2): {0: n1}, (0, 2): {1: -n2, 2: value}, (0, 1): {1: value, 2: n3}}
    return LieAlgebra(brackets, field, dimension=3, basis=["e1", "e2", "e3"], name=name)


_BIANCHI: dict[str, tuple[tuple[int, int, int], int | None]] = {
    "I": ((0, 0, 0), 0), "II": ((1, 0, 0), 0), "III": ((0, 1, -1), 1), "IV": ((0, 0, 1), 1), "V": ((0, 0, 0), 1),
    "VI": ((0, 1, -1), None), "VII": ((0, 1, 1), None), "VIII": ((1, 1, -1), 0), "IX": ((1, 1, 1), 0),
}  # fmt: skip


def _triangular(n: int, above: int, name: str) -> LieAlgebra:
    table = linear_lie_algebra(triangular(n, above)).table
    names = [index_name("e", i, j) for i in range(n) for j in range(i + above, n)]
    # Products of triangular matrices are triangular, and commutators satisfy the Jacobi identity.
    return LieAlgebra(table, basis=names, name=name.format(n), check=False)


# Lie algebras of affine and kinematical groups: Euclidean, Poincaré, Galilei, Schrödinger, conformal, gl(n) + R^n.
# Each is over QQ, with named basis elements.


def euclidean(n: int) -> LieAlgebra:
    """The Euclidean algebra e(n) = so(n) + R^n: first the rotations, then the translations.

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

    ``poincare(3)`` is the algebra of dimension 10 of special relativity.

    [m_ij, p_i] = e_i p_j and [m_ij, p_j] = -e_j p_i, where e_i is 1 for i <= p, else -1 (for p = 0 all are 1).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.poincare(3)
    >>> g, g.center().dimension, [s.dimension for s in g.derived_series()]
    (<Lie algebra iso(3,1) of dimension 10 over QQ>, 0, [10])
    """
    matrices = classical_matrices("so", p, q)
    names = [*_rotations(p + q), *_vectors("p", p + q)]
    # The matrices are the basis of so(p, q) itself: a representation.
    return semidirect_sum(so(p, q), matrices, size=p + q, basis=names, name=f"iso({p},{q})", check=False)


def galilei(n: int) -> LieAlgebra:
    """Galilei algebra of R^n with rotations m_ij, boosts k_i, translations p_i, time translation h; [k_i, h] = p_i.

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

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.bargmann(3)
    >>> g, g.center().rows() == [[0] * 10 + [1]]
    (<Lie algebra bargmann(3) of dimension 11 over QQ>, True)
    """
    return _galilean(n, massive=True)


def schroedinger(n: int) -> LieAlgebra:
    """The Schrödinger algebra of R^n with mass: `bargmann`, with dilations d and expansions c.

    Its basis is: rotations m_ij, then h, d, c, boosts k_i, translations p_i, mass.

    It is (so(n) + sl(2)) + heisenberg(n), a semidirect sum, with [k_i, h] = p_i, [k_i, p_i] = mass, [d, h] = -2 h,
    [d, c] = 2 c, [c, h] = d, [d, k_i] = k_i, [d, p_i] = -p_i and [c, p_i] = -k_i: the symmetries of the free
    Schrödinger equation.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.schroedinger(3)
    >>> g, g.semisimple_type(), g.radical().dimension
    (<Lie algebra schroedinger(3) of dimension 13 over QQ>, 'A1 + A1', 7)
    """
    require_size("n", n)
    sl2 = LieAlgebra({(1, 0): {0: -2}, (1, 2): {2: 2}, (2, 0): {1: 1}})
    blocks = np.array([[[0, 0], [-1, 0]], [[1, 0], [0, -1]], [[0, -1], [0, 0]]])  # h, d, c on the pairs (k_i, p_i)
    matrices = _rotations_of_vectors(n, 2 * n + 1)
    matrices += [np.pad(np.kron(block, np.eye(n, dtype=np.int64)), (0, 1)) for block in blocks]
    names = [*_rotations(n), *"hdc", *_vectors("kp", n), "mass"]
    # Rotations and sl(2) = sp(2, R) preserve the form of the Heisenberg algebra, and commute with each other.
    return semidirect_sum(
        direct_sum(so(n), sl2), matrices, heisenberg(n), basis=names, name=f"schroedinger({n})", check=False
    )


def conformal(p: int, q: int = 0) -> LieAlgebra:
    """The conformal algebra of R^(p,q), isomorphic to so(p+1, q+1).

    Its basis is: translations p_i, rotations m_ij, the dilation d, special conformal transformations k_i.

    [d, p_i] = p_i, [d, k_i] = -k_i, [k_i, p_j] = m_ij + e_ij d, [m_ij, p_i] = e_ii p_j, [m_ij, p_j] = -e_jj p_i, and
    likewise with k for p. The p_i, m_ij, d span the similarities of R^(p,q).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.conformal(3, 1)
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
    names = [*_vectors("p", n), *_rotations(n), "d", *_vectors("k", n)]
    table = StructureConstants(QQ, len(pairs), form_brackets(form, -1, positions))
    # The brackets are those of the orthogonal matrices of a form that is not degenerate.
    return LieAlgebra(table, basis=names, name=f"conformal({p},{q})" if q else f"conformal({p})", check=False)


def affine(n: int) -> LieAlgebra:
    """The affine algebra aff(n) = gl(n) + R^n: elementary matrices e_ij row by row, then translations t_i.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.algebra.affine(1))
    Lie algebra aff(1) over QQ, dimension 2
      basis e11, t1
      [e11, t1] = t1
    """
    matrices = classical_matrices("gl", n)
    names = [*(index_name("e", i, j) for i in range(n) for j in range(n)), *_vectors("t", n)]
    # The matrices are the basis of gl(n) itself: a representation.
    return semidirect_sum(linear_lie_algebra(matrices), matrices, basis=names, name=f"aff({n})", check=False)


def affine_of(matrices: MatricesLike, *, name: str | None = None) -> LieAlgebra:
    """The affine algebra h + V of a linear Lie algebra h: first its basis of matrices (N, N), then the translations.

    [x, v] = x v. Use `semidirect_sum` for a representation that is not faithful or an ideal that is not abelian.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.affine_of([[[0, -1], [1, 0]], [[1, 0], [0, 1]]])
    <Lie algebra of dimension 4 over QQ>
    """
    closure = lie_closure(matrices, close=False)
    # The matrices have the brackets of the algebra: a representation.
    return semidirect_sum(closure.algebra, closure.matrices, name=name, check=False)


def _rotations(n: int) -> list[str]:
    return [index_name("m", i, j) for i, j in itertools.combinations(range(n), 2)]


def _vectors(letters: str, n: int) -> list[str]:
    return [index_name(letter, i) for letter in letters for i in range(n)]


def _rotations_of_vectors(n: int, size: int) -> list[IntegerArray]:
    """The matrices of so(n) on two vectors, the first 2n of `size` coordinates."""
    require_basis(n * (n - 1) // 2, size)
    one = np.eye(2, dtype=np.int64)
    return [np.pad(np.kron(one, matrix), (0, size - 2 * n)) for matrix in classical_matrices("so", n)]


def _galilean(n: int, massive: bool) -> LieAlgebra:
    """so(n) acting by rotations on the nilpotent ideal of boosts, translations, time and, if massive, mass."""
    require_size("n", n)
    d = 2 * n + 1 + massive
    brackets = {(i, 2 * n): {n + i: 1} for i in range(n)}
    brackets |= {(i, n + i): {2 * n + 1: 1} for i in range(n) if massive}
    ideal, rotations = LieAlgebra(brackets, dimension=d), _rotations_of_vectors(n, d)
    names = [*_rotations(n), *_vectors("kp", n), "h", "mass"][: n * (n - 1) // 2 + d]
    # Rotations preserve the brackets of the ideal, and the matrices are those of so(n).
    name = f"{'bargmann' if massive else 'galilei'}({n})"
    return semidirect_sum(so(n), rotations, ideal, basis=names, name=name, check=False)


# Free nilpotent Lie algebras in the basis of Lyndon words, a Hall basis.
# A word is Lyndon if it is smaller than its proper right factors. A Lyndon word w of length at least 2 is bracketed as
# [u, v], where w = u v and v is the longest proper right factor that is Lyndon. For Lyndon words u < v the bracket [u,
# v] is the basis element u v if u is a letter, or if u = u1 u2 with u2 not smaller than v. Otherwise
#
#     [[u1, u2], v] = [[u1, v], u2] + [u1, [u2, v]],
#
# and this recursion terminates.

Word = tuple[int, ...]


def free_nilpotent(generators: int, step: int) -> LieAlgebra:
    """The free nilpotent Lie algebra over QQ with a number of generators; its step is the largest length of a bracket.

    Basis elements are by length and then alphabetic, with their brackets as names: x1, x2, [x1,x2], [x1,[x1,x2]], ...

    Every nilpotent Lie algebra of this step with this number of generators is a quotient of it. For g generators
    there are (1/k) sum_{d | k} mu(d) g^(k/d) basis elements of length k (Witt).

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.algebra.free_nilpotent(2, 3))
    Lie algebra free_nilpotent(2,3) over QQ, dimension 5
      basis x1, x2, [x1,x2], [x1,[x1,x2]], [[x1,x2],x2]
      [x1, x2] = [x1,x2]
      [x1, [x1,x2]] = [x1,[x1,x2]]
      [x2, [x1,x2]] = -[[x1,x2],x2]
    """
    require_size("generators", generators)
    require_size("step", step)
    dimension = _dimension(generators, step, current_limits().dimension)
    within("dimension", dimension, "the algebra has dimension {} or more")
    free = _FreeLie(generators, step)
    index = {word: i for i, word in enumerate(free.words)}
    entries = []
    for (i, u), (j, v) in combinations(enumerate(free.words), 2):
        if len(u) + len(v) <= step:
            entries += [(i, j, index[w], QQ.convert(c)) for w, c in free.bracket(u, v).items()]
    names = [free.name(word) for word in free.words]
    table = StructureConstants(QQ, len(names), entries)
    # Brackets of a quotient of the free Lie algebra, rewritten by antisymmetry and the Jacobi identity only.
    return LieAlgebra(table, basis=names, name=f"free_nilpotent({generators},{step})", check=False)


def _dimension(generators: int, step: int, enough: int) -> int:
    """Number of Lyndon words up to length `step` by Witt's formula; the count ends when it exceeds `enough`."""
    ending: dict[int, int] = {}  # length k: k times the number of Lyndon words of length k
    total = 0
    for k in range(1, step + 1):
        ending[k] = generators**k - sum(ending[d] for d in range(1, k // 2 + 1) if k % d == 0)
        total += ending[k] // k
        if total > enough or generators == 1:
            break
    return total


@final
class _FreeLie:
    """Brackets of Lyndon words up to length `step`."""

    def __init__(self, generators: int, step: int) -> None:
        self.generators, self.step = generators, step
        self._known: dict[tuple[Word, Word], dict[Word, int]] = {}

    @cached_property
    def words(self) -> list[Word]:
        """The Lyndon words of length at most `step`, by length and then alphabetically (Duval's algorithm)."""
        words: list[Word] = []
        word = [-1]
        while word:
            word[-1] += 1
            words.append(tuple(word))
            period = len(word)
            while len(word) < self.step:
                word.append(word[-period])
            while word and word[-1] == self.generators - 1:
                word.pop()
        return sorted(words, key=lambda w: (len(w), w))

    def factors(self, word: Word) -> tuple[Word, Word]:
        """The Lyndon words u, v of the bracketing [u, v] of a Lyndon word of length at least 2."""
        # the least proper right factor is the longest one that is Lyndon
        cut = min(range(1, len(word)), key=lambda i: word[i:])
        return word[:cut], word[cut:]

    def name(self, word: Word) -> str:
        """The bracketing of a Lyndon word as a string in x1, x2, ..."""
        return f"x{word[0] + 1}" if len(word) == 1 else f"[{','.join(map(self.name, self.factors(word)))}]"

    def bracket(self, u: Word, v: Word) -> dict[Word, int]:
        """[u, v] of two basis elements, as {word: coefficient}."""
        if u == v or len(u) + len(v) > self.step:
            return {}
        if u > v:
            return {w: -c for w, c in self.bracket(v, u).items()}
        if (u, v) not in self._known:
            self._known[u, v] = self._new_bracket(u, v)
        return self._known[u, v]

    def _new_bracket(self, u: Word, v: Word) -> dict[Word, int]:
        if len(u) == 1 or (factors := self.factors(u))[1] >= v:
            return {u + v: 1}
        first, second = factors
        terms = [(c, self.bracket(w, second)) for w, c in self.bracket(first, v).items()]
        terms += [(c, self.bracket(first, w)) for w, c in self.bracket(second, v).items()]
        total: defaultdict[Word, int] = defaultdict(int)
        for c, inner in terms:
            for x, d in inner.items():
                total[x] += c * d
        return {w: c for w, c in total.items() if c}
