"""Steps for stiff fields: implicit Runge-Kutta methods with estimates of the error, Rosenbrock and exponential steps.

All of them integrate u' = dexp^-1_u psi(Exp(u) m, t), u(0) = 0 in the algebra, as `liehom.integrators.methods` does.
The equations of the implicit ones are solved in `liehom.correctors.implicit`. See docs/stiff.md.
"""

from liehom.integrators.implicit.exponential_rosenbrock import ExponentialRosenbrock as ExponentialRosenbrock
from liehom.integrators.implicit.rosenbrock import Rosenbrock as Rosenbrock
from liehom.integrators.implicit.stability import amplification as amplification
from liehom.integrators.implicit.stability import stability_limit as stability_limit
from liehom.integrators.implicit.stiff_rkmk import StiffRKMK as StiffRKMK
