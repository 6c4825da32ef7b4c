"""The engine "jax" on JAX arrays: steps as array code or as a scalar graph, loops over them, and their derivatives.

docs/gradients.md shows what can be differentiated, and at what cost.
"""

from liehom.integrators.jax_engine.jax_engine import JaxEngine as JaxEngine
