"""Enumeration of all integer elements of L0, which finds a dominance certificate of every pair that has one.

The random search in floats ends with probability 1; this search always ends. Let L0 be irreducible and not compact and
the pair not full. The elements that dominate form a nonempty open cone in L0 (docs/theory/fullness.md, Theorem 4), so
some rational ray lies in it. The enumeration reaches every rational ray, at each of its integer points; the precision
and the number of cuts grow with the point, so that they suffice at some point of the ray.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from math import comb

from liehom.budget import in_time
from liehom.fullness.search.dominance import Dominant, top_vector
from liehom.fullness.search.exact_dominance import BITS, TRIES, ExactDominance
from liehom.fullness.search.frame import Frame
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction

REPORTED = 1000
"""Elements between two lines of progress."""


def enumerate_dominant(
    action: TracelessIsotropyAction, frame: Frame | None, report: Callable[[str], object]
) -> Dominant:
    """The first element with a dominance certificate among the integer combinations of a basis of L0, by height.

    The height of a combination is the sum of the absolute values of its coefficients.

    Parameters
    ----------
    action : TracelessIsotropyAction
        L0 irreducible over the reals, not compact, and the pair not full; otherwise the search does not end.
    frame : Frame or None
        Its basis of L0 is used, since in a basis with small entries small combinations dominate; else the given one.
    report : callable
        Called with a line of text for each height, and after every 1000 elements.
    """
    exact, size = ExactDominance(action), action.dimension
    members = action.field.identity(size)
    if frame is not None and frame.members.rank() == size:
        members = frame.members
    height = 0
    while True:
        height += 1
        total = number_of_vectors(size, height)
        for number, vector in enumerate(integer_vectors(size, height)):
            in_time()
            if number % REPORTED == 0:
                report(f"enumeration of L0, height {height}, element {number + 1} of {total}")
            coefficients = (action.field.from_integers(vector, 1, size) @ members).row(0)
            found = exact.certificate(coefficients, BITS * height, TRIES * height)
            if found is not None:
                return Dominant(found, coefficients, top_vector(action, coefficients))


def integer_vectors(size: int, height: int) -> Iterator[list[int]]:
    """All integer vectors whose absolute values have the sum `height`, those with few nonzero entries first.

    Examples
    --------
    >>> list(integer_vectors(2, 1))
    [[1, 0], [-1, 0], [0, 1], [0, -1]]
    >>> len(list(integer_vectors(3, 4))), number_of_vectors(3, 4)
    (66, 66)
    """
    for count in range(1, min(size, height) + 1):
        for places in itertools.combinations(range(size), count):
            for ends in itertools.combinations(range(1, height), count - 1):
                values = [b - a for a, b in itertools.pairwise((0, *ends, height))]
                for signs in itertools.product((1, -1), repeat=count):
                    vector = [0] * size
                    for place, value, sign in zip(places, values, signs, strict=True):
                        vector[place] = sign * value
                    yield vector


def number_of_vectors(size: int, height: int) -> int:
    """Number of integer vectors whose absolute values have the sum `height` >= 1."""
    return sum(2**j * comb(size, j) * comb(height - 1, j - 1) for j in range(1, min(size, height) + 1))
