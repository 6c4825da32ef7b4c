"""Landau-Lifshitz-Gilbert spins: one spin in closed form, lattices of spins, and all spins of a lattice as one point.

Users start from `liehom.LandauLifshitz`; see docs/api/instances.md.
"""

from liehom.instances.spins.joint_spins import JointSpins as JointSpins
from liehom.instances.spins.landau_lifshitz import LandauLifshitz as LandauLifshitz
from liehom.instances.spins.macrospin import macrospin as macrospin
from liehom.instances.spins.macrospin import switching_time as switching_time
from liehom.instances.spins.spin_lattice import SpinLattice as SpinLattice
