"""Named subalgebras H of names ``G/H``: parabolics, symmetric subalgebras, stabilizers of octonions.

Each is the stabilizer of a subspace, a point, a linear map or a form, in the coordinates of `liehom.algebra.matrices`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np

from liehom.algebra import matrices as families
from liehom.catalog.linear import scalar_parameters
from liehom.catalog.names import Expression, Sum, Term, terms
from liehom.catalog.subalgebras import preserving
from liehom.errors import CatalogError
from liehom.typing import IntegerArray

Rows = IntegerArray | None


def parabolic_rows(top: Term, head: str, matrices: IntegerArray) -> IntegerArray:
    """The parabolic subalgebra P, Pk or B of an algebra of matrices, as rows of coefficients (m, dim).

    Raises
    ------
    CatalogError
        If the catalogue has no such parabolic subalgebra.
    """
    size = matrices.shape[1]
    unit = _units(top)
    k = 1 if head == "P" else 0 if head == "B" else int(head[1:])
    n = size // unit
    if top.head in ("sl", "gl") and k < n:
        steps = range(1, n) if head == "B" else [k]
        return preserving(matrices, subspaces=[_leading(j * unit, size) for j in steps])
    if top.head == "sp" and top.items[1:] in ((Term("R"),), (Term("C"),)) and 1 <= k <= n // 2:
        return preserving(matrices, subspaces=[_leading(k * unit, size)])
    if top.head in ("so", "su", "u", "sp") and len(top.items) == 2:
        index = min(top.integers())
        if 1 <= k <= index:
            return preserving(matrices, subspaces=[_isotropic(k, unit, size)])
    if str(top) in ("e6(-26)", "e6(6)") and k == 1:
        return preserving(matrices, subspaces=[families.albert_idempotent(1)[None]])
    if str(top) == "g2(2)" and k == 1:
        plus, minus = _split_octonion_units()
        return preserving(matrices, subspaces=[(_axis(plus, 7) + _axis(minus, 7))[None]])
    raise CatalogError(f"{top}/{head}: there is no such parabolic subalgebra in the catalogue")


def special_rows(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """The rows (m, dim) of the subalgebra with a name in the rules of this module, or None."""
    found = _exceptional(f"{top}/{bottom}", matrices)
    for rule in _RULES:
        if found is None:
            found = rule(top, bottom, matrices)
    return found


def _exceptional(name: str, matrices: IntegerArray) -> Rows:
    """The stabilizer of a sum of coordinate vectors (idempotents, the identity, an octonion), or None."""
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
    if name not in points:
        return None
    point = np.zeros(matrices.shape[1], dtype=np.int64)
    point[list(points[name])] = 1
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
    """The stabilizer of two summands, for su(p,q)/s(u(a,b)+u(c,d)) and sl(n)/s(gl(p)+gl(q)), or None."""
    inner = bottom.items[0] if isinstance(bottom, Term) and bottom.head == "s" and len(bottom.items) == 1 else None
    if not isinstance(inner, Sum) or len(inner.terms) != 2 or {t.head for t in inner.terms} - {"u", "gl"}:
        return None
    kind = "u" if top.head == "su" else "gl"
    sizes = [sum(_signature(t)) for t in inner.terms]
    size, unit = matrices.shape[1], _units(top)
    if top.head not in ("su", "sl") or any(t.head != kind for t in inner.terms) or sum(sizes) * unit != size:
        return None
    if top.head == "su" and len(top.items) == 2:
        return _signed_blocks(_signature(top), [_signature(t) for t in inner.terms], matrices)
    return preserving(matrices, subspaces=_split(size, sizes[0] * unit))


def _signed_blocks(whole: tuple[int, int], parts: Sequence[tuple[int, int]], matrices: IntegerArray) -> Rows:
    """The stabilizer in su(p,q) of two summands with given signatures, where u(n) is (n, 0) or (0, n), or None."""
    first, second = ([part, part[::-1]] if part[1] == 0 else [part] for part in parts)
    fitting = [one for one, two in product(first, second) if (one[0] + two[0], one[1] + two[1]) == whole]
    if not fitting:
        return None
    (p, q), (a, b) = whole, fitting[0]
    inside = np.repeat([1, 0, 1, 0], [2 * a, 2 * (p - a), 2 * b, 2 * (q - b)]).astype(bool)
    one = np.eye(2 * (p + q), dtype=np.int64)
    return preserving(matrices, subspaces=[w for w in (one[inside], one[~inside]) if len(w)])


def _symmetric(top: Term, bottom: Expression, matrices: IntegerArray) -> Rows:
    """Stabilizers for su(n)/so(n), sp(n)/u(n), sp(2n,R)/u(n), sp(2n,R)/gl(n), sp(2n,R)/sp(2p,R)+sp(2q,R), or None.

    Also for su(2n)/sp(n) with signatures, so*(2n)/u(n), and a complex algebra over a real form: sl(n,C)/sl(n),
    so(n,C)/so(n), sp(2n,C)/sp(2n,R), sp(2n,C)/sp(n).
    """
    size = matrices.shape[1]
    if isinstance(bottom, Sum):
        return _symplectic_sum(top, bottom, matrices)
    real_symplectic = top.head == "sp" and top.items[1:] == (Term("R"),)
    conjugation = np.diag(np.tile(np.array([1, -1], dtype=np.int64), size // 2))
    if top.head == "su" and bottom == Term("so", top.items):
        return preserving(matrices, commuting=[conjugation])
    if top.head == "su" and bottom == _halved(top):
        turn = np.array([[0, -1], [1, 0]], dtype=np.int64)  # with the conjugation: (z, w) -> (-conj w, conj z)
        antilinear = np.kron(np.eye(size // 4, dtype=np.int64), np.kron(turn, np.diag([1, -1])))
        return preserving(matrices, commuting=[antilinear])
    if top.items[1:] == (Term("C"),) and bottom in _real_forms(top):
        return preserving(matrices, commuting=[conjugation])
    star, complex_symplectic = top.head == "so*", top.head == "sp" and top.items[1:] == (Term("C"),)
    half = Term("u" if star else "sp", (_integer(top.items[0]) // 2 if top.items else 0,))
    if (star or complex_symplectic) and bottom == half:
        return preserving(matrices, forms=[np.eye(size, dtype=np.int64)])
    if top.head == "sp" and not real_symplectic and bottom == Term("u", top.items):
        left = families.quaternionic_gl(1)[1]
        return preserving(matrices, commuting=[np.kron(np.eye(size // 4, dtype=np.int64), left)])
    if real_symplectic and bottom == Term("u", (size // 2,)):
        return preserving(matrices, forms=[np.eye(size, dtype=np.int64)])
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
    rest = [i for i in range(size) if i not in first]
    return preserving(matrices, subspaces=[one[first], one[rest]])


_RULES: Sequence[Callable[[Term, Expression, IntegerArray], Rows]] = (_unitary, _special_blocks, _symmetric)


def _units(top: Term) -> int:
    """The real dimension of the scalars of a classical algebra: 1, 2 or 4."""
    return int(2 ** len(scalar_parameters(top)))


def _integer(value: object) -> int:
    return value if isinstance(value, int) else 0


def _signature(term: Term) -> tuple[int, int]:
    values = [_integer(x) for x in term.items]
    return values[0], (values[1] if len(values) == 2 else 0)


def _axis(i: int, size: int) -> IntegerArray:
    vector: IntegerArray = np.eye(size, dtype=np.int64)[i]
    return vector


def _leading(k: int, size: int) -> IntegerArray:
    """The first k coordinate vectors as rows (k, size)."""
    rows: IntegerArray = np.eye(size, dtype=np.int64)[:k]
    return rows


def _split(size: int, k: int) -> list[IntegerArray]:
    """The coordinate subspaces of the first k and of the other coordinates, without empty ones."""
    one = np.eye(size, dtype=np.int64)
    return [w for w in (one[:k], one[k:]) if len(w)]


def _isotropic(k: int, unit: int, size: int) -> IntegerArray:
    """Rows of the scalar span of e_i + e_(n-1-i), i < k, which is isotropic for diag(1, ..., 1, -1, ..., -1)."""
    n = size // unit
    one = np.eye(n, dtype=np.int64)
    rows = np.array([one[i] + one[n - 1 - i] for i in range(k)])
    return np.kron(rows, np.eye(unit, dtype=np.int64))


def _split_octonion_units() -> tuple[int, int]:
    """Imaginary units (counted from 0) of positive and of negative norm in the split octonions."""
    norm = families.norm_diagonal(families.octonion_table(families.SPLIT_OCTONIONS))[1:].tolist()
    return norm.index(1), norm.index(-1)
