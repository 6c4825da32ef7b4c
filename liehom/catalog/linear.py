"""Integer matrix bases of linear Lie algebras from their names.

classical       gl, sl, so, su, u, sp, spin with the parameters of `liehom.algebra.matrices.named_matrices`; so*(2n)
other scalars   sl(n,Q(sqrt(c))), sl(n,Q(a,b)): over a quadratic field, or over the quaternion algebra (a, b)
exceptional     g2, g2(2), f4, f4(-20), f4(4), e6(-26), e6(6)
forms           form(d1,...,dn): so of the diagonal quadratic form
commutative     field(c0,...,c_(n-1)): Q[t]/(t^n + ... + c0) on itself; diag(...), spiral(a,b), R (scalars)
triangular      upper(n), strict(n)
from others     dual(X), tensor(X,Y), blocks(X,Y,...), copies(k,X), Sk(X), Lk(X); sym(n): so(n) on Sym(n)
with scalars    X+R, X+u(1), X+sp(1), X+sl(1,Q(a,b)), X+spiral(a,b): scalars that commute with X, spiral(a,b) being
                the one matrix a + bJ with J the complex structure, for fractions times their common denominator
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from fractions import Fraction

import numpy as np

from liehom.algebra import matrices as families
from liehom.algebra.matrices.matrix_basis import require_basis, stack
from liehom.algebra.matrices.named_matrices import (
    CLASSICAL_KINDS,
    EXCEPTIONAL_MATRICES,
    classical_matrices,
    exceptional_matrices,
)
from liehom.budget import small_integer
from liehom.catalog.names import Expression, Item, Sum, Term, Value, terms
from liehom.errors import CatalogError
from liehom.typing import IntegerArray

EXCEPTIONAL_KINDS = frozenset(name.partition("(")[0] for name in EXCEPTIONAL_MATRICES)


def linear_matrices(tree: Expression) -> IntegerArray:
    """The matrix basis that a parsed name denotes, shape (dim, N, N).

    Raises
    ------
    CatalogError
        If the name does not denote a linear Lie algebra.

    Examples
    --------
    >>> from liehom.catalog.names import parse_expression
    >>> linear_matrices(parse_expression("sl(2,H)+sp(1)")).shape
    (18, 8, 8)
    """
    first, *scalars = terms(tree)
    matrices = _term_matrices(first)
    if not scalars:
        return matrices
    return families.join(matrices, *(_scalars(first, extra, matrices.shape[1]) for extra in scalars))


def is_linear(tree: Expression) -> bool:
    """Whether all heads of a parsed name denote linear Lie algebras."""
    heads = CLASSICAL_KINDS | EXCEPTIONAL_KINDS | _HEADS.keys()
    return all(t.head in heads or re.fullmatch(r"[SL]\d+", t.head) for t in terms(tree))


def scalar_parameters(term: Term) -> tuple[int, ...]:
    """Doubling parameters of the scalars of a classical algebra: () for R, (-1,) for C, (-1, -1) for H.

    Examples
    --------
    >>> scalar_parameters(Term("su", (3,))), scalar_parameters(Term("sp", (2,)))
    ((-1,), (-1, -1))
    """
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
        raise CatalogError(f"{term} is not a linear Lie algebra of the catalogue; heads: see liehom.catalog.linear")
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
    if len(ground) == 1:
        unit = families.complex_structure(size // 2, parameter=ground[0])[None]
        if extra == Term("u", (1,)):
            return unit
        if extra.head == "spiral" and len(extra.items) == 2:
            return _spiral_scalar(extra, unit)
    if len(ground) == 2:
        units = families.quaternion_scalars(size // 4, parameters=(ground[0], ground[1]))
        if extra == Term("u", (1,)):
            return units[:1]
        if extra.head == "spiral" and len(extra.items) == 2:
            return _spiral_scalar(extra, units[:1])
        same = extra.head == "sl" and len(extra.items) == 2 and scalar_parameters(extra) == ground
        if (extra == Term("sp", (1,)) and ground == (-1, -1)) or (same and extra.items[0] == 1):
            return units
    raise CatalogError(f"{extra} does not act by scalars that commute with {first}; for blocks write blocks(X,Y)")


def _spiral_scalar(extra: Term, unit: IntegerArray) -> IntegerArray:
    """The matrix a + b J, shape (1, N, N), for the complex structure J."""
    growth, frequency = _cleared(extra)
    if not frequency:
        raise CatalogError(f"{extra} is a real multiple of the identity; write R")
    return growth * np.eye(unit.shape[1], dtype=np.int64) + frequency * unit


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
    """The parts X, J, a, b of a name X+spiral(sqrt(a),b), or None for other names; X is empty in spiral(sqrt(a),b).

    Examples
    --------
    >>> from liehom.catalog.names import parse_expression
    >>> X, J, a, b = irrational_spiral(parse_expression("su(3)+spiral(sqrt(2),1)"))
    >>> len(X), J.shape, a, b
    (8, (6, 6), 2, 1)
    """
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


def _so_star(term: Term) -> IntegerArray:
    size = _size(term)
    if size % 2:
        raise CatalogError(f"so*(2n) is named by its even size; got {term}")
    return families.so_star(size // 2)


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


def _blocks(term: Term) -> IntegerArray:
    """The matrix basis of the direct sum of algebras on the direct sum of their spaces."""
    parts = [linear_matrices(_expression(x)) for x in term.items]
    total = sum(part.shape[1] for part in parts)
    placed, offset = [], 0
    for part in parts:
        placed.append(at_offset(part, offset, total))
        offset += part.shape[1]
    return families.join(*placed)


def at_offset(matrices: IntegerArray, offset: int, size: int) -> IntegerArray:
    """Matrices (dim, size, size) with the given matrices as the diagonal block that begins at `offset`."""
    n = matrices.shape[1]
    require_basis(len(matrices), size)
    out = np.zeros((len(matrices), size, size), dtype=np.int64)
    out[:, offset : offset + n, offset : offset + n] = matrices
    return out


def _copies(term: Term) -> IntegerArray:
    if len(term.items) != 2 or not isinstance(term.items[0], int) or term.items[0] < 1:
        raise CatalogError(f"copies takes a positive number and a linear Lie algebra, got {term}")
    matrices = linear_matrices(_expression(term.items[1]))
    require_basis(len(matrices), term.items[0] * matrices.shape[1])
    one = np.eye(term.items[0], dtype=np.int64)
    return stack((np.kron(one, a) for a in matrices), len(one) * matrices.shape[1])


_HEADS: dict[str, Callable[[Term], IntegerArray]] = {
    "so*": _so_star,
    "R": lambda term: np.ones((1, 1, 1), dtype=np.int64),
    "form": lambda term: families.orthogonal(term.integers()),
    "field": lambda term: families.companion_powers(term.integers()),
    "diag": _diagonal,
    "spiral": _spiral,
    "upper": lambda term: families.triangular(_size(term)),
    "strict": lambda term: families.triangular(_size(term), 1),
    "dual": lambda term: -linear_matrices(_one(term)).transpose(0, 2, 1),
    "tensor": _tensor,
    "blocks": _blocks,
    "copies": _copies,
    "sym": lambda term: families.congruence(families.so(_size(term))),
}
