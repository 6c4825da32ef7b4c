"""The engine "jax" on JAX arrays: steps as array code or as a scalar graph, loops over them, and their derivatives.

docs/tutorials/compiled.md shows both.
"""

from liehom.integrators.jax_engine.jax_engine import JaxEngine as JaxEngine
