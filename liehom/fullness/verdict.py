"""Verdicts of the decision: with a certificate, or numerical with a singular value and a gap."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, cast, final

from liehom.display import Displayed
from liehom.errors import CertificateError, UndecidedError
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.checker.verify import verify_certificate
from liehom.fullness.failure import FailureReport, failure_report
from liehom.fullness.reasons import full_reason
from liehom.representations import Pair
from liehom.scalars import Field, Scalar


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
    """Numerically full: every pair within the error of the data is full.

    Attributes
    ----------
    smallest : float
        Smallest singular value sigma_d of the matrix with columns K_b x and x, the same at every unit vector x. The
        K_b are an orthonormal basis of the elements of the traceless rho(h) that preserve an inner product of g/h.
    gap : float
        `smallest` divided by `tolerance`, at least 100.
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
    """Numerically not full: the smallest singular value at some eta is zero up to rounding.

    Attributes
    ----------
    smallest : float
        Smallest singular value sigma_d, relative to the norm of the data, of the matrix with columns A_i x and x, where
        the A_i are the matrices of the isotropy.
    gap : float
        `tolerance` divided by `smallest`.
    tolerance : float
        Error of the data, relative to their norm. Other data within this error can be full.
    eta : list of float
        Element of g, in its basis, at which `smallest` was found.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.Pair(lh.abelian(2).over(lh.RR), []))
    >>> verdict.full, bool(verdict)
    Traceback (most recent call last):
    ...
    liehom.errors.UndecidedError: a numerical verdict is not a proof and has no truth value; ...
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
        As in `NumericallyFull` if a transitive group was found, so that `gap` is less than 100. Else `smallest` is the
        least singular value that was found, as in `NumericallyNotFull`, and `gap` is `smallest` divided by `tolerance`.

    Examples
    --------
    >>> import liehom as lh
    >>> nearly = lh.LieAlgebra({(0, 1): {2: 1.0}, (0, 2): {1: -1e-8}}, dimension=3)
    >>> verdict = lh.decide_fullness(lh.Pair(nearly, [[1, 0, 0]]))
    >>> verdict.full is None
    True
    >>> bool(verdict)
    Traceback (most recent call last):
    ...
    liehom.errors.UndecidedError: whether the pair is full is undecided: sigma_d = 0.707 at every eta, but its error ...
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
        other = "full" if certificate.full else "not full"
        raise CertificateError("kind", f"a certificate of kind {certificate.kind!r} proves that a pair is {other}")
    return verify_certificate(pair, certificate)


def _title(pair: Pair) -> str:
    return pair.name or f"dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}"
