"""Pairs by name: the subalgebra H of a name G/H, and all full pairs of a dimension."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import permutations, product
from math import prod
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import CatalogError, InputError, InternalError, displayed
from liehom.base.typing import IntegerArray, ScalarLike
from liehom.exact.algebra import linear as families
from liehom.exact.algebra.constructions.classical import simple
from liehom.exact.algebra.constructions.families import abelian
from liehom.exact.algebra.constructions.sums import direct_sum, semidirect_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.generated_span import exclusive_entries
from liehom.exact.algebra.linear.linear_bases import null_space
from liehom.exact.algebra.linear.named_matrices import linear_lie_algebra
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.catalog.algebras import (
    affine_algebra,
    algebra_of,
    in_blocks,
    irrational_spiral,
    is_family,
    is_linear,
    linear_matrices,
    scalar_parameters,
)
from liehom.exact.catalog.names import (
    Expression,
    Quotient,
    Sum,
    Term,
    canonical,
    parse,
    parse_expression,
    terms,
    unknown,
)
from liehom.exact.fullness.classification_rows import Key, rows, square_root
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.number_fields import AlgebraicNumber, common_field, number_field
from liehom.exact.scalars.rational import QQ

# Names of pairs of every kind: full pairs first, then those that are not full. Completion reads the text of this file.

NAMES = """
so(2)/so(1) so(3)/so(2) so(4)/so(3) so(5)/so(4) so(8)/so(7) so(12)/so(11) so(2,1)/so(2) so(3,1)/so(3) so(5,1)/so(5)
su(2)/u(1) su(3)/u(2) su(4)/u(3) su(1,1)/u(1) su(2,1)/u(2) su(3,1)/u(3) sp(2)/sp(1)+sp(1) sp(3)/sp(2)+sp(1)
sp(1,1)/sp(1)+sp(1) sp(2,1)/sp(2)+sp(1) f4/spin(9) f4(-20)/spin(9) g2/su(3) spin(7)/g2 so(7)/g2 so(8)/spin(7)
so(4)/u(2) so(6)/u(3) su(4)/sp(2) so(3,C)/so(3) so*(6)/u(3) su(2)/so(2) sp(1)/u(1) sl(2)/so(2) sp(2,R)/u(1)
sl(2,C)/su(2) sl(2,H)/sp(2) sl(2)/B sl(2)/P1 sp(2,R)/P1 su(1,1)/P sl(3)/P1 sl(3)/P2 sl(4)/P1 sl(2,C)/P1 sl(3,C)/P1
sl(2,H)/P1 sl(3,H)/P1 so(2,1)/P so(3,1)/P so(4,1)/P so(5,1)/P so(6,1)/P sp(1,1)/P e6(-26)/P e(2)/so(2) e(3)/so(3)
affine(so(2)) affine(so(3)) affine(so(4)) affine(so(3)+R) affine(form(1,2,5)) affine(su(2)) affine(su(3)) affine(u(2))
affine(sp(1)) affine(sp(2)) affine(sp(2)+u(1)) affine(sp(2)+sp(1)) affine(sp(2)+sp(1)+R) affine(su(3)+spiral(1,1))
affine(g2) affine(spin(7)) affine(spin(9)) affine(spin(9)+R) affine(sl(2)) affine(sl(3)) affine(dual(sl(3)))
affine(gl(2)) affine(gl(3)) affine(sp(4,R)) affine(sp(4,R)+R) affine(sl(2,C)) affine(sl(2,C)+u(1)) affine(gl(2,C))
affine(sl(3,C)) affine(sp(4,C)) affine(sp(4,C)+u(1)) affine(sl(2,H)) affine(sl(2,H)+u(1)) affine(sl(2,H)+sp(1))
affine(sl(3,H)+sp(1)) affine(spin(9,1)) affine(spin(9,1)+R) affine(sl(2,Q(sqrt(-2)))) affine(sl(2,Q(-1,-3)))
affine(gl(1,C)) affine(gl(1,H)) affine(field(1,0)) affine(spiral(1,1)) affine(spin(5)) affine(spin(6))
affine(spin(3,2)) affine(spin(3,3)) affine(spin(5,1)) affine(R) aff(1)/R aff(2)/gl(2) R/0 R^2/R 0/0 so(3)/so(3)
sym(2;1,1) sym(3;2,1) sym(4;3,1) sym(4;4) sym(6;1,5)

