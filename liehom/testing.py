"""Conformance suite: checks for algebras, representations, pairs, certificates, actions and steps."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from liehom.base.errors import CertificateError, ConformanceError, LiehomError
from liehom.base.typing import Array, Real, ScalarLike, Values
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.fullness.decide import decide_fullness
from liehom.exact.representations.constructions import defining
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Field, Matrix
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node
from liehom.flow.steps.expansion import flow_series, step_series
from liehom.flow.steps.step import Generator, LocalStep, Step
from liehom.io.files import from_json, to_json

# The condition of a check, with the error that names the check.


def require(holds: object, check: str, message: str) -> None:
    """Raise `ConformanceError` with the name of the check and the message if the condition is false."""
    if not bool(holds):
        raise ConformanceError(check, message)


# Checks of algebras, representations, pairs and certificates on random elements.

DENSE_DIMENSION = 80  # Largest dimension for which a random unimodular matrix is dense by default


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
    >>> from liehom.exact.scalars import QQ
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
        _check_isotropy(representation, _random_row(field, size, rng).row(0))
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
    data = h.quotient()
    projection = data.projection
    require((h.basis @ projection).is_zero(), "quotient", "the projection to g/h does not vanish on h")
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
    require(from_json(to_json(pair)) == pair, "file", "writing and reading gives another pair")


def check_certificate(
    pair: Pair, certificate: Certificate | Mapping[str, Any], *, bases: int = 1, rng: random.Random | None = None
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
        verdict = decide_fullness(pair.change_of_basis(random_unimodular(n, rng)))
        require(verdict.full == certificate.full, "invariance", "the verdict changes with the basis")
        _holds(verdict.verify, "invariance")


# -- helpers ---------------------------------------------------------------------------------------------
def _holds(action: Callable[[], object], check: str) -> None:
    try:
        action()
    except LiehomError as error:
        raise ConformanceError(check, str(error)) from error


def _random_row(field: Field, n: int, rng: random.Random) -> Matrix:
    return field.matrix([[rng.randint(-3, 3) for _ in range(n)]], (1, n))


def _bracket(algebra: LieAlgebra, x: Matrix, y: Matrix) -> Matrix:
    """Bracket [x, y] of two rows, entry by entry from the structure constants; the library uses contractions."""
    field, n = algebra.field, algebra.dimension
    a, b = x.row(0), y.row(0)
    total = [field.zero] * n
    for i, j, k, value in algebra.structure_constants():
        total[k] = total[k] + value * (a[i] * b[j] - a[j] * b[i])
    return field.from_entries(total, 1, n)


def _same(left: Matrix, right: Matrix) -> bool:
    return (left - right).is_zero()


# Checks of actions and steps: an exponential has the properties of one, and a step has the order that it states.

ROUND_OFF = 1e-12  # Relative difference that counts as round-off
SERIES_ORDER = 6  # Order of the Taylor series on which the exponential is evaluated


def check_space(action: Action, *, trials: int = 3, rng: np.random.Generator | None = None) -> None:
    """Check an action: Exp(-x) inverts Exp(x), Exp agrees with exp to order 2, preserves orbits and acts on Jets.

    Parameters
    ----------
    action : Action
        Action with an exponential of the library or a custom one.
    trials : int
        Number of random elements and points.
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` is "inverse", "order 2", "orbit" or "series".

    Notes
    -----
    The check "orbit" tests, at two small t, that the velocity of the curve Exp(t x) m is tangent to the orbit, as far
    as the Taylor series of the curve is accurate.

    Examples
    --------
    >>> import liehom as lh
    >>> check_space(lh.Action(lh.sym_conjugation(3), "cayley"))
    """
    rng = np.random.default_rng(0) if rng is None else rng
    n, size = action.dimension, action.representation.size
    for _ in range(trials):
        x, m = rng.normal(size=n) / 2, rng.normal(size=size)
        scale = float(np.abs(m).max(initial=1.0)) * float(np.exp(np.linalg.norm(action.infinitesimal.left(x))))
        back = action.act(-x, action.act(x, m))
        require(np.abs(back - m).max(initial=0.0) < 1e3 * ROUND_OFF * scale, "inverse", "Exp(-x) Exp(x) m is not m")
        ray = Jet.from_node(Node(SERIES_ORDER, 0 * x, [None, x, *[None] * (SERIES_ORDER - 1)]))
        curve = action.act(ray, m)
        once = action.infinitesimal(x, m)
        for k, wanted in enumerate((m, once, action.infinitesimal(x, once) / 2)):
            off = np.abs(curve.coefficient(k) - wanted).max(initial=0.0)
            require(off < ROUND_OFF * scale, "order 2", f"Exp(t x) m differs from exp(t x) m at t^{k}")
        _check_tangents(action, curve, scale)
        for h in (1e-2, 1e-3):
            off = np.abs(curve(h) - action.act(h * x, m)).max(initial=0.0)
            require(off < (scale * h ** (SERIES_ORDER + 1) + ROUND_OFF) * scale, "series", "Exp acts otherwise on Jets")


def _check_tangents(action: Action, curve: Jet, scale: float) -> None:
    """Check that the derivative of the curve is tangent to the orbits along it, as far as the series is accurate."""
    for h in (1e-2, 2e-2):
        point = curve(h)
        speed = sum(k * curve.coefficient(k) * h ** (k - 1) for k in range(1, SERIES_ORDER + 1))
        columns = action.infinitesimal.right(point)
        fitted = columns @ np.linalg.lstsq(columns, speed, rcond=1e-6)[0]
        off = float(np.abs(fitted - speed).max(initial=0.0))
        allowed = scale**2 * (1e-6 + SERIES_ORDER * h**SERIES_ORDER)
        require(off < allowed, "orbit", f"Exp(t x) m leaves the orbit: its velocity is off the tangent by {off:.2g}")


def check_order(
    step: Step, order: int | None = None, *, trials: int = 3, rng: np.random.Generator | None = None
) -> None:
    """Check that a step agrees with the flow through an order, and not beyond it.

    Parameters
    ----------
    step : Step
        Step of the library or a custom one.
    order : int, optional
        Order to check (default: ``step.order``).
    trials : int
        Number of random quadratic, time-dependent generators for each of so(3) and sl(2).
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` is "order" (a coefficient up to the order differs) or "sharpness" (the
        order is higher than stated).

    Examples
    --------
    >>> import liehom as lh
    >>> check_order(lh.Heun())
    >>> check_order(lh.Euler(), order=2)
    Traceback (most recent call last):
    ...
    liehom.base.errors.ConformanceError: order: Euler() differs from the flow at order 2 by ...
    """
    rng = np.random.default_rng(0) if rng is None else rng
    claimed = step.order if order is None else order
    worst = 0.0
    for name in ("so(3)", "sl(2)"):
        action = Action(defining(name))
        for _ in range(trials):
            differences = _differences(step, action, claimed + 1, rng)
            for k, off in enumerate(differences[:-1], start=1):
                require(off < 1e-9, "order", f"{step!r} differs from the flow at order {k} by {off:.2g}")
            worst = max(worst, differences[-1])
    require(worst > 1e-7, "sharpness", f"{step!r} agrees with the flow at order {claimed + 1} too")


def _differences(step: Step, action: Action, total: int, rng: np.random.Generator) -> list[float]:
    """Relative differences of the Taylor coefficients 1 ... total of the step and of the flow at time tau."""
    r, size = action.dimension, action.representation.size
    parts = [rng.normal(size=(r, *(size,) * k)) / 2 for k in range(3)]
    m = rng.normal(size=size)
    m /= np.linalg.norm(m)

    def psi(m: Values, t: Real) -> Values:
        linear = np.einsum("ai,...i->...a", parts[1], m)
        return parts[0] * np.cos(t) + linear + np.einsum("aij,...i,...j->...a", parts[2], m, m)

    field = GeneratorField(action.representation, psi)
    dimension = np.linalg.matrix_rank(action.infinitesimal.right(m))
    local = step.at(action, Generator(field, dimension), m, np.array([0.3]))
    flow, series = flow_series(field, m, total, 0.3), step_series(action, local, m, total)
    clock = _clock(local, total)
    differences = []
    for k in range(1, total + 1):
        wanted = sum(_power(clock, i, k) * flow.point(i) for i in range(1, k + 1))
        differences.append(float(np.abs(wanted - series.coefficient(k)).max()) / (1 + float(np.abs(wanted).max())))
    return differences


def _clock(local: LocalStep, total: int) -> Array:
    """Taylor coefficients 0 ... total of the time reparametrization tau(t)."""
    t = Jet.variable(0.0, total)
    clock: Any = local.time(t)
    return np.asarray(clock.coefficients, dtype=float)


def _power(clock: Array, i: int, k: int) -> float:
    """Taylor coefficient k of tau^i."""
    power = np.array([1.0])
    for _ in range(i):
        power = np.convolve(power, clock)
    return float(power[k]) if k < len(power) else 0.0
