"""Pictures of root systems, weights, diagrams of real forms, and brackets, for the page on plots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import liehom as lh
from liehom.plotting.canvas import new_figure
from pictures import picture


@picture
def dynkin_diagrams(colours: Sequence[str]) -> Any:
    figure = new_figure(5.6, 3.2)
    upper, lower = figure.subplots(2, 1)
    lh.plotting.plot_dynkin("F4", upper)
    lh.plotting.plot_dynkin("E8", lower, labels=lh.root_system("E8").highest_roots[0])
    return figure


@picture
def satake_diagrams(colours: Sequence[str]) -> Any:
    figure = new_figure(5.6, 2.2)
    left, right = figure.subplots(1, 2, width_ratios=(3.4, 5.4))  # as many units as wide
    lh.plotting.plot_satake("su(4,2)", left)
    lh.plotting.plot_vogan("su(4,2)", right)
    left.set_title("Satake diagram of su(4,2)")
    right.set_title("Vogan diagram of su(4,2)")
    return figure


@picture
def root_systems(colours: Sequence[str]) -> Any:
    """One in the plane and one in space."""
    figure = new_figure(7.4, 4.0)
    lh.plotting.plot_root_system("G2", figure.add_subplot(1, 2, 1))
    lh.plotting.plot_root_system("B3", figure.add_subplot(1, 2, 2, projection="3d", proj_type="ortho"))
    return figure


@picture
def weight_diagrams(colours: Sequence[str]) -> Any:
    """One in the plane and one in space."""
    figure = new_figure(6.4, 3.8)
    lh.plotting.plot_weights("A2", (3, 1), figure.add_subplot(1, 2, 1))
    lh.plotting.plot_weights("A3", (1, 0, 1), figure.add_subplot(1, 2, 2, projection="3d", proj_type="ortho"))
    return figure


@picture
def bracket_table(colours: Sequence[str]) -> Any:
    figure = new_figure(4.6, 4.6)
    lh.plotting.plot_bracket_table(lh.euclidean(3), figure.add_subplot())
    return figure
