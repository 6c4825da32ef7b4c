"""The largest ideal of g inside h, and the effective pair: the quotients of g and h by it.

It is the limit of the decreasing sequence h, h_1, h_2, ... with h_(i+1) = {x in h_i : [x, g] in h_i}, where h_1 is the
kernel of the isotropy representation. An ideal of g inside h changes neither g/h nor rho(h), so neither fullness.
"""

from __future__ import annotations

from liehom.algebra import Subalgebra
from liehom.representations import Pair
from liehom.scalars import ExactMatrix
from liehom.scalars.fields.exact_field import as_exact
from liehom.scalars.spaces.quotient import echelon_quotient


def isotropy_kernel(pair: Pair) -> ExactMatrix:
    """Rows in g, a basis of the elements of h that act as 0 on g/h.

    Examples
    --------
    >>> import liehom as lh
    >>> isotropy_kernel(lh.pair("sl(3)/P1")).nrows
    2
    """
    data, square = pair.subalgebra.quotient(), pair.dimension**2
    subspace = as_exact(data.subspace)
    if square == 0 or not pair.subalgebra.dimension:
        return subspace
    flat = as_exact(pair.field.stack_rows([a.reshape(1, square) for a in pair.isotropy_matrices()], square))
    if int(flat.modulo().rank()) == flat.nrows:
        return subspace.select(rows=[])
    return flat.left_null_space() @ subspace


def largest_ideal(pair: Pair, kernel: ExactMatrix) -> Subalgebra:
    """The largest ideal of g inside h, from the kernel of the isotropy representation.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(4)/u(2)")
    >>> largest_ideal(pair, isotropy_kernel(pair)).dimension
    3
    """
    # each h_i is an ideal of h, so only brackets with a complement of h can leave it
    found, lift = kernel, pair.subalgebra.quotient().lift
    while found.nrows:
        inside = _staying(pair, found, lift)
        if inside.nrows == found.nrows:
            break
        found = inside
    return Subalgebra(pair.algebra, found, check=False)


def _staying(pair: Pair, space: ExactMatrix, lift: ExactMatrix) -> ExactMatrix:
    """Rows that span the x in a space with [x, v] in the space for all rows v of `lift`."""
    blocks = pair.algebra.table.contract(space, lift, echelon_quotient(space).projection)
    width = blocks[0].nrows * blocks[0].ncols
    if width == 0 or all(block.is_zero() for block in blocks):
        return space
    flat = as_exact(pair.field.stack_rows([block.reshape(1, width) for block in blocks], width))
    return flat.left_null_space() @ space


def effective_pair(pair: Pair, ideal: Subalgebra) -> Pair:
    """The pair (g/n, h/n) of an ideal n of g inside h; the given pair if n = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(4)/u(2)")
    >>> effective_pair(pair, largest_ideal(pair, isotropy_kernel(pair)))
    <pair of dimensions 3/1 over QQ>
    """
    if not ideal.dimension:
        return pair
    algebra = ideal.quotient_algebra()
    rows = (pair.subalgebra.basis @ ideal.quotient().projection).row_space()
    return Pair(algebra, Subalgebra(algebra, rows, check=False))  # the image of a subalgebra
