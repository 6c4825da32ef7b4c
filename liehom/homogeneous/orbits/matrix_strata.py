"""All isotropy strata of rectangular and skew-symmetric matrices, and of binary forms.

Singular values and the eigenvalues of skew-symmetric matrices are normal forms, as eigenvalues are in `strata`. For
square matrices SO(n) keeps one sign more than the values themselves, that of the determinant or of the Pfaffian. If one
of the multiplicities is odd, the two signs have the same isotropy; otherwise they are two strata.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

from liehom.algebra import so
from liehom.algebra.constructions import sl
from liehom.algebra.constructions.sums import direct_sum
from liehom.algebra.matrices.tensor_products import exterior_power, symmetric_power, tensor_sum
from liehom.algebra.roots.real_form_names import canonical_real_form
from liehom.homogeneous.orbits.strata import Stratum, levels, ordered, partitions, require_size
from liehom.homogeneous.orbits.structure_name import reductive_name
from liehom.representations import Representation
from liehom.representations.constructions import standard_matrices
from liehom.scalars import QQ


def rectangular_strata(p: int, q: int) -> list[Stratum]:
    """The strata of so(p) + so(q) on real p x q matrices by X -> A X - X B, largest orbits first.

    Parameters
    ----------
    p, q : int
        At least 1.

    Returns
    -------
    list of Stratum
        The label has the multiplicities of the non-zero singular values. For p = q there may be two strata with the
        same multiplicities; the last entry of the label is negative where the determinant is. The coordinates are the
        entries, row by row.

    Notes
    -----
    Where the singular value s > 0 has multiplicity m_s and n is the rank, the isotropy is the sum of the so(m_s) and of
    so(p - n) + so(q - n). For p = q and n = p - 1 it is the isotropy of a matrix of rank p with one more simple value,
    so that these matrices are in that stratum.

    Examples
    --------
    >>> for stratum in rectangular_strata(2, 3):
    ...     print(stratum)
    <stratum (1, 1): orbits of dimension 4 in 2 parameters, isotropy 0>
    <stratum (1,): orbits of dimension 3 in 1 parameter, isotropy R>
    <stratum (2,): orbits of dimension 3 in 1 parameter, isotropy R>
    <stratum (): orbits of dimension 0 in 0 parameters, isotropy so(3) + R>
    """
    p, q = require_size(p), require_size(q)
    algebra = direct_sum(so(p), so(q))
    matrices = tensor_sum(standard_matrices(f"so({p})"), standard_matrices(f"so({q})"))
    rho = Representation(algebra, [m.tolist() for m in matrices], size=p * q, check=False)
    found = []
    for rank in range(min(p, q) + 1):
        for multiplicities in partitions(rank):
            if p == q == rank + 1:
                continue
            sizes = (*multiplicities, p - rank, q - rank)
            for label in _signed(multiplicities, split=p == q == rank):
                values = [v + 1 for v in levels(multiplicities)]
                if label and label[-1] < 0:
                    values[-1] *= -1
                point = [values[i] if i == j and i < rank else 0 for i in range(p) for j in range(q)]
                found.append(_stratum(label, _orthogonal_name(sizes), len(multiplicities), rho, point))
    return ordered(found)


def skew_strata(k: int) -> list[Stratum]:
    """The strata of so(k) on skew-symmetric k x k matrices by conjugation, largest orbits first.

    Parameters
    ----------
    k : int
        At least 2.

    Returns
    -------
    list of Stratum
        The label has the multiplicities of the positive numbers m for which +-i m are eigenvalues. For even k there
        may be two strata with the same multiplicities; the last entry of the label is negative where the Pfaffian is.
        The coordinates are the entries (i, j) with i < j, in lexicographic order.

    Notes
    -----
    This is the adjoint representation of so(k), in a basis of matrices; `adjoint_strata` labels the same strata by
    subsets of the Dynkin diagram. With the multiplicities m_s and rank 2n the isotropy is the sum of the u(m_s) and of
    so(k - 2n). For k = 2n + 2 it is the isotropy of a matrix with one more simple value, which is in the same stratum.

    Examples
    --------
    >>> for stratum in skew_strata(4):
    ...     print(stratum)
    <stratum (1, 1): orbits of dimension 4 in 2 parameters, isotropy R^2>
    <stratum (-2,): orbits of dimension 2 in 1 parameter, isotropy so(3) + R>
    <stratum (2,): orbits of dimension 2 in 1 parameter, isotropy so(3) + R>
    <stratum (): orbits of dimension 0 in 0 parameters, isotropy so(3) + so(3)>
    """
    k = require_size(k, 2)
    matrices = exterior_power(standard_matrices(f"so({k})"), 2)
    rho = Representation(so(k), [m.tolist() for m in matrices], size=comb(k, 2), check=False)
    found = []
    for half in range(k // 2 + 1):
        for multiplicities in partitions(half):
            if k == 2 * half + 2:
                continue
            ideals = [canonical_real_form(f"su({m})") for m in multiplicities if m > 1]
            rest = k - 2 * half
            ideals += [canonical_real_form(f"so({rest})")] if rest > 2 else []
            for label in _signed(multiplicities, split=k == 2 * half):
                values = [v + 1 for v in levels(multiplicities)]
                if label and label[-1] < 0:
                    values[-1] *= -1
                entries = {(2 * i, 2 * i + 1): v for i, v in enumerate(values)}
                point = [entries.get((i, j), 0) for i in range(k) for j in range(i + 1, k)]
                structure = reductive_name(ideals, len(multiplicities))
                found.append(_stratum(label, structure, len(multiplicities), rho, point))
    return ordered(found)


def binary_form_strata(n: int) -> list[Stratum]:
    """The strata of sl(2, R) on binary forms of degree n, largest orbits first.

    Parameters
    ----------
    n : int
        The degree, at least 1.

    Returns
    -------
    list of Stratum
        The label has one entry, a form of the stratum, and 'generic' for the forms without isotropy. The coordinates
        are the coefficients of x^n, x^(n-1) y, ..., y^n.

    Notes
    -----
    An element that annihilates a form acts on its linear factors over the complex numbers. A nilpotent one leaves x^n
    only, a hyperbolic or elliptic one a power of the quadratic form that it preserves, xy or x^2 + y^2. So there are
    the strata of x^n, of (xy)^m and (x^2 + y^2)^m for n = 2m, and for n > 2 the open one.

    Examples
    --------
    >>> for stratum in binary_form_strata(4):
    ...     print(stratum)
    <stratum (generic,): orbits of dimension 3 in 2 parameters, isotropy 0>
    <stratum ((x^2 + y^2)^2,): orbits of dimension 2 in 1 parameter, isotropy R>
    <stratum ((xy)^2,): orbits of dimension 2 in 1 parameter, isotropy R>
    <stratum (x^4,): orbits of dimension 2 in 0 parameters, isotropy R>
    <stratum (0,): orbits of dimension 0 in 0 parameters, isotropy sl(2,R)>
    """
    n = require_size(n, what="degree of the forms")
    matrices = symmetric_power(standard_matrices("sl(2)"), n)
    rho = Representation(sl(2), [m.tolist() for m in matrices], size=n + 1, check=False)
    power = [int(i == 0) for i in range(n + 1)]
    shown = "x" if n == 1 else f"x^{n}"
    found = [_stratum(("0",), canonical_real_form("sl(2)"), 0, rho, [0] * (n + 1))]
    found.append(_stratum((shown,), "R", 0, rho, power))
    if n % 2 == 0:
        m = n // 2
        end = "" if m == 1 else f"^{m}"
        circle = [comb(m, i // 2) if i % 2 == 0 else 0 for i in range(n + 1)]
        found.append(_stratum((f"(x^2 + y^2){end}" if end else "x^2 + y^2",), "R", 1, rho, circle))
        found.append(_stratum((f"(xy){end}" if end else "xy",), "R", 1, rho, [int(i == m) for i in range(n + 1)]))
    if n > 2:
        found.append(_stratum(("generic",), "0", n - 2, rho, [int(i == 1) for i in range(n + 1)]))
    return ordered(found)


def _signed(multiplicities: tuple[int, ...], *, split: bool) -> list[tuple[int, ...]]:
    """The label, twice if both signs of a square matrix are strata of their own."""
    if not split or not multiplicities or any(m % 2 for m in multiplicities):
        return [multiplicities]
    return [multiplicities, (*multiplicities[:-1], -multiplicities[-1])]


def _orthogonal_name(sizes: Sequence[int]) -> str:
    """The name of the sum of the so(m)."""
    return reductive_name([canonical_real_form(f"so({m})") for m in sizes if m > 2], list(sizes).count(2))


def _stratum(
    label: tuple[int | str, ...], structure: str, parameters: int, rho: Representation, point: list[int]
) -> Stratum:
    exact = tuple(map(QQ.convert, point))
    return Stratum(label, structure, parameters, rho, exact, rho.isotropy(exact))
