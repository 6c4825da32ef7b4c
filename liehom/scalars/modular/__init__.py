"""Linear algebra modulo a prime: ranks, growing spans, intertwining maps.

A rank modulo a prime is a lower bound for the rank over QQ, so results are either proofs or are proved again over QQ
by the caller. Closures, ideals and intertwiners of the layers above start here; see docs/theory/representations.md.
"""
