"""Fullness (6.4): the decision with its certificates, and the independent checker."""

from liehom.fullness.certificates import Certificate as Certificate
from liehom.fullness.checker import verify_certificate as verify_certificate
from liehom.fullness.decide import decide_fullness as decide_fullness
from liehom.fullness.failure import FailureReport as FailureReport
from liehom.fullness.failure import failure_report as failure_report
from liehom.fullness.numerical import decide_numerically as decide_numerically
from liehom.fullness.verdict import Full as Full
from liehom.fullness.verdict import NotFull as NotFull
from liehom.fullness.verdict import NumericallyFull as NumericallyFull
from liehom.fullness.verdict import NumericallyNotFull as NumericallyNotFull
from liehom.fullness.verdict import Verdict as Verdict
