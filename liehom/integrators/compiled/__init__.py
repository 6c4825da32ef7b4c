"""Compiled runs: a step traced as a graph, then run by LLVM or JAX in place of numpy.

What the compiled code cannot do, an output time or a failure, it leaves to `liehom.integrators.run`. See
docs/tutorials/compiled.md.
"""
