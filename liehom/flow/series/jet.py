"""Jet: a truncated Taylor series with array values, on which numpy code runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, Never, TypeAlias, TypeVar, final

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin

from liehom.base.errors import SeriesError, ShapeError
from liehom.base.typing import Key, Real, Values
from liehom.flow.series import node as recurrences
from liehom.flow.series.arrays import (
    NumbersLike,
    as_values,
    constant_like,
    is_exact,
    is_jax,
    is_lazy,
    namespace,
    owned,
    zeros,
)
from liehom.flow.series.node import Coefficient, Node, rewind

Operand: TypeAlias = Any  # a Jet, an array, a number, or a nested list or array of objects that holds Jets
WITHOUT_SERIES = "or take step='rk45', a Runge-Kutta step, which calls the generator on points only, as it is"
"""Remedy of messages about generators that cannot be expanded."""
HOOKS: dict[str, Callable[..., Any]] = {}
"""The functions for ``__array_ufunc__``, ``__array_function__`` and methods of arrays, which `jet_functions` enters."""


# Assignment into Jets: entries are replaced by new series, so results computed before do not change. Slices and
# transposes are views, as for numpy arrays: they show what is assigned later, and assignment into a slice assigns to
# the Jet.


def frozen(x: Any) -> Any:
    """Copy of an index or option, as the caller may change it later."""
    if isinstance(x, np.ndarray):
        return x.copy()
    if isinstance(x, list):
        return [frozen(entry) for entry in x]
    return tuple(frozen(entry) for entry in x) if type(x) is tuple else x


def checked_index(key: Key, x: Values) -> Key:
    """Copy of an index of the array x, with lists as arrays, checked against the shape (JAX would clip it)."""
    parts = key if isinstance(key, tuple) else (key,)
    parts = tuple(np.array(x, dtype=None if x else int) if isinstance(x, list) else frozen(x) for x in parts)
    key = parts if isinstance(key, tuple) else parts[0]
    if is_jax(x) and not any(is_jax(part) for part in parts):
        np.broadcast_to(np.zeros(()), x.shape)[key]
    return key


def kind_of_index(key: Key, ndim: int) -> str:
    """The result of indexing an array with `ndim` axes in numpy: "number", "view" or "copy"."""
    parts = key if isinstance(key, tuple) else (key,)
    integers = sum(isinstance(part, int | np.integer) and not isinstance(part, bool) for part in parts)
    slices = sum(part is Ellipsis or part is None or isinstance(part, slice) for part in parts)
    if integers + slices < len(parts):
        return "copy"
    return "number" if not slices and integers == ndim else "view"


def replaced(node: Node, key: Key, part: Node) -> Node:
    """Node of the series with the entries at `key` replaced by those of `part`."""
    return recurrences.linear(lambda x, y: _replaced(x, key, y), [node, part])


def _replaced(x: Values, key: Key, part: Values) -> Values:
    if is_jax(x) or is_jax(part):
        xp = namespace(x, part)
        return xp.asarray(x, dtype=xp.result_type(x, part)).at[key].set(part)
    if is_lazy(x) or is_lazy(part):
        out: Any = (x + 0.0 * part if is_lazy(part) and not is_lazy(x) else x).copy()
    else:
        out = np.array(x, dtype=np.result_type(x, part))
    out[key] = part
    return out


# Jet: a truncated Taylor series with array values, on which numpy code runs.
#
# A Jet of order n stands for y(t) = y_0 + y_1 t + ... + y_n t^n + O(t^(n+1)) with arrays y_k of one shape; it
# has the shape of its values, and numpy functions of it are Jets.  Coefficients are Taylor coefficients (no
# factorials) and are computed on demand, so that a solution of a differential equation can be expanded in itself
# (`growing`).  The values are numpy arrays of any dtype, JAX arrays, or exact scalars in object arrays.


@final
class Jet(NDArrayOperatorsMixin):
    """A truncated Taylor series whose coefficients are arrays.

    Parameters
    ----------
    coefficients : array_like of shape (order + 1, ...)
        Taylor coefficients along the first axis. Integers become floats; fractions and field elements stay exact.

    Raises
    ------
    ShapeError
        If there is no first axis.
    SeriesError
        From every operation that cannot be expanded: comparisons, maxima, rounding, functions without a recurrence.

    Notes
    -----
    Numpy's arithmetic, elementary functions, indexing, and functions such as ``np.einsum``, ``np.stack``,
    ``np.cross``, ``np.linalg.norm`` work on Jets (``__array_ufunc__``, ``__array_function__``); over JAX arrays they
    call the functions of the same name of ``jax.numpy``. Entries of results may be assigned, as for arrays; series that
    were computed from them before do not change. Jets that a function receives, and their slices, are read-only.

    Examples
    --------
    >>> import numpy as np
    >>> t = Jet.variable(0.0, order=4)
    >>> np.exp(t).coefficients
    array([1.        , 1.        , 0.5       , 0.16666667, 0.04166667])
    >>> m = Jet([[1.0, 0.0], [0.0, 1.0]])  # (1, t)
    >>> np.einsum("i,i", m, m).coefficients
    array([1., 0.])
    """

    __slots__ = ("_function", "_key", "_node", "_parent", "_seen", "_writable")
    _function: Callable[[Any], Any]
    _key: Key
    _seen: Node

    def __init__(self, coefficients: NumbersLike) -> None:
        values = owned(as_values(coefficients))
        if values.ndim == 0:
            raise ShapeError("a Jet needs Taylor coefficients along a first axis, got a single number")
        if values.shape[0] == 0:
            raise ShapeError("a Jet has at least its coefficient 0, got an empty first axis")
        known = [values[k] for k in range(values.shape[0])]
        self._node = Node(len(known) - 1, known[0], known)
        self._parent: Jet | None = None  # the Jet of which this one is a view, by a function, when its node was seen
        self._writable = False

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def from_node(cls, node: Node, *, writable: bool = False) -> Jet:
        """Jet with the coefficients of a node, for new recurrences.

        Examples
        --------
        >>> import numpy as np
        >>> from liehom.flow.series.node import Node
        >>> Jet.from_node(Node(2, np.float64(1), [np.float64(1)], (), lambda k: np.float64(k))).coefficients
        array([1., 1., 2.])
        """
        jet = cls.__new__(cls)
        jet._node, jet._parent, jet._writable = node, None, writable
        return jet

    @classmethod
    def variable(cls, value: NumbersLike, order: int, direction: NumbersLike | None = None) -> Jet:
        """Jet value + direction t (direction 1 by default).

        Examples
        --------
        >>> Jet.variable([1.0, 2.0], 2, [0.0, 1.0]).coefficients.tolist()
        [[1.0, 2.0], [0.0, 1.0], [0.0, 0.0]]
        """
        first = owned(as_values(value))
        slope = zeros(first, first.shape) + 1 if direction is None else owned(as_values(direction))
        if slope.shape != first.shape:
            raise ShapeError(f"a value of shape {first.shape} with a direction of shape {slope.shape}")
        return cls.from_node(Node(order, first, [first, slope, *[None] * (order - 1)][: _checked(order) + 1]))

    @classmethod
    def constant(cls, value: NumbersLike, order: int) -> Jet:
        """Jet with this value and all other coefficients 0.

        Examples
        --------
        >>> Jet.constant(3.0, 2).coefficients
        array([3., 0., 0.])
        """
        return cls.from_node(recurrences.constant(owned(as_values(value)), _checked(order)))

    @classmethod
    def growing(cls, value: NumbersLike, order: int, *, zero: bool = False) -> Jet:
        """Jet of which only the value at 0 is given; `extend` appends the next coefficients.

        The coefficients of functions of it are available as far as they are determined.

        Parameters
        ----------
        value : array_like
        order : int
        zero : bool
            The coefficient at 0 is structurally zero; `value` then only gives shape and dtype.

        Examples
        --------
        The solution of y' = y^2, y(0) = 1:

        >>> y = Jet.growing(1.0, 3)
        >>> slope = y * y
        >>> for k in range(3):
        ...     y.extend(slope.coefficient(k) / (k + 1))
        ...
        >>> y.coefficients
        array([1., 1., 1., 1.])
        """
        first = owned(as_values(value))
        known = (zeros(first, first.shape), [None]) if zero else (first, [first])
        return cls.from_node(Node(_checked(order), *known))

    def extend(self, coefficient: Coefficient) -> None:
        """Append the next coefficient of a growing series; None is zero.

        Raises
        ------
        SeriesError
            If the series is not a growing one or is complete.
        """
        node = self._node
        if node.rule is not None or len(node.known) > node.order:
            raise SeriesError("only a growing series that is not complete can be extended")
        node.known.append(self._fitting(coefficient))

    def _fitting(self, coefficient: Coefficient) -> Coefficient:
        if coefficient is not None and np.shape(coefficient) != self.shape:
            raise ShapeError(f"a coefficient of shape {np.shape(coefficient)} for a series of values {self.shape}")
        return owned(coefficient)

    def replace(self, k: int, coefficient: Coefficient, *results: Jet) -> None:
        """Replace coefficient k >= 1 of a growing series; coefficients of `results` that depend on it are recomputed.

        Examples
        --------
        >>> x = Jet.growing(0.0, 2)
        >>> y = 3 * x
        >>> x.extend(1.0)
        >>> x.replace(1, 2.0, y)
        >>> float(y.coefficient(1))
        6.0
        """
        if self._node.rule is not None or not 1 <= k < len(self._node.known):
            raise SeriesError(f"coefficient {k} cannot be replaced: it has not been given by extend")
        self._node.known[k] = self._fitting(coefficient)
        for result in results:
            rewind(result.node, self._node, k)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def node(self) -> Node:
        """The node that computes the coefficients."""
        if self._parent is not None and self._parent.node is not self._seen:
            self._seen = self._parent.node
            self._node = recurrences.linear(self._function, [self._seen])
        return self._node

    @property
    def order(self) -> int:
        """Index of the last coefficient."""
        return self.node.order

    @property
    def shape(self) -> tuple[int, ...]:
        """Tuple of axis lengths of the values."""
        return tuple(np.shape(self.node.value))

    @property
    def ndim(self) -> int:
        """Number of axes of the values."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of entries of the values."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the entries of the values."""
        value = self.node.value
        return value.dtype if hasattr(value, "dtype") else np.dtype(type(value))

    @property
    def value(self) -> npt.NDArray[Any]:
        """Value at t = 0, a read-only array of the shape of the values."""
        return _read_only(self.node.value)

    @property
    def coefficients(self) -> npt.NDArray[Any]:
        """All Taylor coefficients, shape (order + 1, ...)."""
        if self.dtype == object and not self.shape:
            return np.array([self.coefficient(k)[()] for k in range(self.order + 1)], dtype=object)
        return namespace(self.node.value).stack([self.coefficient(k) for k in range(self.order + 1)])

    @property
    def T(self) -> Jet:
        """Jet of the transposed values."""
        return self.part(lambda x: x.T)

    @property
    def real(self) -> Jet:
        """Jet of the real part, for real t."""
        return self.part(lambda x: x.real)

    @property
    def imag(self) -> Jet:
        """Jet of the imaginary part, for real t."""
        return self.part(lambda x: x.imag)

    def coefficient(self, k: int) -> npt.NDArray[Any]:
        """Taylor coefficient k, a read-only array of the shape of the values."""
        coefficient = self.node.coefficient(k)
        if coefficient is None:
            return zeros(self.node.value, self.shape)
        return _read_only(coefficient if hasattr(coefficient, "shape") else np.asarray(coefficient))

    def __call__(self, t: Real) -> npt.NDArray[Any]:
        """Value of the polynomial at t, by Horner's rule; t broadcasts against the values."""
        total = self.coefficient(self.order)
        for k in range(self.order - 1, -1, -1):
            total = total * t + self.coefficient(k)
        return total

    # -- arithmetic --------------------------------------------------------------------------------------
    if TYPE_CHECKING:
        # numpy's functions reach Jets by `__array_function__`; type checkers know of `__array__` only
        def __array__(self) -> npt.NDArray[Any]: ...

        # methods of arrays that `__getattr__` finds; the last four raise SeriesError
        astype: Callable[..., Jet]
        reshape: Callable[..., Jet]
        sum: Callable[..., Jet]
        max: Callable[..., Jet]
        min: Callable[..., Jet]
        any: Callable[..., Jet]
        all: Callable[..., Jet]

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: object) -> Any:
        return HOOKS["ufunc"](ufunc, method, inputs, options)

    def __array_function__(
        self, function: Callable[..., Any], types: Iterable[type], args: tuple[Any, ...], options: dict[str, Any]
    ) -> Any:
        return HOOKS["function"](function, args, options)

    # -- what branches on values -------------------------------------------------------------------------
    def __bool__(self) -> bool:
        raise _branch("the truth value of a series")

    def __float__(self) -> float:
        raise _branch(
            "float() of a series (or its assignment to an entry of a float array: use np.stack, np.zeros_like)"
        )

    __int__ = __index__ = __complex__ = __trunc__ = __floor__ = __ceil__ = __float__
    __hash__ = object.__hash__

    def _sympy_(self) -> Never:
        """Raise `SympifyError`, so that sympy leaves ``symbol * jet`` to Jet."""
        from sympy import SympifyError

        raise SympifyError(self)

    def __round__(self, digits: int | None = None) -> Never:
        raise _branch("rounding a series")

    # -- as a container ----------------------------------------------------------------------------------
    def __len__(self) -> int:
        if not self.shape:
            raise TypeError("len() of a series of numbers")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter([self[i] for i in range(len(self))])

    def __contains__(self, value: object) -> bool:
        raise _branch("membership in a series")

    def __getitem__(self, key: Key) -> Jet:
        if isinstance(key, Jet):
            raise _branch("an index that is a series")
        key = checked_index(key, self.node.value)
        kind = kind_of_index(key, self.ndim)
        if kind == "view":
            return self.part(lambda x: x[key], key=key if isinstance(key, tuple) else (key,))
        return Jet.from_node(recurrences.linear(lambda x: x[key], [self.node]), writable=kind == "copy")

    def __setitem__(self, key: Key, value: Operand) -> None:
        key = checked_index(key, self.node.value)
        if not self.shares():
            raise SeriesError(
                "this series is given, or a part of one: write into a copy (m.copy(), np.zeros_like(m)) or use np.stack"
            )
        node, part = nodes(self, value)
        jet, new = self, replaced(node, key, part)
        while (parent := jet._parent) is not None:
            if jet._key is None:
                raise SeriesError("this series is a transposed or reshaped view of another one: write into that one")
            jet, new = parent, replaced(parent.node, jet._key, new)
        jet._node = new

    def shares(self) -> bool:
        """Whether entries of this Jet, or of the Jet that it is a view of, may be assigned."""
        return self._writable or self._parent is not None

    def part(self, function: Callable[[Any], Any], *, key: Key = None) -> Jet:
        """Jet of a linear function of the values, such as a slice or a transpose, that shares entries with this Jet.

        If the function is x -> x[key], with a tuple as `key`, assignment into the result assigns to this Jet.

        Examples
        --------
        >>> m = Jet([[1.0, 2.0]]).copy()
        >>> part = m.part(lambda x: x[::-1])
        >>> m[0] = 5.0
        >>> part.value
        array([2., 5.])
        """
        jet = Jet.from_node(recurrences.linear(function, [self.node]))
        if self.shares():
            jet._parent, jet._seen, jet._function, jet._key = self, self._node, function, key
        return jet

    # -- methods that arrays have ------------------------------------------------------------------------
    def copy(self, order: str = "C") -> Jet:
        """A copy whose entries may be assigned."""
        return Jet.from_node(self.node, writable=True)

    __copy__ = copy

    def __deepcopy__(self, memo: object) -> Jet:
        return self.copy()

    def __reduce__(self) -> tuple[type[Jet], tuple[npt.NDArray[Any]]]:
        return Jet, (self.coefficients,)

    def __getattr__(self, name: str) -> Any:
        # other methods of arrays; numpy calls x.sin() for the entries of arrays of objects
        return HOOKS["method"](self, name)

    def __repr__(self) -> str:
        return f"<series of order {self.order} with values of shape {self.shape}>"


