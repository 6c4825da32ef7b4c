from liehom.flow.series.jet import Jet as Jet, as_jet as as_jet, on_series as on_series
from liehom.flow.series.lie_series import (
    Bilinear as Bilinear,
    bch as bch,
    bernoulli as bernoulli,
    cayley_magnus as cayley_magnus,
    cayley_series as cayley_series,
    commutator as commutator,
    dcayley_inverse as dcayley_inverse,
    dexp as dexp,
    dexp_inverse as dexp_inverse,
    exp_series as exp_series,
    log_series as log_series,
    magnus as magnus,
    without_constant as without_constant,
)
