"""The public conformance suite: what every algebra, representation, pair and certificate must satisfy.

Each check tests the axioms on random elements, by other code than that which constructs the objects, and
that writing and reading and changing the basis lose nothing.  A failure raises `ConformanceError`, whose
attribute `check` names what failed.  Random choices come from a generator that the caller may seed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from typing import Any

from liehom.algebra import LieAlgebra
from liehom.errors import CertificateError, ConformanceError, LiehomError
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.checker.verify import verify_certificate
from liehom.fullness.decide import decide_fullness
from liehom.io import from_json, to_json
from liehom.representations.core.pair import Pair
from liehom.representations.core.representation import Representation
from liehom.testing.numerical import check_order as check_order
from liehom.testing.numerical import check_space as check_space

TOLERANCE = 1e-6
DENSE_DIMENSION = 80


def random_unimodular(n: int, rng: random.Random, operations: int | None = None) -> list[list[int]]:
    """A random integer matrix of determinant 1 or -1: a permutation with signs, and elementary row operations.

    Parameters
    ----------
    n : int
    rng : random.Random
    operations : int, optional
        How many row operations; by default 3 n where n is at most 80, which makes the matrix dense, else n.

    Returns
    -------
    list of list of int

    Examples
    --------
    >>> import random
    >>> from liehom.scalars import QQ
    >>> abs(QQ.matrix(random_unimodular(4, random.Random(1))).determinant())
    1
    """
    order = list(range(n))
    rng.shuffle(order)
    rows = [[rng.choice((-1, 1)) if j == order[i] else 0 for j in range(n)] for i in range(n)]
    count = (3 * n if n <= DENSE_DIMENSION else n) if operations is None else operations
    for _ in range(count if n > 1 else 0):
        i, j = rng.sample(range(n), 2)
        sign = rng.choice((-1, 1))
        rows[i] = [a + sign * b for a, b in zip(rows[i], rows[j], strict=True)]
    return rows


def check_lie_algebra(algebra: LieAlgebra, *, trials: int = 3, rng: random.Random | None = None) -> None:
    """Check the axioms, the Killing form, a change of basis and the file format of a Lie algebra.

    Parameters
    ----------
    algebra : LieAlgebra
    trials : int
        How many random triples of elements.
    rng : random.Random, optional

    Raises
    ------
    ConformanceError

    Examples
    --------
    >>> import liehom as lh
    >>> check_lie_algebra(lh.LieAlgebra({(0, 1): {1: 1}}))
    """
    rng = rng or random.Random(0)
    n, field = algebra.dimension, algebra.field
    killing = algebra.killing_form()
    _require(_same(field, killing, killing.T), "killing form", "it is not symmetric")
    for _ in range(trials if n else 0):
        x, y, z = (_random_row(field, n, rng) for _ in range(3))
        xy, yz, zx = (_bracket(algebra, a, b) for a, b in ((x, y), (y, z), (z, x)))
        _require(_is_zero(field, xy + _bracket(algebra, y, x)), "antisymmetry", "[x, y] + [y, x] is not 0")
        cyclic = _bracket(algebra, xy, z) + _bracket(algebra, yz, x) + _bracket(algebra, zx, y)
        _require(_is_zero(field, cyclic), "Jacobi", "[[x, y], z] + [[y, z], x] + [[z, x], y] is not 0")
        invariance = xy @ killing @ z.T - x @ killing @ yz.T
        _require(_is_zero(field, invariance), "killing form", "B([x, y], z) and B(x, [y, z]) differ")
    if field.exact:
        rows = field.matrix(random_unimodular(n, rng), (n, n))
        back = algebra.change_of_basis(rows).change_of_basis(rows.inverse())
        _require(back == algebra, "change of basis", "changing the basis and back gives another table")
    read = from_json(to_json(Pair(algebra, [])))
    _require(isinstance(read, Pair) and read.algebra == algebra, "file", "writing and reading gives another table")


def check_representation(representation: Representation, *, trials: int = 3, rng: random.Random | None = None) -> None:
    """Check that a representation respects the bracket, and its isotropy subalgebras.

    Raises
    ------
    ConformanceError

    Examples
    --------
    >>> import liehom as lh
    >>> check_representation(lh.Representation.from_matrices([[[0, -1], [1, 0]]]))
    """
    rng = rng or random.Random(0)
    algebra, field, size = representation.algebra, representation.field, representation.size
    n = algebra.dimension
    _require(len(representation.matrices) == n, "shape", f"{len(representation.matrices)} matrices for dimension {n}")
    _require(all(a.shape == (size, size) for a in representation.matrices), "shape", "the matrices are not N x N")
    for _ in range(trials if n else 0):
        x, y = _random_row(field, n, rng), _random_row(field, n, rng)
        a, b = representation(x.row(0)), representation(y.row(0))
        c = representation(_bracket(algebra, x, y).row(0))
        _require(_is_zero(field, a @ b - b @ a - c), "bracket", "rho([x, y]) and [rho(x), rho(y)] differ")
        point = _random_row(field, size, rng)
        _check_isotropy(representation, point.row(0))
    _check_isotropy(representation, [0] * size)


def _check_isotropy(representation: Representation, point: list[Any]) -> None:
    field, n = representation.field, representation.algebra.dimension
    isotropy = representation.isotropy(point)
    column = field.matrix([point], (1, representation.size)).T
    for row in isotropy.rows():
        _require(_is_zero(field, representation(row) @ column), "isotropy", "an element of it moves the point")
    orbit = representation.orbit_dimension(point)
    _require(orbit + isotropy.dimension == n, "orbit", f"{orbit} + {isotropy.dimension} is not dim g = {n}")


def check_pair(pair: Pair, *, trials: int = 3, rng: random.Random | None = None) -> None:
    """Check a pair: its algebra, the closure of h, the isotropy representation, the file format.

    Raises
    ------
    ConformanceError

    Examples
    --------
    >>> import liehom as lh
    >>> check_pair(lh.Pair(lh.LieAlgebra({(0, 1): {1: 1}}), [[1, 0]]))
    """
    rng = rng or random.Random(0)
    algebra, h, field = pair.algebra, pair.subalgebra, pair.field
    check_lie_algebra(algebra, trials=trials, rng=rng)
    _require(h.basis.rank() == h.dimension, "basis", "the rows of h are dependent")
    projection = h.quotient().projection
    _require(_is_zero(field, h.basis @ projection), "quotient", "the projection to g/h does not vanish on h")
    data = h.quotient()
    matrices = pair.isotropy_matrices()
    _require(len(matrices) == h.dimension, "isotropy", f"{len(matrices)} matrices for dim h = {h.dimension}")
    for _ in range(trials if h.dimension else 0):
        a, b = rng.randrange(h.dimension), rng.randrange(h.dimension)
        x, y = (data.subspace.select(rows=[i]) for i in (a, b))
        bracket = _bracket(algebra, x, y)
        _require(_is_zero(field, bracket @ projection), "closure", f"the bracket of rows {a} and {b} leaves h")
        if pair.dimension:
            lifted = _random_row(field, pair.dimension, rng) @ data.lift
            outer = _bracket(algebra, bracket, lifted) @ projection
            coordinates = (lifted @ projection).T
            inner = (matrices[a] @ matrices[b] - matrices[b] @ matrices[a]) @ coordinates
            _require(_is_zero(field, outer.T - inner), "isotropy", "rho([x, y]) and [rho(x), rho(y)] differ on g/h")
    read = from_json(to_json(pair))
    _require(read == pair, "file", "writing and reading gives another pair")


def check_certificate(
    pair: Pair,
    certificate: Certificate | Mapping[str, Any],
    *,
    bases: int = 1,
    rng: random.Random | None = None,
) -> None:
    """Check a certificate: it verifies, survives writing and reading, and the verdict does not depend on the basis.

    Parameters
    ----------
    pair : Pair
        Over an exact field.
    certificate : Certificate or its JSON object
    bases : int
        In how many random unimodular bases of g the pair is decided again.
    rng : random.Random, optional

    Raises
    ------
    ConformanceError

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.Pair(lh.LieAlgebra({(0, 1): {1: 1}}), [[1, 0]])
    >>> check_certificate(pair, lh.decide_fullness(pair).certificate)
    """
    rng = rng or random.Random(0)
    certificate = certificate if isinstance(certificate, Certificate) else Certificate.from_json(certificate)
    _holds(lambda: verify_certificate(pair, certificate), "verification")
    again = Certificate.from_json(certificate.to_json())
    _require(again == certificate, "file", "writing and reading gives another certificate")
    if pair.dimension > 1:
        try:
            accepted = verify_certificate(pair, Certificate("trivial", {}, certificate.field))
        except CertificateError:
            accepted = False
        _require(not accepted, "control", "the checker accepts an empty certificate")
    n = pair.algebra.dimension
    for _ in range(bases):
        moved = pair.change_of_basis(random_unimodular(n, rng))
        verdict = decide_fullness(moved)
        _require(verdict.full == certificate.full, "invariance", "the verdict changes with the basis")
        _holds(verdict.verify, "invariance")


# -- helpers ---------------------------------------------------------------------------------------------
def _require(holds: bool, check: str, message: str) -> None:
    if not holds:
        raise ConformanceError(check, message)


def _holds(action: Callable[[], Any], check: str) -> None:
    try:
        action()
    except LiehomError as error:
        raise ConformanceError(check, str(error)) from error


def _random_row(field: Any, n: int, rng: random.Random) -> Any:
    return field.matrix([[rng.randint(-3, 3) for _ in range(n)]], (1, n))


def _bracket(algebra: LieAlgebra, x: Any, y: Any) -> Any:
    """[x, y] entry by entry from the table: other code than the contractions that the library uses."""
    field, n = algebra.field, algebra.dimension
    a, b = x.row(0), y.row(0)
    total = [field.zero] * n
    for i, j, k, value in algebra.structure_constants():
        total[k] = total[k] + value * (a[i] * b[j] - a[j] * b[i])
    return field.from_entries(total, 1, n)


def _is_zero(field: Any, matrix: Any) -> bool:
    if field.exact:
        return bool(matrix.is_zero())
    return bool(abs(matrix.array).max(initial=0.0) < TOLERANCE)


def _same(field: Any, left: Any, right: Any) -> bool:
    return _is_zero(field, left - right)
