"""Jet: a truncated Taylor series with array values, on which ordinary numpy code runs.

A Jet of order n stands for y(t) = y_0 + y_1 t + ... + y_n t^n + O(t^(n+1)) with arrays y_k of one shape; it
has the shape of its values, and numpy functions of it are Jets.  Coefficients are Taylor coefficients (no
factorials) and are computed on demand, so that a solution of a differential equation can be expanded in itself
(`growing`).  The values are numpy arrays of any dtype, JAX arrays, or exact scalars in object arrays.
Imports node, recurrences, jet_functions, arrays, errors.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, final

import numpy as np

from liehom.errors import SeriesError, ShapeError
from liehom.series import recurrences
from liehom.series.arrays import as_values, is_jax, namespace, zeros
from liehom.series.node import Node, rewind


@final
class Jet:
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
    ``np.cross``, ``np.linalg.norm`` work on Jets (``__array_ufunc__``, ``__array_function__``).

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

    __slots__ = ("_node", "_writable")

    def __init__(self, coefficients: Any) -> None:
        values = as_values(coefficients)
        if values.ndim == 0:
            raise ShapeError("a Jet needs Taylor coefficients along a first axis, got a single number")
        if values.shape[0] == 0:
            raise ShapeError("a Jet has at least its coefficient 0, got an empty first axis")
        known = [values[k] for k in range(values.shape[0])]
        self._node = Node(len(known) - 1, known[0], known)
        self._writable = False

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def from_node(cls, node: Node, *, writable: bool = False) -> Jet:
        """The Jet of a node: the door for new recurrences.

        Examples
        --------
        >>> import numpy as np
        >>> from liehom.series.node import Node
        >>> Jet.from_node(Node(2, np.float64(1), [np.float64(1)], (), lambda k: np.float64(k))).coefficients
        array([1., 1., 2.])
        """
        made = cls.__new__(cls)
        made._node = node
        made._writable = writable
        return made

    @classmethod
    def variable(cls, value: Any, order: int, direction: Any = None) -> Jet:
        """value + direction t (direction 1 by default).

        Examples
        --------
        >>> Jet.variable([1.0, 2.0], 2, [0.0, 1.0]).coefficients.tolist()
        [[1.0, 2.0], [0.0, 1.0], [0.0, 0.0]]
        """
        first = as_values(value)
        slope = zeros(first, first.shape) + 1 if direction is None else as_values(direction)
        known = [first, slope, *[None] * (order - 1)][: order + 1]
        return cls.from_node(Node(order, first, known))

    @classmethod
    def constant(cls, value: Any, order: int) -> Jet:
        """A series without t.

        Examples
        --------
        >>> Jet.constant(3.0, 2).coefficients
        array([3., 0., 0.])
        """
        return cls.from_node(recurrences.constant(as_values(value), order))

    @classmethod
    def growing(cls, value: Any, order: int, *, zero: bool = False) -> Jet:
        """A series of which only the value at 0 is given; `extend` gives the next coefficients.

        Functions of it can be asked for the coefficients that are determined so far.

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
        >>> y.coefficients
        array([1., 1., 1., 1.])
        """
        first = as_values(value)
        return cls.from_node(Node(order, first, [None if zero else first]))

    def extend(self, coefficient: Any) -> None:
        """Give the next coefficient of a growing series; None is zero.

        Raises
        ------
        SeriesError
            If the series is not a growing one or is complete.
        """
        node = self._node
        if node.rule is not None or len(node.known) > node.order:
            raise SeriesError("only a growing series that is not complete can be extended")
        node.known.append(coefficient)

    def replace(self, k: int, coefficient: Any, *results: Jet) -> None:
        """Replace coefficient k >= 1 of a growing series, and let `results` forget what depended on it.

        Examples
        --------
        >>> x = Jet.growing(0.0, 2)
        >>> y = 3 * x
        >>> x.extend(1.0)
        >>> x.replace(1, 2.0, y)
        >>> float(y.coefficient(1))
        6.0
        """
        self._node.known[k] = coefficient
        for result in results:
            rewind(result.node, self._node, k)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def node(self) -> Node:
        """The node that computes the coefficients."""
        return self._node

    @property
    def order(self) -> int:
        """The last index of the coefficients."""
        return self._node.order

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the values."""
        return tuple(np.shape(self._node.value))

    @property
    def ndim(self) -> int:
        """The number of axes of the values."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """The number of entries of the values."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def dtype(self) -> Any:
        """The dtype of the values."""
        return getattr(self._node.value, "dtype", np.dtype(type(self._node.value)))

    @property
    def value(self) -> Any:
        """The value at t = 0."""
        return self._node.value

    @property
    def coefficients(self) -> Any:
        """All Taylor coefficients, shape (order + 1, ...)."""
        xp = namespace(self._node.value)
        return xp.stack([self.coefficient(k) for k in range(self.order + 1)])

    @property
    def T(self) -> Jet:
        """The transpose of the values."""
        return self.transpose()

    def coefficient(self, k: int) -> Any:
        """Taylor coefficient k, an array of the shape of the values (a structural zero as an array of zeros)."""
        found = self._node.coefficient(k)
        if found is None:
            return zeros(self._node.value, self.shape)
        return np.asarray(found, dtype=object) if self.dtype == object and not hasattr(found, "shape") else found

    def __call__(self, t: Any) -> Any:
        """The polynomial at t, by Horner's rule; t broadcasts against the values."""
        total = self.coefficient(self.order)
        for k in range(self.order - 1, -1, -1):
            total = total * t + self.coefficient(k)
        return total

    # -- arithmetic --------------------------------------------------------------------------------------
    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        from liehom.series.jet_functions import apply_ufunc

        return apply_ufunc(ufunc, method, inputs, options)

    def __array_function__(self, function: Any, types: Any, args: Any, options: Any) -> Any:
        from liehom.series.jet_functions import apply_function

        return apply_function(function, args, options)

    def __add__(self, other: Any) -> Any:
        return np.add(self, other)

    def __radd__(self, other: Any) -> Any:
        return np.add(other, self)

    def __sub__(self, other: Any) -> Any:
        return np.subtract(self, other)

    def __rsub__(self, other: Any) -> Any:
        return np.subtract(other, self)

    def __mul__(self, other: Any) -> Any:
        return np.multiply(self, other)

    def __rmul__(self, other: Any) -> Any:
        return np.multiply(other, self)

    def __truediv__(self, other: Any) -> Any:
        return np.true_divide(self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return np.true_divide(other, self)

    def __pow__(self, other: Any) -> Any:
        return np.power(self, other)

    def __rpow__(self, other: Any) -> Any:
        return np.power(other, self)

    def __matmul__(self, other: Any) -> Any:
        return np.matmul(self, other)

    def __rmatmul__(self, other: Any) -> Any:
        return np.matmul(other, self)

    def __neg__(self) -> Any:
        return np.negative(self)

    def __pos__(self) -> Jet:
        return self

    # -- what branches on values -------------------------------------------------------------------------
    def __bool__(self) -> bool:
        raise _branch("the truth value of a series")

    def __float__(self) -> float:
        raise _branch("float() of a series (or its assignment to an entry of an array: use np.stack or np.zeros_like)")

    __int__ = __index__ = __complex__ = __float__  # type: ignore[assignment]

    def __abs__(self) -> Any:
        return np.absolute(self)

    def __lt__(self, other: Any) -> Any:
        return np.less(self, other)

    def __le__(self, other: Any) -> Any:
        return np.less_equal(self, other)

    def __gt__(self, other: Any) -> Any:
        return np.greater(self, other)

    def __ge__(self, other: Any) -> Any:
        return np.greater_equal(self, other)

    def __eq__(self, other: object) -> Any:
        return np.equal(self, other)

    def __ne__(self, other: object) -> Any:
        return np.not_equal(self, other)

    __hash__ = object.__hash__

    # -- as a container ----------------------------------------------------------------------------------
    def __len__(self) -> int:
        if not self.shape:
            raise TypeError("len() of a series of numbers")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter([self[i] for i in range(len(self))])

    def __getitem__(self, key: Any) -> Jet:
        return Jet.from_node(recurrences.linear(lambda x: x[key], [self._node]))

    def __setitem__(self, key: Any, value: Any) -> None:
        if not self._writable:
            raise SeriesError(
                "this series is read-only, as a part of another one is: write into np.zeros_like(...) or use np.stack"
            )
        order = min(self.order, value.order) if isinstance(value, Jet) else self.order
        node = value.node if isinstance(value, Jet) else recurrences.constant(as_values(value), order)
        self._node = recurrences.linear(lambda whole, part: _replaced(whole, key, part), [self._node, node])

    # -- methods that arrays have ------------------------------------------------------------------------
    def transpose(self, *axes: Any) -> Any:
        """As numpy's method; so are the following ones."""
        return np.transpose(self, axes[0] if len(axes) == 1 else axes or None)

    def reshape(self, *shape: Any) -> Any:
        """See `transpose`."""
        return np.reshape(self, shape[0] if len(shape) == 1 else shape)

    def sum(self, axis: Any = None, keepdims: bool = False) -> Any:
        """See `transpose`."""
        return np.sum(self, axis=axis, keepdims=keepdims)

    def mean(self, axis: Any = None, keepdims: bool = False) -> Any:
        """See `transpose`."""
        return np.mean(self, axis=axis, keepdims=keepdims)

    def dot(self, other: Any) -> Any:
        """See `transpose`."""
        return np.dot(self, other)

    def trace(self, offset: int = 0, axis1: int = 0, axis2: int = 1) -> Any:
        """See `transpose`."""
        return np.trace(self, offset, axis1, axis2)

    def ravel(self) -> Any:
        """See `transpose`."""
        return np.reshape(self, (-1,))

    def swapaxes(self, a: int, b: int) -> Any:
        """See `transpose`."""
        return np.swapaxes(self, a, b)

    def copy(self) -> Jet:
        """A copy whose entries may be assigned."""
        return Jet.from_node(self._node, writable=True)

    def __getattr__(self, name: str) -> Any:
        # numpy calls x.sin() for the entries of arrays of objects, such as np.array([m[0], m[1]])
        if name in recurrences.FUNCTIONS:
            return lambda: getattr(np, name)(self)
        raise AttributeError(f"a series has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"<series of order {self.order} with values of shape {self.shape}>"


def _replaced(whole: Any, key: Any, part: Any) -> Any:
    if is_jax(whole) or is_jax(part):
        return namespace(whole, part).asarray(whole).at[key].set(part)
    out = np.array(whole, dtype=np.result_type(whole, part))
    out[key] = part
    return out


def _branch(what: str) -> SeriesError:
    return SeriesError(
        f"{what} depends on values, which a Taylor series does not allow; write the generator without branches, "
        "or give it as sympy expressions"
    )
