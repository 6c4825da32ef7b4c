"""Spheres under SO(k), and the frame of section 3 on S^2 with its order conditions.

The rigid body, the spins and the figures of the paper use them; see docs/paper-map.md.
"""

from liehom.instances.spheres.sphere import Sphere as Sphere
from liehom.instances.spheres.sphere_frame import SphereFrame as SphereFrame
