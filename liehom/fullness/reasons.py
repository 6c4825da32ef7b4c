"""The sentence of a verdict FULL: the row of the pair in the classification, and why it is full.

The row follows from the key, see docs/theory/classification.md; no certificate depends on it.
"""

from __future__ import annotations

from liehom.errors import LimitError
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.classification import Classification
from liehom.fullness.classification.key import key_of
from liehom.fullness.classification.rows import row_of
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations import Pair


def full_reason(pair: Pair, certificate: Certificate) -> str:
    """Sentence that names the row of a full pair and says why the pair is full.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.pair("aff(1)/R"))
    >>> full_reason(verdict.pair, verdict.certificate)
    'affine space R^1 under R, where any eta outside h spans g/h'
    """
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
    if _all_preserve_the_form(action, certificate):
        scalars = " up to scalars" if any(a.trace() != 0 for a in action.matrices) else ""
        how = f"compact{scalars} and transitive on the sphere"
    return f"h acts on g/h = R^{d} as {isotropy}, {how}; checked at one point"


def _all_preserve_the_form(action: TracelessIsotropyAction, certificate: Certificate) -> bool:
    """True if L0 preserves the definite form of a certificate of kind 'full', so that L0 is compact."""
    n = action.pair.algebra.dimension
    lift = action.quotient.lift
    form = lift @ certificate.matrix("form", n, n) @ lift.T
    return all(a.T @ form + form @ a == form.scale(0) for a in action.traceless)
