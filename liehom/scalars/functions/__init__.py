"""Rational functions on a variety, as a field with exact arithmetic.

The symbolic correctors and the isotropy at points with free symbols compute over these fields. See
docs/theory/correctors.md.
"""
