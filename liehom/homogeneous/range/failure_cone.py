"""Certified subsets of the cone on which the range condition fails.

The cone is Z = {psi in g : [h, psi] + R psi + h is not g}, described in V = g/h.  Each part below is a subset of Z
for a reason that is checked here; a numerical basis of an eigenspace is only an illustration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from liehom.errors import InputError, ShapeError, UndecidedError
from liehom.homogeneous.range.relative_invariant import MAX_DIMENSION, RelativeInvariant, relative_invariant
from liehom.representations import Pair
from liehom.scalars import QQ, Matrix, Scalar
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import Array


class CertificateLike(Protocol):
    """The part of `liehom.Certificate` that `failure_cone` reads; `Certificate` itself is in a layer above this one."""

    @property
    def kind(self) -> str:
        """The kind of certificate."""
        ...

    def number(self, name: str, /) -> Scalar:
        """The number under a key."""
        ...

    def vector(self, name: str, length: int, /) -> Sequence[Scalar]:
        """The vector under a key."""
        ...

    def matrix(self, name: str, nrows: int, ncols: int, /) -> Matrix:
        """The matrix under a key."""
        ...


@final
@dataclass(frozen=True, slots=True)
class FailureSet:
    """A subset of the cone on which the range condition fails.

    Attributes
    ----------
    kind : {'hypersurface', 'null cone', 'subspace', 'eigenspace'}
    description : str
        The set as a noun phrase, in the coordinates x of ``pair.coordinates``.
    data : RelativeInvariant, Matrix or array
        For a hypersurface f, for a null cone the matrix P of the form, otherwise rows of coordinates x that span the
        subspace (floats for 'eigenspace').
    covers : bool
        Whether Z without this set has codimension at least 2: all components of codimension 1 are in it.
    """

    kind: str
    description: str
    data: RelativeInvariant | Matrix | Array
    covers: bool = False


def failure_cone(
    pair: Pair,
    *,
    forms: Sequence[MatrixLike] = (),
    subspaces: Sequence[MatrixLike] = (),
    certificate: CertificateLike | None = None,
) -> list[FailureSet]:
    """Certified subsets of the cone of psi at which the range condition fails.

    Parameters
    ----------
    pair : Pair
        Over an exact field, with g/h not zero.
    forms : sequence of matrices (d, d)
        Symmetric forms on g/h that h preserves up to scalars, in the coordinates of ``pair.coordinates``.
    subspaces : sequence of matrices or rows (m, d)
        Invariant subspaces of g/h, except 0 and g/h.
    certificate : optional
        A verified certificate of kind 'dominance' or 'commutant'; its eigenspace W is listed with a numerical basis.

    Returns
    -------
    list of FailureSet
        For a full pair with an invariant form these are the zeros of the form, which is 0 only.

    Raises
    ------
    InputError
        If a form is zero or not invariant, or a subspace is zero, not proper or not invariant.
    UndecidedError
        Over float64.

    Notes
    -----
    If A^T P + P A = 2 c P for the A in rho(h) and x^T P x = 0, then P x annihilates rho(h) x and x: the condition
    fails at x if P x is not 0, and if it is 0, x lies in ker P, a proper invariant subspace. On a proper invariant
    subspace rho(h) x and x stay inside.

    Examples
    --------
    >>> import liehom as lh
    >>> [part.description for part in failure_cone(lh.defining(lh.so(3, 1)).pair([1, 0, 0, 0]))]
    ['the zeros of x0^2 + x1^2 - x2^2']
    """
    if not pair.field.exact:
        raise UndecidedError(
            "the cone on which the range condition fails is computed over exact fields only: go to exact numbers by "
            "lh.rationalize(pair, max_denominator=...)"
        )
    found: list[FailureSet] = []
    if has_hypersurfaces_computed(pair):
        invariant = relative_invariant(pair)
        if invariant is not None and invariant.degree:
            found.append(_hypersurface(invariant))
    found += [_null_cone(pair, form) for form in forms]
    found += [_subspace(pair, rows) for rows in subspaces]
    if certificate is not None and certificate.kind in ("dominance", "commutant"):
        found += _eigenspace(pair, certificate)
    return found


def has_hypersurfaces_computed(pair: Pair) -> bool:
    """Whether `failure_cone` lists all components of codimension 1 of the cone on which the range condition fails.

    It does so over QQ if g/h has dimension at most 8, and the condition holds for some psi.

    Examples
    --------
    >>> import liehom as lh
    >>> [has_hypersurfaces_computed(lh.pair(name)) for name in ("so(4)/so(3)", "so(11)/so(10)")]
    [True, False]
    """
    return 0 < pair.dimension <= MAX_DIMENSION and pair.field == QQ


def _hypersurface(invariant: RelativeInvariant) -> FailureSet:
    return FailureSet("hypersurface", f"the zeros of {invariant}", invariant, covers=True)


def _matrix(pair: Pair, rows: MatrixLike) -> Matrix:
    d = pair.dimension
    made: Matrix = pair.field.read(rows, None if isinstance(rows, Matrix) else (len(rows), d))
    if made.ncols != d:
        raise ShapeError(f"expected rows of length {d} (coordinates on g/h), got {made.ncols}")
    return made


def _null_cone(pair: Pair, form: MatrixLike) -> FailureSet:
    p = _matrix(pair, form)
    if p.nrows != p.ncols or p != p.T or p.is_zero():
        raise InputError("an invariant form is a symmetric matrix that is not zero")
    place = next(x for x, v in enumerate(p.entries()) if v != 0)
    i, j = divmod(place, p.ncols)
    for a in pair.isotropy_matrices():
        moved = a.T @ p + p @ a
        if moved != p.scale(moved[i, j] / p[i, j]):
            raise InputError("the form is not invariant under h up to scalars")
    return FailureSet("null cone", f"the zeros of the invariant form of signature {p.signature()}", p)


def _subspace(pair: Pair, rows: MatrixLike) -> FailureSet:
    made = _matrix(pair, rows)
    basis = made.row_space()
    m, d = basis.nrows, pair.dimension
    if not 0 < m < d:
        raise InputError(f"a proper subspace of g/h has dimension between 1 and {d - 1}, got {m}")
    for a in pair.isotropy_matrices():
        if pair.field.stack_rows([basis, basis @ a.T], d).rank() != m:
            raise InputError("the subspace is not invariant under h")
    return FailureSet("subspace", f"an invariant subspace of dimension {m} of g/h", basis)


def _eigenspace(pair: Pair, certificate: CertificateLike) -> list[FailureSet]:
    """The sum W of the generalized eigenspaces with real part above the cut, with a numerical basis.

    Nothing if the numbers are too large for floats.
    """
    from scipy.linalg import schur

    d = pair.dimension
    cut = pair.field.to_float(certificate.number("cut"))
    if certificate.kind == "dominance":
        row = pair.algebra.row(certificate.vector("element", pair.algebra.dimension))
        operator = _isotropy_of(pair, row)
        operator = operator - np.eye(d) * np.trace(operator) / d
        frame, what = np.eye(d), "rho(X) without its trace, X the element of the dominance certificate"
    else:
        operator = certificate.matrix("matrix", d, d).to_numpy()
        complement = certificate.matrix("complement", d, pair.algebra.dimension)
        frame = (complement @ pair.subalgebra.quotient().projection).to_numpy().T
        what = "the commuting matrix of the certificate"
    if not (np.isfinite(operator).all() and np.isfinite(frame).all()):
        return []
    *_, vectors, size = schur(operator, sort=lambda re, im: re > cut)
    basis = (frame @ vectors[:, :size]).T
    text = f"the sum of the eigenspaces of {what} with real part above {cut:g}, of dimension {size} (basis numerical)"
    return [FailureSet("eigenspace", text, basis)]


def _isotropy_of(pair: Pair, row: Matrix) -> Array:
    """The matrix rho(X) on g/h for X in h, as floats."""
    data = pair.subalgebra.quotient()
    made: Array = pair.algebra.table.contract(row, data.lift, data.projection)[0].T.to_numpy()
    return made
