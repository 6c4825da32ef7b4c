"""Weights, characters and irreducible modules by their highest weight, real modules of real forms, spinors.

Weights are in fundamental coordinates; see docs/theory/representations.md.
"""
