"""Recording a computation as a graph of scalar operations, and compiling the graph.

A *tracer* (`Expr`) is a number, or a boolean, whose value is known only when the compiled code runs.  `Traced` is an
array of tracers, on which numpy code runs; a `Tape` records the operations.  A *lane* is one trajectory of an ensemble,
and a *mask* a boolean in each lane; a lane that has nothing left to do is masked out, so it keeps its values.  An
*ordinary step* has no output time, no end of the time span and no failure in it: the loops of JAX make ordinary steps
only, those of LLVM all steps that do not fail.  Users reach this folder through the option ``engine`` of
`liehom.integrate`; see docs/api/tracing.md.
"""

from liehom.tracing.array import Traced as Traced
from liehom.tracing.expr import Expr as Expr
from liehom.tracing.expr import LaneConstant as LaneConstant
from liehom.tracing.expr import RunConstant as RunConstant
from liehom.tracing.graph import Tape as Tape
from liehom.tracing.graph import needed as needed
from liehom.tracing.loop import while_loop as while_loop
from liehom.tracing.machine_code.kernel import Kernel as Kernel
from liehom.tracing.machine_code.kernel import padded as padded
from liehom.tracing.machine_code.machine import lanes_per_register as lanes_per_register
from liehom.tracing.step_graph import Sizes as Sizes
from liehom.tracing.step_graph import StepGraph as StepGraph
