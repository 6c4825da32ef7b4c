"""Interactions of spins: the energies of a lattice and their effective fields h_i = -dE/dm_i.

    exchange                      -J sum_{i ~ j} <m_i, m_j>
    uniaxial anisotropy           -K sum_i <m_i, e>^2
    cubic anisotropy              C sum_i (a_1^2 a_2^2 + a_2^2 a_3^2 + a_3^2 a_1^2),   a_k = <m_i, c_k>
    Dzyaloshinskii-Moriya         D sum_{i ~ j} <d_ij, m_i x m_j>

d_ij is the unit vector from i to j for the bulk kind, and e_3 x that vector for the interfacial kind.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.instances.spins.spin_lattice import SpinLattice
from liehom.typing import Array, Values

KINDS = ("bulk", "interfacial")


def parameter(name: str, value: npt.ArrayLike, shape: tuple[int, ...]) -> Array:
    """A parameter as an array that broadcasts to a shape, checked.

    Raises
    ------
    ShapeError, InputError
        If it is not of this form.

    Examples
    --------
    >>> parameter("damping", 0.5, (4,))
    array(0.5)
    """
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


def orthonormal_axes(axes: npt.ArrayLike | None) -> Array:
    """Three orthonormal vectors in columns, by default the coordinate axes.

    Raises
    ------
    InputError
        If they are not orthonormal.

    Examples
    --------
    >>> orthonormal_axes(None).shape
    (3, 3)
    """
    found = np.eye(3) if axes is None else np.asarray(axes, dtype=float)
    if found.shape != (3, 3) or not np.allclose(found.T @ found, np.eye(3)):
        raise InputError(f"the cubic axes are {axes!r}, expected a (3, 3) matrix with orthonormal columns")
    return found


def bond_vectors(lattice: SpinLattice, kind: str) -> Array:
    """d for the bonds along each axis of the lattice, shape (L, 3).

    Raises
    ------
    InputError
        If the kind is unknown, or the lattice has more than 3 axes.

    Examples
    --------
    >>> bond_vectors(SpinLattice((3, 3)), "interfacial").tolist()
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    if kind not in KINDS:
        raise InputError(f"dmi_kind is {kind!r}, expected one of {', '.join(map(repr, KINDS))}")
    axes = len(lattice.shape)
    if axes > 3:
        raise InputError(f"a lattice of {axes} axes has no directions in space for its bonds: dmi needs at most 3")
    along: Array = np.eye(3)[:axes]
    return along if kind == "bulk" else np.cross([0.0, 0.0, 1.0], along)


def dmi_field(lattice: SpinLattice, strength: float, bonds: Array, m: Values) -> Values:
    """D sum_a d_a x (m_{i + a} - m_{i - a}), shape of m.

    Examples
    --------
    >>> chain, m = SpinLattice((3,)), np.eye(3)
    >>> dmi_field(chain, 2.0, np.array([[1.0, 0.0, 0.0]]), m).tolist()
    [[0.0, 2.0, 2.0], [0.0, -2.0, 0.0], [0.0, 0.0, -2.0]]
    """
    total: Any = 0 * m
    for axis, d in enumerate(bonds):
        total = total + np.cross(strength * d, lattice.difference(m, axis))
    found: Values = total
    return found


def cubic_field(strength: Array, axes: Array, m: Values) -> Values:
    """-2 C sum_k a_k (|m|^2 - a_k^2) c_k for cubic axes c_k in the columns of `axes`, shape of m.

    Examples
    --------
    >>> cubic_field(np.array(1.0), np.eye(3), np.array([0.6, 0.8, 0.0])).round(3).tolist()
    [-0.768, -0.576, 0.0]
    """
    a: Any = m @ axes
    square = a * a
    rest = np.sum(square, axis=-1)[..., None] - square
    found: Values = (-2 * strength[..., None] * a * rest) @ axes.T
    return found


def cubic_energy(axes: Array, m: Values) -> Values:
    """a_1^2 a_2^2 + a_2^2 a_3^2 + a_3^2 a_1^2, shape (...,).

    Examples
    --------
    >>> round(float(cubic_energy(np.eye(3), np.array([0.6, 0.8, 0.0]))), 4)
    0.2304
    """
    a: Any = m @ axes
    square = a * a
    found: Values = square[..., 0] * square[..., 1] + square[..., 1] * square[..., 2] + square[..., 2] * square[..., 0]
    return found
