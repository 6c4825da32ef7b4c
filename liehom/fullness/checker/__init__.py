"""The independent checker of certificates: arithmetic from scratch, shared with nothing of the search.

It may import only `liehom.scalars`, `liehom.errors` and the certificate. What it repeats from other wings is repeated
on purpose. See docs/theory/fullness.md.
"""

from liehom.fullness.checker.verify import verify_certificate as verify_certificate
