from liehom.flow.tracing.array import Traced as Traced
from liehom.flow.tracing.graph import (
    Expr as Expr,
    LaneConstant as LaneConstant,
    RunConstant as RunConstant,
    Tape as Tape,
    needed as needed,
)
from liehom.flow.tracing.loop import Sizes as Sizes, StepGraph as StepGraph, while_loop as while_loop
from liehom.flow.tracing.machine import Kernel as Kernel, lanes_per_register as lanes_per_register, padded as padded
