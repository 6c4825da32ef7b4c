"""The range condition and the cone on which it fails, orbit types and strata, conjugacy of isotropy subalgebras."""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
