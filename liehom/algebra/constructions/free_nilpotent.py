"""Free nilpotent Lie algebras in the basis of Lyndon words, a Hall basis.

A word is Lyndon if it is smaller than its proper right factors. A Lyndon word w of length at least 2 is bracketed as
[u, v], where w = u v and v is the longest proper right factor that is Lyndon. For Lyndon words u < v the bracket [u, v]
is the basis element u v if u is a letter, or if u = u1 u2 with u2 not smaller than v. Otherwise

    [[u1, u2], v] = [[u1, v], u2] + [u1, [u2, v]],

and this recursion terminates.
"""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices.matrix_basis import require_size
from liehom.budget import current_limits, within
from liehom.scalars import QQ

Word = tuple[int, ...]


def free_nilpotent(generators: int, step: int) -> LieAlgebra:
    """The free nilpotent Lie algebra over QQ with given number of generators and step.

    Parameters
    ----------
    generators : int
        At least 1.
    step : int
        The maximal length of a non-zero bracket, at least 1.

    Returns
    -------
    LieAlgebra
        Basis elements by length and then alphabetically, with their brackets as names: x1, x2, [x1,x2],
        [x1,[x1,x2]], ...

    Raises
    ------
    InputError
        If an argument is not a positive integer.

    Notes
    -----
    Every nilpotent Lie algebra of this step with this number of generators is a quotient of it. For g generators
    there are (1/k) sum_{d | k} mu(d) g^(k/d) basis elements of length k (Witt).

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.free_nilpotent(2, 3))
    Lie algebra free_nilpotent(2,3) over QQ, dimension 5
      basis x1, x2, [x1,x2], [x1,[x1,x2]], [[x1,x2],x2]
      [x1, x2] = [x1,x2]
      [x1, [x1,x2]] = [x1,[x1,x2]]
      [x2, [x1,x2]] = -[[x1,x2],x2]
    """
    require_size("generators", generators)
    require_size("step", step)
    dimension = _dimension(generators, step, current_limits().dimension)
    within("dimension", dimension, "the algebra has dimension {} or more")
    free = _FreeLie(generators, step)
    index = {word: i for i, word in enumerate(free.words)}
    entries = []
    for i, u in enumerate(free.words):
        for j in range(i + 1, len(free.words)):
            v = free.words[j]
            if len(u) + len(v) > step:
                break  # words are sorted by length
            entries += [(i, j, index[w], QQ.convert(c)) for w, c in free.bracket(u, v).items()]
    names = [free.name(word) for word in free.words]
    table = StructureConstants(QQ, len(names), entries)
    # Brackets of a quotient of the free Lie algebra, rewritten by antisymmetry and the Jacobi identity only.
    return LieAlgebra(table, basis=names, name=f"free_nilpotent({generators},{step})", check=False)


def _dimension(generators: int, step: int, enough: int) -> int:
    """Number of Lyndon words up to length `step` by Witt's formula; the count ends when it exceeds `enough`."""
    ending: dict[int, int] = {}  # length k: k times the number of Lyndon words of length k
    total = 0
    for k in range(1, step + 1):
        ending[k] = generators**k - sum(ending[d] for d in range(1, k // 2 + 1) if k % d == 0)
        total += ending[k] // k
        if total > enough or generators == 1:
            break
    return total


@final
class _FreeLie:
    """Brackets of Lyndon words up to length `step`."""

    def __init__(self, generators: int, step: int) -> None:
        self.generators = generators
        self.step = step
        self._known: dict[tuple[Word, Word], dict[Word, int]] = {}

    @cached_property
    def words(self) -> list[Word]:
        """The Lyndon words of length at most `step`, by length and then alphabetically (Duval's algorithm)."""
        found: list[Word] = []
        word = [-1]
        while word:
            word[-1] += 1
            found.append(tuple(word))
            period = len(word)
            while len(word) < self.step:
                word.append(word[-period])
            while word and word[-1] == self.generators - 1:
                word.pop()
        return sorted(found, key=lambda w: (len(w), w))

    @cached_property
    def _lyndon(self) -> frozenset[Word]:
        return frozenset(self.words)

    def factors(self, word: Word) -> tuple[Word, Word]:
        """The Lyndon words u, v of the bracketing [u, v] of a Lyndon word of length at least 2."""
        cut = next(i for i in range(1, len(word)) if word[i:] in self._lyndon)
        return word[:cut], word[cut:]

    def name(self, word: Word) -> str:
        """The bracketing of a Lyndon word as a string in x1, x2, ..."""
        if len(word) == 1:
            return f"x{word[0] + 1}"
        left, right = self.factors(word)
        return f"[{self.name(left)},{self.name(right)}]"

    def bracket(self, u: Word, v: Word) -> dict[Word, int]:
        """[u, v] of two basis elements, as {word: coefficient}."""
        if u == v or len(u) + len(v) > self.step:
            return {}
        if u > v:
            return {w: -c for w, c in self.bracket(v, u).items()}
        if (u, v) not in self._known:
            self._known[u, v] = self._new_bracket(u, v)
        return self._known[u, v]

    def _new_bracket(self, u: Word, v: Word) -> dict[Word, int]:
        if len(u) == 1:
            return {u + v: 1}
        first, second = self.factors(u)
        if second >= v:
            return {u + v: 1}
        total: defaultdict[Word, int] = defaultdict(int)
        for w, c in self.bracket(first, v).items():
            for x, d in self.bracket(w, second).items():
                total[x] += c * d
        for w, c in self.bracket(second, v).items():
            for x, d in self.bracket(first, w).items():
                total[x] += c * d
        return {w: c for w, c in total.items() if c}
