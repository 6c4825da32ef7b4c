"""Spins: the Landau-Lifshitz-Gilbert equation, interactions, thermal noise."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError, checked_integer
from liehom.base.typing import Array, Real, Values
from liehom.flow.action.components import joined
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.door import Copies, Representation, adjoint, direct_sum, so
from liehom.flow.engines.arguments import SingleRunOptions
from liehom.flow.methods.low_order import Heun
from liehom.flow.methods.rkmk import RKMK
from liehom.flow.propagation.integration import integrate
from liehom.flow.run.solution import Solution
from liehom.flow.steps.conserving import Conserving
from liehom.flow.steps.corrected import Corrected
from liehom.flow.steps.step import Generator, LocalStep, Step, StepLike, as_step

# Thermal noise of spins: Brownian increments that depend on a seed alone, and steps in the sense of Stratonovich.
#
#     dm = g (h + a m x h) x m dt + g (w + a m x w) x m,   w = (2 a T / gamma)^(1/2) dW,   g = gamma/(1 + a^2)
#
# with the increments dW of a Wiener process for each coordinate of each spin. The strength is that of the
# fluctuation-dissipation theorem, so the stationary distribution has the density exp(-E/T). In a step of size h the
# noise is a constant field w/h. A step of order 2 for smooth fields then converges to the solution in the sense of
# Stratonovich, with weak order 1 and strong order 1/2, or 1 for one source of noise. Its exponentials keep spins on the
# sphere.


@final
class Increments:
    """Increments of independent Wiener processes, one for each entry of an array, in steps of one size."""

    def __init__(self, shape: tuple[int, ...], size: float, seed: int, parts: int = 1) -> None:
        self.shape, self.size, self.seed, self.parts = shape, size, seed, parts
        self._last: tuple[int, Array] | None = None

    def __call__(self, k: int) -> Array:
        """The increments of step k, of standard deviation size^(1/2)."""
        if self._last is None or self._last[0] != k:
            total = np.zeros(self.shape)
            for j in range(k * self.parts, (k + 1) * self.parts):
                # a stream of its own for every step, so that a step does not depend on those before
                stream = np.random.Philox(key=self.seed, counter=[0, 0, 0, j])
                total += np.random.Generator(stream).normal(size=self.shape)
            self._last = k, np.sqrt(self.size / self.parts) * total
        return self._last[1]


@final
class ThermalStep(Step):
    """A step with noise, as a constant field over the step."""

    def __init__(
        self, step: Step, increments: Increments, response: Callable[[Values, Array], Values], begin: float
    ) -> None:
        self.step, self.increments, self.begin, self.response = step, increments, begin, response

    @property
    def order(self) -> int:
        return self.step.order

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if error_terms:
            raise InputError("steps with thermal noise have a fixed size: give dt")
        noise = self.noise(float(np.max(t)))

        def noisy(point: Values, time: Real = 0.0) -> Values:
            return psi.field.psi(point, time) + self.response(point, noise)

        field = psi.field
        with_noise = GeneratorField(field.representation, noisy, time_dependent=True, sites=field.sites)
        return self.step.at(action, Generator(with_noise, psi.orbit_dimension, psi.start), m, t)

    def noise(self, t: float) -> Array:
        """The noise of the step that begins at a time, as a field."""
        size = self.increments.size
        return self.increments(int(np.rint(abs(t - self.begin) / size))) / size

    def __repr__(self) -> str:
        noise = self.increments
        return f"ThermalStep({self.step!r}, size={noise.size}, seed={noise.seed}, parts={noise.parts})"


# SpinLattice: chains, grids and blocks of unit vectors, with the sum over nearest neighbours.
#
#     (sum m)_i = m_{i-1} + m_{i+1}  along each axis of the lattice
#
# Spins are arrays of shape (..., *shape, 3); leading axes are an ensemble of lattices.

MIN_PERIOD = 3
"""Smallest number of spins on a periodic axis."""


@final
@dataclass(frozen=True, slots=True)
class SpinLattice:
    """A rectangular lattice of spins, periodic or open along each axis.

    Parameters
    ----------
    shape : tuple of int
        (): single spins; (n,): a chain; (n1, n2): a grid; and so on.
    periodic : bool or tuple of bool
        One value for all axes, or one for each. A periodic axis has at least 3 spins, because two spins would be
        neighbours twice.

    Examples
    --------
    >>> import numpy as np
    >>> m = np.arange(1.0, 5.0)[:, None] * [0.0, 0.0, 1.0]
    >>> SpinLattice((4,), False).neighbour_sum(m)[:, 2].tolist(), SpinLattice((4,)).neighbour_sum(m)[:, 2].tolist()
    ([2.0, 4.0, 6.0, 3.0], [6.0, 4.0, 6.0, 4.0])
    """

    shape: tuple[int, ...] = ()
    periodic: tuple[bool, ...] | bool = True

    def __post_init__(self) -> None:
        shape = self.shape if isinstance(self.shape, Sequence) else (self.shape,)
        if any(isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1 for n in shape):
            raise InputError(f"the shape of a lattice is a tuple of positive integers, got {self.shape!r}")
        closing = self.periodic
        periodic = tuple(closing) if isinstance(closing, Sequence) else (closing,) * len(shape)
        if len(periodic) != len(shape) or any(not isinstance(p, bool | np.bool_) for p in periodic):
            raise InputError(f"periodic is True, False or one of them for each of {len(shape)} axes, got {closing!r}")
        for n, closed in zip(shape, periodic, strict=True):
            if closed and n < MIN_PERIOD:
                raise InputError(
                    f"an axis of {n} spins cannot be periodic: the least is {MIN_PERIOD}; take periodic=False"
                )
        object.__setattr__(self, "shape", tuple(int(n) for n in shape))
        object.__setattr__(self, "periodic", tuple(bool(p) for p in periodic))

    @property
    def count(self) -> int:
        """Number of spins."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def bonds(self) -> int:
        """Number of pairs of neighbours."""
        closed = self.periodic if isinstance(self.periodic, tuple) else ()
        return sum((n if p else n - 1) * self.count // n for n, p in zip(self.shape, closed, strict=True))

    def neighbour_sum(self, m: Values) -> Any:
        """Sum of the neighbours of every spin, for m (..., *shape, 3), an array or a Jet of this shape."""
        total: Any = 0 * m
        for axis, n in enumerate(self.shape):
            if n > 1:
                before, after = self._neighbours(m, axis)
                total = total + before + after
        return total

    def difference(self, m: Values, axis: int) -> Any:
        """m_{i + 1} - m_{i - 1} along an axis of the lattice; beyond an open end a spin is 0."""
        before, after = self._neighbours(m, axis)
        return after - before

    def _neighbours(self, m: Values, axis: int) -> tuple[Any, Any]:
        """m_{i - 1} and m_{i + 1} along an axis of the lattice."""
        n, place = self.shape[axis], axis - len(self.shape) - 1
        before, after = np.roll(m, 1, axis=place), np.roll(m, -1, axis=place)
        if isinstance(self.periodic, tuple) and self.periodic[axis]:
            return before, after
        sites = np.arange(n).reshape(-1, *[1] * -(place + 1))
        return before * (sites > 0).astype(int), after * (sites < n - 1).astype(int)

    def total(self, x: Values) -> Any:
        """Sum of x (..., *shape) over all spins, shape (...,)."""
        return np.sum(x, axis=tuple(range(-len(self.shape), 0))) if self.shape else x

    def check(self, m: npt.ArrayLike | Values) -> None:
        """Raise ShapeError unless m has the shape (..., *shape, 3)."""
        own = (*self.shape, 3)
        if tuple(np.shape(m)[-len(own) :]) != own:
            raise ShapeError(f"spins of shape {np.shape(m)}, expected (..., {', '.join(map(str, own))})")


# Interactions of spins are the energies of a lattice. Their effective fields are h_i = -dE/dm_i.
#
#     exchange                      -J sum_{i ~ j} <m_i, m_j>
#     uniaxial anisotropy           -K sum_i <m_i, e>^2
#     cubic anisotropy              C sum_i (a_1^2 a_2^2 + a_2^2 a_3^2 + a_3^2 a_1^2),   a_k = <m_i, c_k>
#     Dzyaloshinskii-Moriya         D sum_{i ~ j} <d_ij, m_i x m_j>
#
# d_ij is the unit vector from i to j for the bulk kind, and e_3 x that vector for the interfacial kind.

KINDS = ("bulk", "interfacial")


def parameter(name: str, value: npt.ArrayLike, shape: tuple[int, ...]) -> Array:
    """A parameter as an array that broadcasts to a shape, checked."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {value!r}, expected real numbers") from None
    if not bool(np.isfinite(array).all()):
        raise InputError(f"{name} is {value!r}, expected finite numbers")
    try:
        np.broadcast_to(array, shape)
    except ValueError:
        raise ShapeError(f"{name} has shape {array.shape}, expected one that broadcasts to {shape}") from None
    return array


def orthonormal_axes(axes: npt.ArrayLike | None) -> Array:
    """Three orthonormal vectors in columns, by default the coordinate axes."""
    columns = np.eye(3) if axes is None else np.asarray(axes, dtype=float)
    if columns.shape != (3, 3) or not np.allclose(columns.T @ columns, np.eye(3)):
        raise InputError(f"the cubic axes are {axes!r}, expected a (3, 3) matrix with orthonormal columns")
    return columns


def bond_vectors(lattice: SpinLattice, kind: str) -> Array:
    """d for the bonds along each axis of the lattice, shape (L, 3)."""
    if kind not in KINDS:
        raise InputError(f"dmi_kind is {kind!r}, expected one of {', '.join(map(repr, KINDS))}")
    axes = len(lattice.shape)
    if axes > 3:
        raise InputError(f"a lattice of {axes} axes has no directions in space for its bonds: dmi needs at most 3")
    along: Array = np.eye(3)[:axes]
    return along if kind == "bulk" else np.cross([0.0, 0.0, 1.0], along)


def dmi_field(lattice: SpinLattice, strength: float, bonds: Array, m: Values) -> Values:
    """D sum_a d_a x (m_{i + a} - m_{i - a}), shape of m."""
    total: Any = 0 * m
    for axis, d in enumerate(bonds):
        total = total + np.cross(strength * d, lattice.difference(m, axis))
    return total


def cubic_field(strength: Array, axes: Array, m: Values) -> Values:
    """-2 C sum_k a_k (|m|^2 - a_k^2) c_k for cubic axes c_k in the columns of `axes`, shape of m."""
    a: Any = m @ axes
    square = a * a
    rest = np.sum(square, axis=-1)[..., None] - square
    return (-2 * strength[..., None] * a * rest) @ axes.T


def cubic_energy(axes: Array, m: Values) -> Values:
    """a_1^2 a_2^2 + a_2^2 a_3^2 + a_3^2 a_1^2, shape (...,)."""
    a: Any = m @ axes
    square = a * a
    return square[..., 0] * square[..., 1] + square[..., 1] * square[..., 2] + square[..., 2] * square[..., 0]


# JointSpins has all spins of a small lattice as one point of R^(3n), on which so(3)^n acts.
#
#     rho(x_1, ..., x_n)(m_1, ..., m_n) = (x_1 x m_1, ..., x_n x m_n)
#
# Steps of k exponentials cost O(n) per trajectory. Isotropy and series in matrices cost O(n^3).


@final
class JointSpins:
    """The space of all states of n spins, a product of n spheres in R^(3n).

    Parameters
    ----------
    lattice : SpinLattice
    generator : callable
        psi(m, t) of spins (..., *shape, 3) and times (..., *shape), of the same shape.
    time_dependent : bool

    Attributes
    ----------
    representation : Representation
        so(3)^n on R^(3n).
    field : GeneratorField
        On points (..., 3n), the coordinates of the spins in order.

    Examples
    --------
    >>> from liehom.studies.instances import LandauLifshitz
    >>> spins = LandauLifshitz((3,), exchange=1.0).joint()
    >>> spins.representation.orbit_dimension([0, 0, 1, 0, 1, 0, 1, 0, 0])
    6
    """

    __slots__ = ("field", "lattice", "representation")

    def __init__(self, lattice: SpinLattice, generator: Callable[..., Any], time_dependent: bool) -> None:
        self.lattice = lattice
        self.representation = product_of_spheres(lattice.count)
        axes = (1,) * len(lattice.shape)

        def psi(m: Values, t: Real) -> Any:
            # the time of every lattice, repeated for each of its spins
            times = np.reshape(t, (*np.shape(t), *axes)) + 0 * self.spins(m)[..., 0]
            return self.point(generator(self.spins(m), times))

        self.field = GeneratorField(
            self.representation,
            psi if time_dependent else lambda m: self.point(generator(self.spins(m))),
            time_dependent=time_dependent,
        )

    def point(self, m: npt.ArrayLike | Values) -> Any:
        """Points (..., 3n) of spins (..., *shape, 3), arrays or Jets."""
        spins: Any = m if hasattr(m, "shape") else np.asarray(m, dtype=float)
        self.lattice.check(spins)
        return spins.reshape((*spins.shape[: len(spins.shape) - 1 - len(self.lattice.shape)], 3 * self.lattice.count))

    def spins(self, point: npt.ArrayLike | Values) -> Any:
        """Spins (..., *shape, 3) of points (..., 3n), arrays or Jets."""
        joint: Any = point if hasattr(point, "shape") else np.asarray(point, dtype=float)
        return joint.reshape((*joint.shape[:-1], *self.lattice.shape, 3))


def product_of_spheres(n: int) -> Representation:
    """The representation of so(3)^n on R^(3n)."""
    # unchecked, because it is a direct sum of representations of the summands
    return Representation(direct_sum(*[so(3)] * n), Copies(adjoint(so(3)), n), name="n spins", check=False)


# LandauLifshitz: the Landau-Lifshitz-Gilbert equation of single spins, and of chains and grids of spins.
#
#     m_i' = -gamma m_i x h_i + alpha m_i x m_i',   h_i = -dE/dm_i = J sum_{j ~ i} m_j + 2 K <m_i, e> e + H + ...
#     E = -J sum_{i ~ j} <m_i, m_j> - K sum_i <m_i, e>^2 - sum_i <H, m_i> + ...,     |m_i| = 1
#
# Solved for m_i' it is m_i' = psi_i x m_i with the generator psi_i = gamma/(1 + alpha^2) (h_i + alpha m_i x h_i) in
# so(3): spins turn counterclockwise about the field (for gamma > 0) and, for alpha > 0, towards it.

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
        sites = self.lattice.shape
        self.exchange = float(parameter("exchange", exchange, ()))
        self.anisotropy: Array = parameter("anisotropy", anisotropy, sites)
        self.damping: Array = parameter("damping", damping, sites)
        self.gyromagnetic = float(parameter("gyromagnetic", gyromagnetic, ()))
        if np.any(self.damping < 0):
            raise InputError(f"the damping is {damping!r}, expected at least 0")
        self.cubic: Array = parameter("cubic", cubic, sites)
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
        e = parameter("axis", axis, (*sites, 3))
        length = np.linalg.norm(e, axis=-1, keepdims=True)
        if e.shape[-1:] != (3,) or not bool(np.all(length > 0)):
            raise InputError(f"the axis is {axis!r}, expected vectors of R^3 other than 0")
        self._axis = e / length
        self.time_dependent = callable(applied)
        self._applied: Any = applied
        if not callable(applied):
            self._applied = parameter("applied", applied, (*sites, 3))
            if self._applied.shape[-1:] != (3,):
                raise ShapeError(f"the applied field has shape {self._applied.shape}, expected (..., 3)")
        psi: Callable[..., Any] = self.generator if self.time_dependent else lambda m: self.generator(m)
        sites = sites if self.coupled else ()
        self.field = GeneratorField(adjoint(so(3)), psi, time_dependent=self.time_dependent, sites=sites)

    @property
    def coupled(self) -> bool:
        """Whether the spins are coupled, by exchange or by Dzyaloshinskii-Moriya interaction."""
        return (self.exchange != 0 or self.dmi != 0) and self.lattice.bonds > 0

    def effective_field(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """h = -dE/dm at m (..., *shape, 3), an array or Jet of that shape, for a time (..., *shape) or a number."""
        spins = self._spins(m)
        h = self._field_at(spins, time)
        if np.any(self.anisotropy):
            h = h + self._along(spins) * (2 * self.anisotropy[..., None] * self._axis)
        if np.any(self.cubic):
            h = h + cubic_field(self.cubic, self.cubic_axes, spins)
        return h + self._coupling(spins) if self.coupled else h

    def generator(self, m: npt.ArrayLike | Values, t: Real = 0.0) -> Any:
        """psi = gamma/(1 + alpha^2) (h + alpha m x h), with m' = psi x m; shape (..., *shape, 3)."""
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
        """The field of the neighbours of coupled spins."""
        if not self.dmi:
            return self.exchange * self.lattice.neighbour_sum(spins)
        h = dmi_field(self.lattice, self.dmi, self._bonds, spins)
        return h + self.exchange * self.lattice.neighbour_sum(spins) if self.exchange else h

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
        if self.coupled:
            density = density - np.sum(spins * self._coupling(spins), axis=-1) / 2
        return self.lattice.total(density)

    def energy_rate(self, m: npt.ArrayLike | Values, time: Real = 0.0) -> Any:
        """dE/dt = -gamma sum_i alpha/(1 + alpha^2) |m_i x h_i|^2 in a constant field without spin torque and noise."""
        spins = self._spins(m)
        turning = np.cross(spins, self.effective_field(spins, time))
        rate = self.gyromagnetic * self.damping / (1 + self.damping**2)
        return -self.lattice.total(rate * np.sum(turning * turning, axis=-1))

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
            if options.get("engine", "auto") not in (("auto", "numpy", "llvm") if self.coupled else ("auto", "numpy")):
                raise InputError("noise is compiled by engine='llvm' for coupled spins only: take engine='numpy'")
            step = self._thermal(step, dt, span, spins.shape, seed)
        elif seed is not None:
            raise InputError("a seed is given, but the temperature is 0: there is no noise")
        elif step is None and self.coupled and options.get("engine") == "llvm":
            step = RKMK("rk45")  # explicit stages are compiled, series are not
        return integrate(self.field, span, spins, step=step, dt=dt, **options)

    def noise(self, shape: tuple[int, ...], dt: float, seed: int, parts: int = 1) -> Increments:
        """The `Increments` that `integrate` uses for spins of a shape (..., *shape, 3), to compare runs on one path."""
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
        (`liehom.steps.Conserving`).

        Examples
        --------
        >>> import liehom as lh
        >>> pair = LandauLifshitz((2,), exchange=1.0, periodic=False).joint()
        >>> sol = lh.integrate(pair.field, (0, 1), pair.point([[0, 0, 1.0], [0, 0.6, 0.8]]))
        >>> pair.spins(sol.y.T).shape[1:]
        (2, 3)
        """
        return JointSpins(self.lattice, self.generator, self.time_dependent)

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
        seed = checked_integer(seed, "the seed", 0)
        size = float(np.asarray(dt))
        return self.thermal_step(Heun() if step is None else step, self.noise(shape, size, seed), float(span[0]))

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

    def __repr__(self) -> str:
        shape = f"{self.lattice.shape}, " if self.lattice.shape else ""
        k, damping = _shown(self.anisotropy), _shown(self.damping)
        return f"<LandauLifshitz {shape}J = {self.exchange}, K = {k}, alpha = {damping}>"


def _shown(value: Array) -> str:
    """A parameter as it is printed."""
    return str(float(value)) if value.ndim == 0 else f"array of shape {value.shape}"
