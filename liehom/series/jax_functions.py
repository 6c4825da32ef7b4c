"""Series of functions that are written for JAX arrays, which do not run on Jets, by the Taylor mode of JAX."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from math import factorial
from typing import Any

from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.typing import Values


def expanded_by_jax(function: Callable[..., Values], *operands: Jet | Values) -> Jet:
    """The Jet of function(a, b, ...) for Jets, or arrays, whose values are JAX arrays.

    Parameters
    ----------
    function : callable
        Of JAX arrays, written with the functions of JAX.

    Notes
    -----
    Coefficient k is computed from the coefficients up to k of the operands, without those computed before. So the
    expansion to order n costs O(n^3) operations. Functions written with numpy cost O(n^2).

    Examples
    --------
    >>> import jax
    >>> import numpy as np
    >>> with jax.enable_x64(True):
    ...     x = Jet([jax.numpy.zeros(1), jax.numpy.ones(1), jax.numpy.zeros(1), jax.numpy.zeros(1)])
    ...     print(np.asarray(expanded_by_jax(jax.numpy.tanh, x).coefficient(3)).round(6).tolist())
    [-0.333333]
    """
    jet: Any = import_module("jax.experimental.jet")
    jnp = import_module("jax.numpy")
    moving = [x for x in operands if isinstance(x, Jet)]
    nodes = [x.node for x in moving]

    def of_jets(*values: Values) -> Values:
        left = iter(values)
        return function(*[next(left) if isinstance(x, Jet) else x for x in operands])

    values = tuple(jnp.asarray(node.value) for node in nodes)

    def rule(k: int) -> Values:
        series = tuple(
            [jnp.zeros_like(v) if c is None else factorial(i) * jnp.broadcast_to(c, v.shape) for i, c in terms]
            for v, terms in ((v, list(enumerate(n.known[1 : k + 1], 1))) for v, n in zip(values, nodes, strict=True))
        )
        found: Values = jet.jet(of_jets, values, series)[1][k - 1] / factorial(k)
        return found

    value = of_jets(*values)
    order = min(node.order for node in nodes)
    return Jet.from_node(Node(order, value, [value], tuple((node, 0) for node in nodes), rule))
