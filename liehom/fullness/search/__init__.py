"""Steps of the decision: each module finds a witness, a form or a cut for the isotropy representation.

Only `liehom.fullness.decide` calls them, in order. The independent checker shares no code with them.
The order and the mathematics are in docs/theory/fullness.md.
"""
