"""The exceptions of liehom; all are subclasses of `LiehomError`.

The message of each says what was found and what would be right. Where there is a position (an index, a pair of basis
elements, a key of a file), the exception carries it as an attribute.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class LiehomError(Exception):
    """Root of all exceptions raised by liehom."""

    def __reduce__(self) -> tuple[Any, ...]:
        # constructors take the parts of a message, so pickle must not call them with the message
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[LiehomError], args: tuple[Any, ...], attributes: dict[str, Any]) -> LiehomError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(attributes)
    return error


def shown(value: str) -> str:
    """A value as a message shows it: only the beginning and the end of a string of more than 200 characters."""
    return value if len(value) <= 200 else f"{value[:40]}...{value[-10:]} ({len(value)} characters)"


def displayed(value: object) -> str:
    """The repr of any object as a message shows it: shortened, and never an exception itself."""
    try:
        return shown(repr(value))
    except Exception:  # noqa: BLE001  integers of more digits than Python prints, nested lists, a repr of the caller
        return f"a very long {type(value).__name__}" if isinstance(value, int) else f"a {type(value).__name__}"


class InputError(LiehomError, ValueError):
    """An argument has a wrong value: a parameter out of range, a shape that does not fit, a bad option."""


def checked_integer(value: object, what: str, least: int = 1) -> int:
    """The value as an int, after a check that it is an integer and large enough."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise InputError(f"{what} is an integer at least {least}, got {displayed(value)}")
    return int(value)


class ShapeError(InputError):
    """An array, vector or matrix has the wrong shape or length."""


class FieldError(InputError):
    """A number is not in the field at hand, or the data do not define a real number field."""


class ParseError(InputError):
    """A string is not in the grammar of values (integers, ``+ - * / **``, parentheses, ``sqrt``, names)."""


class FormatError(InputError):
    """A file or JSON object does not have the documented form; no part of it has been used."""


class TangencyError(InputError):
    """A vector field is not tangent to the orbits: `normal` is its normal component."""

    def __init__(self, normal: object, message: str) -> None:
        self.normal = normal
        super().__init__(message)


class SeriesError(InputError):
    """A function cannot be expanded in a Taylor series: it branches on values or has no recurrence."""


class TraceError(InputError):
    """A step cannot be compiled: it branches on values, or calls a function that compiled code does not have."""


class LimitError(InputError):
    """An input or a computation is larger than a limit allows: `limit` is its name, see `liehom.limits`.

    Attributes
    ----------
    limit : str
        Name of the limit.
    found, allowed : int or float
        What was found, and the limit in force.
    """

    def __init__(self, limit: str, found: float, allowed: float, what: str) -> None:
        self.limit, self.found, self.allowed = limit, found, allowed
        enough = _rounded_up(found)
        super().__init__(
            f"{what.format(enough)}, the limit is {allowed}; raise it by `with liehom.limits({limit}={enough})`, on "
            f"the command line by `--limit {limit}={enough}`"
        )


def _rounded_up(size: float) -> str:
    """The size as a number that is at least as large; short if it has many digits."""
    if not isinstance(size, int):
        return f"{-(-size // 1):.0f}" if size < 1e15 else f"{1.05 * size:.1e}"
    bits = size.bit_length()
    return str(size) if bits <= 64 else f"10**{int(bits * 0.30103) + 1}"


class SingularError(LiehomError, ArithmeticError):
    """A linear system has no solution, or a matrix that should be invertible is singular."""


class StructureError(InputError):
    """Structure constants do not define a Lie algebra (indices, antisymmetry)."""


class JacobiError(StructureError):
    """The Jacobi identity fails: `indices` is the triple (i, j, k), `value` the coefficients of the cyclic sum."""

    def __init__(
        self,
        indices: tuple[int, int, int],
        value: dict[int, str],
        names: tuple[str, str, str],
        basis: Sequence[str] = (),
        tolerance: float = 1.0,
    ) -> None:
        self.indices, self.value = indices, value
        power = math.ceil(math.log10(tolerance))  # a failure as large as 1e-2 is not due to inexact numbers
        remedy = (
            f"; it holds up to a relative error of {tolerance:.1e}: declare it by field=lh.FloatField(rtol=1e{power})"
        )
        terms = " + ".join(f"({shown(v)})*{basis[k] if basis else f'e{k}'}" for k, v in sorted(value.items()))
        super().__init__(
            f"the Jacobi identity fails for (i, j, k) = {indices}, that is for {', '.join(names)}: "
            f"[[i,j],k] + [[j,k],i] + [[k,i],j] = {terms}, expected 0{remedy if power < -1 else ''}"
        )


class CocycleError(StructureError):
    """A bilinear form is not a cocycle: `indices` is a triple (i, j, k) that shows it, `value` the cyclic sum."""

    def __init__(self, indices: tuple[int, int, int], value: str, names: tuple[str, str, str]) -> None:
        self.indices, self.value = indices, value
        super().__init__(
            f"the form is not a cocycle for (i, j, k) = {indices}, that is for {', '.join(names)}: "
            f"w([i,j],k) + w([j,k],i) + w([k,i],j) = {shown(value)}, expected 0"
        )


class NotASubalgebraError(InputError):
    """The span of the given rows is not closed under brackets: `pair` names two rows whose bracket leaves it."""

    def __init__(self, pair: tuple[int, int], bracket: str) -> None:
        self.pair = pair
        super().__init__(
            f"the rows do not span a subalgebra: the bracket of rows {pair[0]} and {pair[1]} is {bracket}, "
            "which is not in their span; add it, or pass the rows through subalgebra_generated_by"
        )


