"""The commands `integrate` and `order`: `numerical_commands` declares their options, two modules do the work.

`run_integrate` integrates the problem of a file and prints a table with the report of the corrector; `run_order`
measures the order of convergence. docs/command-line.md describes both commands.
"""
