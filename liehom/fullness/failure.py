"""Failure report for a pair that is not full: does (6.3) hold generically, and certified parts of the cone where not.

The relative invariant of the pair gives the components of codimension 1.  Every proper invariant subspace of g/h is in
the cone, and in a maximal one.  Forms and dominant elements that decide fullness give further parts.  The report says
for which kinds of subsets it is complete, and which kinds were not searched.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

from liehom.display import Displayed
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.homogeneous import FailureSet, RangeCondition, failure_cone, range_condition
from liehom.homogeneous.range.failure_cone import has_hypersurfaces_computed
from liehom.representations import MaximalSubmodules, Pair
from liehom.representations.invariants.intertwiners import invariant_forms
from liehom.scalars import ExactMatrix, as_exact

UNKNOWN = "unknown: the report was written by liehom 0.1.0"


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

    def __setstate__(self, state: Sequence[Any]) -> None:
        # 0.1.0 did not write what it had searched
        for name, value in zip(self.__dataclass_fields__, (*state[:2], *(state[2:] or ((), (UNKNOWN,)))), strict=True):
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        if self.generic.holds is False:
            return "the range condition (6.3) holds for no psi"
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
    for form in invariant_forms(action.traceless, action.size, action.field).symmetric:
        positive, negative, zero = form.signature()
        if positive and negative and not zero:
            forms.append(form)
    maximal = pair.isotropy_representation().maximal_submodules()
    spaces = [space for space in (*maximal.isolated, *maximal.families) if space.dimension]
    subspaces = [as_exact(space.basis) for space in spaces if space.field == pair.field]
    second = certificate.fields.get("also", certificate) if certificate is not None else None
    parts = failure_cone(pair, forms=forms, subspaces=subspaces, certificate=second)
    for space in spaces:
        if space.field != pair.field:  # h preserves it by construction
            text = f"an invariant subspace of dimension {space.dimension} of g/h over {space.field.name}"
            parts.append(FailureSet("subspace", text, space.basis))
    if any(part.kind == "hypersurface" for part in parts):
        # the hypersurface contains the null cones
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