class DependentRowsError(InputError):
    """Rows that should be a basis are linearly dependent; `dependent` lists rows that the earlier ones span."""

    def __init__(self, rank: int, dependent: list[int], what: str = "rows") -> None:
        self.rank, self.dependent = rank, dependent
        super().__init__(
            f"the {what} are linearly dependent: rank {rank}; number(s) {', '.join(map(str, dependent))} "
            "lie in the span of the earlier ones; leave them out"
        )


class NotInSpanError(InputError):
    """A matrix is not in a span of matrices: `index` is its index, `residual` its relative distance from the span."""

    def __init__(self, index: int, residual: float, what: str) -> None:
        self.index, self.residual = index, residual
        super().__init__(what)


class NotAnIdealError(InputError):
    """A subspace that should be an ideal is not an ideal."""


class HomomorphismError(InputError):
    """A linear map does not respect the bracket: `pair` names two basis elements that show it."""

    def __init__(self, pair: tuple[int, int], what: str) -> None:
        self.pair = pair
        super().__init__(what)


class RepresentationError(HomomorphismError):
    """Matrices do not satisfy rho([x, y]) = rho(x) rho(y) - rho(y) rho(x) for the basis elements of `pair`."""


class NotInvariantError(InputError):
    """A subspace is not invariant: basis element number `element` moves row number `vector` out of it."""

    def __init__(self, vector: int, element: int, what: str) -> None:
        self.vector, self.element = vector, element
        super().__init__(what)


class NotFullError(InputError):
    """A pair is not full, so it is in no row of the classification; `verdict` says why, with its certificate."""

    def __init__(self, verdict: object, what: str) -> None:
        self.verdict = verdict
        super().__init__(what)


class NotCompletelyReducibleError(InputError):
    """A representation is not a sum of irreducible ones, or an invariant subspace has no invariant complement."""


class NotReductiveError(InputError):
    """No complement of h is invariant under ad(h): `proof` combines the equations for one to 0 = 1.

    Attributes
    ----------
    proof : dict
        From (z, j, a) to a coefficient, a string: the equation that the part of [h_z, m_j] on h_a vanishes, where h_z
        is row z of the subalgebra and m_j is row j of the standard complement plus an unknown element of h.
    """

    def __init__(self, proof: dict[tuple[int, int, int], str], what: str) -> None:
        self.proof = proof
        super().__init__(what)


class NotClosedError(InputError):
    """Matrices do not span a Lie algebra: `pair` names two whose commutator leaves the span."""

    def __init__(self, pair: tuple[int, int], what: str) -> None:
        self.pair = pair
        super().__init__(what)


class CatalogError(InputError):
    """A name is not in the catalogue; the message lists similar names."""


class CertificateError(LiehomError):
    """A certificate does not prove its verdict: `check` names the check that failed."""

    def __init__(self, check: str, message: str) -> None:
        self.check = check
        super().__init__(f"{check}: {message}")


class CertificateFormatError(CertificateError, FormatError):
    """A certificate does not have the documented form (unknown kind or key, value that does not parse)."""


class ConvergenceError(LiehomError, ArithmeticError):
    """An iteration did not converge: an implicit step, a time reparametrization, a point of an orbit.

    Attributes
    ----------
    unsolved : bool array or None
        For which trajectories of an ensemble; None if it is not known.
    """

    def __init__(self, message: str, unsolved: npt.NDArray[np.bool_] | None = None) -> None:
        super().__init__(message)
        self.unsolved = unsolved


class DamageWarning(UserWarning):
    """A file of stored results is damaged; its name is given, and its results are computed again."""


class WorkerLostError(LiehomError, RuntimeError):
    """Workers were lost before all tasks were done; `done` and `missing` count the tasks."""

    def __init__(self, done: int, missing: int, message: str) -> None:
        self.done, self.missing = done, missing
        super().__init__(message)


class UndecidedError(LiehomError, TypeError):
    """A verdict without a proof was used as a boolean, or the computed invariants do not decide the question."""


class NoRationalInvolutionError(UndecidedError):
    """No Cartan involution has entries in the number field of the algebra, by a proof that `reason` names.

    Over the reals there is one. As a subclass of `UndecidedError`, which is raised if the search found none, it is
    caught together with it.
    """

    def __init__(self, reason: str, message: str) -> None:
        self.reason = reason
        super().__init__(message)


class InternalError(LiehomError, RuntimeError):
    """The library reached a state that a theorem excludes: please report this bug."""


class ConformanceError(LiehomError):
    """An object fails the check named by `check` in the conformance suite `liehom.testing`."""

    def __init__(self, check: str, message: str) -> None:
        self.check = check
        super().__init__(f"{check}: {message}")


class StiffnessWarning(UserWarning):
    """The step sizes of an adaptive run were limited by stability, so that a step for stiff fields takes fewer.

    Attributes
    ----------
    rate : float
        The rate with which deviations from the trajectory are damped.
    time : float
        Where it was first noticed.
    """

    def __init__(self, message: str, rate: float = float("nan"), time: float = float("nan")) -> None:
        self.rate, self.time = rate, time
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.rate, self.time)


class OrderWarning(UserWarning):
    """A run did not keep the order of its `Corrected` step; `time` is where this was first noticed.

    With `dt` the `status` of the solution is -2 then, `success` is False, and `message` says why. Adaptive sizes keep
    the tolerance, and `report` says why the order is not kept.

    Attributes
    ----------
    order : int
        The order of the step.
    time : float
    """

    def __init__(self, message: str, order: int = 0, time: float = float("nan")) -> None:
        self.order, self.time = order, time
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.order, self.time)
