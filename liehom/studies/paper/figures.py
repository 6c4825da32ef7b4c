"""Figures of the paper by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from liehom.base.errors import InputError, displayed
from liehom.studies.paper.efficiency import figure6, figure7
from liehom.studies.paper.energy_errors import figure3, figure4, figure5
from liehom.studies.paper.reproduction import Reproduction
from liehom.studies.paper.trajectories import figure1, figure2, separatrix

_FIGURES: dict[str, Callable[..., Reproduction]] = {
    "fig1": figure1,
    "fig2": figure2,
    "fig3": figure3,
    "fig4": figure4,
    "fig5": figure5,
    "fig6": figure6,
    "fig7": figure7,
    "separatrix": separatrix,
}
NAMES = tuple(_FIGURES)
"""What `reproduce` reproduces: names of figures, and of the experiment on separatrices."""


def reproduce(name: str, *, quick: bool = False, seed: int | None = None) -> Reproduction:
    """Reproduction of a figure of the paper, or of its separatrix experiment.

    Parameters
    ----------
    name : str
        One of `NAMES`: fig1, ..., fig7, separatrix.
    quick : bool
        Use few bodies and short runs: they show orders and zeros, but no averages to compare with the paper's.
    seed : int, optional
        Seed of the random bodies and initial points (default: the figure's).

    Returns
    -------
    Reproduction
        With `.tables`, `.checks`, `.holds`, `.caption()`, `.markdown()`, `.latex()`, `.plot(path)`, `.write(folder)`.

    Examples
    --------
    >>> done = reproduce("fig2", quick=True)
    >>> done.holds, list(done.tables)
    (True, [''])
    """
    if name not in _FIGURES:
        raise InputError(f"there is no figure {name!r} to reproduce, expected one of {', '.join(NAMES)}")
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int) or seed < 0):
        raise InputError(f"a seed is a non-negative integer, got {displayed(seed)}")
    done = _FIGURES[name](quick) if seed is None else _FIGURES[name](quick, seed)
    return replace(done, settings={"quick": bool(quick), "seed": seed})
