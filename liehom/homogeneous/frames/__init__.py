"""Frames of isotropy and tangent directions at a point, and the inner product that norms on g refer to.

`branch_free_frames` has a fixed sequence of operations, for compiled steps and JAX. Used by `Action`, the least-norm
generators and the correctors; see docs/theory/correctors.md.
"""

from liehom.homogeneous.frames.inner_product import InnerProduct as InnerProduct
from liehom.homogeneous.frames.inner_product import inner_product as inner_product
