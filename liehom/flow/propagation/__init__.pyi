from liehom.flow.propagation.ensemble import (
    EnsemblePart as EnsemblePart,
    ensemble_parts as ensemble_parts,
    integrate_ensemble as integrate_ensemble,
    stored_parts as stored_parts,
)
from liehom.flow.propagation.integration import integrate as integrate
from liehom.flow.propagation.propagator import Inspection as Inspection, Propagator as Propagator