def _read_only(x: Coefficient) -> Any:
    """x, made read-only if it is a numpy array, as assignment into it would change the series."""
    if isinstance(x, np.ndarray):
        x.flags.writeable = False
    return x


def _checked(order: int) -> int:
    if not isinstance(order, int | np.integer) or isinstance(order, bool) or order < 0:
        raise SeriesError(f"the order of a series is a whole number from 0 on, got {order!r}")
    return int(order)


def _branch(what: str) -> SeriesError:
    return SeriesError(
        f"{what} depends on values, which a Taylor series does not allow; write the generator without branches, "
        f"or give it as sympy expressions; {WITHOUT_SERIES}"
    )


# One Jet from the nested lists and arrays of objects that generators return, as ``np.array([m[0] * m[1], 0.0])``.

T = TypeVar("T")


def holds_jets(x: object) -> bool:
    """Whether x is a Jet, or a nested list or array of objects with a Jet in it."""
    if isinstance(x, Jet):
        return True
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(entry, Jet) for entry in x.flat)
    return isinstance(x, list | tuple) and any(map(holds_jets, x))


def as_jet(x: Operand, order: int | None = None) -> Jet:
    """x as one Jet, with the entries of lists along the first axes.

    Parameters
    ----------
    x : Jet, array_like, or nested list or array of objects that holds Jets and numbers
        The entries of a list have one shape (else `ShapeError`); numbers stand for constant arrays of that shape.
    order : int, optional
        The order if x holds no Jet (else `SeriesError`); with Jets it is the lowest among them.

    Examples
    --------
    >>> import numpy as np
    >>> m = Jet([[1.0, 2.0], [3.0, 4.0]])
    >>> as_jet(np.array([m[0] * m[1], 5.0])).coefficients
    array([[ 2.,  5.],
           [10.,  0.]])
    """
    if isinstance(x, Jet):
        return x
    if not holds_jets(x):
        if order is None:
            raise SeriesError("an array without a Jet in it needs an order to become a Jet")
        return Jet.constant(_plain(x), order)
    shape, entries = _flattened(x)
    first = next(entry for entry in entries if isinstance(entry, Jet))
    inner = max((np.shape(entry) for entry in entries), key=len)
    for entry in entries:
        if np.shape(entry) not in ((), inner):
            raise ShapeError(f"entries of shapes {inner} and {np.shape(entry)} do not make one array; see np.stack")

    def stacked(*parts: Values) -> Values:
        xp = namespace(*parts)
        full = [part if np.shape(part) == inner else xp.broadcast_to(part, inner) for part in parts]
        if xp is np and not inner:
            return _array(full, shape)
        return xp.stack(full).reshape((*shape, *inner))

    return Jet.from_node(recurrences.linear(stacked, nodes(*entries, like=first)), writable=True)


