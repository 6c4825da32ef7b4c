"""GeneratorField: a vector field X(m) = rho(psi(m)) m on the orbits of a representation, by its generator psi.

The user gives psi, or only X; then psi is the generator of minimal norm.  psi returns one coefficient per basis element
of g, or one per matrix that the user gave to `Representation.from_matrices`.
"""

from __future__ import annotations

from typing import Any, final, overload

import numpy as np

from liehom.errors import InputError, ShapeError, displayed
from liehom.homogeneous.fields.components import Components, GeneratorLike
from liehom.homogeneous.fields.least_norm import RANK_RTOL, TANGENCY_RTOL, LeastNorm
from liehom.homogeneous.maps import action_map
from liehom.homogeneous.range.batched_ranks import batched_ranks
from liehom.immutable import Immutable
from liehom.representations import Representation
from liehom.representations.core.copies import copies_of
from liehom.series.arrays import as_values, is_traced, namespace, zeros
from liehom.series.jet import Jet
from liehom.typing import Array, IntegerArray, Pytree, Real, Values, ValuesLike


@final
class GeneratorField(Immutable):
    """The vector field X(m, t) = rho(psi(m, t)) m.

    Parameters
    ----------
    representation : Representation
        rho, on vectors of N coordinates, of an algebra of dimension r.
    psi : callable, array or sequence
        The generator: a function psi(m), psi(m, t) or psi(m, t, args) that returns an array of shape (..., r) for m
        of shape (..., N) and t of shape (...,), written with numpy functions; or r components, each a number, a string
        such as "1 + m0**2*sin(t)", or a sympy expression in m0, m1, ..., t; or a constant array. If the algebra is the
        closure of fewer given matrices, psi may have one coefficient for each of these.
    time_dependent : bool, optional
        Whether a function psi is called with t. By default it is if it has a second parameter without a default, or
        a parameter named t.
    sites : tuple of int
        Lengths of the last leading axes of m, if these are the sites of a lattice that psi couples by np.roll. All
        sites of a lattice are then integrated with one step size.

    Raises
    ------
    ShapeError
        If psi has the wrong number of components.
    InputError
        If psi has none of these forms.

    Notes
    -----
    These are equations (2.2) and (2.3) of the paper, with the convention that g is a matrix algebra.

    The arguments `args` of a function psi(m, t, args) are any pytree: numbers and arrays in dicts, lists, tuples and
    dataclasses. They are given when the field is integrated, ``integrate(field, ..., args=...)``, or by `with_args`.
    Compiled code takes them as inputs, so that one compiled step serves all values; what psi closes over is compiled
    into it. A psi without t may be psi(m, args), with this name.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> m = np.array([0.6, 0.0, 0.8])
    >>> field.psi(m), round(float(field.vector(m) @ m), 15)
    (array([0.6, 0. , 2.4]), 0.0)
    """

    representation: Representation
    source: GeneratorLike | LeastNorm | Components

    __slots__ = ("_action", "_components", "_dimension", "_sites", "representation", "source", "time_dependent")

    def __init__(
        self,
        representation: Representation,
        psi: GeneratorLike | LeastNorm | Components,
        *,
        time_dependent: bool | None = None,
        sites: tuple[int, ...] = (),
    ) -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        self.representation = representation
        self.source = psi
        self._action = action_map(representation)
        dimension = representation.algebra.dimension
        counts = (representation.given, dimension)
        self._components: Components | LeastNorm = (
            psi
            if isinstance(psi, LeastNorm | Components)
            else Components(psi, representation.size, counts, "psi", time_dependent)
        )
        self._dimension = dimension
        self.time_dependent: bool = self._components.time_dependent
        self._sites: tuple[int, ...] = sites

    @property
    def sites(self) -> tuple[int, ...]:
        """Lengths of the axes of the lattice whose sites psi couples; () for other fields."""
        return self._sites

    def __setstate__(self, state: tuple[None, dict[str, Any]]) -> None:
        for name, value in {"_sites": (), **state[1]}.items():  # pickles of 0.1.0 have no sites
            setattr(self, name, value)

    @classmethod
    def from_vector_field(
        cls,
        representation: Representation,
        field: GeneratorLike,
        *,
        orbit_dimension: int | None = None,
        rtol: float = TANGENCY_RTOL,
        time_dependent: bool | None = None,
    ) -> GeneratorField:
        """The field with the generator of minimal norm of a vector field X(m) or X(m, t) tangent to the orbits.

        Parameters
        ----------
        representation : Representation
        field : callable or sequence
            X in one of the forms that psi may have, with N components.
        orbit_dimension : int, optional
            The dimension of the orbits (default: the numerical rank at each point).
        rtol : float
            Largest admissible normal component of X, relative to X.
        time_dependent : bool, optional
            See `GeneratorField`.

        Raises
        ------
        TangencyError
            On evaluation at points where X is not tangent to the orbit; shows the normal component.

        Notes
        -----
        psi(m) = A^+ X with A = [rho(b_1) m, ..., rho(b_r) m] in an orthonormal basis of g (`inner_product`). At an
        equilibrium psi is 0. If the inner product is Ad-invariant, psi is equivariant wherever X is.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross([0, 0, 1], m))
        >>> np.round(field.vector(np.array([0.6, 0, 0.8])), 12)
        array([0. , 0.6, 0. ])
        """
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        return cls(representation, LeastNorm(representation, field, orbit_dimension, rtol, time_dependent))

    @property
    def takes_args(self) -> bool:
        """Whether psi, or the vector field, is a function with args."""
        return self._components.takes_args

    @property
    def args(self) -> Pytree:
        """The args that psi is called with, a pytree; None if it has none."""
        bound = self._components.bound
        return bound[0] if bound else None

    def with_args(self, args: Pytree) -> GeneratorField:
        """The field with these args, whose psi is a function of (m, t).

        Parameters
        ----------
        args : pytree

        Raises
        ------
        InputError
            If psi takes no args.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
        >>> field.with_args({"inertia": np.array([1.0, 2.0, 4.0])}).psi(np.array([0.6, 0.0, 0.8]))
        array([-0.6, -0. , -0.2])
        """
        return GeneratorField(self.representation, self._components.with_args(args), sites=self.sites)

    def psi(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The generator at m (..., N) and t: an array or Jet of shape (..., r)."""
        made: Values = self._components(m, t)
        missing = self._dimension - int(made.shape[-1])
        if missing == 0:
            return made
        value = made.value if isinstance(made, Jet) else made
        blank = zeros(value, (*value.shape[:-1], missing))
        xp = np if isinstance(made, Jet) else namespace(value)
        filled: Values = xp.concatenate([made, blank], axis=-1)
        return filled

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check the field at initial points, before integration.

        Parameters
        ----------
        m : array of shape (..., N)
        t : float or array of shape (...,)

        Raises
        ------
        ShapeError
            If m or psi(m, t) has the wrong shape, or psi of one trajectory depends on the points of others.
        TangencyError
            If a vector field is not tangent to the orbits.
        InputError
            If a component of psi is not a finite real number; names it. Exceptions raised by psi are not caught.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> lh.GeneratorField(lh.defining(lh.so(2)), ["log(m0)"]).check(np.array([[1.0, 0.0], [0.0, 1.0]]))
        Traceback (most recent call last):
        ...
        liehom.errors.InputError: psi[0] is -inf at m = [0. 1.], t = 0.0 (trajectory 1): start where it is defined, ...
        """
        self._components.check(m, t)

    @overload
    def vector(self, m: Jet, t: Real = 0.0) -> Jet: ...
    @overload
    def vector(self, m: ValuesLike, t: Real = 0.0) -> Values: ...
    def vector(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The vector X(m, t) = rho(psi(m, t)) m, an array or Jet of shape (..., N)."""
        return self.infinitesimal(self.psi(m, t), m)

    @overload
    def infinitesimal(self, x: Jet, m: ValuesLike) -> Jet: ...
    @overload
    def infinitesimal(self, x: ValuesLike, m: Jet) -> Jet: ...
    @overload
    def infinitesimal(self, x: ValuesLike, m: ValuesLike) -> Values: ...
    def infinitesimal(self, x: ValuesLike, m: ValuesLike) -> Values:
        """The vector rho(x) m for x (..., r) and m (..., N)."""
        return self._action(x, m)

    def frobenius_norms(self, x: Values, m: Values) -> Array | None:
        """The Frobenius norms of rho(x), shape (...,), for large ensembles, where they are cheap; else None."""
        return self._action.frobenius_norms(x) if self._action.works_by_columns(x, m) else None

    def __repr__(self) -> str:
        kind = "time-dependent " if self.time_dependent else ""
        return f"<{kind}generator field of {displayed(self.representation)}>"


def check_point(representation: Representation, m: ValuesLike, *, fixed: bool = False) -> IntegerArray:
    """Dimensions of the orbits of points, shape (...), after a check of the points.

    Parameters
    ----------
    representation : Representation
    m : array_like of shape (..., N)
    fixed : bool
        Whether points that the group fixes are admissible; the dimension of their orbits is 0.

    Raises
    ------
    ShapeError
        If m does not have N coordinates.
    InputError
        If a point is not finite, or the group fixes it and `fixed` is false.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> int(check_point(lh.defining(lh.so(3)), np.array([0, 0, 1.0])))
    2
    """
    given: Values = as_values(m)
    if given.ndim == 0 or given.shape[-1] != representation.size:
        raise ShapeError(f"a point has {representation.size} coordinates (on its last axis), got shape {given.shape}")
    if is_traced(given):
        raise InputError("the dimension of an orbit cannot be found from a traced point: check it outside of jax.jit")
    point = np.asarray(given, dtype=float)
    if not bool(np.all(np.isfinite(point))):
        raise InputError(f"the point {given} is not finite")
    copies = copies_of(representation)
    matrices = representation.matrices if copies is None else copies.single.matrices
    scale = max((float(np.abs(a.to_numpy()).max(initial=0.0)) for a in matrices), default=0.0)
    bound = RANK_RTOL * scale * np.linalg.norm(point, axis=-1)
    ranks: IntegerArray = batched_ranks(action_map(representation).right(point), bound)
    if not fixed and bool(np.any(ranks == 0)):
        index = tuple(int(i) for i in np.argwhere(ranks == 0)[0])
        where = f" (trajectory {index[0] if len(index) == 1 else index})" if index else ""
        raise InputError(f"the group leaves the point {given[index]}{where} fixed: its orbit has dimension 0")
    return ranks
