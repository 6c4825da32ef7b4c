"""Symmetric forms over an exact field: orthogonal bases."""

from __future__ import annotations

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.field import Scalar


def orthogonal_basis(form: ExactMatrix) -> tuple[list[ExactMatrix], list[Scalar]]:
    """An orthogonal basis: rows u_i with form(u_i, u_j) = 0, and the values form(u_i, u_i), by exact Gram-Schmidt.

    Parameters
    ----------
    form : ExactMatrix
        Symmetric, (d, d).

    Returns
    -------
    rows : list of ExactMatrix (1, d), a basis
    values : list of field elements; a value is zero if and only if its row is in the radical of the form

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> orthogonal_basis(QQ.matrix([[0, 1], [1, 0]]))[1]
    [2, -1/2]
    """
    field, d = form.field, form.nrows
    rest = [field.unit(d, i) for i in range(d)]
    rows: list[ExactMatrix] = []
    values: list[Scalar] = []
    while rest:
        images = [r @ form for r in rest]
        norms = [(m @ r.T)[0, 0] for m, r in zip(images, rest, strict=True)]
        place = next((i for i, v in enumerate(norms) if v != 0), None)
        if place is None:
            pair = _hyperbolic(rest, images)
            if pair is None:
                return rows + rest, values + [field.zero] * len(rest)
            i, j = pair
            rest[i] = rest[i] + rest[j]
            continue
        chosen, image, norm = rest.pop(place), images.pop(place), norms[place]
        rows.append(chosen)
        values.append(norm)
        rest = [r - chosen.scale((image @ r.T)[0, 0] / norm) for r in rest]
    return rows, values


def _hyperbolic(rest: list[ExactMatrix], images: list[ExactMatrix]) -> tuple[int, int] | None:
    for i in range(len(rest)):
        for j in range(i):
            if (images[i] @ rest[j].T)[0, 0] != 0:
                return i, j
    return None
