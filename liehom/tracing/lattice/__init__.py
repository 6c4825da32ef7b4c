"""Tracing of lattice fields: one site of a lattice as a graph, and its compiled code for all sites.

`LatticeTraced` records psi at one site, where np.roll becomes a load at a shifted site. `LatticeKernel` is the machine
code of the stages of a step, each of them for all sites. `liehom.integrators.compiled.lattice` uses both; see
docs/api/tracing.md.
"""

from liehom.tracing.lattice.lattice_array import LatticeTraced as LatticeTraced
from liehom.tracing.lattice.lattice_array import SiteInputs as SiteInputs
from liehom.tracing.lattice.lattice_kernel import LatticeKernel as LatticeKernel
from liehom.tracing.lattice.lattice_kernel import Stage as Stage
