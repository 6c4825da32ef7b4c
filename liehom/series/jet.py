"""Jet: a truncated Taylor series with array values, on which numpy code runs.

A Jet of order n stands for y(t) = y_0 + y_1 t + ... + y_n t^n + O(t^(n+1)) with arrays y_k of one shape; it
has the shape of its values, and numpy functions of it are Jets.  Coefficients are Taylor coefficients (no
factorials) and are computed on demand, so that a solution of a differential equation can be expanded in itself
(`growing`).  The values are numpy arrays of any dtype, JAX arrays, or exact scalars in object arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, Never, final

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin

from liehom.errors import SeriesError, ShapeError
from liehom.series import jet_views, recurrences
from liehom.series.arrays import NumbersLike, as_values, namespace, owned, zeros
from liehom.series.jet_dispatch import WITHOUT_SERIES, Operand, dispatch
from liehom.series.jet_views import View, ViewOperation
from liehom.series.node import Coefficient, Node, rewind
from liehom.typing import Key, Real


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

    __slots__ = ("_node", "_view", "_writable")

    def __init__(self, coefficients: NumbersLike) -> None:
        values = owned(as_values(coefficients))
        if values.ndim == 0:
            raise ShapeError("a Jet needs Taylor coefficients along a first axis, got a single number")
        if values.shape[0] == 0:
            raise ShapeError("a Jet has at least its coefficient 0, got an empty first axis")
        known = [values[k] for k in range(values.shape[0])]
        self._node = Node(len(known) - 1, known[0], known)
        self._view: View | None = None
        self._writable = False

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def from_node(cls, node: Node, *, writable: bool = False) -> Jet:
        """Jet with the coefficients of a node, for new recurrences.

        Examples
        --------
        >>> import numpy as np
        >>> from liehom.series.node import Node
        >>> Jet.from_node(Node(2, np.float64(1), [np.float64(1)], (), lambda k: np.float64(k))).coefficients
        array([1., 1., 2.])
        """
        made = cls.__new__(cls)
        made._node = node
        made._view = None
        made._writable = writable
        return made

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
        if zero:
            return cls.from_node(Node(_checked(order), zeros(first, first.shape), [None]))
        return cls.from_node(Node(_checked(order), first, [first]))

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
        node.known.append(self._given(coefficient))

    def _given(self, coefficient: Coefficient) -> Coefficient:
        if coefficient is not None and np.shape(coefficient) != self.shape:
            raise ShapeError(f"a coefficient of shape {np.shape(coefficient)} for a series of values {self.shape}")
        return owned(coefficient)

    def replace(self, k: int, coefficient: Coefficient, *results: Jet) -> None:
        """Replace coefficient k >= 1 of a growing series; coefficients of `results` that depend on it are recomputed.

        Raises
        ------
        SeriesError
            If coefficient k has not been appended by `extend`.

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
        self._node.known[k] = self._given(coefficient)
        for result in results:
            rewind(result.node, self._node, k)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def node(self) -> Node:
        """The node that computes the coefficients."""
        if self._view is not None and self._view.owner.node is not self._view.seen:
            self._node = jet_views.followed(self._view)[-1]
            self._view = self._view._replace(seen=self._view.owner.node)
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
        found: npt.NDArray[Any] = _read_only(self.node.value)
        return found

    @property
    def coefficients(self) -> npt.NDArray[Any]:
        """All Taylor coefficients, shape (order + 1, ...)."""
        if self.dtype == object and not self.shape:
            return np.array([self.coefficient(k)[()] for k in range(self.order + 1)], dtype=object)
        xp = namespace(self.node.value)
        found: npt.NDArray[Any] = xp.stack([self.coefficient(k) for k in range(self.order + 1)])
        return found

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
        found = self.node.coefficient(k)
        if found is None:
            return zeros(self.node.value, self.shape)
        made: npt.NDArray[Any] = _read_only(np.asarray(found) if not hasattr(found, "shape") else found)
        return made

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
        return dispatch.apply_ufunc(ufunc, method, inputs, options)

    def __array_function__(
        self, function: Callable[..., Any], types: Iterable[type], args: tuple[Any, ...], options: dict[str, Any]
    ) -> Any:
        return dispatch.apply_function(function, args, options)

    # -- what branches on values -------------------------------------------------------------------------
    def __bool__(self) -> bool:
        raise _branch("the truth value of a series")

    def __float__(self) -> float:
        raise _branch(
            "float() of a series (or its assignment to an entry of a float array: use np.stack, np.zeros_like)"
        )

    if TYPE_CHECKING:
        # raises like __float__
        def __int__(self) -> int: ...
        def __index__(self) -> int: ...
        def __complex__(self) -> complex: ...
        def __trunc__(self) -> int: ...
        def __floor__(self) -> int: ...
        def __ceil__(self) -> int: ...
    else:
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
        key = jet_views.checked_index(key, self.node.value)
        kind = jet_views.kind_of_index(key, self.ndim)
        if kind == "view":
            return self.part(lambda x: x[key], key=key, writable=True)
        return Jet.from_node(recurrences.linear(lambda x: x[key], [self.node]), writable=kind == "copy")

    def __setitem__(self, key: Key, value: Operand) -> None:
        key = jet_views.checked_index(key, self.node.value)
        if not self.shares():
            raise SeriesError(
                "this series is given, or a part of one: write into a copy (m.copy(), np.zeros_like(m)) or use np.stack"
            )
        whole, part = dispatch.nodes(self, value)
        if self._view is None:
            self._node = jet_views.replaced(whole, key, part)
        else:
            self._view.owner._node = jet_views.written(self._view, key, part)

    def shares(self) -> bool:
        """Whether entries of this Jet, or of the Jet that it is a view of, may be assigned."""
        return self._writable or self._view is not None

    def part(self, function: Callable[[Any], Any], *, key: Key = None, writable: bool = False) -> Jet:
        """Jet of a linear function of the values, such as a slice or a transpose, that shares entries with this Jet.

        Parameters
        ----------
        function : callable
            From arrays to arrays.
        key : index, optional
            If function(x) is x[key].
        writable : bool
            Whether assignment into the result assigns to entries of this Jet; needs `key`.

        Examples
        --------
        >>> m = Jet([[1.0, 2.0]]).copy()
        >>> part = m.part(lambda x: x[::-1])
        >>> m[0] = 5.0
        >>> part.value
        array([2., 5.])
        """
        made = Jet.from_node(recurrences.linear(function, [self.node]))
        operation = ViewOperation(function, key, writable)
        if self._writable:
            made._view = View(self, (operation,), self._node)
        elif self._view is not None:
            made._view = self._view._replace(operations=(*self._view.operations, operation))
        return made

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
        return dispatch.method(self, name)

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
