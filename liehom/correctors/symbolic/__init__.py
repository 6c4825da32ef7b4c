"""Isotropy corrections at symbolic and exact points: closed forms, order conditions, proofs.

`closed_form` returns formulas and compiled functions, `order_condition` decides (5.3)-(5.5) at a point. See
docs/theory/correctors.md.
"""

from liehom.correctors.symbolic.closed_form import ClosedForm as ClosedForm
from liehom.correctors.symbolic.closed_form import closed_form as closed_form
from liehom.correctors.symbolic.order_condition import OrderCondition as OrderCondition
from liehom.correctors.symbolic.order_condition import chi as chi
from liehom.correctors.symbolic.order_condition import order_condition as order_condition
