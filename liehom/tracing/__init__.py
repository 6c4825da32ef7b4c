"""Recording a computation as a graph of scalar operations, and machine code made of the graph."""

from liehom.tracing.array import Traced as Traced
from liehom.tracing.expr import Expr as Expr
from liehom.tracing.graph import Tape as Tape
from liehom.tracing.graph import needed as needed
from liehom.tracing.kernel import Kernel as Kernel
from liehom.tracing.kernel import Sizes as Sizes
from liehom.tracing.kernel import StepGraph as StepGraph
from liehom.tracing.kernel import padded as padded
from liehom.tracing.loop import while_loop as while_loop
