"""Plots of measured orders and of trajectories, by matplotlib (the extra `liehom[plot]`).

`canvas` makes figures, colours and files, and is the one module that loads matplotlib; `convergence_plot` draws errors
over step sizes, `trajectory_plot` solutions. A figure belongs to the caller: no window is opened, and no setting of
matplotlib is changed. docs/api/plotting.md lists the functions.
"""

from liehom.plotting.convergence_plot import plot_convergence as plot_convergence
from liehom.plotting.trajectory_plot import plot_trajectory as plot_trajectory
