"""Symplectic and variational steps for Lie-Poisson systems: each step is a Poisson map of the dual of a Lie algebra.

`SphericalMidpoint` is for products of spheres, `MoserVeselov` for free rigid bodies of any dimension,
`IsospectralMidpoint` for quadratic matrix Lie algebras, `VariationalMidpoint` for every Lie algebra, `Splitting` for
sums of Hamiltonians with known flows, and `Composition` raises their order. They lie above `methods`, whose protocol
they share. `liehom.hamiltonian_field` makes their fields; see docs/lie-poisson.md.
"""

from liehom.integrators.symplectic.composition import Composition as Composition
from liehom.integrators.symplectic.isospectral_midpoint import IsospectralMidpoint as IsospectralMidpoint
from liehom.integrators.symplectic.moser_veselov import MoserVeselov as MoserVeselov
from liehom.integrators.symplectic.spherical_midpoint import SphericalMidpoint as SphericalMidpoint
from liehom.integrators.symplectic.splitting import Splitting as Splitting
from liehom.integrators.symplectic.variational_midpoint import VariationalMidpoint as VariationalMidpoint
