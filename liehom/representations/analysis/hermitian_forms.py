"""Invariant Hermitian forms of a representation with a complex or quaternionic structure.

For J in the commutant with J^2 = -1, a Hermitian form is h(u, v) = s(u, v) + i s(u, J v), linear in u and antilinear in
v with i u = J u.  Here s is symmetric and s(J u, v) = -s(u, J v).  Three anticommuting units I, J, K give h = s(u, v) +
i s(u, I v) + j s(u, J v) + k s(u, K v), with s symmetric for Hermitian and skew-symmetric for skew-Hermitian forms.  h
is invariant if and only if s is.  Units need only satisfy J^2 = -d, d > 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

from liehom.errors import InputError
from liehom.representations.analysis.commutant_type import complex_structure, imaginary_units
from liehom.representations.core.generating_matrices import exact_matrices
from liehom.representations.core.representation import Representation
from liehom.representations.invariants.irreducibility import combination
from liehom.scalars import ExactMatrix, Polynomial, Scalar
from liehom.scalars.fields.field import MatrixLike
from liehom.scalars.roots.extension import adjoin_root


@final
@dataclass(frozen=True, slots=True)
class HermitianForms:
    """The invariant Hermitian forms of a representation with a structure, by their real parts.

    Attributes
    ----------
    kind : {'complex', 'quaternionic'}
    units : tuple of (Matrix, scalar)
        One or three anticommuting matrices J of the commutant with J^2 = -d, and d > 0.
    hermitian : tuple of Matrix
        A basis of the real parts s (symmetric) of the Hermitian forms: a real vector space.
    skew_hermitian : tuple of Matrix
        A basis of the real parts (skew-symmetric) of the skew-Hermitian forms; in the complex case these are the i h.

    Examples
    --------
    >>> import liehom as lh
    >>> forms = lh.defining(lh.su(2, 1)).hermitian_forms()
    >>> forms.kind, len(forms.hermitian), sorted(forms.signature(forms.hermitian[0]))
    ('complex', 1, [0, 1, 2])
    """

    kind: Literal["complex", "quaternionic"]
    units: tuple[tuple[ExactMatrix, Scalar], ...]
    hermitian: tuple[ExactMatrix, ...]
    skew_hermitian: tuple[ExactMatrix, ...]

    def signature(self, form: ExactMatrix) -> tuple[int, int, int]:
        """Signature (positive, negative, zero) over C or H of a Hermitian form, given by its real part."""
        per = 2 if self.kind == "complex" else 4
        positive, negative, zero = form.signature()
        return positive // per, negative // per, zero // per

    def imaginary_part(self, form: ExactMatrix, unit: int = 0) -> ExactMatrix:
        """The matrix of the part s(u, J v) / sqrt(d) at the unit i (0), j (1) or k (2).

        The matrix is over the field of the representation, or over its extension by sqrt(d).

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.su(2)).hermitian_forms()
        >>> part = forms.imaginary_part(forms.hermitian[0])
        >>> part == -part.T
        True
        """
        structure, square = self.units[unit]
        value = form @ structure
        f = Polynomial(value.field, [-square, 0, 1]).factor()[0][0]
        up, root = adjoin_root(f, f.degree - 1)
        root = root if up.field.sign(root) > 0 else -root
        return up.matrix(value).scale(1 / root)


def hermitian_forms(rho: Representation, structure: MatrixLike | None = None) -> HermitianForms:
    """Implements `Representation.hermitian_forms`."""
    matrices, size, field = exact_matrices(rho), rho.size, rho.field
    if structure is not None:
        units = [_checked(rho, structure)]
    else:
        units = imaginary_units(matrices, size, field)
        if not units:
            complex_structure(matrices, size, field)  # says what is missing
    forms = rho.invariant_forms()
    hermitian = _adapted(forms.symmetric, units)
    skew = _adapted(forms.skew, units)
    return HermitianForms("complex" if len(units) == 1 else "quaternionic", tuple(units), hermitian, skew)


def _checked(rho: Representation, structure: MatrixLike) -> tuple[ExactMatrix, Scalar]:
    size, field = rho.size, rho.field
    j = field.read(structure, (size, size))
    for i, a in enumerate(rho.matrices):
        if j @ a != a @ j:
            raise InputError(f"the structure does not commute with the matrix of basis element {i}")
    square = j @ j
    value = square[0, 0] if size else -field.one
    if square != field.identity(size).scale(value) or field.sign(value) >= 0:
        raise InputError("the square of a complex structure is a negative number times the identity")
    return j, -value


def _adapted(forms: Sequence[ExactMatrix], units: Sequence[tuple[ExactMatrix, Scalar]]) -> tuple[ExactMatrix, ...]:
    """The combinations s of the forms with s(J u, v) = -s(u, J v) for all units."""
    if not forms:
        return ()
    field, size = forms[0].field, forms[0].nrows
    rows = []
    for s in forms:
        rows.append(field.stack_columns([(j.T @ s + s @ j).reshape(1, size * size) for j, _ in units], 1))
    weights = field.stack_rows(rows, size * size * len(units)).left_null_space()
    return tuple(combination(forms, weights.row(i)) for i in range(weights.nrows))
