"""Compiled runs: a step traced as a graph, then run by LLVM or JAX instead of numpy.

Compiled code makes ordinary steps only, those without an output time, an end or a failure in them, and
`liehom.integrators.run` makes the others. `liehom.integrators.propagator` uses it; see docs/tutorials/compiled.md.
"""
