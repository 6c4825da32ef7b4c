"""The methods: Euler, RKMK, Taylor, stiff and symplectic steps, with the tableaux of Runge and Kutta.

Coefficients are fractions and prove their order; see docs/which-step.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
