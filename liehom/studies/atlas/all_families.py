"""`build`: the atlas, all pairs of the families decided, with certificates, rows and facts."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator

from liehom.base.errors import InputError
from liehom.base.tasks import ExecutorLike
from liehom.studies.atlas.affine import affine_pairs
from liehom.studies.atlas.entry import Entry, Recipe
from liehom.studies.atlas.irreducible import isotropy_irreducible_pairs
from liehom.studies.atlas.subalgebras import low_dimensional_pairs, maximal_pairs, parabolic_pairs
from liehom.studies.atlas.sweeps import iter_sweep
from liehom.studies.atlas.symmetric import group_pairs, symmetric_pairs

FAMILIES: dict[str, Callable[[], Iterable[Recipe]]] = {
    "symmetric": symmetric_pairs,
    "group": group_pairs,
    "isotropy-irreducible": isotropy_irreducible_pairs,
    "parabolic": parabolic_pairs,
    "maximal": maximal_pairs,
    "affine": affine_pairs,
    "dimension at most 4": low_dimensional_pairs,
}
"""The generator of each family, by the name of the family."""


def recipes(families: Iterable[str] | None = None) -> Iterator[Recipe]:
    """Iterator of the recipes of some families, or of all.

    Parameters
    ----------
    families : iterable of str, optional
        Names in `FAMILIES`; by default all of them, in this order.

    Examples
    --------
    >>> [recipe.name for recipe in recipes(["parabolic"])][:3]
    ['sl(2)/P{1}', 'sl(2,C)/P{1}', 'sl(3)/P{1}']
    """
    if isinstance(families, str):
        raise InputError(f"expected a list of names of families, got the string {families!r}")
    wanted = list(FAMILIES if families is None else families)
    if unknown := [name for name in wanted if name not in FAMILIES]:
        raise InputError(f"there is no family {unknown[0]!r}; expected one of {', '.join(FAMILIES)}")
    return (recipe for name in wanted for recipe in FAMILIES[name]())


def build(
    families: Iterable[str] | None = None,
    *,
    executor: ExecutorLike = None,
    store: str | os.PathLike[str] | None = None,
    recheck: bool = False,
) -> Iterator[Entry]:
    """Iterator of the entries of the atlas: each pair decided, its certificate verified, and its facts computed.

    Parameters
    ----------
    families : iterable of str, optional
        Names in `liehom.atlas.FAMILIES`; by default all of them.
    executor, store, recheck
        As for `liehom.studies.atlas.sweeps`.

    Returns
    -------
    iterator of Entry
        In the order of the families. Full pairs have their row in the classification.

    Examples
    --------
    >>> import liehom as lh
    >>> entry = next(lh.atlas.build(["parabolic"]))
    >>> entry.name, entry.full, entry.facts["open_orbits"]
    ('sl(2)/P{1}', True, 2)
    """
    entries = iter_sweep(recipes(families), executor=executor, store=store, recheck=recheck, ordered=True, facts=True)
    return (entry for _, entry in entries)
