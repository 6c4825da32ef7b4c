"""Real solutions of polynomial systems with finitely many of them."""

import flint
import pytest

from liehom.exact.geometry.polynomial_systems import UnfinishedError, real_solutions
from liehom.exact.scalars.rational import QQ

RING = flint.fmpq_mpoly_ctx.get(("x", "y"), flint.Ordering.degrevlex)
X, Y = RING.gens()


@pytest.mark.parametrize(("equations", "nonzero", "points"), [
    ([(X - 1) ** 2 * (2 * X + 1), Y - X**2], [], {(1.0, 1.0), (-0.5, 0.25)}),
    ([(X - 1) ** 2, (Y**2 - 2) ** 3], [], {(1.0, 2**0.5), (1.0, -(2**0.5))}),
    ([X**2 * (X - 3), Y**2 * (Y - X)], [X], {(3.0, 0.0), (3.0, 3.0)}),
    ([X**2 + 1, Y], [], set()),
])  # fmt: skip
def test_repeated_solutions_are_listed_once(
    equations: list[flint.fmpq_mpoly], nonzero: list[flint.fmpq_mpoly], points: set[tuple[float, float]]
) -> None:
    solutions = real_solutions(equations, nonzero, lambda _: True)
    values = [tuple(round(float(s.field.to_float(v)), 12) for v in s.values) for s in solutions]
    assert len(values) == len(points) and set(values) == {tuple(round(v, 12) for v in p) for p in points}
    assert all(s.field == QQ or s.field.degree == 2 for s in solutions)


def test_infinitely_many_complex_solutions_are_an_error() -> None:
    with pytest.raises(UnfinishedError):
        real_solutions([X**2 + Y**2], [], lambda _: True)