so(2,1)/so(1,1) so(3,1)/so(2,1) so(2,2)/so(1,2) so(3,2)/so(2,2) so(4)/so(2)+so(2) so(5)/so(3)+so(2) so(6)/so(3)+so(3)
so(2,2)/so(2)+so(2) so(3,2)/so(3)+so(2) so(5)/so(3) so(8)/u(4) so(4)/0 sl(2)/0 su(3)/so(3) su(4)/so(4) su(2,1)/so(2,1)
su(2,2)/sp(1,1) sl(3,C)/sl(3) sp(4,C)/sp(2) iso(3,1)/so(3,1) galilei(3)/so(3) schroedinger(3)/so(3) su(4)/s(u(2)+u(2))
su(2,2)/s(u(2)+u(2)) su(3)/su(2) su(2,1)/u(1,1) sp(2)/u(2) sp(3)/sp(2) sp(4)/sp(2)+sp(2) sp(2,1)/sp(1,1)+sp(1)
sp(4,R)/u(2) sp(4,R)/gl(2) sp(4,R)/sp(2,R)+sp(2,R) sl(3)/so(3) sl(3)/so(2,1) sl(2)/so(1,1) sl(3,C)/su(3) sl(3,H)/sp(3)
sl(3)/s(gl(2)+gl(1)) sl(4)/P2 sl(4,H)/P2 sl(3)/B sp(4,R)/P1 sp(4,R)/P2 so(2,2)/P so(3,2)/P su(2,1)/P sp(2,1)/P
f4(-20)/spin(8,1) f4(4)/spin(5,4) g2(2)/su(2,1) g2(2)/sl(3) g2(2)/P1 su(2,2)/P{1,3} spin(4,3)/g2(2) spin(9)/spin(7)
e6(-26)/f4 e6(6)/f4(4) e6(6)/P R^2/0 R^3/R heisenberg(1)/0 heisenberg(1)/R affine(so(2,1)) affine(so(3,1))
affine(so(2,1)+R) affine(form(1,1,-3)) affine(form(1,-2)) affine(form(1,-2)+R) affine(su(1,1)) affine(su(2,1))
affine(sp(1,1)) affine(sp(1,1)+sp(1)) affine(g2(2)) affine(spin(4,3)) affine(spin(8,1)) affine(spin(5,5))
affine(spin(5,5)+R) affine(so(3,C)) affine(so(4,C)+R) affine(so*(4)) affine(so*(6)) affine(tensor(sl(2),sl(2)))
affine(tensor(sl(2),sl(3))) affine(tensor(sl(4),sl(2))) affine(sl(2,Q(-1,3))+sl(1,Q(-1,3))) affine(sl(2,Q(-1,3)))
affine(sl(1,Q(-1,3))) affine(sl(2,Q(sqrt(2)))) affine(field(-2,0)) affine(field(-2,0,0)) affine(field(1,1,1,1))
affine(e6(-26)) affine(e6(-26)+R) affine(f4) affine(S2(gl(2))) affine(S3(gl(2))) affine(S2(sl(3))) affine(L2(sl(4)))
affine(sym(3)) affine(upper(2)) affine(upper(3)) affine(strict(3)) affine(blocks(so(2),so(3)))
affine(blocks(gl(1),gl(1))) affine(copies(2,so(3))) affine(copies(2,sl(2))) affine(copies(2,spin(7)))
affine(diag(1,-1)) affine(diag(1,2)) affine(spiral(1,1,2)) sym(3;1,1,1) sym(4;2,2) sym(4;2,1,1) sym(4;1,1,1,1)
sym(6;3,3) su(3)/T^2 su(4)/s(u(2)+u(1)+u(1)) sp(3)/u(1)+sp(2) su(3)/u(1;1,2,-3) f4/spin(8) g2/so(4) sl(3)/K
dual(sl(3)/so(3))
"""

PAIR_NAMES = tuple(NAMES.split())


# Subalgebras of linear Lie algebras as stabilizers, and by inclusion of matrices.
#
# Each of these conditions is linear in X, and the X that satisfy it are closed under commutators:
#
#     X W in W for a subspace W,   X v = 0,   X T = T X,   X^T F + F X = 0.

MAX_PERMUTED = 6


def preserving(
    matrices: IntegerArray,
    *,
    subspaces: Sequence[IntegerArray] = (),
    points: Sequence[IntegerArray] = (),
    commuting: Sequence[IntegerArray] = (),
    forms: Sequence[IntegerArray] = (),
) -> IntegerArray:
    """Basis of the combinations of the matrices that satisfy all conditions, as rows (m, dim)."""
    if len(matrices) == 0:
        return np.zeros((0, 0), dtype=np.int64)
    transposed = matrices.transpose(0, 2, 1)
    conditions = [null_space(w) @ matrices @ w.T for w in subspaces]
    conditions += [matrices @ v for v in points]
    conditions += [matrices @ t - t @ matrices for t in commuting]
    conditions += [transposed @ f + f @ matrices for f in forms]
    flat = [c.reshape(len(matrices), prod(c.shape[1:])) for c in conditions]
    system = np.concatenate([np.zeros((len(matrices), 1), dtype=np.int64), *flat], axis=1).T
    return null_space(system[system.any(axis=1)].reshape(-1, len(matrices)))


def first_units(k: int, n: int) -> IntegerArray:
    """The rows (k, n) of the first k unit vectors."""
    return np.eye(n, dtype=np.int64)[:k]


def coordinates(matrices: IntegerArray, elements: IntegerArray) -> IntegerArray | None:
    """Integer rows (m, dim) with the span of elements in a matrix basis, or None if one is not in the span.

    Each row is a positive multiple of the coefficients of one element.
    """
    if matrices.shape[1:] != elements.shape[1:]:
        return None
    if len(elements) == 0 or len(matrices) == 0:
        rows = np.zeros((len(elements), len(matrices)), dtype=np.int64)
        return rows if not elements.any() else None
    flat = matrices.reshape(len(matrices), -1)
    wanted = elements.reshape(len(elements), -1)
    positions = exclusive_entries([_entries(a) for a in matrices], matrices.shape[1])
    if positions is None:
        return _solved(flat, wanted)
    own = flat[range(len(flat)), positions]
    scale = int(np.lcm.reduce(np.abs(own)))
    rows = wanted[:, positions] * (scale // own)
    used = np.flatnonzero(rows.any(axis=0))
    largest = max(np.abs(rows).sum(axis=1).max(initial=0) * np.abs(flat).max(), scale * np.abs(wanted).max(initial=0))
    kind = np.dtype(float if largest < 2**53 else object)  # float64 products below 2^53 are exact, and faster
    product: npt.NDArray[Any] = rows[:, used].astype(kind) @ flat[used].astype(kind)
    return rows if np.array_equal(product, scale * wanted.astype(kind)) else None


def _entries(matrix: IntegerArray) -> dict[tuple[int, int], int]:
    """The non-zero entries of a matrix as {(row, column): value}, row by row."""
    rows, columns = matrix.nonzero()
    return dict(zip(zip(rows.tolist(), columns.tolist(), strict=True), matrix[rows, columns].tolist(), strict=True))


def _solved(flat: IntegerArray, wanted: IntegerArray) -> IntegerArray | None:
    """The coefficients by the linear relations between both families, or None."""
    m, n = len(wanted), len(flat)
    relations = null_space(np.concatenate([flat, wanted]).T)
    free = relations[:, n:]  # the basis is independent, so each wanted element is the free column of one relation
    if len(relations) != m or np.count_nonzero(free) != m:
        return None
    return -np.sign(free.sum(axis=1, keepdims=True)) * relations[:, :n]


def placements(parts: Sequence[IntegerArray], size: int) -> Iterator[IntegerArray]:
    """Matrix bases with the parts as consecutive diagonal blocks on R^size, in any order, from either end."""
    total = sum(part.shape[1] for part in parts)
    if total <= size:
        for order, start in product(_orders(parts), sorted({0, size - total})):
            yield np.concatenate([*in_blocks(order, size, start)])


def _orders(parts: Sequence[IntegerArray]) -> Iterator[Sequence[IntegerArray]]:
    """The different orders of the parts; of more than `MAX_PERMUTED` parts only the given one and its reverse."""
    if len(parts) > MAX_PERMUTED:
        yield parts
        yield parts[::-1]
        return
    kinds = [next(i for i, other in enumerate(parts) if np.array_equal(part, other)) for part in parts]
    for order in dict.fromkeys(permutations(kinds)):
        yield [parts[i] for i in order]


# Parabolic subalgebras of simple real algebras by the crossed nodes of Satake diagrams: ``G/P{1,6}``.
#
# Nodes are numbered from 1, in the order of Bourbaki, in the diagram of the type that `RealForm` gives to the algebra:
# B2 for sp(4,R) and so(3,2), A3 for so(3,3). A node that is joined to another one by an arrow is crossed together with
# it. Black nodes are never crossed. For a complex algebra, regarded as real, the nodes are those of its complex
# diagram.
#
# ``P{k}`` is conjugate to ``Pk`` in sl(n), in su(p,q) with k and n - k crossed, in sp(2n,R) for n > 2, and in so(p,q),
# p + q > 6, for k < min(p, q). In sl(n,H), ``Pk`` is ``P{2k}``, since k counts quaternionic dimensions.


def parabolic_pair(top: Term, bottom: Term) -> Pair:
    """The pair of a simple real algebra and the parabolic subalgebra with given crossed nodes."""
    nodes = crossed_nodes(RealForm.of_name(str(top)))
    crossed = [int(number) for number in bottom.head[2:-1].split(",")]
    chosen = [i for i, together in enumerate(nodes) if set(together) & set(crossed)]
    if sorted(node for i in chosen for node in nodes[i]) != crossed:
        known = ", ".join(crossed_name([together]) for together in nodes) or "none"
        raise CatalogError(f"{top}/{bottom}: the maximal parabolic subalgebras of {top} are {known}")
    algebra = _algebra(str(top))
    return Pair(algebra, algebra.parabolic_subalgebra(chosen), name=f"{top}/{bottom}")


def crossed_nodes(form: RealForm) -> tuple[tuple[int, ...], ...]:
    """For each simple restricted root the nodes, from 1, that are crossed with it."""
    nodes = form.satake.restricted_nodes
    return tuple(tuple(i + 1 for i in (together[:1] if form.is_complex else together)) for together in nodes)


def crossed_name(together: Iterable[tuple[int, ...]]) -> str:
    """The name of a parabolic subalgebra with these crossed nodes."""
    return f"P{{{','.join(map(str, sorted(i for nodes in together for i in nodes)))}}}"


_algebra = lru_cache(maxsize=8)(simple)
"""The algebra with a name: its restricted root spaces are computed once for all its parabolic subalgebras."""


# Named subalgebras H of names ``G/H``: each is the stabilizer of a subspace, a point, a linear map or a form, in the
# coordinates of `liehom.exact.algebra.linear`.

Rows = IntegerArray | None


def parabolic_rows(top: Term, head: str, matrices: IntegerArray) -> IntegerArray:
    """The parabolic subalgebra P, Pk or B of an algebra of matrices, as rows of coefficients (m, dim)."""
    size = matrices.shape[1]
    unit = _units(top)
    k = 1 if head == "P" else 0 if head == "B" else int(head[1:])
    n = size // unit
    subspaces: list[IntegerArray] = []
    if top.head in ("sl", "gl") and k < n:
        subspaces = [first_units(j * unit, size) for j in (range(1, n) if head == "B" else [k])]
    elif top.head == "sp" and top.items[1:] in ((Term("R"),), (Term("C"),)) and 1 <= k <= n // 2:
        subspaces = [first_units(k * unit, size)]
    elif top.head in ("so", "su", "u", "sp") and len(top.items) == 2 and 1 <= k <= min(top.integers()):
        subspaces = [_isotropic(k, unit, size)]
    elif str(top) in ("e6(-26)", "e6(6)") and k == 1:
        subspaces = [families.albert_idempotent(1)[None]]
    elif str(top) == "g2(2)" and k == 1:
        subspaces = [np.eye(7, dtype=np.int64)[list(_split_octonion_units())].sum(axis=0, keepdims=True)]
    else:
        raise CatalogError(f"{top}/{head}: there is no such parabolic subalgebra in the catalogue")
    return preserving(matrices, subspaces=subspaces)


def special_rows(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """The rows (m, dim) of the subalgebra with a name in the rules of this module, or None."""
    results = (rule(top, bottom, matrices) for rule in _RULES)
    return next((rows for rows in results if rows is not None), None)


def _exceptional(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """The stabilizer of coordinate vectors or their sum (idempotents, the identity, an octonion), or None.

    Also of the quaternions among the octonions, for g2/so(4).
    """
    if f"{top}/{bottom}" == "g2/so(4)":
        return preserving(matrices, subspaces=[first_units(3, 7)])
    if f"{top}/{bottom}" == "f4/spin(8)":
        return preserving(matrices, points=list(first_units(3, 27)))
    plus, minus = _split_octonion_units()
    points: dict[str, tuple[int, ...]] = {
        "f4/spin(9)": (0,),
        "f4(-20)/spin(9)": (0,),
        "f4(-20)/spin(8,1)": (1,),
        "f4(4)/spin(5,4)": (0,),
        "e6(-26)/f4": (0, 1, 2),
        "e6(6)/f4(4)": (0, 1, 2),
        "g2/su(3)": (0,),
        "g2(2)/su(2,1)": (plus,),
        "g2(2)/sl(3)": (minus,),
        "spin(7)/g2": (0,),
        "spin(4,3)/g2(2)": (0, 7),  # e0 is a null vector here
        "spin(9)/spin(7)": (0,),
    }
    units = points.get(f"{top}/{bottom}")
    if units is None:
        return None
    point = np.zeros(matrices.shape[1], dtype=np.int64)
    point[list(units)] = 1
    return preserving(matrices, points=[point])


def _unitary(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """The stabilizer of a complex line, for su(p,q)/u(p-1,q) and su(p,q)/u(p,q-1), or None."""
    if top.head != "su" or not isinstance(bottom, Term) or bottom.head != "u":
        return None
    (p, q), below = _signature(top), _signature(bottom)
    size = 2 * (p + q)
    if below == ((p - 1, q) if q == 0 else (p, q - 1)):
        return preserving(matrices, subspaces=_split(size, size - 2))
    return preserving(matrices, subspaces=_split(size, 2)) if below == (p - 1, q) else None


def _special_blocks(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """The stabilizer of summands, for su(n)/s(u(p)+u(q)+...), su(p,q)/s(u(a,b)+u(c,d)), sl(n)/s(gl(p)+...), or None."""
    inner = bottom.items[0] if isinstance(bottom, Term) and bottom.head == "s" and len(bottom.items) == 1 else None
    if not isinstance(inner, Sum) or {t.head for t in inner.terms} - {"u", "gl"}:
        return None
    kind = "u" if top.head == "su" else "gl"
    sizes = [sum(_signature(t)) for t in inner.terms]
    size, unit = matrices.shape[1], _units(top)
    if top.head not in ("su", "sl") or any(t.head != kind for t in inner.terms) or sum(sizes) * unit != size:
        return None
    if top.head == "su" and len(top.items) == 2:
        parts = [_signature(t) for t in inner.terms]
        return _signed_blocks(_signature(top), parts, matrices) if len(parts) == 2 else None
    return preserving(matrices, commuting=[np.diag(np.repeat(range(len(sizes)), [n * unit for n in sizes]))])


def _torus(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """Circles, maximal tori and centralizers of tori in su(n), so(n) and sp(n), or None.

    The circle u(1;w1,...,wn) has these weights; T^n and sp(n)/u(p)+...+sp(q)+... commute with elements of a torus.
    """
    kind, size = top.head, matrices.shape[1]
    if kind not in ("su", "so", "sp") or len(top.items) != 1 or not isinstance(bottom, Term | Sum):
        return None
    unit, turn = (4, families.quaternionic_gl(1)[1]) if kind == "sp" else (2, families.complex_structure(1))
    places = size // unit

    def element(weights: Sequence[int]) -> IntegerArray:
        out = np.zeros((size, size), dtype=np.int64)
        out[: places * unit, : places * unit] = np.kron(np.diag(weights), turn)
        return out

    if isinstance(bottom, Term) and bottom.head == "u" and bottom.items == (1,) and len(bottom.after) == places:
        weights = [int(w) for w in bottom.after]
        return coordinates(matrices, element(weights)[None]) if any(weights) else None
    if isinstance(bottom, Term) and bottom.head.startswith("T^"):
        rows = preserving(matrices, commuting=[element(range(1, places + 1))])
        return rows if f"T^{len(rows)}" == bottom.head else None
    sizes = [_integer(t.items[0]) if len(t.items) == 1 and t.head in ("u", "sp") else 0 for t in terms(bottom)]
    heads = {t.head for t in terms(bottom)}
    if kind != "sp" or "u" not in heads or not all(sizes) or sum(sizes) != places:
        return None
    labels = np.repeat(range(len(sizes)), 4 * np.array(sizes, dtype=np.int64)).astype(np.int64)
    circles = [int(t.head == "u") for t, n in zip(terms(bottom), sizes, strict=True) for _ in range(n)]
    return preserving(matrices, commuting=[np.diag(labels), element(circles)])


def _signed_blocks(signature: tuple[int, int], parts: Sequence[tuple[int, int]], matrices: IntegerArray) -> Rows:
    """The stabilizer in su(p,q) of two summands with these signatures, where u(n) is (n, 0) or (0, n), or None."""
    first, second = ([part, part[::-1]] if part[1] == 0 else [part] for part in parts)
    fitting = [one for one, two in product(first, second) if (one[0] + two[0], one[1] + two[1]) == signature]
    if not fitting:
        return None
    (p, q), (a, b) = signature, fitting[0]
    inside = np.repeat([1, 0, 1, 0], [2 * a, 2 * (p - a), 2 * b, 2 * (q - b)]).astype(bool)
    one = np.eye(2 * (p + q), dtype=np.int64)
    return preserving(matrices, subspaces=[w for w in (one[inside], one[~inside]) if len(w)])


def _symmetric(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """Stabilizers for su(n)/so(n), sp(n)/u(n), sp(2n,R)/u(n), sp(2n,R)/gl(n), sp(2n,R)/sp(2p,R)+sp(2q,R), or None.

    Also for su(2n)/sp(n) with signatures, so*(2n)/u(n), and a complex algebra over a real form: sl(n,C)/sl(n),
    so(n,C)/so(n), sp(2n,C)/sp(2n,R), sp(2n,C)/sp(n).
    """
    if isinstance(bottom, Sum):
        return _symplectic_sum(top, bottom, matrices)
    size = matrices.shape[1]
    ground = top.items[1:]
    real_symplectic = top.head == "sp" and ground == (Term("R"),)
    if (top.head == "su" and bottom == Term("so", top.items)) or (
        ground == (Term("C"),) and bottom in _real_forms(top)
    ):
        conjugation = np.diag(np.tile(np.array([1, -1], dtype=np.int64), size // 2))
        return preserving(matrices, commuting=[conjugation])
    if top.head == "su" and bottom == _halved(top):
        turn = np.array([[0, -1], [1, 0]], dtype=np.int64)  # with the conjugation: (z, w) -> (-conj w, conj z)
        antilinear = np.kron(np.eye(size // 4, dtype=np.int64), np.kron(turn, np.diag([1, -1])))
        return preserving(matrices, commuting=[antilinear])
    half = (_integer(top.items[0]) // 2 if top.items else 0,)
    if (
        (top.head == "so*" and bottom == Term("u", half))
        or (top.head == "sp" and ground == (Term("C"),) and bottom == Term("sp", half))
        or (real_symplectic and bottom == Term("u", (size // 2,)))
    ):
        return preserving(matrices, forms=[np.eye(size, dtype=np.int64)])
    if top.head == "sp" and not real_symplectic and bottom == Term("u", top.items):
        left = families.quaternionic_gl(1)[1]
        return preserving(matrices, commuting=[np.kron(np.eye(size // 4, dtype=np.int64), left)])
    if real_symplectic and bottom == Term("gl", (size // 2,)):
        return preserving(matrices, subspaces=_split(size, size // 2))
    return None


def _halved(top: Term) -> Term | None:
    """sp(p/2, q/2) for su(p, q) with even p and q."""
    values = tuple(map(_integer, top.items))
    return None if any(x % 2 for x in values) else Term("sp", tuple(x // 2 for x in values))


def _real_forms(top: Term) -> list[Term]:
    """The algebras of real matrices in sl(n,C), so(n,C) or sp(2n,C)."""
    n = top.items[:1]
    return {"sl": [Term("sl", n)], "so": [Term("so", n)], "sp": [Term("sp", (*n, Term("R")))]}.get(top.head, [])


def _symplectic_sum(top: Term, bottom: Sum, matrices: IntegerArray) -> Rows:
    size = matrices.shape[1]
    split = [t.items[0] for t in terms(bottom) if t.head == "sp" and t.items[1:] == (Term("R"),)]
    if top.head != "sp" or top.items[1:] != (Term("R"),) or len(split) != 2 or len(bottom.terms) != 2:
        return None
    p = split[0]
    if not isinstance(p, int) or p % 2 or p + _integer(split[1]) != size:
        return None
    one = np.eye(size, dtype=np.int64)
    first = [*range(p // 2), *range(size // 2, size // 2 + p // 2)]
    return preserving(matrices, subspaces=[one[first], one[[i for i in range(size) if i not in first]]])


_RULES: Sequence[Callable[[Term, Expression, IntegerArray], Rows]] = (
    _exceptional, _unitary, _special_blocks, _torus, _symmetric,
)  # fmt: skip


def _units(top: Term) -> int:
    """The real dimension of the scalars of a classical algebra: 1, 2 or 4."""
    return int(2 ** len(scalar_parameters(top)))


def _integer(value: object) -> int:
    return value if isinstance(value, int) else 0


def _signature(term: Term) -> tuple[int, int]:
    values = [_integer(x) for x in term.items]
    return values[0], (values[1] if len(values) == 2 else 0)


def _split(size: int, k: int) -> list[IntegerArray]:
    """The coordinate subspaces of the first k and of the other coordinates, without empty ones."""
    one = np.eye(size, dtype=np.int64)
    return [w for w in (one[:k], one[k:]) if len(w)]


def _isotropic(k: int, unit: int, size: int) -> IntegerArray:
    """Rows of the scalar span of e_i + e_(n-1-i), i < k, which is isotropic for diag(1, ..., 1, -1, ..., -1)."""
    one = np.eye(size // unit, dtype=np.int64)
    return np.kron((one + one[::-1])[:k], np.eye(unit, dtype=np.int64))


def _split_octonion_units() -> tuple[int, int]:
    """Imaginary units (counted from 0) of positive and of negative norm in the split octonions."""
    norm = families.norm_diagonal(families.octonion_table(families.SPLIT_OCTONIONS))[1:].tolist()
    return norm.index(1), norm.index(-1)


# affine(H)       H + R^N over H                       sym(n;m1,m2,...)   so(n), a symmetric matrix with multiplicities
# G/0, G/G        trivial ones                         e(n)/so(n), iso(p,q)/so(p,q), galilei(n)/so(n), aff(n)/gl(n),
#                 bargmann(n)/so(n), schroedinger(n)/so(n), R^n/R^m, heisenberg(n)/R
# G/Pk, G/P       the stabilizer of a k-dimensional subspace over the scalars, isotropic if G preserves a form; P = P1;
#                 in e6 the stabilizer of the line of an idempotent, in g2(2) of a null line
# G/P{i,j,...}    the parabolic subalgebra of a simple real algebra with these nodes of the Satake diagram crossed
# G/B             in sl(n) and gl(n) the stabilizer of a complete flag
# G/K, G/T^r      a maximal compact subalgebra of semisimple G; the maximal torus of compact G of rank r
# dual(G/H)       the dual of a symmetric pair: with the other sign of [m, m]
# G/H             the subalgebra in the table of `special`; otherwise H as diagonal blocks of the matrices of G

_ROTATING = ("e", "iso", "galilei", "bargmann", "schroedinger")
"""Families whose first basis elements are those of so(n) or so(p,q)."""


def pair(name: str) -> Pair:
    """The pair with a catalogue name.

    It is named by the canonical form of the given name; its repr is the call that constructs it.

    Parameters
    ----------
    name : str
        Such as 'so(4)/so(3)', 'SU(3)/T^2', 'sl(3)/P1', 'affine(spin(9,1)+R)', 'sym(4;3,1)', or the name of a space
        such as 'CP^3', 'Gr(2,C^5)', 'V(2,5)', 'W(1,2)'; `pair_names` lists one of each kind; other sizes are valid too.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.pair("so(4)/so(3)"), lh.pair("sl(3, R)/P1").name
    (pair('so(4)/so(3)'), 'sl(3)/P1')
    >>> lh.pair("CP^3"), lh.pair("Fl(1,2;C^3)").name
    (pair('su(4)/u(3)'), 'su(3)/s(u(1)+u(1)+u(1))')
    >>> lh.pair("so(4)/so(5)")
    Traceback (most recent call last):
    ...
    liehom.base.errors.CatalogError: 'so(4)/so(5)' is not the name of a pair in the catalogue; the nearest are ...
    """
    tree = parse(name)
    result = None
    if isinstance(tree, Quotient):
        result = _quotient(tree)
    elif isinstance(tree, Term) and tree.head == "affine":
        result = _affine(tree)
    elif isinstance(tree, Term) and tree.head == "sym" and tree.after:
        result = _sym_pair(tree)
    elif isinstance(tree, Term) and tree.head == "dual" and not tree.after:
        result = _dual_pair(tree)
    if result is None:
        raise unknown(str(tree), PAIR_NAMES, "pair")
    return result


def pair_names() -> tuple[str, ...]:
    """Names of pairs of every kind, full pairs first.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.pair_names()[:2]
    ('so(2)/so(1)', 'so(3)/so(2)')
    """
    return PAIR_NAMES


def _spanned(algebra: LieAlgebra, rows: IntegerArray, name: object, *, check: bool = False) -> Pair:
    """The pair of an algebra and the span of rows; `check` proves that the span is a subalgebra."""
    matrix = algebra.field.from_integers(rows.ravel().tolist(), len(rows), algebra.dimension)  # type: ignore[attr-defined]
    return Pair(algebra, Subalgebra(algebra, matrix, check=check), name=None if name is None else str(name))


def _affine(tree: Term) -> Pair | None:
    if len(tree.items) != 1 or isinstance(tree.items[0], int | Fraction) or tree.after or not is_linear(tree.items[0]):
        return None
    spiral = irrational_spiral(tree.items[0])
    if spiral is not None:
        matrices, j, square, frequency = spiral
        return spiral_pair(matrices, j, number_field(f"sqrt({square})"), f"sqrt({square})", frequency, str(tree))
    matrices = linear_matrices(tree.items[0])
    algebra = affine_algebra(matrices, str(tree))
    # no check: the linear part of an affine algebra is a subalgebra
    return _spanned(algebra, first_units(len(matrices), algebra.dimension), tree)


def spiral_pair(
    matrices: IntegerArray,
    j: IntegerArray,
    field: ExactField,
    growth: ScalarLike,
    frequency: ScalarLike,
    name: str | None,
) -> Pair:
    """X + K (a + bJ) on K^N with the translations, for matrices X that commute with J and a, b in a field K."""
    size = j.shape[0]
    read = [field.from_integers(a.ravel().tolist(), size, size) for a in (*matrices, j)]
    spiral = field.identity(size).scale(growth) + read.pop().scale(frequency)
    # no check: the matrices commute with the spiral and are a basis of their span
    h = direct_sum(linear_lie_algebra(matrices), abelian(1)).over(field)
    algebra = semidirect_sum(h, [*read, spiral], size=size, name=name, check=False)
    return _spanned(algebra, first_units(len(matrices) + 1, algebra.dimension), name)


def _sym_pair(tree: Term) -> Pair:
    """so(n) with the stabilizer of diag(1, ..., 1, 2, ..., 2, ...) in the symmetric matrices."""
    (n,) = tree.integers() if len(tree.items) == 1 else (0,)
    multiplicities = [int(m) for m in tree.after]
    if n < 1 or any(m < 1 for m in multiplicities) or sum(multiplicities) != n:
        raise CatalogError(f"sym(n;m1,m2,...) needs positive multiplicities with sum n; got {tree}")
    matrices = linear_matrices(Term("so", (n,)))
    point = np.diag(np.repeat(np.arange(1, len(multiplicities) + 1), multiplicities))
    rows = preserving(matrices, commuting=[point])
    return _spanned(linear_lie_algebra(matrices, f"so({n})"), rows, tree)  # a stabilizer


def _dual_pair(tree: Term) -> Pair:
    """The dual of a symmetric pair (g, h): the algebra h + m with the other sign of [m, m], over h."""
    inner = pair("/".join(map(str, tree.items)))
    rows, k = inner.subalgebra.rows(), inner.subalgebra.dimension
    if not inner.field.exact or not inner.is_reductive():
        raise CatalogError(f"{tree}: {inner.name} has no invariant complement, so it is not symmetric")
    g = inner.algebra.change_of_basis([*rows, *inner.reductive_complement().rows()]) if inner.dimension else None
    if g is None or any(i >= k and l >= k for i, _, l, _ in g.table):
        raise CatalogError(f"{tree}: {inner.name} is not a symmetric pair")
    brackets: dict[tuple[int, int], dict[int, Any]] = {}
    for i, j, l, c in g.table:
        brackets.setdefault((i, j), {})[l] = -c if i >= k else c
    # no check: h + im in the complexification of g
    return _spanned(
        LieAlgebra(brackets, g.field, dimension=g.dimension, check=False), first_units(k, g.dimension), tree
    )


def _compact_part(top: Expression, bottom: Expression) -> Pair:
    """The pair of an algebra and K, its maximal compact subalgebra, or T^r, the maximal torus if it is compact."""
    algebra, name = algebra_of(top), f"{top}/{bottom}"
    if str(bottom) == "K":
        if not algebra.is_semisimple():
            raise CatalogError(f"{name}: K is the maximal compact subalgebra of a semisimple algebra")
        inside = algebra.cartan_decomposition().k
        if inside.algebra.field != algebra.field:
            raise CatalogError(f"{name}: no maximal compact subalgebra is over {algebra.field.name} in this basis")
        return Pair(algebra, inside, name=name)
    inside = algebra.cartan_subalgebra()
    if algebra.killing_signature() != (0, algebra.dimension, 0) or str(bottom) != f"T^{inside.dimension}":
        raise CatalogError(f"{name}: T^r is the maximal torus of a compact semisimple algebra of rank r")
    return Pair(algebra, inside, name=name)


def _quotient(tree: Quotient) -> Pair | None:
    top, bottom = tree.top, tree.bottom
    if isinstance(bottom, Term) and bottom.head.startswith("P{"):
        return parabolic_pair(top, bottom) if isinstance(top, Term) else None
    torus = isinstance(bottom, Term) and re.fullmatch(r"K|T\^\d+", bottom.head) is not None
    plain = _not_linear(top, bottom)
    if plain is not None:
        return _spanned(*plain, tree)
    if not is_linear(top):
        return _compact_part(top, bottom) if torus else None
    matrices = linear_matrices(top)
    algebra = algebra_of(top) if isinstance(top, Term) and is_family(top) else linear_lie_algebra(matrices, str(top))
    rows = _rows(top, bottom, matrices)
    if rows is not None:
        return _spanned(algebra, rows, tree)  # no check: the stabilizer of something, see `preserving`
    if torus:
        return _compact_part(top, bottom)
    rows = _included(matrices, bottom)
    return None if rows is None else _spanned(algebra, rows, tree, check=True)


def _rows(top: Expression, bottom: Expression, matrices: IntegerArray) -> IntegerArray | None:
    """The rows of a subalgebra that is the stabilizer of something, or None."""
    if bottom == Term("0"):
        return np.zeros((0, len(matrices)), dtype=np.int64)
    if not isinstance(top, Term):
        return None
    if isinstance(bottom, Term) and not bottom.items and re.fullmatch(r"P\d*|B", bottom.head):
        return parabolic_rows(top, bottom.head, matrices)
    return special_rows(top, bottom, matrices)


def _included(matrices: IntegerArray, bottom: Expression) -> IntegerArray | None:
    """The rows of the subalgebra whose matrices are diagonal blocks of the algebra, in some order, or None."""
    if not is_linear(bottom):
        return None
    with suppress(CatalogError):  # if the sum means blocks, not an algebra with scalars
        rows = coordinates(matrices, linear_matrices(bottom))
        if rows is not None:
            return rows
    parts = [linear_matrices(t) for t in terms(bottom)]
    solved = (coordinates(matrices, placed) for placed in placements(parts, matrices.shape[1]))
    return next((rows for rows in solved if rows is not None), None)


def _not_linear(top: Expression, bottom: Expression) -> tuple[LieAlgebra, IntegerArray] | None:
    """Abelian, Euclidean, affine and Heisenberg algebras with the rows of a named subalgebra, or None."""
    if not isinstance(top, Term) or not isinstance(bottom, Term):
        return None
    known = top.head in ("0", "R", "heisenberg", "aff", "affine", *_ROTATING) or top.head.startswith("R^")
    if not known or (top.head == "R" and bottom.head not in ("0", "R")):
        return None
    algebra = algebra_of(top)
    n = algebra.dimension
    linear = {"aff": Term("gl", top.items)}.get(top.head, canonical(Term("so", top.items)))
    if (
        bottom.head == "0"
        or (top.head[0] in "0R" and bottom.head[0] == "R" and algebra_of(bottom).dimension <= n)
        or (top.head in (*_ROTATING, "aff") and bottom == linear)
        or (str(top) == "aff(1)" and bottom == Term("R"))
        or (top.head == "affine" and top.items == (bottom,))
    ):
        return algebra, first_units(algebra_of(bottom).dimension, n)
    return (algebra, first_units(n, n)[-1:]) if top.head == "heisenberg" and bottom == Term("R") else None


# All full pairs of a given dimension, by the classification: a pair for each row, a family for each row of spirals.


@final
@dataclass(frozen=True, slots=True)
class SpiralFamily:
    """The full pairs with isotropy S + R(J + c), c > 0: one for each c, all with the same S.

    Attributes
    ----------
    name : str
        Such as 'affine(su(3)+spiral(c,1))'; with a number or a square root for c it is the name of a pair.
    key : Key
        The key of all members, without the parameter c^2.
    space : str

    Examples
    --------
    >>> import liehom as lh
    >>> family = next(x for x in lh.full_pairs(6) if isinstance(x, SpiralFamily))
    >>> family.name, family.pair("1/2")
    ('affine(su(3)+spiral(c,1))', pair('affine(su(3)+spiral(1/2,1))'))
    """

    name: str
    key: Key
    space: str

    def pair(self, c: ScalarLike) -> Pair:
        """The member with this c > 0, over the smallest of the fields QQ, QQ(c) with c^2 rational, and the field of c.

        Parameters
        ----------
        c : rational number, string such as 'sqrt(2)', or element of a number field

        Examples
        --------
        >>> import liehom as lh
        >>> family = next(x for x in lh.full_pairs(2) if isinstance(x, SpiralFamily))
        >>> c = lh.number_field("sqrt(2)").convert("1 + sqrt(2)")
        >>> lh.classify(family.pair(c)).space
        'affine space R^2 under R(J+c), c^2 = 3 + 2*sqrt(2)'
        """
        field = c.field if isinstance(c, AlgebraicNumber) else common_field([c]) if isinstance(c, str) else QQ
        value = field.convert(c)
        if field.sign(value) <= 0:
            raise InputError(f"c must be positive, got {displayed(c)}; -c gives an isomorphic pair, 0 another row")
        text = square_root(value * value)
        if text is not None:
            return pair(self.name.replace("(c,1)", f"({text},1)"))
        isotropy = self.name.removeprefix("affine(").replace("(c,1))", "(sqrt(2),1)")
        if (parts := irrational_spiral(parse_expression(isotropy))) is None:
            raise InternalError(f"{self.name} is not the name of a family of spirals")
        return spiral_pair(parts[0], parts[1], field, value, 1, None)


def full_pairs(d: int) -> tuple[Pair | SpiralFamily, ...]:
    """All full pairs (g, h) with dim g/h = d for which h contains no ideal of g: one for each row, spirals as families.

    Affine spaces come first, then |1|-graded g, then compact isotropy. All other pairs are extensions of these by an
    ideal inside h.

    docs/theory/classification.md has the theorem.

    Examples
    --------
    >>> import liehom as lh
    >>> [x.name for x in lh.full_pairs(3)]  # doctest: +NORMALIZE_WHITESPACE
    ['affine(so(3))', 'affine(so(3)+R)', 'affine(sl(3))', 'affine(sl(3)+R)', 'sl(4)/P1', 'so(4,1)/P', 'so(4)/so(3)',
     'so(3,1)/so(3)']
    >>> len(lh.full_pairs(8))
    47
    """
    return tuple(SpiralFamily(row.name, row.key, row.space) if row.is_family else pair(row.name) for row in rows(d))