def _array(parts: list[Values], shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Numbers as an array of this shape, without numpy looking into them."""
    out = np.empty(len(parts), np.result_type(*[getattr(part, "dtype", np.dtype(object)) for part in parts]))
    for i, part in enumerate(parts):
        out[i] = part[()] if isinstance(part, np.ndarray) else part
    return out.reshape(shape)


def _plain(x: Operand) -> Operand:
    """x, with a list of JAX arrays stacked by JAX, as numpy would look into their values."""
    if isinstance(x, list | tuple) and any(is_lazy(entry) for entry in x):
        return namespace(*x).stack([namespace(*x).asarray(entry) for entry in x])
    return x


def _flattened(x: Operand) -> tuple[tuple[int, ...], list[Operand]]:
    """(outer shape, entries in order) of a nested list or array of objects."""
    if isinstance(x, np.ndarray):
        return x.shape, list(x.flat)
    parts = [_flattened(entry) if isinstance(entry, list | tuple) else ((), [entry]) for entry in x]
    if len({shape for shape, _ in parts}) != 1:
        raise ShapeError("lists of several lengths do not make one array")
    if all(isinstance(entry, np.ndarray) and entry.dtype == object for entry in x):
        parts = [_flattened(entry) for entry in x]
    return (len(parts), *parts[0][0]), [entry for _, entries in parts for entry in entries]


def nodes(*values: Operand, like: Jet | None = None) -> list[Node]:
    """Nodes of Jets and constants, to the lowest order among the Jets; constants are of the kind of `like`."""
    parts = [x if type(x) is Jet or not holds_jets(x) else as_jet(x) for x in values]
    series = [x.node for x in parts if type(x) is Jet]
    if len(series) == len(parts):
        return series
    order = min(node.order for node in series)
    kind = series[0].value if like is None else like.node.value
    if not is_lazy(kind):
        kind = next((node.value for node in series if is_exact(np.asarray(node.value))), kind)
    return [x.node if type(x) is Jet else recurrences.constant(constant_like(kind, x), order) for x in parts]


def on_series(function: Callable[..., T], *arguments: object) -> T:
    """The value ``function(*arguments)``; if numpy fails because of a Jet in a float array, `SeriesError` says so.

    Writing a Jet into an entry of a float array ends in numpy's "setting an array element with a sequence".

    Examples
    --------
    >>> on_series(lambda m: 2 * m, Jet([1.0, 1.0])).coefficients
    array([2., 2.])
    """
    try:
        return function(*arguments)
    except (ValueError, TypeError) as error:
        reason: BaseException | None = error
        while reason is not None and not isinstance(reason, SeriesError):
            reason = reason.__cause__
        if reason is None or reason is error:
            raise
        raise SeriesError(str(reason)) from error
