"""Failure report for a pair that is not full: does (6.3) hold generically, and certified parts of the cone where not.

The forms, invariant subspaces and dominant elements that decide fullness give the parts of the cone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.homogeneous import FailureSet, RangeCondition, failure_cone, range_condition
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import invariant_forms
from liehom.representations.invariants.irreducibility import nilpotent_ideal_rows
from liehom.scalars import ExactMatrix


@final
@dataclass(frozen=True, slots=True)
class FailureReport:
    """Whether the range condition holds for generic psi, and certified subsets of the cone on which it fails.

    Attributes
    ----------
    generic : RangeCondition
        The range condition at a generic psi.
    parts : tuple of FailureSet
        Certified subsets of the cone; empty if the condition holds for no psi.
    """

    generic: RangeCondition
    parts: tuple[FailureSet, ...]

    def __str__(self) -> str:
        if self.generic.holds is False:
            return "the range condition (6.3) holds for no psi"
        if self.generic.holds is None:
            head = "it is not decided whether the range condition (6.3) holds for generic psi"
        else:
            head = "the range condition (6.3) holds for generic psi"
        if not self.parts:
            return f"{head}; it fails on a cone that contains eta"
        return f"{head}; it fails on a cone containing " + ", and ".join(part.description for part in self.parts)


def failure_report(pair: Pair, certificate: Certificate | None = None) -> FailureReport:
    """Failure report of an exact pair that is not full; `NotFull.where_it_fails` calls it.

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
    forms: list[ExactMatrix] = []
    subspaces: list[ExactMatrix] = []
    for form in invariant_forms(action.traceless, action.size, action.field).symmetric:
        positive, negative, zero = form.signature()
        if zero:
            subspaces.append(form.null_space())
        elif positive and negative:
            forms.append(form)
    rows = nilpotent_ideal_rows(action.traceless, action.size, action.field)
    if rows.nrows:
        subspaces.append(rows.null_space())
    second = certificate.fields.get("also", certificate) if certificate is not None else None
    parts = failure_cone(pair, forms=forms, subspaces=subspaces, certificate=second)
    if any(part.kind == "hypersurface" for part in parts):
        # the hypersurface contains the null cones
        parts = [part for part in parts if part.kind != "null cone"]
    return FailureReport(generic, tuple(parts))
