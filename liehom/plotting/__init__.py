"""Pictures of what has been measured and integrated, by matplotlib (the extra `liehom[plot]`).

In reading order: `canvas` (figures, colours, files), `convergence` (errors over step sizes), `trajectory`.
A figure belongs to the caller; no window is opened and no setting of matplotlib is changed.
"""

from liehom.plotting.convergence_plot import plot_convergence as plot_convergence
from liehom.plotting.trajectory_plot import plot_trajectory as plot_trajectory
