"""JointSpins: all spins of a small lattice as one point of R^(3n), on which so(3)^n acts.

    rho(x_1, ..., x_n)(m_1, ..., m_n) = (x_1 x m_1, ..., x_n x m_n)

Steps of k exponentials cost O(n) per trajectory; what needs the isotropy or a series in matrices costs O(n^3).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import direct_sum, so
from liehom.homogeneous import GeneratorField
from liehom.instances.spins.spin_lattice import SpinLattice
from liehom.representations import Representation, adjoint
from liehom.representations.core.copies import Copies
from liehom.typing import Real, Values


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
    >>> from liehom.instances import LandauLifshitz
    >>> spins = LandauLifshitz((3,), exchange=1.0).joint()
    >>> spins.representation.orbit_dimension([0, 0, 1, 0, 1, 0, 1, 0, 0])
    6
    """

    field: GeneratorField
    lattice: SpinLattice
    representation: Representation

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
        """Spins (..., *shape, 3) of points (..., 3n), arrays or Jets.

        Examples
        --------
        >>> from liehom.instances import LandauLifshitz
        >>> LandauLifshitz((3, 4)).joint().spins([0.0] * 36).shape
        (3, 4, 3)
        """
        joint: Any = point if hasattr(point, "shape") else np.asarray(point, dtype=float)
        return joint.reshape((*joint.shape[:-1], *self.lattice.shape, 3))


def product_of_spheres(n: int) -> Representation:
    """The representation of so(3)^n on R^(3n).

    Examples
    --------
    >>> product_of_spheres(2)
    <representation 'n spins' of <Lie algebra so(3)+so(3) of dimension 6 over QQ> on QQ^6>
    """
    # unchecked, because it is a direct sum of representations of the summands
    return Representation(direct_sum(*[so(3)] * n), Copies(adjoint(so(3)), n), name="n spins", check=False)
