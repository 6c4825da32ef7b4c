"""Dynamical Lie algebras: the real Lie algebra that i H_1, ..., i H_r generate, for sums H_a of Pauli words."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.roots.real_form_names import join_real_forms
from liehom.budget import current_limits, within
from liehom.display import Displayed
from liehom.errors import InputError
from liehom.pauli.identification import WordIdeal, word_ideals
from liehom.pauli.symplectic import closed_words, real_matrix, word_table
from liehom.pauli.words import Hamiltonian, PauliSums, read_sums, spell
from liehom.representations.core.representation import Representation
from liehom.scalars import Scalar


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
    spanned_by_words : bool
        Whether i times each of these words is in the algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.pauli.closure(["XX", "ZI", "IZ"])
    >>> made.dimension, made.words
    (6, ('XX', 'ZI', 'IZ', 'YX', 'XY', 'YY'))
    >>> print(made.describe())
    dynamical Lie algebra of dimension 6 on 2 qubits
      so(3) + so(3)
      2 so(3), spanned by 6 Pauli words
    """

    def __init__(self, sums: PauliSums, words: list[int]) -> None:
        self.qubits: int = sums.qubits
        self.sums: PauliSums = sums
        self._integers: tuple[int, ...] = tuple(words)
        self.spanned_by_words: bool = all(len(terms) == 1 for terms in sums.terms)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words that occur in the algebra, a tuple of str."""
        return tuple(spell(word, self.qubits) for word in self._integers)

    @cached_property
    def word_algebra(self) -> LieAlgebra:
        """The Lie algebra spanned by i times each word in `words`, of which the algebra is a subalgebra.

        Its constants are 0, 2 and -2: [iP, iQ] = 2 iR or -2 iR for anticommuting words P, Q with product R.
        """
        table = word_table(self._integers, self.qubits)
        name = self.name if self.spanned_by_words else None
        made = LieAlgebra(table, basis=self.words, name=name, check=False)  # commutators of matrices
        return made if self.sums.field == made.field else made.over(self.sums.field)

    @cached_property
    def subalgebra(self) -> Subalgebra:
        """The algebra as a subalgebra of `word_algebra`; its rows are coefficients of words."""
        if self.spanned_by_words:
            whole = self.word_algebra
            return Subalgebra(whole, whole.field.identity(whole.dimension), check=False)
        return self.word_algebra.subalgebra_generated_by(self._generator_rows())

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The algebra. Its basis is i times the words, or i times the sums in the rows of `subalgebra`."""
        return self.word_algebra if self.spanned_by_words else self.subalgebra.as_algebra()

    @property
    def dimension(self) -> int:
        """Dimension over the reals, an int."""
        return len(self._integers) if self.spanned_by_words else self.subalgebra.dimension

    @cached_property
    def ideals(self) -> tuple[WordIdeal, ...]:
        """The ideals that connected sets of words generate, for generators that are single words.

        Raises
        ------
        InputError
            If a Hamiltonian has several terms; the ideals of `algebra` are then found by its own methods.
        """
        if not self.spanned_by_words:
            raise InputError("a Hamiltonian has several terms; use algebra.simple_ideals() for its ideals")
        return tuple(word_ideals([next(iter(terms)) for terms in self.sums.terms], self.qubits))

    @cached_property
    def name(self) -> str | None:
        """The name of an algebra that words span, such as 'so(20)' or 'so(3) + u(1)'; None for other algebras."""
        if not self.spanned_by_words:
            return None
        kinds = [ideal.kind for ideal in self.ideals for _ in range(ideal.copies)]
        if None in kinds:
            return None
        simple = join_real_forms(k for k in kinds if k is not None and k != "u(1)")
        central = ["u(1)"] * kinds.count("u(1)")
        return " + ".join(([simple] if simple != "0" else []) + central)

    def describe(self) -> str:
        """Dimension, name and ideals as lines of text.

        Words are identified by linear algebra over F_2, sums of words by `LieAlgebra.describe`.

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
        if not self.spanned_by_words or self.name is None:
            return "\n".join([title, *self.algebra.describe().splitlines()[1:]])
        lines = [title, f"  {self.name}"]
        for ideal in self.ideals:
            count = f"{ideal.copies} {ideal.kind}" if ideal.copies > 1 else ideal.kind
            number = len(ideal.words)
            lines.append(f"  {count}, spanned by {number} Pauli word{'s' if number > 1 else ''}")
        return "\n".join(lines)

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

        Raises
        ------
        InputError
            If i times the Hamiltonian is not in the algebra: the Hamiltonians that were given do not generate it.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.pauli.closure(["XX", "ZI", "IZ"]).element("1/2 * XY - YY")
        [0, 0, 0, 0, 1/2, -1]
        """
        terms = read_sums([hamiltonian], self.qubits).terms[0]
        row = self.word_algebra.field.matrix([self._row(terms)])
        if row.row(0) not in self.subalgebra:
            raise InputError("i times the Hamiltonian is not in the algebra; closure([..., it]) gives a larger one")
        return self.subalgebra.basis.T.solve(row.T).T.row(0)

    def _generator_rows(self) -> list[list[Scalar]]:
        return [self._row(terms) for terms in self.sums.terms]

    def _row(self, terms: dict[int, Scalar]) -> list[Scalar]:
        position = {word: i for i, word in enumerate(self._integers)}
        row = [self.word_algebra.field.zero] * len(position)
        for word, coefficient in terms.items():
            if word not in position:
                raise InputError(f"the word {spell(word, self.qubits)} does not occur in the algebra")
            row[position[word]] = coefficient
        return row

    def __repr__(self) -> str:
        name = f" {self.name}" if self.spanned_by_words and self.name else ""
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
    algebra. For sums, the words that occur span a larger Lie algebra, in which the subalgebra is computed exactly.

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
