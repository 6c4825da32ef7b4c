"""The systems of the paper and related ones, all of them uses of the generic code.

Spheres, rigid bodies, isospectral flows on symmetric matrices, Landau-Lifshitz-Gilbert spins.
"""

from liehom.flow.bodies import AttitudeBody, BodyState, HeavyTop, PoseState, SE3Body
from liehom.flow.spins import JointSpins, LandauLifshitz, SpinLattice
from liehom.studies.isospectral import SymmetricMatrices, double_bracket_flow, qr_flow, qr_solution, toda_flow
from liehom.studies.rigid_body import RigidBody
from liehom.studies.rigid_body_updates import (
    ClosedFormUpdate,
    ExactOrbit,
    ExactOrbitUpdate,
    GeneratorTaylor,
    NominalTimeCorrected,
    Update,
    update_names,
)
from liehom.studies.spheres import Sphere, SphereFrame

__all__ = [
    "AttitudeBody",
    "BodyState",
    "ClosedFormUpdate",
    "ExactOrbit",
    "ExactOrbitUpdate",
    "GeneratorTaylor",
    "HeavyTop",
    "JointSpins",
    "LandauLifshitz",
    "NominalTimeCorrected",
    "PoseState",
    "RigidBody",
    "SE3Body",
    "Sphere",
    "SphereFrame",
    "SpinLattice",
    "SymmetricMatrices",
    "Update",
    "double_bracket_flow",
    "qr_flow",
    "qr_solution",
    "toda_flow",
    "update_names",
]
