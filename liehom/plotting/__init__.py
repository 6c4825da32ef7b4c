"""Plots of orders, errors, trajectories, strata, failure cones, roots and diagrams, by matplotlib (`liehom[plot]`).

* `canvas` makes figures, colours and files, and is the one module that loads matplotlib.
* `convergence_plot` draws errors over step sizes, `work_precision_plot` errors over costs, `drift_plot` errors of first
  integrals over time.
* `surfaces` draws spheres and other quadrics with curves on them, `trajectory_plot` solutions, whose points between the
  steps are those of `curves`, `animation` the same in motion.
* `phase_plot` draws phase portraits on spheres, `spectrum_plot` eigenvalues over time.
* `strata_plot` draws failure cones, eigenvalues and Weyl chambers.
* `root_plot` draws roots and weights, `diagram_plot` Dynkin, Satake and Vogan diagrams and bracket tables.

A figure belongs to the caller: no window is opened, and no setting of matplotlib is changed. docs/api/plotting.md lists
the functions.
"""

from liehom.plotting.animation import animate_trajectory as animate_trajectory
from liehom.plotting.canvas import style as style
from liehom.plotting.convergence_plot import plot_convergence as plot_convergence
from liehom.plotting.diagram_plot import plot_bracket_table as plot_bracket_table
from liehom.plotting.diagram_plot import plot_dynkin as plot_dynkin
from liehom.plotting.diagram_plot import plot_satake as plot_satake
from liehom.plotting.diagram_plot import plot_vogan as plot_vogan
from liehom.plotting.drift_plot import plot_energy_drift as plot_energy_drift
from liehom.plotting.phase_plot import plot_phase_portrait as plot_phase_portrait
from liehom.plotting.root_plot import plot_root_system as plot_root_system
from liehom.plotting.root_plot import plot_weights as plot_weights
from liehom.plotting.spectrum_plot import plot_spectrum as plot_spectrum
from liehom.plotting.strata_plot import plot_eigenvalues as plot_eigenvalues
from liehom.plotting.strata_plot import plot_failure_cone as plot_failure_cone
from liehom.plotting.strata_plot import plot_weyl_chamber as plot_weyl_chamber
from liehom.plotting.trajectory_plot import plot_quadric as plot_quadric
from liehom.plotting.trajectory_plot import plot_trajectory as plot_trajectory
from liehom.plotting.work_precision_plot import plot_work_precision as plot_work_precision
