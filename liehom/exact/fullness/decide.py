"""The decision whether a pair is full, with a certificate, and its row in the classification."""

from __future__ import annotations

import logging
import random
from collections.abc import Callable, Sequence
from typing import TypeAlias

from liehom.base.budget import in_time
from liehom.base.errors import InputError, InternalError, NotFullError, UndecidedError, displayed
from liehom.exact.fullness import certificate_writer
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.certificate_writer import eta_of_witness, numerical_eta, numerical_eta_of_commutant
from liehom.exact.fullness.classification import Classification, key_of
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.fullness.numerical import decide_numerically
from liehom.exact.fullness.search.dominance import (
    Dominant,
    balanced_frame,
    enumerate_dominant,
    find_dominant,
    plain_frame,
)
from liehom.exact.fullness.search.forms import decide_by_forms, full_by_positive_form
from liehom.exact.fullness.search.witnesses import certificate_of_reduction, eigenvector_witness, kernel_witness
from liehom.exact.fullness.verdict import Full, NotFull, Verdict
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import invariant_forms
from liehom.exact.representations.invariants.irreducibility import nilpotent_ideal_rows, split_by_commutant, traceless
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix

# The decision whether a pair (g, h) is full, with a certificate.
#
# The steps are those of docs/theory/fullness.md: trivial cases, the rank at sample points, invariant forms, nilpotent
# ideals, the commutant, construction of a definite form, spectral search for dominance. Every step only proposes a
# certificate; the certificate proves the verdict. The logger "liehom.exact.fullness" records at level DEBUG each step
# with its outcome.

Progress: TypeAlias = Callable[[str], object]
"""Called with a line of text as each step begins."""

LOG = logging.getLogger("liehom.exact.fullness")
"""Records the pair, each step with its outcome, and the verdict, at level DEBUG."""
FIRST_TRIES, ROUNDS = 40, 6
"""Random elements in the first round of the spectral search, and rounds; each round that fails doubles the elements."""


def decide_fullness(pair: Pair, *, seed: int = 0, progress: Progress | None = None) -> Verdict:
    """A proof that a pair is full or not full, or a numerical answer for a pair over float64.

    Parameters
    ----------
    pair : Pair
    seed : int, optional
        Seed of the random choices, which affect the certificate that is found and the time, never the verdict.
    progress : callable, optional
        Called with a line of text as each step begins, and after every 1000 elements of an enumeration. An error that
        it raises ends the decision.

    Returns
    -------
    Full or NotFull
        For every exact pair (over QQ or a real number field), with a certificate that `verify` checks.
    NumericallyFull, NumericallyNotFull or NumericallyUndecided
        For a pair over float64, with the singular value and the gap that the answer rests on; see
        `decide_numerically`.

    Notes
    -----
    The decision ends for every exact pair, with one of the two verdicts (docs/theory/fullness.md, "Termination").
    (g, h) is full if every eta outside h satisfies h + [h, eta] + R eta = g (Lewis and Olver 2001,
    Definition 6, (6.4)). The paper leaves open which pairs are full; the procedure decides it pair by pair.
    ``logging.getLogger("liehom.exact.fullness").setLevel(logging.DEBUG)`` shows the steps with their outcomes.

    Examples
    --------
    >>> import liehom as lh
    >>> print(decide_fullness(lh.pair("so(4)/so(3)")))
    full: S^3 = SO(4)/SO(3), where h acts on g/h = R^3 as so(3), compact and transitive on the sphere; checked at ...
    >>> decide_fullness(lh.pair("so(3,1)/so(2,1)")).full
    False
    """
    if not isinstance(pair, Pair):
        raise InputError(f"expected a Pair, got {displayed(pair)}; liehom.pair reads names, liehom.load files")
    LOG.debug("decide %r: dim g/h = %d", pair, pair.dimension)
    verdict = _verdict(pair, seed, progress)
    LOG.debug("verdict: %s", verdict)
    return verdict


def _verdict(pair: Pair, seed: int, progress: Progress | None) -> Verdict:
    if not isinstance(pair.field, ExactField):
        return decide_numerically(pair, seed=seed)
    action = TracelessIsotropyAction(pair)
    if pair.dimension <= 1:
        return Full(pair, certificate_writer.trivial(pair.field))
    return _decide(action, seed, progress)


def _begin(step: str, progress: Progress | None) -> None:
    in_time()
    LOG.debug("step: %s", step)
    if progress is not None:
        progress(step)


def _decide(action: TracelessIsotropyAction, seed: int, progress: Progress | None) -> Verdict:
    _begin("rank at sample points", progress)
    rng = random.Random(seed)
    x, certificate = _sample(action, rng)
    if certificate is not None:
        LOG.debug("the rank is below %d at a sample point: not full", action.size)
        return _not_full(action, certificate, _few_directions(action))
    _begin("invariant forms", progress)
    forms = invariant_forms(action.traceless, action.size, action.field)
    LOG.debug("%d symmetric and %d skew-symmetric invariant forms", len(forms.symmetric), len(forms.skew))
    if forms.symmetric:
        return _by_forms(action, forms.symmetric, x)
    _begin("nilpotent ideals", progress)
    rows = nilpotent_ideal_rows(action.traceless, action.size, action.field)
    if rows.nrows:
        LOG.debug("the nilpotent ideal is not 0, so the pair is not full")
        reason = "a nilpotent ideal of the isotropy algebra annihilates an invariant subspace"
        return _not_full(action, kernel_witness(action, rows), reason)
    _begin("commutant", progress)
    imaginary = traceless(action.commutant(), action.size, action.field)
    split = split_by_commutant(imaginary, action.size, action.field)
    LOG.debug(
        "commutant of dimension %d, %s", len(action.commutant()), "a division algebra" if split is None else "reducible"
    )
    if split is not None:
        return _reducible(action, certificate_of_reduction(action, split))
    _begin("definite form", progress)
    certificate = full_by_positive_form(action, imaginary)
    LOG.debug("definite form: %s", "not found" if certificate is None else "found, so the pair is full")
    if certificate is not None:
        return Full(action.pair, certificate)
    return _by_dominance(action, seed, progress)


