"""FreeBody: the protocol of a rigid body that its updates use, with the inverse inertia Om and the vector fields.

The updates are written for this protocol, below `RigidBody`, which satisfies it and whose methods return them.
"""

from __future__ import annotations

from typing import Any, Protocol, TypeAlias

import numpy as np

from liehom.homogeneous import GeneratorField
from liehom.representations import Representation
from liehom.typing import Values

FloatType: TypeAlias = type[np.floating[Any]]
"""numpy.float64 or numpy.longdouble."""


class FreeBody(Protocol):
    """A free rigid body m' = m x Om m, with the methods that its updates call.

    Attributes
    ----------
    representation : Representation
        so(3) on R^3 by the cross product.

    Examples
    --------
    >>> from liehom.instances import RigidBody
    >>> body: FreeBody = RigidBody([1, 2, 4])
    >>> body.apply(np.array([1.0, 1.0, 1.0])).tolist()
    [1.0, 0.5, 0.25]
    """

    representation: Representation

    def apply(self, m: Values) -> Any:
        """Om m for points m (..., 3)."""
        ...

    def invariants(self, dtype: FloatType = np.float64) -> tuple[Any, Any, Any]:
        """e_1, e_2, e_3, the elementary symmetric functions of the inverse moments."""
        ...

    def field(self, kind: str = "o") -> GeneratorField:
        """The vector field with the generator omega_b ("b") or omega_o ("o")."""
        ...
