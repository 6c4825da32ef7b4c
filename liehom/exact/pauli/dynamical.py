"""Dynamical Lie algebras of Pauli words, and their names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import combinations
from operator import xor
from typing import final

from liehom.base.budget import current_limits, within
from liehom.base.errors import InputError
from liehom.base.objects import Displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.real_form import canonical_real_form, join_real_forms, real_forms
from liehom.exact.algebra.roots.root_system import join_types
from liehom.exact.algebra.structure.identification import lines_of_forms
from liehom.exact.pauli.simple_ideals import simple_types
from liehom.exact.pauli.span import LiftedRows, WordSpan
from liehom.exact.pauli.words import (
    Hamiltonian,
    PauliSums,
    closed_words,
    read_sums,
    real_matrix,
    spell,
    swapped,
    word_table,
)
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Scalar

# Names of the Lie algebras that Pauli words span. Let D be a set of words that is closed under commutators and
# connected by anticommutation. Let W be its span over F_2, R the radical of the symplectic form on W, V = W / R of
# dimension 2m, and K the translations of R that preserve D. The words of K are central and square to 1, so their signs
# split the algebra into |K| copies of the span of D / K:
#
#   * su(2^m) if D / K has 4^m - 1 elements. These are all words except the identity on m qubits.
#   * so(2^m) or sp(2^(m-1)) if D is the set {q = 1} of a quadratic form q on W that vanishes on R. These are the words
#     that an involutive anti-automorphism negates. The algebra is orthogonal if q has Arf invariant 0, else symplectic.
#   * so(k) if D / K consists of anticommuting words c_1, ..., c_(k-1) and their products c_i c_j.
#
# Each criterion is checked as it is stated. If none applies, the ideal has no name here.


@final
@dataclass(frozen=True, slots=True)
class WordIdeal:
    """An ideal that is spanned by Pauli words which anticommutation connects.

    Attributes
    ----------
    words : tuple of int
    copies : int
        The number of isomorphic ideals whose sum it is.
    kind : str or None
        Name of one of them, such as 'so(20)'; 'u(1)' for a central word; None if it was not recognized.
    """

    words: tuple[int, ...]
    copies: int
    kind: str | None


def word_ideals(generators: Sequence[int], qubits: int) -> list[WordIdeal]:
    """The ideals that connected sets of words generate, in the order of their first words."""
    return [_recognized(part, closed_words(part, qubits), qubits) for part in _connected(generators, qubits)]


def _connected(generators: Sequence[int], qubits: int) -> list[list[int]]:
    """The generators, distinct, by connected components of their anticommutation graph."""
    left = list(dict.fromkeys(generators))
    parts = []
    while left:
        part, left = [left[0]], left[1:]
        for word in part:  # the list grows while it is read
            other = swapped(word, qubits)
            near = [w for w in left if (w & other).bit_count() & 1]
            part += near
            left = [w for w in left if w not in set(near)]
        parts.append(part)
    return parts


def _recognized(generators: Sequence[int], words: Sequence[int], qubits: int) -> WordIdeal:
    if len(words) == 1:
        return WordIdeal(tuple(words), 1, "u(1)")
    radical = _radical(generators, qubits)
    fibre = [w ^ words[0] for w in words if _residue(w ^ words[0], radical) == 0]
    inside = set(words)
    translations = [r for r in fibre if all(w ^ r in inside for w in words)]
    if len(translations) < len(fibre):
        return WordIdeal(tuple(words), 1, None)
    kind = _kind(generators, words, radical, translations, qubits)
    return WordIdeal(tuple(words), len(translations), None if kind is None else canonical_real_form(kind))


def _kind(
    generators: Sequence[int], words: Sequence[int], radical: Sequence[int], translations: Sequence[int], qubits: int
) -> str | None:
    m = (len(_reduced(generators)) - len(radical)) // 2
    count = len(words) // len(translations)
    images = {_residue(w, radical) for w in words}
    if len(images) == count == 4**m - 1:
        return f"su({2**m})"
    arf = _arf_invariant(generators, words, radical, qubits)
    if arf is not None and len(words) == 2 ** len(radical) * 2 ** (m - 1) * (2**m + (1 if arf else -1)):
        return f"sp({2 ** (m - 1)})" if arf else f"so({2**m})"
    return _orthogonal(words, _reduced(translations), count, qubits)


def _orthogonal(words: Sequence[int], translations: Sequence[int], count: int, qubits: int) -> str | None:
    """'so(k)' if the words modulo translations are k - 1 anticommuting words and their products."""
    classes = list(dict.fromkeys(_residue(w, translations) for w in words))
    first = classes[0]
    second, *near = [w for w in classes if _anticommute(w, first, qubits)]
    rest = [w for w in near if _anticommute(w, second, qubits) and w != _residue(first ^ second, translations)]
    units = [first, second, *rest]
    pairs = list(combinations(units, 2))
    if not all(_anticommute(a, b, qubits) for a, b in pairs):
        return None
    spanned = {_residue(a ^ b, translations) for a, b in pairs} | set(units)
    k = len(units) + 1
    return f"so({k})" if len(spanned) == count == k * (k - 1) // 2 and spanned == set(classes) else None


def _arf_invariant(generators: Sequence[int], words: Sequence[int], radical: Sequence[int], qubits: int) -> int | None:
    """The Arf invariant of the quadratic form that is 1 on all words, or None if there is none on V.

    q(a + b) = q(a) + q(b) + <a, b>. It is carried along as one more bit of each word.
    """
    flag = 1 << (2 * qubits)

    def add(a: int, b: int) -> int:
        return (a ^ b) ^ (flag if _anticommute(a, b, qubits) else 0)

    basis: dict[int, int] = {}  # leading bit of the word -> word with its value of q

    def reduced(word: int) -> int:
        while word & (flag - 1):
            top = (word & (flag - 1)).bit_length()
            if top not in basis:
                return word
            word = add(word, basis[top])
        return word

    for g in generators:
        left = reduced(g | flag)
        if left & (flag - 1):
            basis[(left & (flag - 1)).bit_length()] = left
        elif left:
            return None  # q(0) = 1: the values at the generators contradict each other
    if any(reduced(r) for r in radical) or any(reduced(w) != flag for w in words):
        return None  # q(r) = 1 for a central word, or q(w) = 0 for a word: read off the value left at 0
    return _arf_of(list(basis.values()), add, flag, qubits)


def _arf_of(vectors: list[int], add: Callable[[int, int], int], flag: int, qubits: int) -> int:
    """Sum of q(a) q(b) over the pairs of a symplectic basis, by Gram-Schmidt."""
    total = 0
    while vectors:
        a, *vectors = vectors
        partner = next((b for b in vectors if _anticommute(a, b, qubits)), None)
        if partner is None:
            continue
        vectors.remove(partner)
        total ^= int(bool(a & flag) and bool(partner & flag))
        for i, v in enumerate(vectors):
            to_a, to_b = _anticommute(v, a, qubits), _anticommute(v, partner, qubits)
            v = add(v, partner) if to_a else v
            vectors[i] = add(v, a) if to_b else v
    return total


def _anticommute(a: int, b: int, qubits: int) -> bool:
    return bool((a & ((1 << 2 * qubits) - 1) & swapped(b & ((1 << 2 * qubits) - 1), qubits)).bit_count() & 1)


def _reduced(words: Iterable[int]) -> list[int]:
    """A basis over F_2 of the span, by elimination from the leading bit."""
    basis: dict[int, int] = {}
    for word in words:
        while word:
            top = word.bit_length()
            if top not in basis:
                basis[top] = word
                break
            word ^= basis[top]
    return [basis[top] for top in sorted(basis, reverse=True)]


def _residue(word: int, basis: Sequence[int]) -> int:
    """The representative of a word modulo the span of a basis from `_reduced`."""
    return reduce(lambda word, b: min(word, word ^ b), basis, word)


def _radical(generators: Sequence[int], qubits: int) -> list[int]:
    """A basis of the words in the span that commute with all generators."""
    basis = _reduced(generators)
    # for each basis word the bits of its anticommutation with the basis, and the bit of its own index
    rows = [
        sum(1 << j for j, other in enumerate(basis, len(basis)) if _anticommute(word, other, qubits)) | 1 << i
        for i, word in enumerate(basis)
    ]
    kernel = [row for row in _reduced(rows) if not row >> len(basis)]
    return _reduced(reduce(xor, (word for i, word in enumerate(basis) if row >> i & 1)) for row in kernel)


@final
class DynamicalLieAlgebra(Displayed):
    """The real Lie algebra that Hermitian sums of Pauli words generate, made by `closure`.

    Attributes
    ----------
    qubits : int
    sums : PauliSums
        The Hamiltonians that were given.
    words : tuple of str
        The words that occur in the algebra, qubit 0 first.

    Examples
    --------
    >>> import liehom as lh
    >>> algebra = lh.pauli.closure(["XX", "ZI", "IZ"])
    >>> algebra.dimension, algebra.words
    (6, ('XX', 'ZI', 'IZ', 'YX', 'XY', 'YY'))
    >>> print(algebra.describe())
    dynamical Lie algebra of dimension 6 on 2 qubits
      so(3) + so(3)
      2 so(3), spanned by 6 Pauli words
    """

    def __init__(self, sums: PauliSums, words: list[int]) -> None:
        self.qubits: int = sums.qubits
        self.sums: PauliSums = sums
        self._integers: tuple[int, ...] = tuple(words)
        self._are_words: bool = all(len(terms) == 1 for terms in sums.terms)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words that occur in the algebra, a tuple of str."""
        return tuple(spell(word, self.qubits) for word in self._integers)

    @cached_property
    def _rows(self) -> LiftedRows | None:
        """The reduced echelon basis in coordinates on the words, or None if the words themselves are a basis."""
        return None if self._are_words else WordSpan(self.sums, self._integers).basis()

    @property
    def spanned_by_words(self) -> bool:
        """Whether i times each word in `words` is in the algebra."""
        return self._rows is None

    @cached_property
    def word_algebra(self) -> LieAlgebra:
        """The Lie algebra spanned by i times each word in `words`, of which the algebra is a subalgebra.

        Its constants are 0, 2 and -2: [iP, iQ] = 2 iR or -2 iR for anticommuting words P, Q with product R.
        """
        table = word_table(self._integers, self.qubits)
        name = self.name if self.spanned_by_words else None
        algebra = LieAlgebra(table, basis=self.words, name=name, check=False)  # commutators of matrices
        return algebra if self.sums.field == algebra.field else algebra.over(self.sums.field)

    @cached_property
    def subalgebra(self) -> Subalgebra:
        """The algebra as a subalgebra of `word_algebra`; its rows are coefficients of words."""
        algebra = self.word_algebra
        rows = algebra.field.identity(algebra.dimension) if self._rows is None else self._rows.matrix()
        return Subalgebra(algebra, rows, check=False)

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The algebra. Its basis is i times the words, or i times the sums in the rows of `subalgebra`."""
        return self.word_algebra if self.spanned_by_words else self.subalgebra.as_algebra()

    @property
    def dimension(self) -> int:
        """Dimension over the reals, an int."""
        return len(self._integers) if self._rows is None else len(self._rows.pivots)

    @cached_property
    def ideals(self) -> tuple[WordIdeal, ...]:
        """The ideals that connected sets of words generate, if words span the algebra."""
        if not self.spanned_by_words:
            raise InputError("words do not span the algebra; use algebra.simple_ideals() for its ideals")
        return tuple(word_ideals([word for terms in self.sums.terms for word in terms], self.qubits))

    @cached_property
    def name(self) -> str | None:
        """The name of an algebra that words span, such as 'so(20)' or 'so(3) + u(1)'; None for other algebras."""
        if not self.spanned_by_words:
            return None
        kinds = [ideal.kind for ideal in self.ideals for _ in range(ideal.copies)]
        if None in kinds:
            return None
        simple = join_real_forms(k for k in kinds if k is not None and k != "u(1)")
        return " + ".join(([simple] if simple != "0" else []) + ["u(1)"] * kinds.count("u(1)"))

    def describe(self) -> str:
        """Dimension, name and ideals as lines of text.

        Words are identified by linear algebra over F_2. Other algebras have the lines of `LieAlgebra.describe`.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.pauli.closure(["XX + YY", "ZI"]).describe())
        dynamical Lie algebra of dimension 4 on 2 qubits
          reductive: Levi factor of dimension 3, radical of dimension 1
          Levi factor: simple, real form so(3), rank 1, real rank 0, maximal compact so(3)
          nilradical of dimension 1, centre of dimension 1
          derived series 4 > 3, lower central series 4 > 3
          Killing form of signature (0, 3, 1) (positive, negative, zero)
        """
        on = f"{self.qubits} qubit{'s' if self.qubits > 1 else ''}"
        title = f"dynamical Lie algebra of dimension {self.dimension} on {on}"
        if self.name is None:
            lines = self._structure() or [line.strip() for line in self.algebra.describe().splitlines()[1:]]
            return "\n  ".join([title, *lines])
        lines = [title, f"  {self.name}"]
        for ideal in self.ideals:
            count = f"{ideal.copies} {ideal.kind}" if ideal.copies > 1 else ideal.kind
            number = len(ideal.words)
            lines.append(f"  {count}, spanned by {number} Pauli word{'s' if number > 1 else ''}")
        return "\n".join(lines)

    def _structure(self) -> list[str]:
        """The lines of `LieAlgebra.describe` without a table: the algebra is compact. None if a type remains open."""
        span = WordSpan(self.sums, self._integers)
        basis = span.basis(derived=True)
        d, derived = self.dimension, span.size if basis is None else len(basis.pivots)
        types = simple_types(span, basis) if derived else []
        if types is None:
            return []
        sizes = f"nilradical of dimension {d - derived}, centre of dimension {d - derived}"
        series = f"derived series {d} > {derived}, lower central series {d} > {derived}"
        form = f"Killing form of signature (0, {derived}, {d - derived}) (positive, negative, zero)"
        if not derived:
            return ["abelian", sizes, series, form]
        lines = lines_of_forms(join_types(types), [real_forms(t)[-1] for t in types])  # the compact ones
        if derived == d:
            return [*lines, form]
        parts = f"reductive: Levi factor of dimension {derived}, radical of dimension {d - derived}"
        return [parts, f"Levi factor: {lines[0]}", sizes, series, form]

    def representation(self) -> Representation:
        """The representation on C^N, N = 2 to the number of qubits: basis elements as N x N skew-Hermitian matrices.

        Raises
        ------
        LimitError
            If the matrices have more entries together than `liehom.limits` allows.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.pauli.closure(["X", "Y"]).representation()
        >>> rho.complex_size, rho.complex_matrices()[1]
        (2, Matrix([
        [ 0, 1],
        [-1, 0]]))
        """
        size = 2 ** (self.qubits + 1)
        within("entries", self.dimension * size * size, "the matrices of the representation have {} entries")
        field = self.word_algebra.field
        words = [field.matrix(real_matrix(word, self.qubits)) for word in self._integers]
        flat = field.stack_rows([a.reshape(1, size * size) for a in words], size * size)
        matrices = (self.subalgebra.basis @ flat).split_rows(size, size)
        return Representation(
            self.algebra, matrices, size=size, name=f"C^{2**self.qubits}", coordinates="complex", check=False
        )

    def element(self, hamiltonian: Hamiltonian) -> list[Scalar]:
        """The coefficients in the basis of `algebra` of i times a Hamiltonian, a list of length `dimension`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pauli.closure(["XX", "ZI", "IZ"]).element("1/2 * XY - YY")
        [0, 0, 0, 0, 1/2, -1]
        """
        row = self.word_algebra.field.matrix([self._row(read_sums([hamiltonian], self.qubits).terms[0])])
        if row.row(0) not in self.subalgebra:
            raise InputError("i times the Hamiltonian is not in the algebra; closure([..., it]) gives a larger one")
        return self.subalgebra.basis.T.solve(row.T).T.row(0)

    def _row(self, terms: dict[int, Scalar]) -> list[Scalar]:
        position = {word: i for i, word in enumerate(self._integers)}
        row = [self.word_algebra.field.zero] * len(position)
        for word, coefficient in terms.items():
            if word not in position:
                raise InputError(f"the word {spell(word, self.qubits)} does not occur in the algebra")
            row[position[word]] = coefficient
        return row

    def __repr__(self) -> str:
        name = f" {self.name}" if self._are_words and self.name else ""
        return f"<dynamical Lie algebra{name} of {len(self.sums.terms)} Hamiltonians on {self.qubits} qubits>"


def closure(hamiltonians: Iterable[Hamiltonian], *, qubits: int | None = None) -> DynamicalLieAlgebra:
    """The dynamical Lie algebra of Hamiltonians H_a: the real Lie algebra that the matrices i H_a generate.

    Parameters
    ----------
    hamiltonians : iterable
        Each a Pauli word or a sum of words with exact real coefficients: "ZZI"; "XX + 1/2 * YY"; "Z(0) @ Z(1)" or
        "0.5 * Z0 * Z1" with qubits by number; ``{"XX": 1, "YY": "sqrt(2)"}``; pairs ``[("XX", 1), ("YY", 2)]``.
        The first letter of a word belongs to qubit 0. Words of several Hamiltonians commute or anticommute, so that
        the coefficient of a single word does not matter.
    qubits : int, optional
        Number of qubits; by default the smallest number that the words show.

    Raises
    ------
    ParseError, FieldError, InputError
        If a Hamiltonian is not a sum of words with exact real coefficients.
    LimitError
        If nested commutators reach more words than the dimension that `liehom.limits` allows.

    Notes
    -----
    Words are bit vectors, and commutators of words are computed over F_2. The closure of single words needs no linear
    algebra. For sums, the words that occur may span a larger Lie algebra. The subalgebra is computed modulo primes and
    lifted when it is first asked for, and its dimension is proved. The limit `seconds` of `liehom.limits` ends this.

    Examples
    --------
    >>> import liehom as lh
    >>> open_chain = lh.pauli.closure(lh.pauli.ising(lh.pauli.chain(10)))
    >>> open_chain.dimension, open_chain.name
    (190, 'so(20)')
    """
    sums = read_sums(hamiltonians, qubits)
    allowed = current_limits().dimension
    words = closed_words([word for terms in sums.terms for word in terms], sums.qubits, allowed)
    within("dimension", len(words), "nested commutators reach {} words or more")
    return DynamicalLieAlgebra(sums, words)
