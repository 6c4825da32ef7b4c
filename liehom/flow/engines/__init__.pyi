from liehom.flow.engines.engine import Engine as Engine, Problem as Problem
from liehom.flow.engines.sensitivity import Gradient as Gradient, Sensitivity as Sensitivity
