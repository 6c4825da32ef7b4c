from liehom.plotting.canvas import style as style
from liehom.plotting.diagram_plot import (
    plot_bracket_table as plot_bracket_table,
    plot_dynkin as plot_dynkin,
    plot_root_system as plot_root_system,
    plot_satake as plot_satake,
    plot_vogan as plot_vogan,
    plot_weights as plot_weights,
)
from liehom.plotting.drift_plot import plot_energy_drift as plot_energy_drift, plot_spectrum as plot_spectrum
from liehom.plotting.error_plot import plot_convergence as plot_convergence, plot_work_precision as plot_work_precision
from liehom.plotting.phase_plot import plot_phase_portrait as plot_phase_portrait
from liehom.plotting.strata_plot import (
    plot_eigenvalues as plot_eigenvalues,
    plot_failure_cone as plot_failure_cone,
    plot_weyl_chamber as plot_weyl_chamber,
)
from liehom.plotting.trajectory_plot import (
    animate_trajectory as animate_trajectory,
    plot_quadric as plot_quadric,
    plot_trajectory as plot_trajectory,
)
