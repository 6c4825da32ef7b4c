"""The independent checker of certificates, with its own arithmetic: it shares no code with the search.

It imports only `liehom.scalars`, `liehom.errors` and the certificate, and it repeats on purpose what other wings have
too. Call `verify_certificate`; the other functions are for the checker alone. docs/theory/fullness.md says what each
kind of certificate proves.
"""

from liehom.fullness.checker.verify import verify_certificate as verify_certificate
