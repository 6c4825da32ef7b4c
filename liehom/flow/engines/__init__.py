"""What takes the steps of a checked problem: numpy, machine code by LLVM, JAX.

`engine` says what an engine is; see docs/tutorials/compiled.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
