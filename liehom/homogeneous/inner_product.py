"""Which inner product on g measures "least norm": an Ad-invariant one where there is one.

On a compact algebra -tr(rho(x) rho(y)) (or minus the Killing form) is Ad-invariant and positive definite; for
matrices closed under transposition tr(rho(x)^T rho(y)) is -B(x, theta y) with the Cartan involution
theta(x) = -x^T, invariant under the maximal compact subgroup; otherwise the coefficient product of the given
basis.  Imports representations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.representations import Representation

RTOL = 1e-9


@final
@dataclass(frozen=True, slots=True)
class InnerProduct:
    """A positive definite form on g.

    Attributes
    ----------
    matrix : array of shape (dim, dim)
        The Gram matrix in the basis of g.
    name : str
        The formula, as the report of a corrector prints it.
    invariant : bool
        Whether it is Ad-invariant.

    Examples
    --------
    >>> import liehom as lh
    >>> inner_product(lh.defining(lh.so(3))).name
    '-tr(rho(x) rho(y)), Ad-invariant'
    """

    matrix: Any
    name: str
    invariant: bool

    def orthonormal_basis(self) -> Any:
        """A matrix whose columns are an orthonormal basis, shape (dim, dim).

        Examples
        --------
        >>> import liehom as lh
        >>> product = inner_product(lh.defining(lh.sl(2)))
        >>> basis = product.orthonormal_basis()
        >>> bool(np.allclose(basis.T @ product.matrix @ basis, np.eye(3)))
        True
        """
        return np.linalg.inv(np.linalg.cholesky(self.matrix)).T


def inner_product(representation: Representation) -> InnerProduct:
    """The inner product on g by which corrections are least: see the module's formula.

    Parameters
    ----------
    representation : Representation

    Examples
    --------
    >>> import liehom as lh
    >>> inner_product(lh.defining(lh.so(3, 1))).name
    'tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose'
    >>> inner_product(lh.trivial(lh.abelian(2))).name
    'coefficients in the given basis'
    """
    n = representation.algebra.dimension
    flat = np.array([a.to_numpy().ravel() for a in representation.matrices]).reshape(n, -1)
    turned = np.array([a.to_numpy().T.ravel() for a in representation.matrices]).reshape(n, -1)
    trace = -flat @ turned.T
    if _is_positive(trace):
        return InnerProduct(trace, "-tr(rho(x) rho(y)), Ad-invariant", True)
    killing = -np.asarray(representation.algebra.killing_form().to_numpy())
    if _is_positive(killing):
        return InnerProduct(killing, "minus the Killing form, Ad-invariant", True)
    if _is_positive(flat @ flat.T) and _contains(flat, turned):
        name = "tr(rho(x)^T rho(y)) = -tr(rho(x) rho(theta y)), theta = minus transpose"
        return InnerProduct(flat @ flat.T, name, False)
    return InnerProduct(np.eye(n), "coefficients in the given basis", False)


def _is_positive(form: Any) -> bool:
    if form.size == 0:
        return True
    values = np.linalg.eigvalsh((form + form.T) / 2)
    return bool(values[0] > RTOL * abs(values[-1]))


def _contains(rows: Any, others: Any) -> bool:
    """Whether the span of the rows contains the others."""
    found = np.linalg.lstsq(rows.T, others.T, rcond=None)[0]
    return bool(np.abs(rows.T @ found - others.T).max(initial=0.0) <= RTOL * np.abs(rows).max(initial=1.0))
