"""Plots of orders, errors, trajectories, strata, failure cones, roots and diagrams, by matplotlib.

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

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
