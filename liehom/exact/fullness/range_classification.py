"""The range condition at generic eta: a certificate for every pair, and the theorem that says why.

A pair is generic if [h, eta] + R eta + h = g for eta outside a proper algebraic set. docs/theory/range.md has the
theorems and their proofs. The certificate alone decides. The theorems give the reason, the set of failures and the
number of open orbits, which are computed when they are first read.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import cached_property
from typing import Any, final

from liehom.base.errors import CertificateError, FieldError, InternalError, UndecidedError
from liehom.base.objects import Displayed
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify import verify_range
from liehom.exact.fullness.classification import Classification, effective_pair, isotropy_kernel, key_of, largest_ideal
from liehom.exact.fullness.classification_rows import rows
from liehom.exact.fullness.decide import decide_fullness, exact_field_of
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.orbits.cone import central_candidates, counted_open_orbits, invariant_degree
from liehom.exact.orbits.range import RankProof, largest_rank
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import invariant_forms
from liehom.exact.representations.invariants.irreducibility import combination, evaluated, trace_radical
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.polynomial import Polynomial


def classify_range(pair: Pair) -> RangeClassification:
    """Whether the range condition holds at generic eta, with a certificate, the reason and the open orbits.

    Parameters
    ----------
    pair : Pair
        Over QQ or a real number field.

    Raises
    ------
    UndecidedError
        If the pair is over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> print(classify_range(lh.pair("so(3,1)/so(2,1)")))
    generic: class C, a real form of S^3 = SO(4)/SO(3)
    >>> print(classify_range(lh.pair("sl(3)/B")))
    generic: parabolic
    >>> classify_range(lh.pair("sl(3)/so(3)"))
    <not generic: sl(3)/so(3)>
    """
    field = exact_field_of(pair)
    if pair.dimension == 0:
        zero = [field.zero] * pair.algebra.dimension
        return RangeClassification(pair, Certificate.over(field, "generic", eta=zero))
    try:
        best, proof = largest_rank(pair, enough=pair.dimension)
    except UndecidedError as error:
        return RangeClassification(pair, None, str(error))
    if proof is None:
        return RangeClassification(pair, Certificate.over(field, "generic", eta=best.psi))
    return RangeClassification(pair, _certificate(pair, proof))


def _certificate(pair: Pair, proof: RankProof) -> Certificate:
    """The proof in coordinates of g."""
    field, data = proof.directions.field, pair.subalgebra.quotient()
    fields: dict[str, Any] = {"point": (field.matrix([proof.point]) @ data.lift).row(0)}
    fields["directions"] = as_exact(proof.directions) @ as_exact(data.lift)
    if proof.stabilizer is None:
        return Certificate.over(field, "lattice", **fields)
    scalars = proof.stabilizer.select(columns=[0])
    elements = proof.stabilizer.select(columns=range(1, proof.stabilizer.ncols)) @ as_exact(data.subspace)
    fields["stabilizer"] = field.stack_columns([elements, scalars], elements.nrows) if elements.nrows else []
    return Certificate.over(field, "slice", **fields)


@final
@dataclass(frozen=True, repr=False)
class RangeClassification(Displayed):
    """Whether the range condition holds at generic eta, a result of `classify_range`.

    Attributes
    ----------
    pair : Pair
    certificate : Certificate or None
        Of kind 'generic', 'slice' or 'lattice'; None if the question is undecided.
    undecided : str
        Why there is no certificate, else empty.

    Examples
    --------
    >>> import liehom as lh
    >>> result = lh.classify_range(lh.pair("so(3,1)/so(2,1)"))
    >>> result.generic, result.fails_on, result.open_orbits, result.verify()
    (True, 'exactly B = 0, B of signature (2, 1)', 3, True)
    """

    pair: Pair
    certificate: Certificate | None
    undecided: str = ""

    @property
    def generic(self) -> bool | None:
        """Whether the range condition holds for eta outside a proper algebraic set; None if undecided."""
        return None if self.certificate is None else self.certificate.kind == "generic"

    def verify(self, pair: Pair | None = None) -> bool:
        """True if the independent checker verifies the certificate, by default for the own pair.

        Raises
        ------
        CertificateError
            If a check fails, or the question is undecided.
        """
        if self.certificate is None:
            raise CertificateError("kind", f"there is no certificate: {self.undecided}")
        return verify_range(self.pair if pair is None else pair, self.certificate) == self.generic

    @cached_property
    def reason(self) -> str:
        """The theorem of docs/theory/range.md that applies, or "by rank"; not certified."""
        d, certificate = self.pair.dimension, self.certificate
        if certificate is None:
            return self.undecided
        if d <= 1:
            return f"dim g/h = {d}"
        if is_parabolic(self.pair):
            return "parabolic"
        if self._action.dimension + 1 < d:
            return f"by rank: rho(h) + R has dimension {self._action.dimension + 1} < {d}"
        if (form := self._form) is not None:
            if self.generic and (space := self._space(form)):
                return space
            what = f"rho(h) is completely reducible and preserves a form of signature {_signs(form)} up to scalars"
            return f"{what}, and is {'' if self.generic else 'not '}a real form of a transitive group of a sphere"
        text = "prehomogeneous, by rank" if self.generic else "by rank"
        solvable = "; h is solvable and contains the nilradical of a Borel subalgebra"
        return text + solvable * has_nilradical(self.pair)

    @cached_property
    def _action(self) -> TracelessIsotropyAction:
        return TracelessIsotropyAction(self.pair)

    @cached_property
    def _form(self) -> ExactMatrix | None:
        """A non-degenerate form that L0 preserves, if L0 is completely reducible: the hypothesis of Theorem O."""
        action = self._action
        if action.size < 2 or not is_completely_reducible(action):
            return None
        forms, rng = invariant_forms(action.traceless, action.size, action.field).symmetric, random.Random(action.size)
        form = combination(forms, [rng.randint(1, 99) for _ in forms]) if forms else None
        return form if form is not None and form.rank() == action.size else None

    def _space(self, form: ExactMatrix) -> str | None:
        """The space of class C for a generic pair of reductive algebras, by Theorem G; None if g is not reductive."""
        ideal = largest_ideal(self.pair, isotropy_kernel(self.pair))
        effective = effective_pair(self.pair, ideal)
        if not effective.algebra.is_semisimple():
            return None
        if 0 in form.signature()[:2]:
            return f"class C: {Classification(key_of(self._action)[0], ideal.subspace).space}"
        h = effective.subalgebra.dimension
        for row in rows(self.pair.dimension):
            if row.key.letter == "C" and row.key.s + len(row.key.centre) == h:
                return f"class C, a real form of {row.space}"
        raise InternalError("a generic pair of reductive algebras is in no row of class C, please report it")

    @cached_property
    def fails_on(self) -> str:
        """The set of eta at which the range condition fails, modulo h: an equation, with what is known of it."""
        pair = self.pair
        if self.certificate is None or not self.generic:
            return "everywhere" if self.certificate is not None else "undecided"
        if pair.dimension <= 1:
            return "nowhere" + (" outside h" if pair.dimension else "")
        if (form := self._form) is not None:
            p, q = _signs(form)
            return f"exactly B = 0, B of signature ({p}, {q})" if p * q else "nowhere outside h"
        if decide_fullness(pair).full:
            return "nowhere outside h"
        try:
            degree = invariant_degree(pair)
        except (FieldError, UndecidedError):
            return "a proper algebraic set"
        if not degree:
            return "a set of codimension at least 2"
        known = "exactly" if self._action.dimension + 1 == pair.dimension else "contains"
        return f"{known} f = 0, f a relative invariant of degree {degree}"

    @cached_property
    def _orbits(self) -> tuple[int | None, str]:
        if self.certificate is None:
            return None, self.undecided
        try:
            return counted_open_orbits(self.pair, self.generic)
        except (FieldError, UndecidedError) as error:
            return None, str(error)

    @property
    def open_orbits(self) -> int | None:
        """The number of open orbits on g/h of the connected group of rho(h) + R; None if it is not known."""
        return self._orbits[0]

    @property
    def open_orbits_reason(self) -> str:
        """One sentence that proves the number of open orbits, or says why it is not known."""
        return self._orbits[1]

    def to_json(self) -> dict[str, Any]:
        """The attributes as a JSON object, with the certificate; `Certificate.from_json` reads the latter."""
        out: dict[str, Any] = {name: getattr(self, name) for name in ("generic", "reason", "fails_on", "open_orbits")}
        return out | {"certificate": self.certificate and self.certificate.to_json()}

    def __str__(self) -> str:
        return f"{ANSWERS[self.generic]}: {self.reason}"

    def __repr__(self) -> str:
        pair = self.pair
        title = pair.name or f"dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}"
        return f"<{ANSWERS[self.generic]}: {title}>"


ANSWERS = {True: "generic", False: "not generic", None: "undecided"}


def _signs(form: ExactMatrix) -> tuple[int, int]:
    """The signature (p, q) with p >= q, since a form is invariant with either sign."""
    p, q = sorted(form.signature()[:2], reverse=True)
    return p, q


def is_parabolic(pair: Pair) -> bool:
    """Whether g is semisimple and h contains a Borel subalgebra of the complexification.

    Let n be the orthogonal complement of h for the Killing form. h is parabolic if and only if n lies in h and [h, n]
    = n. For a parabolic h, n is its nilradical. Conversely n is an ideal of h, solvable by Cartan's criterion, and
    [h, n] = n lies in the nilpotent radical of h, so its elements are nilpotent in the adjoint representation of g.
    So n lies in the nilradical of a Borel subalgebra b, and h, its complement, contains b.
    """
    basis, form = as_exact(pair.subalgebra.basis), as_exact(pair.algebra.killing_form())
    if form.rank() < pair.algebra.dimension:
        return False
    n, data = (basis @ form).null_space(), pair.subalgebra.quotient()
    if not (n @ as_exact(data.projection)).is_zero():
        return False
    if not n.nrows:
        return True
    blocks = pair.algebra.table.contract(basis, n, pair.field.identity(pair.algebra.dimension))
    return bool(as_exact(pair.field.stack_rows(list(blocks), pair.algebra.dimension)).rank() == n.nrows)


def has_nilradical(pair: Pair) -> bool:
    """Whether g is semisimple, and h a solvable subalgebra that contains the nilradical n of a Borel subalgebra b.

    Then b is the normalizer of h, and h = n + t' for a subspace t' of a torus, as in Theorem P''.
    """
    if not pair.subalgebra.as_algebra().is_solvable() or not pair.algebra.is_semisimple():
        return False
    borel = pair.algebra.normalizer(pair.subalgebra)
    if not borel.as_algebra().is_solvable() or not is_parabolic(Pair(pair.algebra, borel)):
        return False
    n = (as_exact(borel.basis) @ as_exact(pair.algebra.killing_form())).null_space()
    return bool((n @ as_exact(pair.subalgebra.quotient().projection)).is_zero())


def is_completely_reducible(action: TracelessIsotropyAction) -> bool:
    """Whether L0 is shown to be completely reducible: its trace form is non-degenerate, and its center semisimple.

    The former makes L0 reductive. An element is semisimple if the squarefree part of its characteristic polynomial
    annihilates it.
    """
    basis, field, d = action.traceless, action.field, action.size
    if trace_radical(basis):
        return False
    for z in central_candidates(basis, d, field):
        value = field.identity(d)
        for factor, _ in Polynomial(field, z.characteristic_coefficients()).factor():
            value = value @ evaluated(factor, z)
        if not value.is_zero():
            return False
    return True
