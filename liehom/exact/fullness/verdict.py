"""Verdicts of the decision, their sentences, and the report of a failure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, cast, final

from liehom.base.errors import CertificateError, LimitError, UndecidedError
from liehom.base.objects import Displayed
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.fullness.classification import Classification, key_of
from liehom.exact.fullness.classification_rows import row_of
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.orbits.cone import FailureSet, failure_cone, has_hypersurfaces_computed
from liehom.exact.orbits.range import RangeCondition, range_condition
from liehom.exact.representations.analysis.submodules import MaximalSubmodules
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import invariant_forms
from liehom.exact.scalars.exact_field import as_exact
from liehom.exact.scalars.field import Field, Scalar

# The relative invariant of the pair gives the components of codimension 1 of the set where (6.3) fails. Every proper
# invariant subspace of g/h is in the cone, and in a maximal one. Forms and dominant elements that decide fullness give
# further parts. The report says for which kinds of subsets it is complete, and which kinds were not searched. The cone
# of a full pair is 0 in g/h, that is h.

ALL = "all subsets (the pair is full)"


@final
@dataclass(frozen=True, slots=True, repr=False)
class FailureReport(Displayed):
    """Whether the range condition holds for generic psi, and certified subsets of the cone on which it fails.

    Attributes
    ----------
    generic : RangeCondition
        The range condition at a generic psi.
    parts : tuple of FailureSet
        Certified subsets of the cone; empty if the condition holds for no psi.
    searched : tuple of str
        Kinds of subsets of the cone of which `parts` are a complete list, proved.
    not_searched : tuple of str
        Kinds of subsets of which the cone may contain some that `parts` do not list.
    """

    generic: RangeCondition
    parts: tuple[FailureSet, ...]
    searched: tuple[str, ...] = ()
    not_searched: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        if self.generic.holds is False:
            return "the range condition (6.3) holds for no psi"
        if ALL in self.searched:
            return "the range condition (6.3) holds for every psi" + (" outside h; it fails on h" if self.parts else "")
        if self.generic.holds is None:
            head = "it is not decided whether the range condition (6.3) holds for generic psi"
        else:
            head = "the range condition (6.3) holds for generic psi"
        where = ", and ".join(part.description for part in self.parts)
        text = f"{head}; it fails on a cone " + (f"containing {where}" if where else "that contains eta")
        if self.searched:
            text += f". Complete for: {', '.join(self.searched)}"
        if self.not_searched:
            text += f". Not searched: {', '.join(self.not_searched)}"
        return text


def failure_report(pair: Pair, certificate: Certificate | None = None) -> FailureReport:
    """Failure report of an exact pair, made for pairs that are not full; `NotFull.where_it_fails` calls it.

    Parameters
    ----------
    pair : Pair
    certificate : Certificate, optional
        Certificate of the verdict. A dominance or commutant certificate, also as the second certificate of a witness,
        adds its eigenspace to the report.

    Examples
    --------
    >>> import liehom as lh
    >>> print(failure_report(lh.pair("so(3,1)/so(2,1)")).generic.holds)
    True
    """
    generic = range_condition(pair)
    if generic.holds is False:
        return FailureReport(generic, ())
    action = TracelessIsotropyAction(pair)
    symmetric = invariant_forms(action.traceless, action.size, action.field).symmetric
    forms = [form for form in symmetric if min((signs := form.signature())[:2]) and not signs[2]]
    maximal = pair.isotropy_representation().maximal_submodules()
    spaces = [space for space in (*maximal.isolated, *maximal.families) if space.dimension]
    subspaces = [as_exact(space.basis) for space in spaces if space.field == pair.field]
    second = certificate.fields.get("also", certificate) if certificate is not None else None
    parts = failure_cone(pair, forms=forms, subspaces=subspaces, certificate=second)
    further = [space for space in spaces if space.field != pair.field]  # h preserves them by construction
    text = "an invariant subspace of dimension {0.dimension} of g/h over {0.field.name}"
    parts += [FailureSet("subspace", text.format(space), space.basis) for space in further]
    if any(part.covers for part in parts):
        # the zeros of the relative invariant contain the null cones
        parts = [part for part in parts if part.kind != "null cone"]
    return FailureReport(generic, tuple(parts), *_claims(pair, generic, maximal))


def _claims(pair: Pair, generic: RangeCondition, maximal: MaximalSubmodules) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The kinds of subsets that were searched completely, and those that were not."""
    done, left = [], []
    if generic.holds and has_hypersurfaces_computed(pair):
        done.append("components of codimension 1 (by a greatest common divisor)")
    else:
        left.append("components of codimension 1 (they are computed over QQ, for g/h of dimension at most 8)")
    if not maximal.is_finite:
        left.append("maximal invariant subspaces of g/h (infinitely many, each contains a listed one)")
    elif any(space.dimension for space in maximal.isolated):
        done.append("invariant subspaces of g/h (the maximal ones)")
    else:
        done.append("invariant subspaces of g/h (there are none)")
    if pair.dimension > 2:
        left.append("other components of codimension at least 2")
    return tuple(done), tuple(left)


