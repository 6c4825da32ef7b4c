"""The classification of full pairs: the key of a pair by linear algebra, and the table of rows that it points to.

`rows` is the table, `effective` finds the largest ideal of g inside h, `key` computes the key, `classification` holds
the result, and `verify` checks a key with linear algebra of its own. Names of rows are strings here, which
`catalog` above reads. `reasons` uses `rows` and `key` for the sentence of a verdict; all others use `liehom.classify`.
The theorem and its proof are in docs/theory/classification.md.
"""

from liehom.fullness.classification.classification import Classification as Classification
from liehom.fullness.classification.rows import Key as Key
from liehom.fullness.classification.rows import Row as Row
from liehom.fullness.classification.rows import rows as rows
