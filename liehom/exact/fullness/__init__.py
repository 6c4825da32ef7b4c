"""Full pairs: the decision with its certificates, the independent checker, and the classification.

`decide` has the order of the steps, `search` the sources of certificates, `checker` what proves them. See
docs/theory/fullness.md and docs/theory/classification.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
