"""A graph as machine code by LLVM: the text of its operations, of the loop over the steps of a run, and what runs it.

`liehom.tracing` hands on `Kernel`; the lattices of `liehom.tracing.lattice` write loops of their own around a `Body`.
"""
