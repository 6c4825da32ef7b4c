"""Fullness, (6.4) of the paper: the decision, its certificates, and the independent checker of certificates.

`decide` runs the steps of `search` and returns a `verdict`; every exact verdict carries a certificate, and `checker`
verifies certificates without the code of the search. `failure` describes where the range condition fails for a pair
that is not full, and `numerical` answers for pairs over float64. `classifier` finds the row of a full pair in the
table of `classification`. Everyone may use the names below; the wings are internal. The theory is in
docs/theory/fullness.md and docs/theory/classification.md.
"""

from liehom.fullness.certificates import Certificate as Certificate
from liehom.fullness.checker import verify_certificate as verify_certificate
from liehom.fullness.classification import Classification as Classification
from liehom.fullness.classifier import classify as classify
from liehom.fullness.decide import decide_fullness as decide_fullness
from liehom.fullness.failure import FailureReport as FailureReport
from liehom.fullness.failure import failure_report as failure_report
from liehom.fullness.numerical import decide_numerically as decide_numerically
from liehom.fullness.verdict import Full as Full
from liehom.fullness.verdict import NotFull as NotFull
from liehom.fullness.verdict import NumericallyFull as NumericallyFull
from liehom.fullness.verdict import NumericallyNotFull as NumericallyNotFull
from liehom.fullness.verdict import NumericallyUndecided as NumericallyUndecided
from liehom.fullness.verdict import Verdict as Verdict
