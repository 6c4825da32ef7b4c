"""The independent checker of certificates: elementary linear algebra from scratch.

It imports scalars and the bracket table, and nothing of the search; see docs/theory/fullness.md.
"""
