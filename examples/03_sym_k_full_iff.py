"""SO(k) conjugates symmetric k x k matrices: at which points is the isotropy subalgebra full?

Lewis and Olver (section 6, remark) note that it is full where k - 1 eigenvalues coincide and one differs. Here is the
converse as well: of all patterns of multiplicities for k <= 6, no other is full (a scalar matrix is a fixed
point, where there is nothing to ask).
"""

from collections.abc import Iterator

import liehom as lh


def partitions(n: int, largest: int) -> Iterator[tuple[int, ...]]:
    """The ways to write n as a sum of integers from `largest` down to 1, in descending order."""
    if n == 0:
        yield ()
    for first in range(min(n, largest), 0, -1):
        for rest in partitions(n - first, first):
            yield (first, *rest)


def diagonal_point(multiplicities: tuple[int, ...]) -> list[int]:
    """The diagonal matrix with these multiplicities, as the vector of entries (i, j), i <= j."""
    eigenvalues = [value for value, times in enumerate(multiplicities, start=1) for _ in range(times)]
    k = len(eigenvalues)
    return [eigenvalues[i] if i == j else 0 for i in range(k) for j in range(i, k)]


count = 0
for k in range(2, 7):
    rho = lh.sym_conjugation(k)
    for pattern in partitions(k, k):
        if len(pattern) == 1:
            continue
        pair = rho.pair(diagonal_point(pattern))
        verdict = lh.decide_fullness(pair)
        assert verdict.verify()
        assert verdict.full == (pattern == (k - 1, 1)), pattern
        print(f"k = {k}  {pattern!s:<20} dim orbit {pair.dimension:>2}  {'full' if verdict.full else 'not full'}")
        count += 1

print(count, "patterns: full exactly where the multiplicities are (k - 1, 1)")
assert count == 23
