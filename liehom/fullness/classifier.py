"""`classify`: the row of a full pair in the classification."""

from __future__ import annotations

from liehom.errors import InputError, NotFullError, UndecidedError, displayed
from liehom.fullness.classification import Classification
from liehom.fullness.classification.key import key_of
from liehom.fullness.decide import decide_fullness
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.fullness.verdict import Verdict
from liehom.representations import Pair
from liehom.scalars import ExactField


def classify(pair: Pair, verdict: Verdict | None = None) -> Classification:
    """The row of a full pair over QQ or a real number field in the classification of full pairs.

    Parameters
    ----------
    pair : Pair
    verdict : Full, optional
        The verdict of `decide_fullness` for this pair; by default the pair is decided first.

    Returns
    -------
    Classification
        The key, and the largest ideal of g inside h.

    Raises
    ------
    NotFullError
        If the pair is not full; it carries the verdict.
    UndecidedError
        If the pair is over float64.
    InputError
        If `pair` is not a Pair, or the verdict is about a different pair.
    InternalError
        If the key is in no row: such a pair would be a counterexample to the theorem.

    Notes
    -----
    docs/theory/classification.md has the theorem, and why the key determines the row. The key is computed by linear
    algebra over the field of the pair and one sign.

    Examples
    --------
    >>> import liehom as lh
    >>> print(classify(lh.pair("so(7)/g2")))
    spin(7)/g2: S^7 = Spin(7)/G2
    >>> print(classify(lh.pair("so(4)/u(2)")))
    so(3)/so(2): S^2 = SO(3)/SO(2), up to an ideal of dimension 3 inside h
    >>> classify(lh.pair("so(3,1)/so(2,1)"))
    Traceback (most recent call last):
    ...
    liehom.errors.NotFullError: only full pairs are classified, and this one is not full: the isotropy preserves ...
    """
    if not isinstance(pair, Pair):
        raise InputError(
            f"expected a Pair, got {displayed(pair)}; a name is read by liehom.pair, a file by liehom.load"
        )
    if not isinstance(pair.field, ExactField):
        raise UndecidedError(
            f"only exact pairs are classified, and this one is over {pair.field.name}: make it exact by "
            "liehom.rationalize(pair, max_denominator=...)"
        )
    verdict = decide_fullness(pair) if verdict is None else verdict
    if verdict.pair != pair:
        raise InputError("the verdict is about a different pair; leave it out to have this pair decided")
    if not verdict.full:
        raise NotFullError(verdict, f"only full pairs are classified, and this one is {verdict}")
    key, ideal = key_of(TracelessIsotropyAction(pair))
    found = Classification(key, ideal.subspace)
    found.row  # noqa: B018  # raises if the key is in no row
    return found
