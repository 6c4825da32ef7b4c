"""LandauLifshitz: the Landau-Lifshitz-Gilbert equation of single spins, and of chains and grids of spins.

    m_i' = -gamma m_i x h_i + alpha m_i x m_i',   h_i = -dE/dm_i = J sum_{j ~ i} m_j + 2 K <m_i, e> e + H + ...
    E = -J sum_{i ~ j} <m_i, m_j> - K sum_i <m_i, e>^2 - sum_i <H, m_i> + ...,     |m_i| = 1

Solved for m_i' it is m_i' = psi_i x m_i with the generator psi_i = gamma/(1 + alpha^2) (h_i + alpha m_i x h_i) in
so(3): spins turn counterclockwise about the field (for gamma > 0) and, for alpha > 0, towards it. Cubic anisotropy and
Dzyaloshinskii-Moriya interaction are in `interactions`, thermal noise in `thermal`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.correctors import Conserving, Corrected, Step
from liehom.correctors.step import StepLike, as_step
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.components import joined
from liehom.instances.spins.interactions import (
    bond_vectors,
    cubic_energy,
    cubic_field,
    dmi_field,
    orthonormal_axes,
    parameter,
)
from liehom.instances.spins.joint_spins import JointSpins
from liehom.instances.spins.spin_lattice import SpinLattice
from liehom.instances.spins.thermal import Increments, ThermalStep
from liehom.integrators import RKMK, Heun, Solution, integrate
from liehom.integrators.arguments import SingleRunOptions
from liehom.representations import adjoint
from liehom.typing import Array, Real, Values

UNIT_RTOL = 1e-6
"""Largest difference of the length of a spin from 1."""

AppliedField: TypeAlias = npt.ArrayLike | Callable[[Any], Any]
"""An applied field, constant or as a function of time."""


@final
class LandauLifshitz:
    """Spins on a lattice with exchange, anisotropy, Dzyaloshinskii-Moriya interaction, a field, damping and noise.

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
    cubic : float or array_like of the lattice's shape
        C, of the energy C (a_1^2 a_2^2 + a_2^2 a_3^2 + a_3^2 a_1^2) in the components along the cubic axes.
    cubic_axes : (3, 3) array_like
        Orthonormal columns, by default the coordinate axes.
    dmi : float
        D, of the energy D <d_ij, m_i x m_j> of each pair of neighbours.
    dmi_kind : "bulk" or "interfacial"
        d_ij is the unit vector from i to j, or e_3 x that vector.
    spin_torque : float
        A field a m x p is added to h, not to the energy (Slonczewski's torque -gamma a m x (m x p)).
    polarization : (3,) array_like
        p.
    damping : float or array_like of the lattice's shape
        alpha, not negative.
    temperature : float
        T, in units of the energy. Above 0 the field has white noise of variance 2 alpha T/gamma, `integrate` needs dt,
        and the damping must be positive.
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
    temperature: float
    time_dependent: bool

    __slots__ = (
        "_applied", "_axis", "_bonds", "anisotropy", "cubic", "cubic_axes", "damping", "dmi", "exchange", "field",
        "gyromagnetic", "lattice", "polarization", "spin_torque", "temperature", "time_dependent",
    )  # fmt: skip

    def __init__(
        self,
        shape: tuple[int, ...] = (),
        *,
        exchange: float = 0.0,
        anisotropy: npt.ArrayLike = 0.0,
        axis: npt.ArrayLike = (0.0, 0.0, 1.0),
        applied: AppliedField = (0.0, 0.0, 0.0),
        cubic: npt.ArrayLike = 0.0,
        cubic_axes: npt.ArrayLike | None = None,
        dmi: float = 0.0,
        dmi_kind: str = "bulk",
        spin_torque: float = 0.0,
        polarization: npt.ArrayLike = (1.0, 0.0, 0.0),
        damping: npt.ArrayLike = 0.0,
        temperature: float = 0.0,
        gyromagnetic: float = 1.0,
        periodic: bool | tuple[bool, ...] = True,
    ) -> None:
        self.lattice = SpinLattice(shape, periodic)
        self.exchange = float(parameter("exchange", exchange, ()))
        self.anisotropy: Array = parameter("anisotropy", anisotropy, self.lattice.shape)
        self.damping: Array = parameter("damping", damping, self.lattice.shape)
        self.gyromagnetic = float(parameter("gyromagnetic", gyromagnetic, ()))
        if np.any(self.damping < 0):
            raise InputError(f"the damping is {damping!r}, expected at least 0")
        self.cubic: Array = parameter("cubic", cubic, self.lattice.shape)
        self.cubic_axes: Array = orthonormal_axes(cubic_axes)
        self.dmi = float(parameter("dmi", dmi, ()))
        self._bonds = bond_vectors(self.lattice, dmi_kind) if self.dmi else np.zeros((0, 3))
        self.spin_torque = float(parameter("spin_torque", spin_torque, ()))
        self.polarization: Array = np.broadcast_to(parameter("polarization", polarization, (3,)), (3,))
        self.temperature = float(parameter("temperature", temperature, ()))
        if self.temperature < 0 or (self.temperature > 0 and not np.all(self.damping > 0)):
            raise InputError(
                f"the temperature is {temperature!r} with the damping {damping!r}: expected at least 0, and damping "
                "where there is noise, which it balances"
            )
        e = parameter("axis", axis, (*self.lattice.shape, 3))
        length = np.linalg.norm(e, axis=-1, keepdims=True)
        if e.shape[-1:] != (3,) or not bool(np.all(length > 0)):
            raise InputError(f"the axis is {axis!r}, expected vectors of R^3 other than 0")
        self._axis = e / length
        self.time_dependent = callable(applied)
        self._applied: Any = applied
        if not callable(applied):
            self._applied = constant = parameter("applied", applied, (*self.lattice.shape, 3))
            if constant.shape[-1:] != (3,):
                raise ShapeError(f"the applied field has shape {constant.shape}, expected (..., 3)")
        psi: Callable[..., Any] = self.generator if self.time_dependent else lambda m: self.generator(m)
        sites = self.lattice.shape if self.coupled else ()
        self.field = GeneratorField(adjoint(so(3)), psi, time_dependent=self.time_dependent, sites=sites)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def coupled(self) -> bool:
        """Whether the spins are coupled, by exchange or by Dzyaloshinskii-Moriya interaction."""
        return (self.exchange != 0 or self.dmi != 0) and self.lattice.bonds > 0

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
        if np.any(self.cubic):
            h = h + cubic_field(self.cubic, self.cubic_axes, spins)
        coupling = self._coupling(spins)
        return h if coupling is None else h + coupling

    def generator(self, m: npt.ArrayLike | Values, t: Real = 0.0) -> Any:
        """psi = gamma/(1 + alpha^2) (h + alpha m x h), with m' = psi x m; shape (..., *shape, 3).

        Examples
        --------
        >>> LandauLifshitz(applied=[0.0, 0.0, 2.0], damping=0.5).generator([1.0, 0.0, 0.0]).tolist()
        [0.0, -0.8, 1.6]
        """
        spins = self._spins(m)
        h = self.effective_field(spins, t)
        if self.spin_torque:
            h = h + self.spin_torque * np.cross(spins, self.polarization)
        return self._response(spins, h)

    def _response(self, spins: Values, h: Values) -> Any:
        """The generator of the spins in a field h."""
        rate = (self.gyromagnetic / (1 + self.damping**2))[..., None]
        if not np.any(self.damping):
            return rate * h + 0 * spins
        return rate * (h + self.damping[..., None] * np.cross(spins, h))

    def _coupling(self, spins: Values) -> Any:
        """The field of the neighbours, or None without coupling."""
        if not self.coupled:
            return None
        if not self.dmi:
            return self.exchange * self.lattice.neighbour_sum(spins)
        found = dmi_field(self.lattice, self.dmi, self._bonds, spins)
        return found + self.exchange * self.lattice.neighbour_sum(spins) if self.exchange else found

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
        if np.any(self.cubic):
            density = density + self.cubic * cubic_energy(self.cubic_axes, spins)
        coupling = self._coupling(spins)
        if coupling is not None:
            density = density - np.sum(spins * coupling, axis=-1) / 2
        return self.lattice.total(density)

    def energy_rate(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """dE/dt = -gamma sum_i alpha/(1 + alpha^2) |m_i x h_i|^2 in a constant field without spin torque and noise.

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
        seed: int | None = None,
        **options: Unpack[SingleRunOptions],
    ) -> Solution:
        """The spins as functions of time, a `Solution` of `liehom.integrate`.

        Parameters
        ----------
        t_span : (float, float)
        m0 : (..., *shape, 3) array_like
            Unit vectors.
        step : Step or str, optional
            Default: that of `liehom.integrate`, `RKMK("rk45")` for coupled spins in machine code, `Heun()` with noise.
            Corrected steps are for spins without coupling only.
        dt : float, optional
            The step size. By default it is adaptive: one for all coupled spins of a lattice, by the error of all
            together, and one for each spin without coupling. With noise it is needed.
        seed : int, optional
            Of the noise; the same seed, dt and shape of m0 give the same numbers. By default a random one.
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
        step = None if step is None else as_step(step)
        if self.coupled:
            self._check_together(step, dt, options)
        span = tuple(t_span)
        if self.temperature:
            if options.get("engine", "numpy") not in (("numpy", "llvm") if self.coupled else ("numpy",)):
                raise InputError("noise is compiled by engine='llvm' for coupled spins only: take engine='numpy'")
            step = self._thermal(step, dt, span, spins.shape, seed)
        elif seed is not None:
            raise InputError("a seed is given, but the temperature is 0: there is no noise")
        elif step is None and self.coupled and options.get("engine") == "llvm":
            step = RKMK("rk45")  # explicit stages are compiled, series are not
        return integrate(self.field, span, spins, step=step, dt=dt, **options)

    def noise(self, shape: tuple[int, ...], dt: float, seed: int, parts: int = 1) -> Increments:
        """The `Increments` that `integrate` uses for spins of a shape (..., *shape, 3), to compare runs on one path.

        Examples
        --------
        >>> warm = LandauLifshitz(damping=0.1, temperature=0.5)
        >>> warm.noise((2, 3), 0.01, seed=4)(0).shape
        (2, 3)
        """
        return Increments(shape, dt, seed, parts)

    def thermal_step(self, step: Step, noise: Increments, begin: float = 0.0) -> ThermalStep:
        """A step with given increments, for `liehom.integrate` with the dt of the increments.

        Examples
        --------
        >>> import liehom as lh
        >>> warm = LandauLifshitz(damping=0.1, temperature=0.5)
        >>> step = warm.thermal_step(lh.Heun(), warm.noise((3,), 0.01, seed=4))
        >>> sol = lh.integrate(warm.field, (0, 1), [0, 0, 1.0], step=step, dt=0.01)
        >>> bool(abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-14)
        True
        """
        strength = np.sqrt(2 * self.damping * self.temperature / self.gyromagnetic)[..., None]
        return ThermalStep(step, noise, lambda m, w: self._response(m, strength * w), begin)

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
    def _thermal(
        self, step: Step | None, dt: npt.ArrayLike | None, span: Sequence[float], shape: tuple[int, ...],
        seed: int | None,
    ) -> ThermalStep:  # fmt: skip
        """The step with noise, checked."""
        if dt is None or np.ndim(dt):
            raise InputError("spins with noise have steps of one fixed size: give one number dt")
        if isinstance(step, Corrected | Conserving):
            raise InputError(f"{step!r} with noise: its correction expands smooth fields; take Heun() or RKMK('heun')")
        if seed is None:
            seed = int(np.random.SeedSequence().generate_state(1)[0])
        elif isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
            raise InputError(f"the seed is {seed!r}, expected an integer at least 0")
        size = float(np.asarray(dt))
        return self.thermal_step(Heun() if step is None else step, self.noise(shape, size, int(seed)), float(span[0]))

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

    def __setstate__(self, state: tuple[None, dict[str, Any]]) -> None:
        plain = LandauLifshitz()  # pickles of 0.1.0 have no other interactions than it
        for name in self.__slots__:
            setattr(self, name, state[1].get(name, getattr(plain, name)))

    def __repr__(self) -> str:
        shape = f"{self.lattice.shape}, " if self.lattice.shape else ""
        k, damping = _shown(self.anisotropy), _shown(self.damping)
        return f"<LandauLifshitz {shape}J = {self.exchange}, K = {k}, alpha = {damping}>"


def _shown(value: Array) -> str:
    """A parameter as it is printed."""
    return str(float(value)) if value.ndim == 0 else f"array of shape {value.shape}"
