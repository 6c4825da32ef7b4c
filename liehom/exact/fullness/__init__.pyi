from liehom.exact.fullness.certificate import Certificate as Certificate
from liehom.exact.fullness.checker.verify import verify_certificate as verify_certificate, verify_range as verify_range
from liehom.exact.fullness.classification import Classification as Classification
from liehom.exact.fullness.control_systems import (
    Controllability as Controllability,
    Reach as Reach,
    controllability as controllability,
)
from liehom.exact.fullness.decide import classify as classify, decide_fullness as decide_fullness
from liehom.exact.fullness.numerical import decide_numerically as decide_numerically
from liehom.exact.fullness.range_classification import (
    RangeClassification as RangeClassification,
    classify_range as classify_range,
)
from liehom.exact.fullness.verdict import (
    FailureReport as FailureReport,
    Full as Full,
    NotFull as NotFull,
    NumericallyFull as NumericallyFull,
    NumericallyNotFull as NumericallyNotFull,
    NumericallyUndecided as NumericallyUndecided,
    Verdict as Verdict,
    failure_report as failure_report,
)
