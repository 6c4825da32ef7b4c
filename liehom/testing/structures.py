"""Checks of algebras, representations, pairs and certificates on random elements."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from liehom.algebra import LieAlgebra
from liehom.errors import CertificateError, ConformanceError, LiehomError
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.checker.verify import verify_certificate
from liehom.fullness.decide import decide_fullness
from liehom.io import from_json, to_json
from liehom.representations.core.pair import Pair
from liehom.representations.core.representation import Representation
from liehom.scalars import Field, Matrix
from liehom.testing.requirement import require
from liehom.typing import ScalarLike

DENSE_DIMENSION = 80
"""Largest dimension for which a random unimodular matrix is dense by default."""


def random_unimodular(n: int, rng: random.Random, operations: int | None = None) -> list[list[int]]:
    """Random integer matrix of determinant 1 or -1: a signed permutation after elementary row operations.

    Parameters
    ----------
    n : int
    rng : random.Random
    operations : int, optional
        Number of row operations (default: 3 n if n <= 80, which makes the matrix dense, else n).

    Returns
    -------
    list of list of int
        The rows.

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
        Number of random triples of elements.
    rng : random.Random, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` names it.

    Examples
    --------
    >>> import liehom as lh
    >>> check_lie_algebra(lh.LieAlgebra({(0, 1): {1: 1}}))
    """
    rng = rng or random.Random(0)
    n, field = algebra.dimension, algebra.field
    killing = algebra.killing_form()
    require(_same(killing, killing.T), "killing form", "it is not symmetric")
    for _ in range(trials if n else 0):
        x, y, z = (_random_row(field, n, rng) for _ in range(3))
        xy, yz, zx = (_bracket(algebra, a, b) for a, b in ((x, y), (y, z), (z, x)))
        require((xy + _bracket(algebra, y, x)).is_zero(), "antisymmetry", "[x, y] + [y, x] is not 0")
        cyclic = _bracket(algebra, xy, z) + _bracket(algebra, yz, x) + _bracket(algebra, zx, y)
        require(cyclic.is_zero(), "Jacobi", "[[x, y], z] + [[y, z], x] + [[z, x], y] is not 0")
        invariance = xy @ killing @ z.T - x @ killing @ yz.T
        require(invariance.is_zero(), "killing form", "B([x, y], z) and B(x, [y, z]) differ")
    if field.exact:
        rows = field.matrix(random_unimodular(n, rng), (n, n))
        back = algebra.change_of_basis(rows).change_of_basis(rows.inverse())
        require(back == algebra, "change of basis", "changing the basis and back gives another table")
    read = from_json(to_json(Pair(algebra, [])))
    require(isinstance(read, Pair) and read.algebra == algebra, "file", "writing and reading gives another table")


def check_representation(representation: Representation, *, trials: int = 3, rng: random.Random | None = None) -> None:
    """Check that a representation preserves brackets, and check its isotropy subalgebras.

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` names it.

    Examples
    --------
    >>> import liehom as lh
    >>> check_representation(lh.Representation.from_matrices([[[0, -1], [1, 0]]]))
    """
    rng = rng or random.Random(0)
    algebra, field, size = representation.algebra, representation.field, representation.size
    n = algebra.dimension
    require(len(representation.matrices) == n, "shape", f"{len(representation.matrices)} matrices for dimension {n}")
    require(all(a.shape == (size, size) for a in representation.matrices), "shape", "the matrices are not N x N")
    for _ in range(trials if n else 0):
        x, y = _random_row(field, n, rng), _random_row(field, n, rng)
        a, b = representation(x.row(0)), representation(y.row(0))
        c = representation(_bracket(algebra, x, y).row(0))
        require((a @ b - b @ a - c).is_zero(), "bracket", "rho([x, y]) and [rho(x), rho(y)] differ")
        point = _random_row(field, size, rng)
        _check_isotropy(representation, point.row(0))
    _check_isotropy(representation, [0] * size)


def _check_isotropy(representation: Representation, point: Sequence[ScalarLike]) -> None:
    field, n = representation.field, representation.algebra.dimension
    isotropy = representation.isotropy(point)
    column = field.matrix([point], (1, representation.size)).T
    moved = field.stack_rows([(a @ column).T for a in representation.matrices], representation.size)
    require((isotropy.basis @ moved).is_zero(), "isotropy", "an element of it moves the point")
    orbit = representation.orbit_dimension(point)
    require(orbit + isotropy.dimension == n, "orbit", f"{orbit} + {isotropy.dimension} is not dim g = {n}")


def check_pair(pair: Pair, *, trials: int = 3, rng: random.Random | None = None) -> None:
    """Check a pair: its algebra, the closure of h, the isotropy representation, the file format.

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` names it.

    Examples
    --------
    >>> import liehom as lh
    >>> check_pair(lh.Pair(lh.LieAlgebra({(0, 1): {1: 1}}), [[1, 0]]))
    """
    rng = rng or random.Random(0)
    algebra, h, field = pair.algebra, pair.subalgebra, pair.field
    check_lie_algebra(algebra, trials=trials, rng=rng)
    require(h.basis.rank() == h.dimension, "basis", "the rows of h are dependent")
    projection = h.quotient().projection
    require((h.basis @ projection).is_zero(), "quotient", "the projection to g/h does not vanish on h")
    data = h.quotient()
    matrices = pair.isotropy_matrices()
    require(len(matrices) == h.dimension, "isotropy", f"{len(matrices)} matrices for dim h = {h.dimension}")
    for _ in range(trials if h.dimension else 0):
        a, b = rng.randrange(h.dimension), rng.randrange(h.dimension)
        x, y = (data.subspace.select(rows=[i]) for i in (a, b))
        bracket = _bracket(algebra, x, y)
        require((bracket @ projection).is_zero(), "closure", f"the bracket of rows {a} and {b} leaves h")
        if pair.dimension:
            lifted = _random_row(field, pair.dimension, rng) @ data.lift
            outer = _bracket(algebra, bracket, lifted) @ projection
            coordinates = (lifted @ projection).T
            inner = (matrices[a] @ matrices[b] - matrices[b] @ matrices[a]) @ coordinates
            require((outer.T - inner).is_zero(), "isotropy", "rho([x, y]) and [rho(x), rho(y)] differ on g/h")
    read = from_json(to_json(pair))
    require(read == pair, "file", "writing and reading gives another pair")


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
        Number of random unimodular bases of g in which the pair is decided again.
    rng : random.Random, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` names it.

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
    require(again == certificate, "file", "writing and reading gives another certificate")
    if pair.dimension > 1:
        try:
            accepted = verify_certificate(pair, Certificate("trivial", {}, certificate.field))
        except CertificateError:
            accepted = False
        require(not accepted, "control", "the checker accepts an empty certificate")
    n = pair.algebra.dimension
    for _ in range(bases):
        moved = pair.change_of_basis(random_unimodular(n, rng))
        verdict = decide_fullness(moved)
        require(verdict.full == certificate.full, "invariance", "the verdict changes with the basis")
        _holds(verdict.verify, "invariance")


# -- helpers ---------------------------------------------------------------------------------------------
def _holds(action: Callable[[], object], check: str) -> None:
    try:
        action()
    except LiehomError as error:
        raise ConformanceError(check, str(error)) from error


def _random_row(field: Field, n: int, rng: random.Random) -> Matrix:
    row: Matrix = field.matrix([[rng.randint(-3, 3) for _ in range(n)]], (1, n))
    return row


def _bracket(algebra: LieAlgebra, x: Matrix, y: Matrix) -> Matrix:
    """Bracket [x, y] of two rows, entry by entry from the structure constants; the library uses contractions."""
    field, n = algebra.field, algebra.dimension
    a, b = x.row(0), y.row(0)
    total = [field.zero] * n
    for i, j, k, value in algebra.structure_constants():
        total[k] = total[k] + value * (a[i] * b[j] - a[j] * b[i])
    row: Matrix = field.from_entries(total, 1, n)
    return row


def _same(left: Matrix, right: Matrix) -> bool:
    return (left - right).is_zero()
