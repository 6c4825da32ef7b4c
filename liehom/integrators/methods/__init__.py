"""Steps of Lie group methods: Euler, Heun, Taylor, Lie-Taylor, RKMK, Crouch-Grossman, commutator-free.

Each method is a `Step` of `liehom.correctors`. `step_named` finds methods by name, for files and the command line.
docs/extending.md explains how to write a custom one.
"""

from liehom.integrators.methods.products import CommutatorFree4 as CommutatorFree4
from liehom.integrators.methods.products import CrouchGrossman3 as CrouchGrossman3
from liehom.integrators.methods.products import ProductStep as ProductStep
from liehom.integrators.methods.products import Scheme as Scheme
from liehom.integrators.methods.rkmk import RKMK as RKMK
from liehom.integrators.methods.rkmk import EmbeddedStep as EmbeddedStep
from liehom.integrators.methods.steps import BackwardEuler as BackwardEuler
from liehom.integrators.methods.steps import Euler as Euler
from liehom.integrators.methods.steps import Heun as Heun
from liehom.integrators.methods.steps import LieTaylor as LieTaylor
from liehom.integrators.methods.taylor import Taylor as Taylor
