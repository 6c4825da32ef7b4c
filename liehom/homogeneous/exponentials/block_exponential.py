"""The exponential of a representation that is a direct sum in its coordinates: each block by its own formula.

Blocks are the smallest sets of coordinates that no rho(e_i) couples. The three rows of a rotation matrix, the spins of
a lattice and translations are blocks on which Rodrigues' formula holds, although it does not hold on their sum. Equal
blocks are computed together, as one array.
"""

from __future__ import annotations

from typing import Any, NamedTuple, final

import numpy as np

from liehom.homogeneous.exponentials.exponential import SeriesExponential, TrueExponential, exact_exponential
from liehom.homogeneous.exponentials.rodrigues import PowerIdentity, Rodrigues, power_identity, rodrigues_action
from liehom.homogeneous.maps import Entries, FieldMap, action_entries
from liehom.representations import Representation
from liehom.scalars import Field, Scalar
from liehom.series.arrays import is_exact, namespace
from liehom.typing import IntegerArray, Values

MAX_BLOCK = 16
"""Blocks with more coordinates are not searched for a closed form."""


class Blocks(NamedTuple):
    """Equal blocks: generators (k, d) and coordinates (k, n) of each of them, their map and their identity."""

    generators: IntegerArray
    coordinates: IntegerArray
    infinitesimal: FieldMap
    identity: PowerIdentity


@final
class BlockExponential(TrueExponential):
    """exp(rho(x)) m on blocks of coordinates, each by Rodrigues' formula.

    Parameters
    ----------
    representation : Representation
    blocks : list of Blocks
        From `blocks_of`.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3)).direct_sum(lh.defining(lh.so(3)))
    >>> lh.Action(rho).exponential.name
    'exp (Rodrigues)'
    >>> pair = lh.Representation(lh.abelian(2), [np.kron(np.diag(d), [[0, -1], [1, 0]]) for d in ([1, 0], [0, 1])])
    >>> lh.Action(pair).exponential.name
    'exp (Rodrigues in blocks)'
    """

    def __init__(self, representation: Representation, blocks: list[Blocks]) -> None:
        super().__init__(representation)
        self._blocks = blocks
        moved = np.concatenate([block.coordinates.ravel() for block in blocks])
        rests = np.ones(representation.size, dtype=bool)
        rests[moved] = False
        fixed = np.flatnonzero(rests)
        order = np.concatenate([moved, fixed])
        self._fixed = fixed
        self._order: IntegerArray | None = None if np.array_equal(order, np.arange(len(order))) else np.argsort(order)

    @property
    def name(self) -> str:
        return "exp (Rodrigues in blocks)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        shape = np.broadcast_shapes(x.shape[:-1], m.shape[:-1])
        parts: list[Any] = []
        for block in self._blocks:
            k, n = block.coordinates.shape
            index = (0, slice(None)) if k == 1 else (slice(None), slice(None))
            moved = rodrigues_action(
                block.infinitesimal, block.identity, x[..., block.generators[index]], m[..., block.coordinates[index]]
            )
            parts.append(moved if k == 1 else moved.reshape((*shape, k * n)))
        xp = namespace(x, m)
        if self._fixed.size:
            kept = m[..., self._fixed]
            parts.append(xp.broadcast_to(kept, (*shape, len(self._fixed))) if kept.shape[:-1] != shape else kept)
        made: Values = xp.concatenate(parts, axis=-1) if len(parts) > 1 else parts[0]
        return made if self._order is None else made[..., self._order]


def blocks_of(representation: Representation) -> list[Blocks] | None:
    """The blocks of a representation, if there are several coordinates sets and a closed form holds on each of them.

    Examples
    --------
    >>> import liehom as lh
    >>> blocks_of(lh.defining(lh.so(4))) is None
    True
    """
    entries = action_entries(representation)
    roots = _components(entries, representation.size)
    moved = {j for _, j, _, _ in entries} | {i for _, _, i, _ in entries}
    if len({roots[i] for i in range(representation.size)}) < 2 or not moved:
        return None
    members: dict[int, list[int]] = {}
    for i in sorted(moved):
        members.setdefault(roots[i], []).append(i)
    if max(map(len, members.values())) > MAX_BLOCK:
        return None
    parts: dict[int, list[tuple[int, int, int, Scalar]]] = {root: [] for root in members}
    for entry in entries:
        parts[roots[entry[1]]].append(entry)
    return _grouped(parts, members, representation.field)


def _components(entries: Entries, size: int) -> list[int]:
    """A representative of the set of coordinates that each coordinate is coupled to."""
    parent = list(range(size))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for _, j, i, _ in entries:
        parent[root(j)] = root(i)
    return [root(i) for i in range(size)]


def _grouped(
    parts: dict[int, list[tuple[int, int, int, Scalar]]], members: dict[int, list[int]], field: Field
) -> list[Blocks] | None:
    """Blocks with equal matrices put together; None if one of them has no closed form."""
    kinds: list[tuple[list[Any], list[list[int]], list[list[int]]]] = []
    for root, entries in parts.items():
        generators, coordinates = sorted({a for a, *_ in entries}), members[root]
        number, place = {a: k for k, a in enumerate(generators)}, {i: k for k, i in enumerate(coordinates)}
        own = sorted(((number[a], place[j], place[i], v) for a, j, i, v in entries), key=lambda entry: entry[:3])
        for known, first, second in kinds:
            if known == own and len(second[0]) == len(coordinates):
                first.append(generators)
                second.append(coordinates)
                break
        else:
            kinds.append((own, [generators], [coordinates]))
    found = []
    for own, first, second in kinds:
        d, n = len(first[0]), len(second[0])
        identity = power_identity(_matrices(own, d, n, field), field)
        if identity is None:
            return None
        found.append(Blocks(np.array(first), np.array(second), FieldMap(own, (d, n, n), field), identity))
    return found


def _matrices(entries: Entries, count: int, size: int, field: Field) -> list[Any]:
    """The matrices (size, size) of a block from their entries (generator, column, row, value)."""
    rows = [[[field.zero] * size for _ in range(size)] for _ in range(count)]
    for a, j, i, value in entries:
        rows[a][i][j] = value
    return [field.matrix(m, (size, size)) for m in rows]


def default_exponential(representation: Representation) -> TrueExponential:
    """The exponential "exp": Rodrigues' formula where it holds, on the whole or on each block, else the series.

    Examples
    --------
    >>> import liehom as lh
    >>> default_exponential(lh.defining(lh.so(4))).name
    'exp (series)'
    """
    identity = power_identity(representation.matrices, representation.field)
    if identity is not None and identity.power == 1:
        return Rodrigues(representation)
    blocks = blocks_of(representation)  # each of them may need a lower power than the whole
    if blocks is not None:
        return BlockExponential(representation, blocks)
    return SeriesExponential(representation) if identity is None else Rodrigues(representation)