# The sentence of a verdict FULL names the row of the pair in the classification. The row follows from the key, see
# docs/theory/classification.md; no certificate depends on it.


def full_reason(pair: Pair, certificate: Certificate) -> str:
    """Sentence that names the row of a full pair and says why the pair is full."""
    action = TracelessIsotropyAction(pair)
    try:
        key, ideal = key_of(action)
    except LimitError:  # the pair is proved full all the same
        return f"a pair whose row needs more than the limits, where {_why(action, 'a linear algebra', certificate)}"
    row = row_of(key)
    if row is None:
        why = _why(action, "a linear algebra", certificate)
        return f"a pair in no row of the classification, please report it; {why}"
    space = Classification(key, ideal.subspace).space
    inside = f", up to an ideal of dimension {ideal.dimension} inside h" if ideal.dimension else ""
    return f"{space}{inside}, where {_why(action, row.isotropy, certificate)}"


def _why(action: TracelessIsotropyAction, isotropy: str, certificate: Certificate) -> str:
    d = action.size
    if d <= 1:
        return ("h = g", "any eta outside h spans g/h")[d]
    how = "transitive on the rays already through the elements that preserve a definite form"
    if _keeps(action, certificate):
        scalars = " up to scalars" if any(a.trace() != 0 for a in action.matrices) else ""
        how = f"compact{scalars} and transitive on the sphere"
    return f"h acts on g/h = R^{d} as {isotropy}, {how}; checked at one point"


def preserves_its_form(verdict: Full) -> bool:
    """True if L0 of a full pair is compact: it preserves the definite form of the certificate."""
    if verdict.certificate.kind != "full":
        return False
    return _keeps(TracelessIsotropyAction(verdict.pair), verdict.certificate)


def _keeps(action: TracelessIsotropyAction, certificate: Certificate) -> bool:
    """True if L0 preserves the definite form of a certificate of kind 'full', so that L0 is compact."""
    n = action.pair.algebra.dimension
    lift = action.quotient.lift
    form = lift @ certificate.matrix("form", n, n) @ lift.T
    return all(a.T @ form + form @ a == form.scale(0) for a in action.traceless)


@final
@dataclass(frozen=True, slots=True, repr=False)
class Full(Displayed):
    """The pair is full: rank [rho(h) x, x] = d for every x != 0 in g/h.

    Attributes
    ----------
    pair : Pair
    certificate : Certificate
        Of kind 'trivial' or 'full'.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.pair("so(4)/so(3)"))
    >>> verdict, bool(verdict), verdict.verify()
    (<full: so(4)/so(3)>, True, True)
    """

    pair: Pair
    certificate: Certificate
    _reason: str | None = field(default=None, compare=False)

    @property
    def full(self) -> Literal[True]:
        """Whether the pair is full: True."""
        return True

    @property
    def reason(self) -> str:
        """One sentence, with the row of the classification: computed when it is first read, cached, not certified."""
        if self._reason is None:
            object.__setattr__(self, "_reason", full_reason(self.pair, self.certificate))
        return cast("str", self._reason)

    def verify(self) -> bool:
        """True if the independent checker verifies the certificate; otherwise raises `CertificateError`."""
        return _verified(self.pair, self.certificate, self.full)

    def where_it_fails(self) -> FailureReport:
        """Failure report: (6.3) holds for every psi outside h, and fails on h if h is not g.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.decide_fullness(lh.pair("so(4)/so(3)")).where_it_fails())
        the range condition (6.3) holds for every psi outside h; it fails on h
        """
        zero = self.pair.field.zeros(0, self.pair.dimension)
        parts = (FailureSet("subspace", "h", zero, covers=True),) if self.pair.dimension else ()
        return FailureReport(range_condition(self.pair), parts, (ALL,))

    def to_json(self) -> dict[str, Any]:
        """Verdict as a JSON object: `full`, `proved`, `reason`, the evidence and the certificate."""
        return {"full": True, "proved": True, "reason": self.reason, "certificate": self.certificate.to_json()}

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return f"<full: {_title(self.pair)}>"

    def __str__(self) -> str:
        return f"full: {self.reason}"


