"""Linear algebra modulo a prime: ranks, growing spans, intertwining maps.

A rank modulo a prime is a lower bound for the rank over QQ. A result is therefore a proof, or the caller proves it over
QQ. Closures, ideals and intertwiners in the layers above use this wing; see docs/theory/representations.md.
"""
