from liehom.flow.tracing.array import Traced as Traced
from liehom.flow.tracing.graph import (
    Expr as Expr,
    Tape as Tape,
    needed as needed,
)
from liehom.flow.tracing.loop import while_loop as while_loop
from liehom.flow.tracing.machine import Kernel as Kernel
