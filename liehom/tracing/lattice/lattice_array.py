"""LatticeTraced: values at one site of a lattice, on which numpy code for the whole lattice runs.

Its shape is (n_1, ..., n_L, ...) as for arrays of values at all sites, but it holds one site only. Functions of the
last axes run on that site. np.roll along an axis of the lattice shifts the sites at which numbers are loaded, and
arrays of numbers over the lattice become loads too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, final

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin

from liehom.errors import TraceError
from liehom.tracing.array import Operand, Traced, expr_array
from liehom.tracing.expr import Expr
from liehom.tracing.graph import Tape
from liehom.typing import Array, Key

Offset = tuple[int, ...]
"""A shift of sites, one integer for each axis of the lattice."""

MATRIX_PRODUCTS = frozenset(["matmul", "matvec", "vecmat"])
REDUCTIONS = frozenset(["sum", "max", "min", "amax", "amin", "prod", "mean", "all", "any", "norm", "cumsum"])


@final
class SiteInputs:
    """The inputs of a graph that are loaded at a site of the lattice or at a shifted one.

    Attributes
    ----------
    sites : tuple of int
        Lengths of the axes.
    loads : dict
        (plane, offset) of an input, by its index; planes are named by (kind, number, component).
    arrays : list of arrays over the lattice
        The planes ("array", number, 0).

    Examples
    --------
    >>> inputs = SiteInputs(Tape(), (4, 4))
    >>> x = inputs.load(("m", 0, 0), (0, 0))
    >>> inputs.loads[inputs.shifted(x, (1, 0)).value]
    (('m', 0, 0), (1, 0))
    """

    sites: tuple[int, ...]
    tape: Tape

    def __init__(self, tape: Tape, sites: tuple[int, ...]) -> None:
        self.tape, self.sites = tape, sites
        self.loads: dict[int, tuple[tuple[str, int, int], Offset]] = {}
        self.arrays: list[Array] = []
        self._known: dict[tuple[tuple[str, int, int], Offset], Expr] = {}
        self._count = 0

    def fresh(self) -> Expr:
        """A new input that is not loaded, such as the time."""
        self._count += 1
        return self.tape.input(self._count - 1)

    def load(self, plane: tuple[str, int, int], offset: Offset) -> Expr:
        """The number of a plane at a shifted site."""
        if (plane, offset) not in self._known:
            made = self._known[plane, offset] = self.fresh()
            self.loads[made.value] = plane, offset
        return self._known[plane, offset]

    def array(self, values: Array) -> Expr:
        """The number of an array over the lattice at the site; arrays that are equal everywhere are constants."""
        first = float(values.flat[0])
        if bool((values == first).all()):
            return self.tape.constant(first)
        number = next((i for i, a in enumerate(self.arrays) if np.array_equal(a, values)), None)
        if number is None:
            number = len(self.arrays)
            self.arrays.append(np.array(values, dtype=np.float64))
        return self.load(("array", number, 0), (0,) * len(self.sites))

    def shifted(self, x: Expr, offset: Offset) -> Expr:
        """A number at the site that is shifted by an offset."""
        known: dict[int, Expr] = {}

        def moved(y: Expr) -> Expr:
            if y.index not in known:
                if y.op == "input" and y.value in self.loads:
                    plane, own = self.loads[y.value]
                    known[y.index] = self.load(plane, tuple(a + b for a, b in zip(own, offset, strict=True)))
                elif not y.args:
                    known[y.index] = y
                else:
                    known[y.index] = self.tape.again(y, tuple(moved(a) for a in y.args))
            return known[y.index]

        return moved(x)


@final
class LatticeTraced(NDArrayOperatorsMixin):
    """Values at one site of a lattice, with the shape of an array over the lattice.

    Parameters
    ----------
    inputs : SiteInputs
    inner : Traced
        Of shape (1, ..., 1, ...), with one axis of length 1 for each axis of the lattice.

    Examples
    --------
    >>> inputs = SiteInputs(Tape(), (4, 4))
    >>> entries = [inputs.load(("m", 0, c), (0, 0)) for c in range(3)]
    >>> m = LatticeTraced(inputs, Traced(inputs.tape, np.array(entries, dtype=object).reshape(1, 1, 3)))
    >>> (np.roll(m, 1, axis=0) + m).shape, len(inputs.loads)
    ((4, 4, 3), 6)
    """

    inner: Traced
    inputs: SiteInputs

    __slots__ = ("inner", "inputs")
    __array_priority__: float = 200.0
    __hash__ = object.__hash__

    def __init__(self, inputs: SiteInputs, inner: Traced) -> None:
        if inner.shape[: len(inputs.sites)] != (1,) * len(inputs.sites):
            raise TraceError("psi mixes sites of the lattice other than by np.roll, which is not compiled")
        self.inputs, self.inner = inputs, inner

    @property
    def shape(self) -> tuple[int, ...]:
        """Tuple of axis lengths, as for arrays over the lattice."""
        return (*self.inputs.sites, *self.inner.shape[len(self.inputs.sites) :])

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self.inner.ndim

    @property
    def size(self) -> int:
        """Number of entries of the whole lattice."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the entries, float64 or bool."""
        return self.inner.dtype

    def __getitem__(self, key: Key) -> LatticeTraced:
        parts = key if isinstance(key, tuple) else (key,)
        if parts[:1] != (Ellipsis,) and any(part != slice(None) for part in parts[: len(self.inputs.sites)]):
            raise TraceError("sites of the lattice are picked by an index, which is not compiled: write np.roll")
        return LatticeTraced(self.inputs, self.inner[key])

    def __len__(self) -> int:
        return self.shape[0]

    def reshape(self, *shape: Operand) -> LatticeTraced:
        """Array with other last axes."""
        wanted = tuple(shape[0]) if len(shape) == 1 and not isinstance(shape[0], int) else shape
        lattice = len(self.inputs.sites)
        if wanted[:lattice] != self.inputs.sites:
            raise TraceError("psi reshapes the axes of the lattice, which is not compiled")
        return LatticeTraced(self.inputs, self.inner.reshape((1,) * lattice + wanted[lattice:]))

    def __bool__(self) -> bool:
        return bool(self.inner)

    def __repr__(self) -> str:
        return f"<one site of an array of shape {self.shape}>"

    # -- numpy's protocols -------------------------------------------------------------------------------
    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        raise TraceError(
            "psi makes an array of numbers of values on the lattice, which compiled code does not know yet"
        )

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: Operand) -> Operand:
        if any(type(x).__name__ == "Jet" for x in inputs):
            return NotImplemented
        out = options.pop("out", None)
        if method != "__call__":
            raise TraceError(f"np.{ufunc.__name__}.{method} cannot be compiled on a lattice")
        inner = max(x.ndim for x in inputs if isinstance(x, LatticeTraced))
        # a matrix has two axes of its own
        matrices = ufunc.__name__ in MATRIX_PRODUCTS
        values = [x if matrices and _is_matrix(x) else self._at_site(x, inner) for x in inputs]
        made = LatticeTraced(self.inputs, ufunc(*values, **options))
        if out is None:
            return made
        if not isinstance(out[0], LatticeTraced):
            raise TraceError(f"np.{ufunc.__name__} writes into an array of floats: use x = x + y in place of x += y")
        out[0].inner.entries[...] = made.inner.entries
        return out[0]

    def __array_function__(
        self,
        function: Callable[..., Any],
        types: Iterable[type],
        args: tuple[Operand, ...],
        options: dict[str, Operand],
    ) -> Operand:
        name, sites = function.__name__, self.inputs.sites
        first = args[0] if args else None
        if name == "roll":
            return self._rolled(*args, **options)
        if name in ("shape", "ndim") and isinstance(first, LatticeTraced):
            return getattr(first, name)
        if name == "broadcast_to" and isinstance(first, LatticeTraced):
            shape = tuple(args[1])
            inner_shape = (1,) * len(sites) + shape[len(sites) :]
            spread: Operand = np.broadcast_to(first.inner.entries, inner_shape)
            return LatticeTraced(self.inputs, Traced(self.inputs.tape, spread))
        if name in REDUCTIONS and isinstance(first, LatticeTraced):
            axis = args[1] if len(args) > 1 and name != "norm" else options.get("axis")
            axes = (axis,) if isinstance(axis, int) else tuple(axis or ())
            if not axes or any(a % first.ndim < len(sites) for a in axes):
                raise TraceError(
                    f"np.{name} over the sites of the lattice is not compiled: sum over the last axes only"
                )
        inner = max(_dimensions(args), _dimensions(tuple(options.values())))
        made = function(*self._at_sites(args, inner), **{k: self._at_sites(v, inner) for k, v in options.items()})
        if isinstance(made, list | tuple):
            return type(made)(LatticeTraced(self.inputs, x) for x in made)
        return LatticeTraced(self.inputs, made) if isinstance(made, Traced) else made

    def _rolled(self, x: Operand, shift: Operand, axis: Operand = None) -> LatticeTraced:
        lattice = len(self.inputs.sites)
        if axis is None or not isinstance(x, LatticeTraced):
            raise TraceError("np.roll without an axis is not compiled on a lattice")
        pairs = np.broadcast(shift, axis)
        made, offset = x.inner.entries, [0] * lattice
        for number, place in pairs:
            if int(place) % x.ndim < lattice:
                offset[int(place) % x.ndim] -= int(number)
            else:
                made = np.roll(made, int(number), axis=int(place))
        entries = np.empty(made.shape, dtype=object)
        for index, entry in np.ndenumerate(made):
            entries[index] = self.inputs.shifted(entry, tuple(offset))
        return LatticeTraced(self.inputs, Traced(self.inputs.tape, entries))

    def _at_sites(self, x: Operand, inner: int) -> Operand:
        if isinstance(x, list | tuple) and any(isinstance(e, LatticeTraced | np.ndarray | list | tuple) for e in x):
            return type(x)(self._at_sites(e, inner) for e in x)
        return self._at_site(x, inner)

    def _at_site(self, x: Operand, ndim: int) -> Operand:
        """A value at the site; an array with the axes of the lattice becomes one load for each of its last entries."""
        if isinstance(x, LatticeTraced):
            return x.inner
        lattice = len(self.inputs.sites)
        inner = ndim - lattice
        if not isinstance(x, np.ndarray) or x.ndim <= inner or x.dtype.kind not in "biuf":
            return x
        own = x.reshape((1,) * (ndim - x.ndim) + x.shape)
        if own.shape[:lattice] == (1,) * lattice:
            return own
        whole = np.broadcast_to(own, (*self.inputs.sites, *own.shape[lattice:]))
        entries = np.empty(own.shape[lattice:], dtype=object)
        for index in np.ndindex(entries.shape):
            found = self.inputs.array(whole[(slice(None),) * lattice + index])
            entries[index] = self.inputs.tape.truth(found) if x.dtype.kind == "b" else found
        return Traced(self.inputs.tape, expr_array(self.inputs.tape, entries.reshape((1,) * lattice + entries.shape)))


def _is_matrix(x: object) -> bool:
    return isinstance(x, np.ndarray) and x.ndim == 2


def _dimensions(x: Operand) -> int:
    """The largest number of axes of a lattice array among arguments."""
    if isinstance(x, LatticeTraced):
        return x.ndim
    return max(map(_dimensions, x), default=0) if isinstance(x, list | tuple) else 0
