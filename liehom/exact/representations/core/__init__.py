"""`Representation` and `Pair`, complex coordinates of points, elements by their matrices.

The two classes are tables of contents whose methods lead upwards; see docs/theory/representations.md.
"""

from liehom.base.lazy import lazy_modules

__getattr__ = lazy_modules(__name__)
