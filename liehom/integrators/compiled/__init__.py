"""Compiled runs: a step traced as a graph, then run by LLVM or JAX instead of numpy.

Machine code makes all steps, the first, the last and those at output times included; JAX on numpy arrays makes ordinary
steps only. `liehom.integrators.run` makes the others, and those that fail. `liehom.integrators.propagator` uses this
wing; see docs/tutorials/compiled.md.
"""
