"""The sentence of a verdict FULL: the row of the pair in the classification, and why it is full.

The row follows from the key, see docs/theory/classification.md; no certificate depends on it.
"""

from __future__ import annotations

from liehom.errors import LimitError
from liehom.fullness.classification import Classification
from liehom.fullness.classification.key import key_of
from liehom.fullness.classification.rows import row_of
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction


def full_reason(action: TracelessIsotropyAction, compact: bool) -> str:
    """Sentence that names the row of a full pair and says why the pair is full.

    Examples
    --------
    >>> import liehom as lh
    >>> full_reason(TracelessIsotropyAction(lh.pair("aff(1)/R")), compact=True)
    'affine space R^1 under R, where any eta outside h spans g/h'
    """
    try:
        key, ideal = key_of(action)
    except LimitError:  # the pair is proved full all the same
        return f"a pair whose row needs more than the limits, where {_why(action, 'a linear algebra', compact)}"
    row = row_of(key)
    if row is None:
        return f"a pair in no row of the classification, please report it; {_why(action, 'a linear algebra', compact)}"
    space = Classification(key, ideal.subspace).space
    inside = f", up to an ideal of dimension {ideal.dimension} inside h" if ideal.dimension else ""
    return f"{space}{inside}, where {_why(action, row.isotropy, compact)}"


def _why(action: TracelessIsotropyAction, isotropy: str, compact: bool) -> str:
    d = action.size
    if d <= 1:
        return ("h = g", "any eta outside h spans g/h")[d]
    how = "transitive on the rays already through the elements that preserve a definite form"
    if compact:
        scalars = " up to scalars" if any(a.trace() != 0 for a in action.matrices) else ""
        how = f"compact{scalars} and transitive on the sphere"
    return f"h acts on g/h = R^{d} as {isotropy}, {how}; checked at one point"
