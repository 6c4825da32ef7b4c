"""Certificates as frozen data and as JSON, and how the decision constructs them.

`certificate` and `certificate_fields` are the data and their JSON, which the checker reads. `certificate_writer` and
`witnesses` belong to the search, and the checker does not import them. docs/formats.md lists the kinds and their
fields; docs/theory/fullness.md says what each kind proves.
"""

from liehom.fullness.certificates.certificate import Certificate as Certificate