def _few_directions(action: TracelessIsotropyAction) -> str:
    size = action.dimension + 1
    if size < action.size:
        return f"rho(h) + R has dimension {size}, fewer than the {action.size} directions of g/h, at every eta"
    return "h moves a sample point in too few directions"


def _sample(action: TracelessIsotropyAction, rng: random.Random) -> tuple[ExactMatrix, Certificate | None]:
    """A point of rank d and None, or a point of lower rank and its witness; random points first, then the axes."""
    first: ExactMatrix = action.random_point(rng)
    points = [first, *(action.random_point(rng) for _ in range(2))]
    points += [action.field.unit(action.size, i).T for i in range(action.size)]
    for x in points:
        if action.rank_at(x) < action.size:
            phi = action.action_rows(x).null_space().select(rows=[0])
            return x, certificate_writer.rational_witness(action, x, phi)
    return first, None


def _by_forms(action: TracelessIsotropyAction, symmetric: Sequence[ExactMatrix], x: ExactMatrix) -> Verdict:
    certificate = decide_by_forms(action, symmetric, x)
    if certificate.full:
        return Full(action.pair, certificate)
    kind = f"{len(symmetric)} independent symmetric forms"
    if len(symmetric) == 1:
        kind = "a symmetric form with {} positive, {} negative and {} zero squares".format(*symmetric[0].signature())
    reason = f"the isotropy preserves {kind} up to scale, and the rank drops on a null vector"
    return _not_full(action, certificate, reason)


def _reducible(action: TracelessIsotropyAction, certificate: Certificate) -> NotFull:
    reason = "the isotropy representation is reducible over the reals: its commutant is not a division algebra"
    if certificate.kind == "commutant":
        eta = numerical_eta_of_commutant(action, certificate)
        return NotFull(action.pair, certificate, reason, eta_numerical=eta)
    return _not_full(action, certificate, reason)


def _by_dominance(action: TracelessIsotropyAction, seed: int, progress: Progress | None) -> NotFull:
    """Random rounds first, which nearly always end at once; then the enumeration, which always ends."""
    tries, frame = FIRST_TRIES, plain_frame(action)
    for round_number in range(ROUNDS):
        if frame is not None:
            _begin(f"spectral search, {tries} random elements", progress)
            dominant = find_dominant(action, frame, tries, seed + round_number)
            LOG.debug("dominant element: %s", "none found" if dominant is None else "found, so the pair is not full")
            if dominant is not None:
                return _with_exact_eta(action, dominant)
            tries *= 2
        if round_number == 0:
            _begin("coordinates in which floats see the spectrum", progress)
            frame = balanced_frame(action) or frame
    dominant = enumerate_dominant(action, frame, lambda step: _begin(step, progress))
    LOG.debug("dominant element: found, so the pair is not full")
    return _with_exact_eta(action, dominant)


def _with_exact_eta(action: TracelessIsotropyAction, dominant: Dominant) -> NotFull:
    reason = "the top eigenspace of an element of h moves in too few directions (weight count below d)"
    witness = eigenvector_witness(action, [dominant.element])
    if witness is None:
        eta = numerical_eta(action, dominant.top)
        return NotFull(action.pair, dominant.certificate, reason, eta_numerical=eta)
    both = Certificate(witness.kind, {**witness.fields, "also": dominant.certificate}, witness.field)
    return _not_full(action, both, reason)


def _not_full(action: TracelessIsotropyAction, certificate: Certificate, reason: str) -> NotFull:
    eta, field, rank = eta_of_witness(action, certificate)
    if rank == action.size:
        raise InternalError("the rank does not drop at the eta that was found; please report this pair")
    if rank is not None:
        reason = f"{reason}; the rank of [rho(h) eta, eta] is {rank} of {action.size}"
    return NotFull(action.pair, certificate, reason, eta=eta, eta_field=field, rank=rank)


# `classify`: the row of a full pair in the classification.


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
    liehom.base.errors.NotFullError: only full pairs are classified, and this one is not full: the isotropy ...
    """
    exact_field_of(pair)
    verdict = decide_fullness(pair) if verdict is None else verdict
    if verdict.pair != pair:
        raise InputError("the verdict is about a different pair; leave it out to have this pair decided")
    if not verdict.full:
        raise NotFullError(verdict, f"only full pairs are classified, and this one is {verdict}")
    key, ideal = key_of(TracelessIsotropyAction(pair))
    classification = Classification(key, ideal.subspace)
    classification.row  # noqa: B018  # raises if the key is in no row
    return classification


def exact_field_of(pair: object) -> ExactField:
    """The field of a pair, which can be classified if it is exact; raises an error for anything else."""
    if not isinstance(pair, Pair):
        raise InputError(f"expected a Pair, got {displayed(pair)}; liehom.pair reads names, liehom.load files")
    if not isinstance(pair.field, ExactField):
        raise UndecidedError(
            f"only exact pairs are classified, and this one is over {pair.field.name}: make it exact by "
            "liehom.rationalize(pair, max_denominator=...)"
        )
    return pair.field
