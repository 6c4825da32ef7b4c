"""Certificates as frozen data and as JSON, and how the decision writes them.

`certificate` is read by the checker; `certificate_writer` and `witnesses` belong to the search. The kinds and their
fields are in docs/formats.md.
"""

from liehom.fullness.certificates.certificate import Certificate as Certificate
