"""The free rigid body: its exact motion, the updates of Figure 6 by the corrector and in closed form, the attitude.

Users start from `RigidBody`, whose methods return the other objects. See docs/reproduction.md for its use in the paper.
"""

from liehom.instances.rigid_body.closed_forms import ClosedFormUpdate as ClosedFormUpdate
from liehom.instances.rigid_body.exact_orbit import ExactOrbit as ExactOrbit
from liehom.instances.rigid_body.exact_orbit import ExactOrbitUpdate as ExactOrbitUpdate
from liehom.instances.rigid_body.nominal_time_corrected import GeneratorTaylor as GeneratorTaylor
from liehom.instances.rigid_body.nominal_time_corrected import NominalTimeCorrected as NominalTimeCorrected
from liehom.instances.rigid_body.rigid_body import RigidBody as RigidBody
from liehom.instances.rigid_body.updates import Update as Update
from liehom.instances.rigid_body.updates import update_names as update_names