@final
@dataclass(frozen=True, slots=True, repr=False)
class NotFull(Displayed):
    """The pair is not full: some eta outside h has rank [h, [h, eta], eta] < dim g.

    Attributes
    ----------
    pair : Pair
    certificate : Certificate
        Of kind 'witness', 'commutant' or 'dominance'.
    reason : str
        One sentence.
    eta : list or None
        An exact eta at which the rank drops, coefficients in the basis of g over `eta_field`.
    eta_field : Field or None
        The input field, or the number field that eta needs.
    rank : int or None
        The exact rank of [rho(h) eta, eta] in g/h.
    eta_numerical : list of float or None
        An eta rounded to floats, if no exact eta was found. The proof is the certificate, not this vector.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.pair("so(3,1)/so(2,1)"))
    >>> verdict.full, verdict.rank, verdict.rank_defect, verdict.verify()
    (False, 2, 1, True)
    """

    pair: Pair
    certificate: Certificate
    reason: str
    eta: list[Scalar] | None = field(default=None, hash=False)
    eta_field: Field | None = None
    rank: int | None = None
    eta_numerical: list[float] | None = field(default=None, hash=False)

    @property
    def full(self) -> Literal[False]:
        """Whether the pair is full: False."""
        return False

    @property
    def rank_defect(self) -> int | None:
        """dim g/h minus the rank at eta, an int; None if eta is numerical only."""
        return None if self.rank is None else self.pair.dimension - self.rank

    def where_it_fails(self) -> FailureReport:
        """Failure report: whether (6.3) holds for generic psi, and certified subsets of the cone on which it fails.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")).where_it_fails())
        the range condition (6.3) holds for generic psi; it fails on a cone containing ...
        """
        return failure_report(self.pair, self.certificate)

    def verify(self) -> bool:
        """True if the independent checker verifies the certificate; otherwise raises `CertificateError`."""
        return _verified(self.pair, self.certificate, self.full)

    def to_json(self) -> dict[str, Any]:
        """Verdict as a JSON object: `full`, `proved`, `reason`, the evidence and the certificate."""
        out: dict[str, Any] = {"full": False, "proved": True, "reason": self.reason}
        if self.eta is not None and self.eta_field is not None:
            out["eta"] = [self.eta_field.format(v) for v in self.eta]
            out["eta_field"] = self.eta_field.name
            out["rank"], out["rank_defect"] = self.rank, self.rank_defect
        if self.eta_numerical is not None:
            out["eta_numerical"] = self.eta_numerical
        out["certificate"] = self.certificate.to_json()
        return out

    def __bool__(self) -> bool:
        return False

    def __repr__(self) -> str:
        return f"<not full: {_title(self.pair)}>"

    def __str__(self) -> str:
        return f"not full: {self.reason}"


@dataclass(frozen=True, slots=True, repr=False)
class _Numerical(Displayed):
    """Fields and methods of the numerical verdicts; each states its `full` and its `tolerance`."""

    pair: Pair
    reason: str
    smallest: float
    gap: float
    eta: list[float] = field(default_factory=list, hash=False)

    @property
    def full(self) -> bool | None:
        """Whether the pair is numerically full; None if that is undecided."""
        raise NotImplementedError

    @property
    def tolerance(self) -> float:
        """Error of sigma_d, a float: `gap` compares `smallest` with it."""
        return self.smallest / self.gap

    @property
    def certificate(self) -> None:
        """None, since a numerical verdict is not proved."""
        return

    def verify(self) -> bool:
        """Raises `UndecidedError`, since there is no certificate to verify."""
        raise UndecidedError("a numerical verdict has no certificate; give exact numbers to have a proof")

    def __str__(self) -> str:
        return f"{ANSWERS[self.full]} (numerical, not proved): {self.reason}"

    def __bool__(self) -> bool:
        if self.full is None:
            raise UndecidedError(
                f"whether the pair is full is undecided: {self.reason}; exact data are always decided, see "
                "liehom.rationalize"
            )
        raise UndecidedError("a numerical verdict is not a proof and has no truth value; read its attribute `full`")

    def to_json(self) -> dict[str, Any]:
        """Verdict as a JSON object: `full`, `proved`, `reason`, the evidence and the certificate."""
        return {
            "full": self.full,
            "proved": False,
            "reason": self.reason,
            "smallest_singular_value": self.smallest,
            "tolerance": self.tolerance,
            "gap": self.gap,
            "eta_numerical": self.eta,
            "certificate": None,
        }


