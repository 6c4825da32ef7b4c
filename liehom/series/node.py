"""Node: a power series that computes its Taylor coefficients one after the other, on demand.

A node holds its coefficients so far, the nodes they depend on, and a rule for the next coefficient.  Coefficient k of a
sum or product needs coefficients up to k of the operands; of an integral or a recurrence, up to k - 1 (its lag).
So a series may depend on itself with a lag; this is how the solution of a differential equation is expanded.  No
coefficient is computed twice, and an expansion to order n costs O(n^2) products.  A coefficient None is a structural
zero.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, TypeAlias, final

from liehom.errors import SeriesError
from liehom.typing import Values

Coefficient: TypeAlias = Values | None
"""A Taylor coefficient; None is a structural zero."""

Rule: TypeAlias = Callable[[int], Coefficient]


@final
class Node:
    """A series with coefficients on demand; users see it as a `Jet`.

    Parameters
    ----------
    order : int
        The last index that may be asked for.
    value : array
        The value at 0. If coefficient 0 is a structural zero, it still gives shape and dtype.
    known : list
        Coefficients from 0 on, None for a structural zero; at least the first.
    operands : tuple of (Node, lag)
    rule : callable, optional
        k -> coefficient k, for k = len(known), .... Without a rule the coefficients are appended from outside.

    Examples
    --------
    >>> one = Node(3, 1.0, [1.0], (), lambda k: None)
    >>> exponential = Node(3, 1.0, [1.0])
    >>> exponential.depends((exponential, 1), rule=lambda k: exponential.known[k - 1] / k)
    >>> exponential.coefficient(3)
    0.16666666666666666
    """

    known: list[Any]
    operands: tuple[tuple[Node, int], ...]

    __slots__ = ("known", "operands", "order", "rule", "value")

    def __init__(
        self,
        order: int,
        value: Values,
        known: list[Any],
        operands: tuple[tuple[Node, int], ...] = (),
        rule: Rule | None = None,
    ) -> None:
        self.order: int = order
        self.value: Values = value
        self.known = known
        self.operands = operands
        self.rule = rule

    def depends(self, *operands: tuple[Node, int], rule: Rule) -> None:
        """Set operands and rule after construction, for a series that depends on itself."""
        self.operands, self.rule = operands, rule

    def coefficient(self, k: int) -> Coefficient:
        """Coefficient k, or None if it is a structural zero; missing coefficients of operands are computed first."""
        if 0 <= k < len(self.known):
            found: Coefficient = self.known[k]
            return found
        if k < 0:
            raise SeriesError(f"the coefficients of a series begin with 0, got {k}")
        if k > self.order:
            raise SeriesError(f"coefficient {k} of a series of order {self.order} is not known")
        stack: list[tuple[Node, int]] = [(self, k)]
        while stack:
            node, wanted = stack[-1]
            have = len(node.known)
            if have > wanted:
                stack.pop()
                continue
            missing = [(o, have - lag) for o, lag in node.operands if len(o.known) <= have - lag]
            if missing:
                stack.extend(missing)
            elif node.rule is None:
                raise SeriesError(f"coefficient {have} of a growing series is asked for before it is given")
            else:
                node.known.append(node.rule(have))
        found = self.known[k]
        return found


def rewind(root: Node, source: Node, k: int) -> None:
    """Forget the coefficients of the nodes under `root` that depend on coefficient k of `source`.

    Called after coefficient k >= 1 of a growing `source` was replaced. A node that needs `source` with lag l
    forgets its coefficients from k + l on, and so do the nodes that depend on it.

    Examples
    --------
    >>> x = Node(2, 1.0, [1.0, 1.0])
    >>> y = Node(2, 2.0, [2.0], ((x, 0),), lambda k: 2 * x.known[k])
    >>> y.coefficient(1)
    2.0
    >>> x.known[1] = 5.0
    >>> rewind(y, x, 1)
    >>> y.coefficient(1)
    10.0
    """
    users: dict[int, list[tuple[Node, int]]] = {}
    seen, stack = {id(root)}, [root]
    while stack:
        node = stack.pop()
        for below, lag in node.operands:
            users.setdefault(id(below), []).append((node, lag))
            if id(below) not in seen:
                seen.add(id(below))
                stack.append(below)
    first, pending = {id(source): k}, deque([source])
    while pending:
        below = pending.popleft()
        for node, lag in users.get(id(below), []):
            start = first[id(below)] + lag
            if node is not source and start < first.get(id(node), len(node.known)):
                first[id(node)] = start
                del node.known[start:]
                pending.append(node)
