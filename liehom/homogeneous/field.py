"""GeneratorField: a vector field X(m) = rho(psi(m)) m on the orbits of a representation, by its generator psi.

psi may be given, or only X, of which the generator of least norm is then computed.  Psi returns one coefficient per
basis element of g, or one per matrix that the user gave to `Representation.from_matrices`.
Imports generator, inner_product, maps, series, representations, errors.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.errors import InputError, ShapeError, TangencyError
from liehom.homogeneous.generator import Components
from liehom.homogeneous.inner_product import inner_product
from liehom.homogeneous.maps import action_map
from liehom.representations import Representation
from liehom.series.arrays import is_exact, is_jax
from liehom.series.jet import Jet

RANK_RTOL = 1e-9
TANGENCY_RTOL = 1e-8


@final
class GeneratorField:
    """The vector field X(m, t) = rho(psi(m, t)) m.

    Parameters
    ----------
    representation : Representation
        rho, on vectors of N coordinates, of an algebra of dimension r.
    psi : callable or sequence
        The generator: a function psi(m) or psi(m, t) that returns an array of shape (..., r) for m of shape
        (..., N) and t of shape (...,), written with numpy functions; or r components, each a number, a text such
        as "1 + m0**2*sin(t)", or a sympy expression in m0, m1, ..., t. Where the algebra was closed from fewer
        given matrices, psi may have one coefficient for each of these.
    time_dependent : bool, optional
        Whether psi depends on t; by default read off from its parameters or symbols.

    Raises
    ------
    ShapeError
        If psi has the wrong number of components.
    InputError
        If psi is none of these forms.

    Notes
    -----
    Equations (2.2), (2.3) of the paper with the convention that g is a matrix algebra.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> m = np.array([0.6, 0.0, 0.8])
    >>> field.psi(m), round(float(field.vector(m) @ m), 15)
    (array([0.6, 0. , 2.4]), 0.0)
    """

    __slots__ = ("_action", "_components", "representation", "source", "time_dependent")

    def __init__(self, representation: Representation, psi: Any, *, time_dependent: bool | None = None) -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {representation!r}")
        self.representation = representation
        self.source = psi
        self._action = action_map(representation)
        dimension = representation.algebra.dimension
        if isinstance(psi, _LeastNorm):
            self._components: Any = psi
        else:
            self._components = Components(psi, representation.size, (representation.given, dimension), "psi")
        if time_dependent is not None and callable(psi):
            self._components.time_dependent = time_dependent
        self.time_dependent: bool = self._components.time_dependent

    @classmethod
    def from_vector_field(
        cls, representation: Representation, field: Any, *, orbit_dimension: int | None = None
    ) -> GeneratorField:
        """The field with the generator of least norm of a given vector field X(m) or X(m, t) tangent to the orbits.

        Parameters
        ----------
        representation : Representation
        field : callable or sequence
            X in one of the forms that psi may have, with N components.
        orbit_dimension : int, optional
            The dimension of the orbits, where the numerical rank at the points is not to decide.

        Raises
        ------
        TangencyError
            When it is evaluated where X is not tangent to the orbit; shows the normal component.

        Notes
        -----
        psi(m) = A^T (A A^T)^+ X with A = [rho(e_1) m, ..., rho(e_r) m] in an orthonormal basis of g
        (`inner_product`).

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross([0, 0, 1], m))
        >>> np.round(field.vector(np.array([0.6, 0, 0.8])), 12)
        array([0. , 0.6, 0. ])
        """
        return cls(representation, _LeastNorm(representation, field, orbit_dimension))

    def psi(self, m: Any, t: Any = 0.0) -> Any:
        """The generator at m (..., N) and t: an array or Jet of shape (..., r)."""
        made = self._components(m, t)
        missing = self.representation.algebra.dimension - int(made.shape[-1])
        if missing == 0:
            return made
        value = made.value if isinstance(made, Jet) else made
        blank = 0 * value[..., :1].repeat(missing, axis=-1)
        if is_jax(value) and not isinstance(made, Jet):
            from liehom.series.arrays import namespace

            return namespace(value).concatenate([made, blank], axis=-1)
        return np.concatenate([made, blank], axis=-1)

    def vector(self, m: Any, t: Any = 0.0) -> Any:
        """X(m, t) = rho(psi(m, t)) m, an array or Jet of shape (..., N)."""
        return self.infinitesimal(self.psi(m, t), m)

    def infinitesimal(self, x: Any, m: Any) -> Any:
        """rho(x) m for x (..., r) and m (..., N)."""
        return self._action(x, m)

    def __repr__(self) -> str:
        kind = "time-dependent " if self.time_dependent else ""
        return f"<{kind}generator field of {self.representation!r}>"


@final
class _LeastNorm:
    """(m, t) -> the generator of least norm of a vector field."""

    def __init__(self, representation: Representation, field: Any, orbit_dimension: int | None) -> None:
        self._field = Components(field, representation.size, (representation.size,), "the vector field")
        self.time_dependent = self._field.time_dependent
        self._action = action_map(representation)
        self._basis = inner_product(representation).orthonormal_basis()
        self._dimension = orbit_dimension

    def __call__(self, m: Any, t: Any = 0.0) -> Any:
        x = self._field(m, t)
        value = m.value if isinstance(m, Jet) else m
        if is_exact(value):
            raise InputError("the generator of least norm is computed in floats; give psi itself for exact numbers")
        normal = self._normal_space(np.asarray(value, dtype=float), x)
        columns = np.einsum("...ia,ab->...ib", self._action.right(m), self._basis)
        # X lies in the range of A A^T, and `normal` completes it to an invertible matrix: along a curve it stays
        # complementary to the tangent spaces, so that it need not be followed.
        square = np.einsum("...ia,...ja->...ij", columns, columns) + normal
        y = _solve(square, x[..., None])[..., 0]
        return np.einsum("...ia,...i,ba->...b", columns, y, self._basis)

    def _normal_space(self, m: Any, x: Any) -> Any:
        """The projector on the normal space at m, scaled as A A^T is; checks that X is tangent."""
        columns = self._action.right(m) @ self._basis
        left, sizes, _ = np.linalg.svd(columns)
        padded = np.zeros((*left.shape[:-2], left.shape[-1]))
        padded[..., : sizes.shape[-1]] = sizes
        if self._dimension is None:
            outside = padded <= RANK_RTOL * padded[..., :1]
        else:
            outside = np.broadcast_to(np.arange(left.shape[-1]) >= self._dimension, padded.shape)
        basis = left * outside[..., None, :]
        field = np.asarray(x.value if isinstance(x, Jet) else x, dtype=float)
        normal = (basis @ (np.swapaxes(basis, -1, -2) @ field[..., None]))[..., 0]
        size = np.linalg.norm(field, axis=-1, keepdims=True)
        if bool(np.any(np.linalg.norm(normal, axis=-1, keepdims=True) > TANGENCY_RTOL * (size + _tiny(m)))):
            raise _not_tangent(m, field, normal)
        return basis @ np.swapaxes(basis, -1, -2) * (padded[..., :1, None] ** 2)


def _tiny(m: Any) -> Any:
    """What counts as zero next to points of this size."""
    return 1e-6 * np.linalg.norm(m, axis=-1, keepdims=True)


def _solve(a: Any, b: Any) -> Any:
    if getattr(a, "dtype", None) == np.longdouble and not isinstance(a, Jet):
        from liehom.homogeneous.cayley import _solve as refined

        return refined(a, b)
    return np.linalg.solve(a, b)


def _not_tangent(m: Any, field: Any, normal: Any) -> TangencyError:
    sizes = np.linalg.norm(normal, axis=-1)
    index = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    where = f" of trajectory {tuple(int(i) for i in index)}" if index else ""
    return TangencyError(
        normal[index],
        f"the vector field is not tangent to the orbit at m = {m[index]}{where}: X = {field[index]} has the normal "
        f"component {normal[index]} of size {sizes[index]:.3g}",
    )


def check_point(representation: Representation, m: Any) -> Any:
    """Check starting points; returns the dimension of the orbit of each, shape (...).

    Raises
    ------
    ShapeError
        If m does not have N coordinates.
    InputError
        If it is not finite, or the group leaves a point fixed.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> int(check_point(lh.defining(lh.so(3)), np.array([0, 0, 1.0])))
    2
    """
    if m.ndim == 0 or m.shape[-1] != representation.size:
        raise ShapeError(f"a point has {representation.size} coordinates (on its last axis), got shape {m.shape}")
    if not bool(np.all(np.isfinite(np.asarray(m, dtype=float)))):
        raise InputError(f"the point {m} is not finite")
    columns = action_map(representation).right(np.asarray(m, dtype=float))
    sizes = np.linalg.svd(columns, compute_uv=False)
    scale = max((float(np.abs(a.to_numpy()).max(initial=0.0)) for a in representation.matrices), default=0.0)
    bound = RANK_RTOL * scale * np.linalg.norm(np.asarray(m, dtype=float), axis=-1)[..., None]
    ranks = (sizes > bound).sum(axis=-1)
    if bool(np.any(ranks == 0)):
        index = np.argwhere(ranks == 0)[0]
        where = f" (trajectory {tuple(int(i) for i in index)})" if len(index) else ""
        raise InputError(f"the group leaves the point {m[tuple(index)]}{where} fixed: its orbit has dimension 0")
    return ranks
