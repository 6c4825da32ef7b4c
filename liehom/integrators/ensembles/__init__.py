"""Ensembles in chunks on any executor, stored in order of completion and merged into one Solution.

Users call `liehom.integrate_ensemble`; see docs/distributed.md.
"""

from liehom.integrators.ensembles.ensemble import EnsemblePart as EnsemblePart
from liehom.integrators.ensembles.ensemble import ensemble_parts as ensemble_parts
from liehom.integrators.ensembles.ensemble import integrate_ensemble as integrate_ensemble
from liehom.integrators.ensembles.ensemble import stored_parts as stored_parts
