"""Invariants of a subalgebra h of g under inner automorphisms of g; different values prove that two are not conjugate.

An inner automorphism maps every ideal of g to itself, acts trivially on the centre and on g/[g, g], and preserves the
Killing form of g and the forms tr rho(x) rho(y).  Where h has a characteristic line (h itself, its centre, a term of a
series), the characteristic polynomials on the line are invariants up to the scalings of the line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import final

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.representations import Representation
from liehom.representations.invariants.irreducibility import evaluated, trace_form
from liehom.scalars import ExactMatrix, Polynomial, as_exact

Value = tuple[object, ...]
# Coefficients of the combinations of the forms: any fixed numbers give invariants, unequal ones give more of them.
COMBINATIONS = ((1, 3, 7, 19, 31, 43, 61, 83), (2, -3, 5, -11, 13, -17, 23, -29))


@final
@dataclass(frozen=True)
class ConjugacyInvariants:
    """Computes invariants under inner automorphisms of subalgebras of the algebra of one representation.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2, 1))
    >>> of = ConjugacyInvariants(rho)
    >>> spacelike, timelike = (of(rho.isotropy(x)) for x in ([1, 0, 0], [0, 0, 1]))
    >>> [name for name in spacelike if spacelike[name] != timelike[name]][:1]
    ['Killing form of g']
    """

    rho: Representation

    def __call__(self, h: Subalgebra) -> dict[str, Value]:
        """Invariants of a subalgebra, by name; their order and the names depend on the representation only."""
        own = h.as_algebra()
        found = self._dimensions(h, own)
        forms = self._forms(h, own)
        for name, form in forms.items():
            found[name] = form.signature()
        found["forms together"] = _pencil(list(forms.values())) if h.dimension else ()
        found["invariant forms on fixed vectors"] = self._on_fixed_vectors(h)
        found["place modulo the derived algebra"] = self._modulo_derived(h)
        found["characteristic lines"] = tuple(self._line(h, line) for line in _lines(own))
        return found

    def _dimensions(self, h: Subalgebra, own: LieAlgebra) -> dict[str, Value]:
        g = self.rho.algebra
        matrices = [as_exact(self.rho(row)) for row in h.rows()]
        size = self.rho.size
        fixed = self.rho.field.stack_rows(matrices, size).rank() if matrices else 0
        moved = self.rho.field.stack_columns(matrices, size).rank() if matrices else 0
        return {
            "derived series": tuple(term.dimension for term in own.derived_series()),
            "central series": tuple(
                term.dimension for series in (own.lower_central_series(), own.upper_central_series()) for term in series
            ),
            "normalizer and centralizer": (g.normalizer(h).dimension, g.centralizer(h).dimension),
            "fixed and moved vectors": (size - fixed, moved),
            "ideals": tuple(h.subspace.intersection(ideal.subspace).dimension for ideal in self._ideals),
            "centre": tuple(tuple(r) for r in h.subspace.intersection(g.center().subspace).rows()),
        }

    def _forms(self, h: Subalgebra, own: LieAlgebra) -> dict[str, ExactMatrix]:
        if not h.dimension:
            return {}
        rows = as_exact(h.basis)
        forms = {"Killing form": as_exact(own.killing_form())}
        forms["Killing form of g"] = rows @ self._killing @ rows.T
        forms["trace form"] = trace_form([as_exact(self.rho(row)) for row in h.rows()])
        for i, form in enumerate(self._ideal_forms):
            forms[f"Killing form of ideal {i}"] = rows @ form @ rows.T
        return forms

    def _on_fixed_vectors(self, h: Subalgebra) -> Value:
        """Signatures of the invariant forms of V, which the group preserves, on the vectors that h annihilates."""
        size, field = self.rho.size, self.rho.field
        matrices = [as_exact(self.rho(row)) for row in h.rows()]
        fixed = as_exact(field.stack_rows(matrices, size).null_space() if matrices else field.identity(size))
        if not 0 < fixed.nrows < size:
            return ()
        symmetric, skew = self._invariant_forms
        signatures = tuple((fixed @ form @ fixed.T).signature() for form in symmetric)
        return (*signatures, *((fixed @ form @ fixed.T).rank() for form in skew))

    def _modulo_derived(self, h: Subalgebra) -> Value:
        """The canonical basis of the image of h in g/[g, g]."""
        _, projection = self.rho.algebra.derived_subalgebra().subspace.quotient_map()
        image = h.basis @ projection
        return tuple(tuple(row) for row in image.row_space().to_rows())

    def _line(self, h: Subalgebra, line: ExactMatrix) -> Value:
        x = line @ as_exact(h.basis)
        return _up_to_scale([as_exact(self.rho.algebra.ad(x)), as_exact(self.rho(x.row(0)))])

    @cached_property
    def _invariant_forms(self) -> tuple[tuple[ExactMatrix, ...], tuple[ExactMatrix, ...]]:
        forms = self.rho.invariant_forms()
        return forms.symmetric, forms.skew

    @cached_property
    def _killing(self) -> ExactMatrix:
        return as_exact(self.rho.algebra.killing_form())

    @cached_property
    def _ideals(self) -> list[Subalgebra]:
        """Ideals that all inner automorphisms preserve: terms of series, the radical, simple ideals over the field."""
        g = self.rho.algebra
        ideals = [g.radical(), *g.derived_series()[1:], *g.lower_central_series()[2:], *g.upper_central_series()]
        return ideals + self._simple

    @cached_property
    def _simple(self) -> list[Subalgebra]:
        g = self.rho.algebra
        return g.direct_sum_decomposition() if g.dimension and g.is_semisimple() else []

    @cached_property
    def _ideal_forms(self) -> list[ExactMatrix]:
        """The Killing forms of the simple ideals as forms on g, if there are several ideals."""
        if len(self._simple) < 2:
            return []
        n, field = self.rho.algebra.dimension, self.rho.field
        coordinates = field.stack_rows([as_exact(ideal.basis) for ideal in self._simple], n).inverse()
        found, start = [], 0
        for ideal in self._simple:
            places = range(start, start + ideal.dimension)
            part = coordinates.select(columns=places) @ as_exact(ideal.basis)  # x -> its component in the ideal
            found.append(part @ self._killing @ part.T)
            start += ideal.dimension
        return found


def _lines(own: LieAlgebra) -> Iterator[ExactMatrix]:
    """Characteristic lines of a Lie algebra, as rows of coordinates; the order depends on invariants only."""
    if own.dimension == 1:
        yield as_exact(own.whole().basis)
        return
    for term in [own.center(), *own.derived_series()[1:], *own.lower_central_series()[2:]]:
        if term.dimension == 1:
            yield as_exact(term.basis)


def _pencil(forms: Sequence[ExactMatrix]) -> Value:
    """Signatures of combinations B of forms B_i, and the characteristic polynomials of B^-1 B_i where B is regular."""
    found: list[object] = []
    for numbers in COMBINATIONS:
        coefficients = [numbers[i % len(numbers)] + i // len(numbers) for i in range(len(forms))]
        total = forms[0].scale(coefficients[0])
        for form, c in zip(forms[1:], coefficients[1:], strict=True):
            total = total + form.scale(c)
        signature = total.signature()
        found.append(signature)
        if not signature[2]:
            inverse = total.inverse()
            found += [tuple((inverse @ form).characteristic_coefficients()) for form in forms]
    return tuple(found)


def _up_to_scale(matrices: Sequence[ExactMatrix]) -> Value:
    """Invariants of matrices A_i up to conjugation and one common real factor: spectra, and the size of Jordan blocks.

    A factor c multiplies the coefficient v of weight k of a characteristic polynomial by c^k. With the first v_0 != 0,
    of weight k_0, the numbers v^(k_0) / v_0^k are invariant; so are the signs of v for even k, and the products of the
    signs of two v of odd weight.
    """
    field = matrices[0].field
    found: list[object] = []
    weighted = []
    for a in matrices:
        coefficients = a.characteristic_coefficients()[::-1]
        weighted += [(k, v) for k, v in enumerate(coefficients) if k]
        f = Polynomial(field, a.characteristic_coefficients())
        nilpotent = evaluated(f // f.gcd(f.derivative()), a)
        found.append((*_ranks(a), *_ranks(nilpotent)))
    first = next(((k, v) for k, v in weighted if v != 0), None)
    odd = next((field.sign(v) for k, v in weighted if v != 0 and k % 2), 1)
    for k, v in weighted if first else ():
        k0, v0 = first or (1, field.one)
        found.append((v**k0 / v0**k, field.sign(v) * (odd if k % 2 else 1)))
    return tuple(found)


def _ranks(a: ExactMatrix) -> list[int]:
    """The ranks of A, A^2, ..., until they stay equal."""
    found, power = [a.nrows, a.rank()], a
    while found[-1] != found[-2]:
        power = power @ a
        found.append(power.rank())
    return found
