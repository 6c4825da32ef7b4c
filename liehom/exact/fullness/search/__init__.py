"""Sources of certificates: invariant forms, ideals and commutants, eigenvectors, dominant weights.

Floats and primes propose here; what is returned is proved by the checker. See docs/theory/fullness.md.
"""
