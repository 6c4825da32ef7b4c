"""Where (6.3) fails for a pair that is not full: generically or on a cone, and certified parts of the cone.

The forms, subspaces and dominant elements that decide fullness are exactly what the cone is made of.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.homogeneous import FailureSet, RangeCondition, failure_cone, range_condition
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import invariant_forms
from liehom.representations.invariants.irreducibility import nilpotent_ideal_rows


@final
@dataclass(frozen=True, slots=True)
class FailureReport:
    """Whether the range condition holds generically, and certified subsets of where it fails.

    Attributes
    ----------
    generic : RangeCondition
    parts : tuple of FailureSet
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
    """Where the range condition fails, for an exact pair that is not full.

    Parameters
    ----------
    pair : Pair
    certificate : Certificate, optional
        Of the verdict; a dominance or commutant certificate (or the second one of a witness) adds its eigenspace.

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
    forms: list[Any] = []
    subspaces: list[Any] = []
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
        # the null cones lie in the hypersurface, which says more
        parts = [part for part in parts if part.kind != "null cone"]
    return FailureReport(generic, tuple(parts))