ANSWERS: dict[bool | None, str] = {True: "full", False: "not full", None: "undecided"}
"""Words for the attribute `full` of a verdict."""


@final
class NumericallyFull(_Numerical):
    """Numerically full: every pair within the error of the data is full, if errors are propagated to first order.

    Attributes
    ----------
    smallest : float
        Lower bound of the smallest singular value sigma_d of the matrix with columns K_b x and x at every unit vector
        x. The K_b are an orthonormal basis of the elements of the traceless rho(h) that preserve an inner product.
    gap : float
        `smallest` divided by `tolerance`, at least 1.5.
    tolerance : float
        Error of `smallest`, propagated from the error of the data.
    eta : list of float
        Element of g, in its basis, at which `smallest` was computed.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]))
    >>> print(verdict)
    full (numerical, not proved): sigma_d = 0.707 at every eta, ... times its error ..., since a compact group ...
    """

    __slots__ = ()

    @property
    def full(self) -> Literal[True]:
        """Whether the pair is numerically full: True."""
        return True

    def __repr__(self) -> str:
        return f"<numerically full: {_title(self.pair)}, least singular value {self.smallest:.3g}>"


@final
class NumericallyNotFull(_Numerical):
    """Numerically not full: for all data within their error, or sigma_d at some eta is zero up to rounding.

    Attributes
    ----------
    smallest : float
        Smallest singular value sigma_d, relative to the norm of the data, of the matrix with columns A_i x and x, where
        the A_i are the matrices of the isotropy.
    gap : float
        `tolerance` divided by `smallest`.
    tolerance : float
        Error of the data, relative to their norm. `reason` says whether other data within this error can be full.
    eta : list of float
        Element of g, in its basis, at which `smallest` was found.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.Pair(lh.abelian(2).over(lh.RR), []))
    >>> verdict.full, bool(verdict)
    Traceback (most recent call last):
    ...
    liehom.base.errors.UndecidedError: a numerical verdict is not a proof and has no truth value; ...
    """

    __slots__ = ()

    @property
    def full(self) -> Literal[False]:
        """Whether the pair is numerically full: False."""
        return False

    @property
    def tolerance(self) -> float:
        """Error of the data relative to their norm, a float."""
        return self.gap * max(self.smallest, 1e-300)

    def __repr__(self) -> str:
        return f"<numerically not full: {_title(self.pair)}, least singular value {self.smallest:.3g}>"


@final
class NumericallyUndecided(_Numerical):
    """Numerically undecided: the data are too inexact, or nothing was found that shows 'full' or 'not full'.

    Attributes
    ----------
    smallest, gap, tolerance, eta
        As in `NumericallyFull` if a transitive group was found, so that `gap` is less than 1.5. Else `smallest` is the
        least singular value that was found, as in `NumericallyNotFull`, and `gap` is `smallest` divided by `tolerance`.

    Examples
    --------
    >>> import liehom as lh
    >>> nearly = lh.LieAlgebra({(0, 1): {2: 1.0}, (0, 2): {1: -1e-9}}, dimension=3)
    >>> verdict = lh.decide_fullness(lh.Pair(nearly, [[1, 0, 0]]))
    >>> verdict.full is None
    True
    >>> bool(verdict)
    Traceback (most recent call last):
    ...
    liehom.base.errors.UndecidedError: whether the pair is full is undecided: sigma_d = 0.707 at every eta, but ...
    """

    __slots__ = ()

    @property
    def full(self) -> None:
        """Whether the pair is numerically full: None, since that is undecided."""
        return

    def __repr__(self) -> str:
        return f"<numerically undecided: {_title(self.pair)}, least singular value {self.smallest:.3g}>"


Verdict: TypeAlias = Full | NotFull | NumericallyFull | NumericallyNotFull | NumericallyUndecided
"""A result of `decide_fullness`."""


def _verified(pair: Pair, certificate: Certificate, full: bool) -> bool:
    if certificate.full != full:
        other = ANSWERS[certificate.full]
        raise CertificateError("kind", f"a certificate of kind {certificate.kind!r} proves that a pair is {other}")
    return verify_certificate(pair, certificate)


def _title(pair: Pair) -> str:
    return pair.name or f"dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}"
