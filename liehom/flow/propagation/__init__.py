"""What users call: `Propagator`, `integrate` and `integrate_ensemble`.

Arguments are checked once, and the engine is kept from call to call; see docs/tutorials/integrating.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
