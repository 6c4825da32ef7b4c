"""Verdicts of the decision: with a certificate, or numerical with a singular value and a gap."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, final

from liehom.errors import CertificateError, UndecidedError
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.checker.verify import verify_certificate
from liehom.fullness.failure import FailureReport, failure_report
from liehom.representations import Pair
from liehom.scalars import Field, Scalar


@final
@dataclass(frozen=True, slots=True, repr=False)
class Full:
    """The pair is full: rank [rho(h) x, x] = d for every x != 0 in g/h.

    Attributes
    ----------
    pair : Pair
    certificate : Certificate
        Of kind 'trivial' or 'full'.
    reason : str
        One sentence. Names of groups in it follow from dimensions; the certificate does not depend on them.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.pair("so(4)/so(3)"))
    >>> verdict, bool(verdict), verdict.verify()
    (<full: so(4)/so(3)>, True, True)
    """

    pair: Pair
    certificate: Certificate
    reason: str

    @property
    def full(self) -> Literal[True]:
        """Whether the pair is full: True."""
        return True

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
class NotFull:
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
class _Numerical:
    """Fields and methods of both numerical verdicts; each states its `full`."""

    pair: Pair
    reason: str
    smallest: float
    gap: float
    eta: list[float] = field(default_factory=list, hash=False)

    @property
    def full(self) -> bool:
        """Whether the pair is numerically full."""
        raise NotImplementedError

    @property
    def certificate(self) -> None:
        """None, since a numerical verdict is not proved."""
        return

    def verify(self) -> bool:
        """Raises `UndecidedError`, since there is no certificate to verify."""
        raise UndecidedError("a numerical verdict has no certificate; give exact numbers to have a proof")

    def __str__(self) -> str:
        answer = "full" if self.full else "not full"
        return f"{answer} (numerical, not proved): {self.reason}"

    def __bool__(self) -> bool:
        raise UndecidedError("a numerical verdict is not a proof and has no truth value; read its attribute `full`")

    def to_json(self) -> dict[str, Any]:
        """Verdict as a JSON object: `full`, `proved`, `reason`, the evidence and the certificate."""
        return {
            "full": self.full,
            "proved": False,
            "reason": self.reason,
            "smallest_singular_value": self.smallest,
            "gap": self.gap,
            "eta_numerical": self.eta,
            "certificate": None,
        }


@final
class NumericallyFull(_Numerical):
    """Numerically full: the smallest singular value of [rho(h) x, x] found on the sphere is above the tolerance.

    Attributes
    ----------
    smallest : float
        Smallest ratio sigma_d / sigma_1 that was found, over many initial points.
    gap : float
        `smallest` divided by the tolerance of the field.
    eta : list of float
        Element of g, in its basis, at which `smallest` was found.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]))
    >>> print(verdict)
    full (numerical, not proved): min sigma_d / sigma_1 >= 1 found in 62 starts, tolerance 3e-05
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
    """Numerically not full: the smallest singular value at some eta is below the tolerance.

    Attributes
    ----------
    smallest, gap, eta
        As in `NumericallyFull`, except that `gap` is the tolerance divided by `smallest`.

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

    def __repr__(self) -> str:
        return f"<numerically not full: {_title(self.pair)}, least singular value {self.smallest:.3g}>"


Verdict: TypeAlias = Full | NotFull | NumericallyFull | NumericallyNotFull
"""A result of `decide_fullness`."""


def _verified(pair: Pair, certificate: Certificate, full: bool) -> bool:
    if certificate.full != full:
        other = "full" if certificate.full else "not full"
        raise CertificateError("kind", f"a certificate of kind {certificate.kind!r} proves that a pair is {other}")
    return verify_certificate(pair, certificate)


def _title(pair: Pair) -> str:
    return pair.name or f"dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}"
