"""Cartan involutions and decompositions, split tori and parabolic subalgebras of semisimple real algebras.

Floating point proposes an involution and exact arithmetic proves it; see docs/theory/structure.md.
"""

from liehom.base.lazy import lazy_modules

__getattr__ = lazy_modules(__name__)
