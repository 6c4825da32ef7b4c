"""Types that signatures of all layers name: arrays by their entries, numbers, values that numpy code runs on.

Input that numpy converts is `numpy.typing.ArrayLike`, as in numpy's own signatures; `MatrixLike`, what is read as a
matrix over a field, stands beside `liehom.scalars.Matrix`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
"""A numpy array of float64; shapes are in the docstring."""

IntegerArray: TypeAlias = npt.NDArray[np.int64]
"""A numpy array of int64."""

BooleanArray: TypeAlias = npt.NDArray[np.bool_]
"""A numpy array of booleans: a mask, or one answer per trajectory."""

ComplexArray: TypeAlias = npt.NDArray[np.complex128]
"""A numpy array of complex128."""

ObjectArray: TypeAlias = npt.NDArray[np.object_]
"""A numpy array of Python objects: exact numbers, sympy expressions."""

Key: TypeAlias = Any
"""What stands in the brackets of an array: integers, slices, Ellipsis, masks, and tuples of these."""


class Number(Protocol):
    """What has the arithmetic of a field: numbers of Python, numpy, flint and sympy, elements of number fields."""

    def __neg__(self) -> Any: ...
    def __add__(self, other: Any, /) -> Any: ...
    def __radd__(self, other: Any, /) -> Any: ...
    def __sub__(self, other: Any, /) -> Any: ...
    def __rsub__(self, other: Any, /) -> Any: ...
    def __mul__(self, other: Any, /) -> Any: ...
    def __rmul__(self, other: Any, /) -> Any: ...
    def __truediv__(self, other: Any, /) -> Any: ...
    def __rtruediv__(self, other: Any, /) -> Any: ...


ScalarLike: TypeAlias = int | float | str | Number
"""What a field reads as one of its elements: numbers of Python, numpy, flint and sympy, strings such as "1/2"."""

VectorLike: TypeAlias = Sequence[ScalarLike] | npt.NDArray[Any]
"""What a field reads as a row of its elements."""


class Values(Protocol):
    """What numpy code runs on: numpy arrays, `liehom.Jet`, the tracers of `liehom.tracing`, JAX arrays.

    Code written for `Values` uses numpy's operators and functions only, so the same lines compute with numbers,
    expand in Taylor series and record a graph to be compiled. The last axis holds components, leading axes hold
    trajectories.
    """

    @property
    def shape(self) -> tuple[int, ...]:
        """Tuple of axis lengths."""
        ...

    @property
    def ndim(self) -> int:
        """Number of axes."""
        ...

    def __array__(self) -> npt.NDArray[Any]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: Any, /) -> Any: ...
    def __neg__(self) -> Values: ...
    def __add__(self, other: Any, /) -> Values: ...
    def __radd__(self, other: Any, /) -> Values: ...
    def __sub__(self, other: Any, /) -> Values: ...
    def __rsub__(self, other: Any, /) -> Values: ...
    def __mul__(self, other: Any, /) -> Values: ...
    def __rmul__(self, other: Any, /) -> Values: ...
    def __truediv__(self, other: Any, /) -> Values: ...
    def __rtruediv__(self, other: Any, /) -> Values: ...
    def __pow__(self, other: Any, /) -> Values: ...
    def __matmul__(self, other: Any, /) -> Values: ...
    def __rmatmul__(self, other: Any, /) -> Values: ...


Real: TypeAlias = "float | Values"
"""A real number, or one per trajectory: a time, a step size."""
