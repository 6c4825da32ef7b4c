"""The Cartan decomposition g = k + p over the field of the algebra, from a Cartan involution that is proved.

An involution theta is a Cartan involution if it is an automorphism and -K(x, theta y) is positive definite; both are
exact checks.  Candidates come from floating point (cartan_involution): in a basis that suits the algebra the best
Cartan involution has small rational entries.  Another basis is first brought back: the lattice that it spans is
LLL-reduced for -K(x, theta y), and theta is moved to suit the reduced basis, in turn.  Where no rational candidate
passes the checks there may be none: then `UndecidedError` says so, and the decomposition over float64 is at hand.
Imports cartan_involution, cartan_subalgebra, lie_algebra, subalgebra, scalars, errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final

import numpy as np

from liehom.algebra.cartan_involution import (
    cartan_involution_of_constants,
    kicked,
    nearest_cartan_involution,
)
from liehom.algebra.cartan_subalgebra import cartan_subalgebra
from liehom.algebra.lie_algebra import LieAlgebra
from liehom.algebra.subalgebra import Subalgebra
from liehom.errors import ConvergenceError, InputError, UndecidedError
from liehom.scalars import RR, FloatField, Subspace
from liehom.scalars.lattice import integral_preimage, reduced_basis

ROUNDS = 60
FEW_ROUNDS = 8
SMALL = 24
LATTICE_DIMENSION = 40
LATTICE_STEPS = 12
SEEDS = 4
DENOMINATOR = 24
CLOSE = 1e-4


@final
@dataclass(frozen=True, slots=True)
class CartanDecomposition:
    """g = k + p for a Cartan involution: k is a maximal compact subalgebra, p its complement for the Killing form.

    Attributes
    ----------
    k : Subalgebra
        The fixed points of theta.
    p : Subspace
        Where theta is -1.
    theta : Matrix
        The involution, (n, n), on columns.
    """

    k: Subalgebra
    p: Subspace
    theta: Any

    def __iter__(self) -> Any:
        return iter((self.k, self.p))


def cartan_decomposition(algebra: LieAlgebra) -> CartanDecomposition:
    """The Cartan decomposition of a semisimple algebra; unpacks as ``k, p``.

    Raises
    ------
    InputError
        If the algebra is not semisimple.
    UndecidedError
        If no Cartan involution with small rational entries was found; over ``lh.RR`` it is found numerically.

    Notes
    -----
    k is a subalgebra, [k, p] lies in p, [p, p] in k, the Killing form is negative definite on k and positive definite
    on p; over an exact field all this follows from the two checks of the involution.

    Examples
    --------
    >>> import liehom as lh
    >>> k, p = cartan_decomposition(lh.so(4, 1))
    >>> k.dimension, p.dimension, k.as_algebra().real_form()
    (6, 4, 'so(3) + so(3)')
    """
    field, n = algebra.field, algebra.dimension
    killing = algebra.killing_form()
    if killing.rank() < n:
        raise InputError("a Cartan decomposition is that of a semisimple algebra; take the Levi factor")
    if isinstance(field, FloatField):
        return _decomposed(algebra, field.from_entries(_numerical(algebra).T.ravel().tolist(), n, n))
    theta = field.identity(n) if killing.signature()[0] == 0 else _rational(algebra, killing)
    if theta is None:
        raise UndecidedError(
            f"no Cartan involution of {algebra!r} with entries of denominator at most {DENOMINATOR} was found in this "
            "basis or a reduced one; algebra.over(lh.RR).cartan_decomposition() finds one numerically"
        )
    return _decomposed(algebra, theta)


def is_cartan_involution(algebra: LieAlgebra, theta: Any) -> bool:
    """Whether a matrix (n, n), on columns, is a Cartan involution; decided exactly.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3)
    >>> is_cartan_involution(g, g.field.identity(3)), is_cartan_involution(lh.sl(2), g.field.identity(3))
    (True, False)
    """
    n, field = algebra.dimension, algebra.field
    theta = field.read(theta, (n, n))
    if theta.shape != (n, n) or theta @ theta != field.identity(n):
        return False
    form = -(algebra.killing_form() @ theta)
    if form != form.T or not form.is_positive_definite():
        return False
    return bool(algebra.table.changed(theta.T, theta.T) == algebra.table)  # an automorphism, and its own inverse


def _decomposed(algebra: LieAlgebra, theta: Any) -> CartanDecomposition:
    field, n = algebra.field, algebra.dimension
    one = field.identity(n)
    k = (one + theta).T.row_space()
    p = (one - theta).T.row_space()
    # The fixed points of an automorphism.
    return CartanDecomposition(Subalgebra(algebra, k, check=False), Subspace(field, p, n), theta)


def _numerical(algebra: LieAlgebra) -> Any:
    """Theta on rows, for an algebra over float64."""
    n = algebra.dimension
    constants = algebra.table.dense().array.reshape(n, n, n)
    killing = algebra.killing_form().to_numpy()
    return _found(constants, killing, _numerical_rank(constants))


def _numerical_rank(constants: Any) -> int:
    x = np.random.default_rng(len(constants)).standard_normal(len(constants))
    values = np.abs(np.linalg.eigvals(np.einsum("i,ijk->jk", x, constants)))
    return int((values < 1e-6 * max(values.max(), 1e-300)).sum())


def _found(constants: Any, killing: Any, rank: int) -> Any:
    failure: Exception | None = None
    for seed in range(SEEDS):
        try:
            theta = cartan_involution_of_constants(constants, killing, rank, seed)
            return nearest_cartan_involution(constants, killing, theta)
        except (ConvergenceError, np.linalg.LinAlgError) as error:
            failure = error
    raise ConvergenceError(f"no Cartan involution in double precision: {failure}")


def _rational(algebra: LieAlgebra, killing: Any) -> Any:
    """A Cartan involution over the field, on columns, or None."""
    field, n = algebra.field, algebra.dimension
    rank = cartan_subalgebra(algebra).dimension
    rng = np.random.default_rng(n)
    theta = None
    for start in (field.identity(n), _larger_lattice(algebra)):
        if start is None:
            continue
        basis, current = start, algebra if start == field.identity(n) else algebra.change_of_basis(start)
        theta = None
        for _ in range(ROUNDS if n <= SMALL else FEW_ROUNDS):
            constants = current.over(RR).table.dense().array.reshape(n, n, n)
            form = current.killing_form().to_numpy()
            try:
                theta = _found(constants, form, rank) if theta is None else theta
                theta = nearest_cartan_involution(constants, form, theta)
            except (ConvergenceError, np.linalg.LinAlgError):
                break
            candidate = _recognised(field, theta)
            if candidate is not None and is_cartan_involution(current, candidate):
                return basis.T @ candidate @ basis.T.inverse()
            rows = _reduced(field, form, theta)
            if rows == field.identity(n):  # a local minimum: leave it by a random inner automorphism
                theta = kicked(constants, form, theta, rng)
                rows = _reduced(field, form, theta)
            as_floats = rows.to_numpy()
            theta = as_floats @ theta @ np.linalg.inv(as_floats)
            basis, current = rows @ basis, current.change_of_basis(rows)
    return None


def _reduced(field: Any, killing: Any, theta: Any) -> Any:
    n = len(killing)
    return field.from_integers(reduced_basis(-killing @ theta.T).parts[0].entries(), n, n)


def _larger_lattice(algebra: LieAlgebra) -> Any:
    """A basis of a larger lattice than Z^n that depends less on the basis: normalizers of lattices, repeatedly; or None.

    The normalizer of L is {x : [x, L] in L}; it is closed under brackets, and contains every closed lattice that it is
    the normalizer of.
    """
    field, n = algebra.field, algebra.dimension
    if field.degree > 1 or n > LATTICE_DIMENSION:
        return None
    basis, current = field.identity(n), algebra
    for _ in range(LATTICE_STEPS):
        rows = integral_preimage(current.table.flat())
        if abs(rows.determinant()) == 1:
            break
        basis, current = rows @ basis, current.change_of_basis(rows)
    return None if basis == field.identity(n) else basis


def _recognised(field: Any, theta: Any) -> Any:
    """Nearby fractions of small denominators as a matrix on columns, or None if some entry has none nearby."""
    values = []
    for x in theta.T.ravel().tolist():
        guess = Fraction(x).limit_denominator(DENOMINATOR)
        if abs(float(guess) - x) > CLOSE:
            return None
        values.append(field.convert(guess))
    return field.from_entries(values, *theta.shape)
