"""GeneratorField: a vector field X(m) = rho(psi(m)) m on the orbits of a representation, by its generator psi.

psi may be given, or only X, of which the generator of least norm is then computed.  Psi returns one coefficient per
basis element of g, or one per matrix that the user gave to `Representation.from_matrices`.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.fields.components import Components
from liehom.homogeneous.fields.least_norm import RANK_RTOL, TANGENCY_RTOL, LeastNorm
from liehom.homogeneous.maps import action_map
from liehom.homogeneous.range.batched_ranks import batched_ranks
from liehom.representations import Representation
from liehom.series.arrays import as_values, is_traced, namespace, zeros
from liehom.series.jet import Jet


@final
class GeneratorField:
    """The vector field X(m, t) = rho(psi(m, t)) m.

    Parameters
    ----------
    representation : Representation
        rho, on vectors of N coordinates, of an algebra of dimension r.
    psi : callable, array or sequence
        The generator: a function psi(m) or psi(m, t) that returns an array of shape (..., r) for m of shape
        (..., N) and t of shape (...,), written with numpy functions; or r components, each a number, a text such
        as "1 + m0**2*sin(t)", or a sympy expression in m0, m1, ..., t; or a constant array. Where the algebra was
        closed from fewer given matrices, psi may have one coefficient for each of these.
    time_dependent : bool, optional
        Whether a function psi is called with t; by default read off from its parameters. It is if it has a second
        parameter without a default, or one named t.

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

    __slots__ = ("_action", "_components", "_dimension", "representation", "source", "time_dependent")

    def __init__(self, representation: Representation, psi: Any, *, time_dependent: bool | None = None) -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {representation!r}")
        self.representation = representation
        self.source = psi
        self._action = action_map(representation)
        dimension = representation.algebra.dimension
        counts = (representation.given, dimension)
        self._components: Components | LeastNorm = (
            psi if isinstance(psi, LeastNorm) else Components(psi, representation.size, counts, "psi", time_dependent)
        )
        self._dimension = dimension
        self.time_dependent: bool = self._components.time_dependent

    @classmethod
    def from_vector_field(
        cls,
        representation: Representation,
        field: Any,
        *,
        orbit_dimension: int | None = None,
        rtol: float = TANGENCY_RTOL,
        time_dependent: bool | None = None,
    ) -> GeneratorField:
        """The field with the generator of least norm of a given vector field X(m) or X(m, t) tangent to the orbits.

        Parameters
        ----------
        representation : Representation
        field : callable or sequence
            X in one of the forms that psi may have, with N components.
        orbit_dimension : int, optional
            The dimension of the orbits, where the numerical rank at the points is not to decide.
        rtol : float
            How large the normal component of X may be, relative to X.
        time_dependent : bool, optional
            As for psi.

        Raises
        ------
        TangencyError
            When it is evaluated where X is not tangent to the orbit; shows the normal component.

        Notes
        -----
        psi(m) = A^+ X with A = [rho(b_1) m, ..., rho(b_r) m] in an orthonormal basis of g (`inner_product`). At an
        equilibrium it is 0. Where the inner product is Ad-invariant, psi is as equivariant as X is.

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
            raise InputError(f"expected a Representation, got {representation!r}")
        return cls(representation, LeastNorm(representation, field, orbit_dimension, rtol, time_dependent))

    def psi(self, m: Any, t: Any = 0.0) -> Any:
        """The generator at m (..., N) and t: an array or Jet of shape (..., r)."""
        made = self._components(m, t)
        missing = self._dimension - int(made.shape[-1])
        if missing == 0:
            return made
        value = made.value if isinstance(made, Jet) else made
        blank = zeros(value, (*value.shape[:-1], missing))
        return (np if isinstance(made, Jet) else namespace(value)).concatenate([made, blank], axis=-1)

    def check(self, m: Any, t: Any = 0.0) -> None:
        """Check the field at starting points, before anything is integrated.

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
            If a component of psi is not a finite real number; names it. What psi itself raises passes through.

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

    def vector(self, m: Any, t: Any = 0.0) -> Any:
        """X(m, t) = rho(psi(m, t)) m, an array or Jet of shape (..., N)."""
        return self.infinitesimal(self.psi(m, t), m)

    def infinitesimal(self, x: Any, m: Any) -> Any:
        """rho(x) m for x (..., r) and m (..., N)."""
        return self._action(x, m)

    def frobenius_norms(self, x: Any, m: Any) -> Any:
        """The Frobenius norms of rho(x), shape (...,), where that is cheap: for large ensembles (x, m); else None."""
        return self._action.frobenius_norms(x) if self._action.works_by_columns(x, m) else None

    def __repr__(self) -> str:
        kind = "time-dependent " if self.time_dependent else ""
        return f"<{kind}generator field of {self.representation!r}>"


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
    m = as_values(m)
    if m.ndim == 0 or m.shape[-1] != representation.size:
        raise ShapeError(f"a point has {representation.size} coordinates (on its last axis), got shape {m.shape}")
    if is_traced(m):
        raise InputError("the dimension of an orbit cannot be found from a traced point: check it outside of jax.jit")
    point = np.asarray(m, dtype=float)
    if not bool(np.all(np.isfinite(point))):
        raise InputError(f"the point {m} is not finite")
    scale = max((float(np.abs(a.to_numpy()).max(initial=0.0)) for a in representation.matrices), default=0.0)
    bound = RANK_RTOL * scale * np.linalg.norm(point, axis=-1)
    ranks = batched_ranks(action_map(representation).right(point), bound)
    if bool(np.any(ranks == 0)):
        index = tuple(int(i) for i in np.argwhere(ranks == 0)[0])
        where = f" (trajectory {index[0] if len(index) == 1 else index})" if index else ""
        raise InputError(f"the group leaves the point {m[index]}{where} fixed: its orbit has dimension 0")
    return ranks
