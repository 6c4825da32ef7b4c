"""Systems of the paper and related ones, all of them uses of the generic code.

`spheres` has SO(k) on spheres and the order conditions on S^2, `bodies` rigid bodies under torques and forces, and
`rigid_body` the exact motion of the free body and the updates of Figure 6. `sym_conjugation` and `isospectral` have the
symmetric matrices with given eigenvalues and their flows, `spins` the Landau-Lifshitz-Gilbert equation. Users,
`liehom.paper` and the examples may use them; see docs/api/instances.md.
"""

from liehom.instances.bodies import AttitudeBody as AttitudeBody
from liehom.instances.bodies import BodyState as BodyState
from liehom.instances.bodies import HeavyTop as HeavyTop
from liehom.instances.bodies import PoseState as PoseState
from liehom.instances.bodies import SE3Body as SE3Body
from liehom.instances.isospectral import double_bracket_flow as double_bracket_flow
from liehom.instances.isospectral import qr_flow as qr_flow
from liehom.instances.isospectral import qr_solution as qr_solution
from liehom.instances.isospectral import toda_flow as toda_flow
from liehom.instances.rigid_body import ClosedFormUpdate as ClosedFormUpdate
from liehom.instances.rigid_body import ExactOrbit as ExactOrbit
from liehom.instances.rigid_body import ExactOrbitUpdate as ExactOrbitUpdate
from liehom.instances.rigid_body import GeneratorTaylor as GeneratorTaylor
from liehom.instances.rigid_body import NominalTimeCorrected as NominalTimeCorrected
from liehom.instances.rigid_body import RigidBody as RigidBody
from liehom.instances.rigid_body import Update as Update
from liehom.instances.rigid_body import update_names as update_names
from liehom.instances.spheres import Sphere as Sphere
from liehom.instances.spheres import SphereFrame as SphereFrame
from liehom.instances.spins import JointSpins as JointSpins
from liehom.instances.spins import LandauLifshitz as LandauLifshitz
from liehom.instances.spins import SpinLattice as SpinLattice
from liehom.instances.spins import macrospin as macrospin
from liehom.instances.spins import switching_time as switching_time
from liehom.instances.sym_conjugation import SymmetricMatrices as SymmetricMatrices
