"""The steps of the decision that find a witness, a form or a cut for the isotropy representation.

Each file is one source of certificates; `liehom.fullness.decide` calls them in order. See docs/theory/fullness.md.
"""
