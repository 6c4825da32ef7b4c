"""A computation as a graph of scalar operations, and compiled code made from it.

A *tracer* is a symbolic number on a tape. numpy code that runs on arrays of tracers is recorded. The graph is evaluated
on arrays, differentiated in reverse mode, compiled by LLVM, or turned into a JAX function. A *lane* is one trajectory
of a compiled step; a lane is masked out where another one is still at work. An *ordinary step* has no output time, end
or failure in it. See docs/api/tracing.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
