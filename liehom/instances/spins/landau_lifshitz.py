"""LandauLifshitz: the Landau-Lifshitz-Gilbert equation of single spins, and of chains and grids of spins.

    m_i' = -gamma m_i x h_i + alpha m_i x m_i',   h_i = -dE/dm_i = J sum_{j ~ i} m_j + 2 K <m_i, e> e + H
    E = -J sum_{i ~ j} <m_i, m_j> - K sum_i <m_i, e>^2 - sum_i <H, m_i>,     |m_i| = 1

Solved for m_i' it is m_i' = psi_i x m_i with the generator psi_i = gamma/(1 + alpha^2) (h_i + alpha m_i x h_i) in
so(3): spins turn counterclockwise about the field (for gamma > 0) and, for alpha > 0, towards it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.correctors import Conserving, Corrected, Step
from liehom.correctors.step import StepLike, as_step
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.components import joined
from liehom.instances.spins.joint_spins import JointSpins
from liehom.instances.spins.spin_lattice import SpinLattice
from liehom.integrators import Solution, integrate
from liehom.integrators.arguments import SingleRunOptions
from liehom.representations import adjoint
from liehom.typing import Array, Real, Values

UNIT_RTOL = 1e-6
"""Largest difference of the length of a spin from 1."""

AppliedField: TypeAlias = npt.ArrayLike | Callable[[Any], Any]
"""An applied field, constant or as a function of time."""


@final
class LandauLifshitz:
    """Spins on a lattice with exchange, uniaxial anisotropy, an applied field and damping.

    Parameters
    ----------
    shape : tuple of int
        (): single spins, however many; (n,): a chain; (n1, n2): a grid.
    exchange : float
        J: positive for a ferromagnet.
    anisotropy : float or array_like of the lattice's shape
        K: positive for an easy axis, negative for an easy plane.
    axis : (3,) or (*shape, 3) array_like
        e, of any length but 0.
    applied : (3,) or (*shape, 3) array_like, or callable
        H, constant or a function of t. A function is written with numpy functions, and maps t (...,) to an array
        (..., 3) or to a list of 3 arrays (...,).
    damping : float or array_like of the lattice's shape
        alpha, not negative.
    gyromagnetic : float
        gamma. The form of Landau and Lifshitz, m' = -m x h - alpha m x (m x h), is gamma = 1 + alpha^2.
    periodic : bool or tuple of bool
        The boundary along each axis: see `SpinLattice`.

    Attributes
    ----------
    field : GeneratorField
        On so(3) and R^3, for states m (..., *shape, 3). Every spin is a trajectory, and psi couples them along the axes
        of the lattice. The field is right as long as all spins of a lattice are at one time, which fixed steps in
        nominal time guarantee; `integrate` checks this.

    Raises
    ------
    InputError, ShapeError
        If an argument has a wrong type, shape or sign.

    Notes
    -----
    Spins without coupling are on S^2, where isotropy is full: a corrected step has any order, with a time
    reparametrization for each spin. Coupled spins are on a product of n spheres, of dimension 2n, where n directions of
    isotropy and one time reparametrization do not suffice (rank 3 of 4 for two spins). For them the order comes from
    `LieTaylor` and `RKMK`, and isotropy conserves first integrals: see `joint`.

    Examples
    --------
    A spin turns about the field and into it:

    >>> import numpy as np
    >>> import liehom as lh
    >>> spin = LandauLifshitz(applied=[0.0, 0.0, 1.0], damping=0.1)
    >>> sol = spin.integrate((0, 20), [1.0, 0.0, 0.0], step=lh.Corrected(lh.Euler(), 4), dt=0.1)
    >>> bool(abs(sol.y[2, -1] - np.tanh(20 * 0.1 / 1.01)) < 1e-5)
    True

    A closed chain of 100 spins loses energy:

    >>> chain = LandauLifshitz((100,), exchange=1.0, anisotropy=0.1, damping=0.2)
    >>> m = np.random.default_rng(0).normal(size=(100, 3))
    >>> m = m / np.linalg.norm(m, axis=-1, keepdims=True)
    >>> sol = chain.integrate((0, 2), m, step=lh.RKMK("rk4"), dt=0.1, t_eval=[0, 1, 2])
    >>> bool((np.diff(chain.energy(np.moveaxis(sol.y, -1, 0))) < 0).all())
    True
    """

    exchange: float
    field: GeneratorField
    gyromagnetic: float
    lattice: SpinLattice
    time_dependent: bool

    __slots__ = (
        "_applied", "_axis", "anisotropy", "damping", "exchange", "field", "gyromagnetic", "lattice", "time_dependent",
    )  # fmt: skip

    def __init__(
        self,
        shape: tuple[int, ...] = (),
        *,
        exchange: float = 0.0,
        anisotropy: npt.ArrayLike = 0.0,
        axis: npt.ArrayLike = (0.0, 0.0, 1.0),
        applied: AppliedField = (0.0, 0.0, 0.0),
        damping: npt.ArrayLike = 0.0,
        gyromagnetic: float = 1.0,
        periodic: bool | tuple[bool, ...] = True,
    ) -> None:
        self.lattice = SpinLattice(shape, periodic)
        self.exchange = float(self._given("exchange", exchange, ()))
        self.anisotropy: Array = self._given("anisotropy", anisotropy, self.lattice.shape)
        self.damping: Array = self._given("damping", damping, self.lattice.shape)
        self.gyromagnetic = float(self._given("gyromagnetic", gyromagnetic, ()))
        if np.any(self.damping < 0):
            raise InputError(f"the damping is {damping!r}, expected at least 0")
        e = self._given("axis", axis, (*self.lattice.shape, 3))
        length = np.linalg.norm(e, axis=-1, keepdims=True)
        if e.shape[-1:] != (3,) or not bool(np.all(length > 0)):
            raise InputError(f"the axis is {axis!r}, expected vectors of R^3 other than 0")
        self._axis = e / length
        self.time_dependent = callable(applied)
        self._applied: Any = applied
        if not callable(applied):
            self._applied = constant = self._given("applied", applied, (*self.lattice.shape, 3))
            if constant.shape[-1:] != (3,):
                raise ShapeError(f"the applied field has shape {constant.shape}, expected (..., 3)")
        psi: Callable[..., Any] = self.generator if self.time_dependent else lambda m: self.generator(m)
        sites = self.lattice.shape if self.coupled else ()
        self.field = GeneratorField(adjoint(so(3)), psi, time_dependent=self.time_dependent, sites=sites)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def coupled(self) -> bool:
        """Whether the spins are coupled by exchange."""
        return self.exchange != 0 and self.lattice.bonds > 0

    # -- physics -----------------------------------------------------------------------------------------
    def effective_field(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """h = -dE/dm at m (..., *shape, 3), an array or Jet of that shape, for a time (..., *shape) or a number.

        Examples
        --------
        >>> LandauLifshitz((3,), exchange=2.0, periodic=False).effective_field([[0, 0, 1.0]] * 3)[:, 2].tolist()
        [2.0, 4.0, 2.0]
        """
        spins = self._spins(m)
        h = self._field_at(spins, time)
        if np.any(self.anisotropy):
            h = h + self._along(spins) * (2 * self.anisotropy[..., None] * self._axis)
        if self.coupled:
            h = h + self.exchange * self.lattice.neighbour_sum(spins)
        return h

    def generator(self, m: npt.ArrayLike | Values, t: Real = 0.0) -> Any:
        """psi = gamma/(1 + alpha^2) (h + alpha m x h), with m' = psi x m; shape (..., *shape, 3).

        Examples
        --------
        >>> LandauLifshitz(applied=[0.0, 0.0, 2.0], damping=0.5).generator([1.0, 0.0, 0.0]).tolist()
        [0.0, -0.8, 1.6]
        """
        spins = self._spins(m)
        h = self.effective_field(spins, t)
        rate = (self.gyromagnetic / (1 + self.damping**2))[..., None]
        if not np.any(self.damping):
            return rate * h + 0 * spins
        return rate * (h + self.damping[..., None] * np.cross(spins, h))

    def energy(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """E of the lattices m (..., *shape, 3), shape (...,), arrays or Jets.

        Examples
        --------
        >>> LandauLifshitz((4,), exchange=1.0, applied=[0, 0, 0.5]).energy([[0, 0, 1.0]] * 4)
        np.float64(-6.0)
        """
        spins = self._spins(m)
        density = -np.sum(spins * self._field_at(spins, time), axis=-1)
        if np.any(self.anisotropy):
            density = density - self.anisotropy * self._along(spins)[..., 0] ** 2
        if self.coupled:
            density = density - self.exchange / 2 * np.sum(spins * self.lattice.neighbour_sum(spins), axis=-1)
        return self.lattice.total(density)

    def energy_rate(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """dE/dt = -gamma sum_i alpha/(1 + alpha^2) |m_i x h_i|^2 in a constant field, shape (...,).

        Examples
        --------
        >>> LandauLifshitz(applied=[0, 0, 2.0], damping=0.5).energy_rate([1.0, 0, 0])
        np.float64(-1.6)
        """
        spins = self._spins(m)
        turning = np.cross(spins, self.effective_field(spins, time))
        rate = self.gyromagnetic * self.damping / (1 + self.damping**2)
        return -self.lattice.total(rate * np.sum(turning * turning, axis=-1))

    # -- integration -------------------------------------------------------------------------------------
    def integrate(
        self,
        t_span: Iterable[float],
        m0: npt.ArrayLike,
        *,
        step: StepLike | None = None,
        dt: npt.ArrayLike | None = None,
        **options: Unpack[SingleRunOptions],
    ) -> Solution:
        """The spins as functions of time, a `Solution` of `liehom.integrate`.

        Parameters
        ----------
        t_span : (float, float)
        m0 : (..., *shape, 3) array_like
            Unit vectors.
        step : Step or str, optional
            Default: that of `liehom.integrate`. Corrected steps are for spins without coupling only.
        dt : float, optional
            The step size. By default it is adaptive: one for all coupled spins of a lattice, by the error of all
            together, and one for each spin without coupling.
        **options
            Options of `liehom.integrate`.

        Returns
        -------
        Solution
            y has shape (..., *shape, 3, n), t shape (..., *shape, n).

        Raises
        ------
        ShapeError
            If m0 has another shape.
        InputError
            If a spin is not of length 1; for coupled spins, if their step sizes or clocks would differ.

        Examples
        --------
        >>> sol = LandauLifshitz((3,), exchange=1.0).integrate((0, 1), [[0, 0, 1.0], [0, 1.0, 0], [1.0, 0, 0]])
        >>> sol.y.shape[:2], bool(np.ptp(sol.t, axis=0).max() == 0)
        ((3, 3), True)
        """
        spins = np.asarray(m0)
        self.lattice.check(spins)
        if spins.dtype.kind not in "iuf" or not bool(np.all(np.abs(np.linalg.norm(spins, axis=-1) - 1) <= UNIT_RTOL)):
            raise InputError("the spins are not of length 1: divide them by their norms")
        if self.coupled:
            self._check_together(None if step is None else as_step(step), dt, options)
        return integrate(self.field, t_span, spins, step=step, dt=dt, **options)

    def joint(self) -> JointSpins:
        """The `JointSpins` of the lattice, all spins as one point on a product of spheres, for few spins.

        There all spins have one adaptive step size, events stop all of them, and isotropy conserves the energy
        (`liehom.correctors.Conserving`).

        Examples
        --------
        >>> import liehom as lh
        >>> pair = LandauLifshitz((2,), exchange=1.0, periodic=False).joint()
        >>> sol = lh.integrate(pair.field, (0, 1), pair.point([[0, 0, 1.0], [0, 0.6, 0.8]]))
        >>> pair.spins(sol.y.T).shape[1:]
        (2, 3)
        """
        return JointSpins(self.lattice, self.generator, self.time_dependent)

    # -- private -----------------------------------------------------------------------------------------
    def _check_together(self, step: Step | None, dt: npt.ArrayLike | None, options: SingleRunOptions) -> None:
        """Raise InputError if the options would bring coupled spins to different times."""
        if np.ndim(dt):  # type: ignore[arg-type]
            raise InputError("the spins are coupled, so they need one step size: give one number dt, or none")
        if isinstance(step.step if isinstance(step, Conserving) else step, Corrected):
            raise InputError(
                "the spins are coupled: isotropy and clock do not correct a step on a product of spheres, and clocks "
                "of their own would bring the spins to different times; take LieTaylor(order) or RKMK(...)"
            )
        if options.get("events") is not None:
            raise InputError("the spins are coupled: an event would stop one of them; take joint() for events")

    def _given(self, name: str, value: npt.ArrayLike, shape: tuple[int, ...]) -> Array:
        """A parameter as an array that broadcasts to a shape, checked."""
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"{name} is {value!r}, expected real numbers") from None
        if not bool(np.isfinite(array).all()):
            raise InputError(f"{name} is {value!r}, expected finite numbers")
        try:
            fits = np.broadcast_shapes(array.shape, shape) == shape
        except ValueError:
            fits = False
        if not fits:
            raise ShapeError(f"{name} has shape {array.shape}, expected one that broadcasts to {shape}")
        return array

    def _spins(self, m: npt.ArrayLike | Values) -> Any:
        """Spins as an array or Jet of a shape (..., *shape, 3), checked."""
        spins: Any = m if hasattr(m, "shape") else np.asarray(m, dtype=float)
        self.lattice.check(spins)
        return spins

    def _along(self, m: Values) -> Any:
        """<m, e>, shape (..., *shape, 1)."""
        return np.sum(m * self._axis, axis=-1)[..., None]

    def _field_at(self, m: Values, t: Real) -> Any:
        """The applied field at time t, in the form of m."""
        if not self.time_dependent:
            return self._applied
        h = self._applied(t)
        if isinstance(h, list | tuple):
            zero = 0 * (t if hasattr(t, "shape") else np.asarray(t, dtype=float))
            h = np.stack([zero + x for x in h], axis=-1)
        h = joined(h, m)
        if h.shape[-1:] != (3,):
            raise ShapeError(f"the applied field has shape {h.shape} at t of shape {np.shape(t)}, expected (..., 3)")
        return h

    def __repr__(self) -> str:
        shape = f"{self.lattice.shape}, " if self.lattice.shape else ""
        k, damping = _shown(self.anisotropy), _shown(self.damping)
        return f"<LandauLifshitz {shape}J = {self.exchange}, K = {k}, alpha = {damping}>"


def _shown(value: Array) -> str:
    """A parameter as it is printed."""
    return str(float(value)) if value.ndim == 0 else f"array of shape {value.shape}"
