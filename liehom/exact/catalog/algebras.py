"""Lie algebras and representations by name: matrix bases of linear Lie algebras, families without matrices.

Linear Lie algebras:
  classical       gl, sl, so, su, u, sp, spin with the parameters of `linear.named_matrices`; so*(2n)
  other scalars   sl(n,Q(sqrt(c))), sl(n,Q(a,b)): over a quadratic field, or over the quaternion algebra (a, b)
  exceptional     g2, g2(2), f4, f4(-20), f4(4), e6(-26), e6(6)
  forms           form(d1,...,dn): so of the diagonal quadratic form
  commutative     field(c0,...,c_(n-1)): Q[t]/(t^n + ... + c0) on itself; diag(...), spiral(a,b), R (scalars)
  triangular      upper(n), strict(n)
  motions         e(n), iso(p,q), aff(n) on the vectors (x, 1), affine(X) too; galilei(n) on the vectors (x, t, 1)
  from others     dual(X), tensor(X,Y), blocks(X,Y,...), copies(k,X), Sk(X), Lk(X); sym(n): so(n) on Sym(n)
  with scalars    X+R, X+u(1), X+sp(1), X+sl(1,Q(a,b)), X+spiral(a,b): scalars that commute with X, spiral(a,b)
                  the one matrix a + bJ with J the complex structure, for fractions times their common denominator
Kinematical, conformal, solvable, free nilpotent families:
  bargmann(n): galilei(n) with mass; schroedinger(n); conformal(p), conformal(p,q)
  filiform(n), oscillator(n), free_nilpotent(g,k)
  bianchi(I), ..., bianchi(VI;a), bianchi(VII;a), A1,1, ..., A6,22 with parameters as in A4,2(1/2)
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from typing import TypeVar

import numpy as np

from liehom.base.budget import small_integer
from liehom.base.errors import CatalogError, InputError, LimitError
from liehom.base.typing import IntegerArray
from liehom.exact.algebra import linear as families
from liehom.exact.algebra.constructions import families as constructed
from liehom.exact.algebra.constructions.classical import simple
from liehom.exact.algebra.constructions.low_dimensional import low_dimensional
from liehom.exact.algebra.constructions.sums import direct_sum, semidirect_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.linear_bases import motions, require_basis, stack
from liehom.exact.algebra.linear.named_matrices import (
    CLASSICAL_KINDS,
    EXCEPTIONAL_MATRICES,
    FAMILY_MATRICES,
    classical_matrices,
    exceptional_matrices,
    linear_lie_algebra,
)
from liehom.exact.catalog.names import Expression, Item, Sum, Term, Value, parse_expression, terms, unknown
from liehom.exact.representations.core.representation import Representation

T = TypeVar("T")
EXCEPTIONAL_KINDS = frozenset(name.partition("(")[0] for name in EXCEPTIONAL_MATRICES)


def linear_matrices(tree: Expression) -> IntegerArray:
    """The matrix basis that a parsed name denotes, shape (dim, N, N)."""
    first, *scalars = terms(tree)
    matrices = _term_matrices(first)
    if not scalars:
        return matrices
    return families.join(matrices, *(_scalars(first, extra, matrices.shape[1]) for extra in scalars))


def is_linear(tree: Expression) -> bool:
    """Whether all heads of a parsed name denote linear Lie algebras."""
    heads = CLASSICAL_KINDS | _HEADS.keys()
    known = (t.head in heads or str(t) in EXCEPTIONAL_MATRICES or re.fullmatch(r"[SL]\d+", t.head) for t in terms(tree))
    return all(known)


def scalar_parameters(term: Term) -> tuple[int, ...]:
    """Doubling parameters of the scalars of a classical algebra: () for R, (-1,) for C, (-1, -1) for H."""
    second = term.items[1] if len(term.items) > 1 else 0
    if isinstance(second, Term):
        return _ground(second)
    return {"su": (-1,), "u": (-1,), "sp": (-1, -1), "so*": (-1, -1)}.get(term.head, ())


def _ground(letter: Term) -> tuple[int, ...]:
    """The doubling parameters of R, C, H, Q(sqrt(c)) or Q(a,b)."""
    if letter.head in "RCH" and not letter.items:
        return {"R": (), "C": (-1,), "H": (-1, -1)}[letter.head]
    if letter.head == "Q":
        if len(letter.items) == 1 and isinstance(letter.items[0], Term) and letter.items[0].head == "sqrt":
            return letter.items[0].integers()
        if len(letter.items) == 2:
            return letter.integers()
    raise CatalogError(f"{letter} does not denote scalars; expected R, C, H, Q(sqrt(c)) or Q(a,b)")


def _term_matrices(term: Term) -> IntegerArray:
    if term.after:
        raise CatalogError(f"{term} is not a linear Lie algebra: unexpected ';'")
    if term.head in CLASSICAL_KINDS:
        return _classical(term)
    if term.head in EXCEPTIONAL_KINDS:
        return exceptional_matrices(str(term))
    power = re.fullmatch(r"([SL])(\d+)", term.head)
    if power:
        build = families.symmetric_power if power[1] == "S" else families.exterior_power
        return build(linear_matrices(_one(term)), small_integer(power[2]))
    if term.head not in _HEADS:
        raise CatalogError(
            f"{term} is not a linear Lie algebra of the catalogue; heads: see liehom.exact.catalog.algebras"
        )
    return _HEADS[term.head](term)


def _classical(term: Term) -> IntegerArray:
    if not 1 <= len(term.items) <= 2 or not isinstance(term.items[0], int):
        raise CatalogError(f"{term.head} takes a size and perhaps a second parameter, as in {term.head}(3); got {term}")
    n, second = term.items[0], term.items[1] if len(term.items) == 2 else 0
    if isinstance(second, int):
        return classical_matrices(term.head, n, second)
    if isinstance(second, Sum | Fraction):
        raise CatalogError(f"{second} does not denote scalars; expected R, C, H, Q(sqrt(c)) or Q(a,b)")
    ground = _ground(second)
    if second.head != "Q":
        return classical_matrices(term.head, n, second.head)
    if term.head != "sl":
        raise CatalogError(f"{term} is not in the catalogue; over {second} there is sl(n,{second})")
    if len(ground) == 1:
        return families.complex_sl(n, parameter=ground[0])
    return families.quaternionic_sl(n, parameters=(ground[0], ground[1]))


def _scalars(first: Term, extra: Term, size: int) -> IntegerArray:
    """Matrices on R^size of scalars that commute with a classical algebra over C, H, Q(sqrt(c)) or Q(a,b)."""
    if extra == Term("R"):
        return np.eye(size, dtype=np.int64)[None]
    ground = scalar_parameters(first)
    if len(ground) in (1, 2):
        if len(ground) == 1:
            units = families.complex_structure(size // 2, parameter=ground[0])[None]
        else:
            units = families.quaternion_scalars(size // 4, parameters=(ground[0], ground[1]))
        if extra == Term("u", (1,)):
            return units[:1]
        if extra.head == "spiral" and len(extra.items) == 2:
            growth, frequency = _cleared(extra)
            if not frequency:
                raise CatalogError(f"{extra} is a real multiple of the identity; write R")
            return growth * np.eye(size, dtype=np.int64) + frequency * units[:1]
        same = len(ground) == len(extra.items) == 2 and extra.head == "sl" and scalar_parameters(extra) == ground
        if (ground == (-1, -1) and extra == Term("sp", (1,))) or (same and extra.items[0] == 1):
            return units
    raise CatalogError(
        f"{extra} does not act by scalars that commute with {first}; for blocks write blocks(X,Y), "
        "and for a subalgebra of a product lh.Pair(lh.direct_sum(g, g), rows)"
    )


def _cleared(term: Term) -> list[int]:
    """The rational parameters of a term times their common denominator."""
    values = [Fraction(x) for x in term.items if isinstance(x, int | Fraction)]
    if len(values) != len(term.items):
        raise CatalogError(
            f"{term} is not a linear Lie algebra over the rationals; with a square root it is read in "
            "names affine(X+spiral(sqrt(a),b)) only"
        )
    den = math.lcm(*(x.denominator for x in values))
    cleared = [int(x * den) for x in values]
    if any(abs(x) >= 2**62 for x in cleared):
        raise CatalogError(f"{term} has too large numbers over a common denominator; make the pair by liehom.affine_of")
    return cleared


def irrational_spiral(tree: Expression) -> tuple[IntegerArray, IntegerArray, Value, Value] | None:
    """The parts X, J, a, b of a name X+spiral(sqrt(a),b), or None for other names; X is empty in spiral(sqrt(a),b)."""
    *first, last = terms(tree)
    if last.head != "spiral" or len(last.items) != 2 or len(first) > 1:
        return None
    root, frequency = last.items
    if not isinstance(root, Term) or root.head != "sqrt" or len(root.items) != 1 or isinstance(frequency, Term | Sum):
        return None
    (square,) = root.items
    if isinstance(square, Term | Sum) or square <= 0 or not frequency:
        raise CatalogError(f"{last} needs a positive rational number in the square root and a frequency that is not 0")
    if not first:
        return np.zeros((0, 2, 2), dtype=np.int64), families.complex_structure(1), square, frequency
    matrices = _term_matrices(first[0])
    return matrices, _scalars(first[0], Term("u", (1,)), matrices.shape[1])[0], square, frequency


def _expression(item: Item) -> Expression:
    if isinstance(item, int | Fraction):
        raise CatalogError(f"expected a linear Lie algebra, got the number {item}")
    return item


def _one(term: Term) -> Expression:
    if len(term.items) != 1:
        raise CatalogError(f"{term.head} takes one linear Lie algebra, got {term}")
    return _expression(term.items[0])


def _size(term: Term) -> int:
    values = term.integers()
    if len(values) != 1 or values[0] < 1:
        raise CatalogError(f"{term.head} takes one positive integer, got {term}")
    return values[0]


def _spiral(term: Term) -> IntegerArray:
    values = _cleared(term)
    if len(values) < 2:
        raise CatalogError(f"spiral takes the growth and at least one frequency, got {term}")
    growth, *frequencies = values
    require_basis(1, 2 * len(frequencies))
    matrix = growth * np.eye(2 * len(frequencies), dtype=np.int64)
    for k, omega in enumerate(frequencies):
        matrix[2 * k, 2 * k + 1], matrix[2 * k + 1, 2 * k] = -omega, omega
    return matrix[None]


def _diagonal(term: Term) -> IntegerArray:
    values = term.integers()
    require_basis(1, len(values))
    return np.diag(np.array(values, dtype=np.int64))[None]


def _tensor(term: Term) -> IntegerArray:
    if len(term.items) != 2:
        raise CatalogError(f"tensor takes two linear Lie algebras, got {term}")
    return families.tensor_sum(*(linear_matrices(_expression(x)) for x in term.items))


def _of_family(term: Term) -> IntegerArray:
    values, wanted = term.integers(), 2 if term.head == "iso" else 1
    if len(values) != wanted:
        raise CatalogError(f"{term.head} takes {wanted} integer(s), got {term}")
    return _built(term, FAMILY_MATRICES[term.head], *values)


def _blocks(term: Term) -> IntegerArray:
    """The matrix basis of the direct sum of algebras on the direct sum of their spaces."""
    parts = [linear_matrices(_expression(x)) for x in term.items]
    return families.join(*in_blocks(parts, sum(part.shape[1] for part in parts)))


def in_blocks(parts: Sequence[IntegerArray], size: int, offset: int = 0) -> Iterator[IntegerArray]:
    """Each part as matrices (dim, size, size): consecutive diagonal blocks, the first of which begins at `offset`."""
    for matrices in parts:
        require_basis(len(matrices), size)
        block = slice(offset, offset + matrices.shape[1])
        out = np.zeros((len(matrices), size, size), dtype=np.int64)
        out[:, block, block] = matrices
        offset = block.stop
        yield out


def _copies(term: Term) -> IntegerArray:
    if len(term.items) != 2 or not isinstance(term.items[0], int) or term.items[0] < 1:
        raise CatalogError(f"copies takes a positive number and a linear Lie algebra, got {term}")
    matrices = linear_matrices(_expression(term.items[1]))
    require_basis(len(matrices), term.items[0] * matrices.shape[1])
    one = np.eye(term.items[0], dtype=np.int64)
    return stack((np.kron(one, a) for a in matrices), len(one) * matrices.shape[1])


_HEADS: dict[str, Callable[[Term], IntegerArray]] = {
    "R": lambda term: np.ones((1, 1, 1), dtype=np.int64),
    "form": lambda term: families.orthogonal(term.integers()),
    "field": lambda term: families.companion_powers(term.integers()),
    "diag": _diagonal,
    "spiral": _spiral,
    **dict.fromkeys(FAMILY_MATRICES, _of_family),
    "affine": lambda term: motions(linear_matrices(_one(term))),
    "dual": lambda term: -linear_matrices(_one(term)).transpose(0, 2, 1),
    "tensor": _tensor,
    "blocks": _blocks,
    "copies": _copies,
    "sym": lambda term: families.congruence(families.so(_size(term))),
}


def is_family(term: Term) -> bool:
    """Whether the head of a term names a family."""
    return term.head in _FAMILIES or _NUMBERED.fullmatch(term.head) is not None


def family_algebra(term: Term) -> LieAlgebra:
    """The Lie algebra that a term with the name of a family denotes."""
    if term.head == "bianchi":
        return _bianchi(term)
    if numbered := _NUMBERED.fullmatch(term.head):
        return _built(term, low_dimensional, int(numbered[1]), int(numbered[2]), *term.after)
    build, least, most = _FAMILIES[term.head]
    values = term.integers()
    if term.after or not least <= len(values) <= most:
        wanted = f"{least}" if least == most else f"{least} or {most}"
        raise CatalogError(f"{term.head} takes {wanted} integer(s), got {term}")
    return _built(term, build, *values)


def _built(term: Term, build: Callable[..., T], *values: Value | str) -> T:
    try:
        return build(*values)
    except (CatalogError, LimitError):
        raise
    except InputError as error:
        raise CatalogError(f"{term}: {error}") from None


def _bianchi(term: Term) -> LieAlgebra:
    kind = term.items[0] if len(term.items) == 1 else None
    if not isinstance(kind, Term) or kind.items or len(term.after) > 1:
        raise CatalogError(f"bianchi takes a Roman numeral, and perhaps a parameter as in bianchi(VII;2); got {term}")
    return _built(term, constructed.bianchi, kind.head, *term.after)


_NUMBERED = re.compile(r"A(\d),(\d+)", re.ASCII)
_FAMILIES: dict[str, tuple[Callable[..., LieAlgebra], int, int]] = {
    "e": (constructed.euclidean, 1, 1),
    "heisenberg": (constructed.heisenberg, 1, 1),
    "iso": (constructed.poincare, 2, 2),
    "galilei": (constructed.galilei, 1, 1),
    "bargmann": (constructed.bargmann, 1, 1),
    "schroedinger": (constructed.schroedinger, 1, 1),
    "conformal": (constructed.conformal, 1, 2),
    "aff": (constructed.affine, 1, 1),
    "filiform": (constructed.filiform, 1, 1),
    "oscillator": (constructed.oscillator, 1, 1),
    "free_nilpotent": (constructed.free_nilpotent, 2, 2),
    "bianchi": (constructed.bianchi, 1, 1),
}


EXAMPLES = (
    "so(3)", "so(3,1)", "so(3,C)", "so*(6)", "su(3)", "su(2,1)", "u(2)", "sp(3)", "sp(2,1)", "sp(4,R)", "sp(4,C)",
    "sl(3)", "sl(3,C)", "sl(2,H)", "gl(2)", "spin(7)", "spin(9,1)", "g2", "g2(2)", "f4", "f4(-20)", "f4(4)",
    "e6(-26)", "e6(6)", "e7(-25)", "e8(8)", "upper(3)", "heisenberg(1)", "e(3)", "R^2", "aff(1)", "affine(so(3))",
    "affine(su(2)+spiral(1,1))", "iso(3,1)", "galilei(3)", "bargmann(3)", "schroedinger(3)", "conformal(3,1)",
    "filiform(5)", "oscillator(1)", "free_nilpotent(2,3)", "bianchi(VII)", "bianchi(VII;1/2)", "A4,1", "A4,2(1/2)",
    "so(3)+sl(2)",
)  # fmt: skip
"""One name of each kind, for hints in messages."""


def algebra(name: str) -> LieAlgebra:
    """The Lie algebra with a catalogue name such as 'sp(4,R)' or 'e(3)'; '+' means the direct sum, as in 'so(3)+R'.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.algebra("sl(2, H)"), lh.catalog.algebra("so(3)+R").dimension
    (<Lie algebra sl(2,H) of dimension 15 over QQ>, 4)
    """
    return algebra_of(parse_expression(name))


def representation(name: str) -> Representation:
    """The defining representation of a linear Lie algebra with a catalogue name such as 'g2' or 'sl(2,H)+sp(1)'.

    Others are 'tensor(sl(4),sl(2))', 'S2(gl(2))' and 'sym(4)', the conjugation of so(4) on Sym(4); see
    `liehom.exact.catalog.algebras` for all heads.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.representation("g2")
    <representation 'g2' of <Lie algebra g2 of dimension 14 over QQ> on QQ^7>
    """
    tree = parse_expression(name)
    if not is_linear(tree):
        known = [other for other in EXAMPLES if is_linear(parse_expression(other))]
        raise unknown(str(tree), known, "representation")
    return representation_of(linear_matrices(tree), str(tree))


def algebra_of(tree: Expression) -> LieAlgebra:
    """The Lie algebra of a parsed name."""
    if isinstance(tree, Sum):
        return direct_sum(*map(algebra_of, tree.terms), name=str(tree))
    if tree.head == "0" or tree.head.startswith("R"):
        return constructed.abelian(_power(tree))
    if is_family(tree):
        return family_algebra(tree)
    if tree.head == "affine" and len(tree.items) == 1 and not isinstance(tree.items[0], int | Fraction):
        return affine_algebra(linear_matrices(tree.items[0]), str(tree))
    if tree.head == "sym" and not tree.after:
        return algebra_of(Term("so", tree.items))
    if not is_linear(tree):
        with suppress(CatalogError):
            return simple(str(tree))
        raise unknown(str(tree), EXAMPLES, "algebra")
    return linear_lie_algebra(linear_matrices(tree), str(tree))


def affine_algebra(matrices: IntegerArray, name: str | None = None) -> LieAlgebra:
    """The affine algebra h + R^N of a linear Lie algebra h: first h, then the translations."""
    # no check: the matrices are the basis of h, so they are a representation
    return semidirect_sum(linear_lie_algebra(matrices), matrices, size=matrices.shape[1], name=name, check=False)


def representation_of(matrices: IntegerArray, name: str) -> Representation:
    """The defining representation of a matrix basis that is closed under commutators."""
    size = int(matrices.shape[1])
    if len(matrices) == 0:
        return Representation(linear_lie_algebra(matrices, name), [], size=size, name=name)
    closure = lie_closure(matrices, close=False, name=name)
    # no check: the structure constants come from the matrices
    return Representation(closure.algebra, closure.matrices, size=size, name=name, check=False)


def _power(term: Term) -> int:
    """The n of R^n."""
    if term.items or term.after or not (term.head == "0" or term.head[2:].isdecimal() or not term.head[2:]):
        raise CatalogError(f"R^n is written with a circumflex, as in R^2; got {term}")
    return 0 if term.head == "0" else int(term.head[2:] or 1)
