"""Rational functions on a variety, as a field with exact arithmetic.

`coordinate_ring` has the polynomials, with normal forms modulo the equations of the variety, and `function_field` the
fractions. The symbolic correctors compute over these fields; see docs/theory/correctors.md.
"""
