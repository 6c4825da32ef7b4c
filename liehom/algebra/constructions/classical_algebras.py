"""The classical Lie algebras gl, sl, so, su, u, sp and so*(2n), and the parabolic subalgebras of sl(n).

Each is over QQ, in the basis of its matrices (`liehom.algebra.matrices`), and has a name that the catalogue reads.
"""

from __future__ import annotations

import itertools

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.matrices import form_preserving
from liehom.algebra.matrices.matrix_basis import require_size
from liehom.algebra.matrices.named_matrices import Parameter, classical_matrices, classical_name, linear_lie_algebra
from liehom.errors import InputError


def gl(n: int, over: str = "R") -> LieAlgebra:
    """The real Lie algebra gl(n) over 'R', 'C' or 'H', of dimension n**2, 2 n**2 or 4 n**2.

    Parameters
    ----------
    n : int
        Size, at least 1.
    over : 'R', 'C' or 'H'

    Raises
    ------
    InputError
        If n is not a positive integer, or `over` is not one of the three letters.

    Notes
    -----
    The basis is E_ij, row by row. Over C each E_ij is followed by i E_ij, over H by i E_ij, j E_ij, k E_ij. Indices
    count from 0, and ``lh.defining(g)`` has the matrices.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.gl(2).dimension, lh.gl(1, "H").dimension
    (4, 4)
    """
    return _classical("gl", n, over)


def sl(n: int, over: str = "R") -> LieAlgebra:
    """The real Lie algebra sl(n) over 'R', 'C' or 'H'; over H, the real trace vanishes.

    Raises
    ------
    InputError
        If n is not a positive integer, or `over` is not one of the three letters.

    Notes
    -----
    The basis is E_ij for i != j, row by row, then E_ii - E_{i+1,i+1}. Over C each of these is followed by its multiple
    by i. Over H it is q E_ij for i != j and q = 1, i, j, k, then q E_ii for q = i, j, k, then E_ii - E_{i+1,i+1}.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sl(3), lh.sl(2, "H").dimension
    (<Lie algebra sl(3) of dimension 8 over QQ>, 15)
    """
    return _classical("sl", n, over)


def so(p: int, q: int | str = 0) -> LieAlgebra:
    """The real Lie algebra so(p, q), of dimension n (n - 1) / 2 with n = p + q, or so(n, 'C').

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Notes
    -----
    The basis is L_ij = d_i E_ji - d_j E_ij for i < j in lexicographic order, with d_i = 1 for the first p indices and
    -1 for the others (for p = 0 all are 1). In so(n), L_ij rotates e_i towards e_j. For n = 3 these are hat(z),
    -hat(y), hat(x) with hat(w) v = w x v. In so(n, 'C') each E_ji - E_ij is followed by its multiple by i.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.so(3).killing_signature(), lh.so(2, 1).killing_signature(), lh.so(3, "C").dimension
    ((0, 3, 0), (2, 1, 0), 6)
    """
    return _classical("so", p, q)


def su(p: int, q: int = 0) -> LieAlgebra:
    """The real Lie algebra su(p, q), of dimension n**2 - 1 with n = p + q.

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Notes
    -----
    The basis is d_k E_lk - d_l E_kl, then i (d_k E_lk + d_l E_kl), for each k < l in lexicographic order, and after all
    these i (E_kk - E_{k+1,k+1}); d_k = 1 for the first p indices and -1 for the others (for p = 0 all are 1). On R^2n
    an entry a + bi is the block [[a, -b], [b, a]]. In su(2) these are -i sigma_y, i sigma_x, i sigma_z.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.su(3).killing_signature(), lh.su(1, 1).killing_signature()
    ((0, 8, 0), (2, 1, 0))
    """
    return _classical("su", p, q)


def u(p: int, q: int = 0) -> LieAlgebra:
    """The real Lie algebra u(p, q), of dimension n**2 with n = p + q.

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Notes
    -----
    The basis is i E_kk for all k, then for k < l the elements of `su`: d_k E_lk - d_l E_kl and i (d_k E_lk + d_l E_kl).

    Examples
    --------
    >>> import liehom as lh
    >>> lh.u(2).center().dimension
    1
    """
    return _classical("u", p, q)


def sp(p: int, q: int | str = 0) -> LieAlgebra:
    """The compact sp(n), sp(p, q) on H^(p+q), or with a letter the split sp(2n, 'R') and sp(2n, 'C').

    Parameters
    ----------
    p : int
        If q is a number, sp(p, q) has dimension n (2n + 1) with n = p + q; sp(1) = su(2). If q is a letter, p is the
        even size 2n.
    q : int, 'R' or 'C'

    Raises
    ------
    InputError
        If p or q is negative, p + q is 0, or the size is odd and q is a letter.

    Notes
    -----
    The basis of sp(p, q) is i E_kk for all k, j E_kk for all k, k E_kk for all k (the units i, j, k of H), then for
    each k < l and x = 1, i, j, k the matrix d_k x E_lk - d_l conj(x) E_kl, with the signs d of `su`. On R^4n an entry
    x is the block of the left multiplication by x in the basis 1, i, j, k.

    The basis of sp(2n, 'R') is E_ij - E_{n+j,n+i} row by row, then for i <= j in lexicographic order
    E_{i,n+j} + E_{j,n+i} (E_{i,n+i} for i = j), then the transposes of these. In sp(2n, 'C') each is followed by its
    multiple by i.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sp(2).killing_signature(), lh.sp(4, "R").killing_signature(), lh.sp(1, 1).killing_signature()
    ((0, 10, 0), (6, 4, 0), (4, 6, 0))
    """
    return _classical("sp", p, q)


def so_star(n: int) -> LieAlgebra:
    """The real Lie algebra so*(2n) = {X in gl(n, H) : X* j + j X = 0}, of dimension n (2n - 1).

    Parameters
    ----------
    n : int
        Size over the quaternions, at least 1; half the number in the name.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Notes
    -----
    The basis is j E_kk for all k, then for each k < l and q = 1, i, j, k the matrix q E_kl + j conj(q) j E_lk.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.so_star(3), lh.so_star(3).killing_signature()
    (<Lie algebra so*(6) of dimension 15 over QQ>, (6, 9, 0))
    """
    require_size("n", n)
    return linear_lie_algebra(form_preserving.so_star(n), f"so*({2 * n})")


def parabolic_subalgebra(*sizes: int) -> Subalgebra:
    """The parabolic subalgebra of block upper triangular matrices in sl(n).

    Parameters
    ----------
    *sizes : int
        The sizes of the diagonal blocks, at least one, each at least 1; n is their sum. Sizes 1, ..., 1 give the Borel
        subalgebra.

    Returns
    -------
    Subalgebra
        Of ``sl(n)``, in its basis. In `LieAlgebra.parabolic_subalgebra` the ends of the blocks are crossed.

    Raises
    ------
    InputError
        If there is no block or a size is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> h = lh.parabolic_subalgebra(1, 2)
    >>> h, h.algebra.normalizer(h).dimension
    (<subalgebra of dimension 6 in sl(3) over QQ>, 6)
    """
    if not sizes:
        raise InputError("a parabolic subalgebra needs the sizes of its diagonal blocks, such as (1, 2)")
    for size in sizes:
        require_size("the size of a block", size)
    ends = list(itertools.accumulate(sizes))
    return sl(ends[-1]).parabolic_subalgebra([end - 1 for end in ends[:-1]])


def _classical(kind: str, first: int, second: Parameter) -> LieAlgebra:
    return linear_lie_algebra(classical_matrices(kind, first, second), classical_name(kind, first, second))
