"""Truncated Taylor series on which numpy code runs, and series in Lie algebras.

In reading order:

- `arrays`: which kind of numbers an array holds;
- `node`, `recurrences`: coefficients on demand, and their formulas;
- `jet`, `jet_views`: the class `Jet`, and assignment into Jets;
- `assembly`, `jet_ufuncs`, `jet_functions`: numpy's functions on Jets, which `jet_dispatch` hands to the class;
- `bilinear`, `lie_series`: brackets and actions, Magnus and Baker-Campbell-Hausdorff series.
"""

import liehom.series.jet_functions  # noqa: F401 (enters itself in `jet_dispatch`)
from liehom.series.assembly import as_jet as as_jet
from liehom.series.assembly import on_series as on_series
from liehom.series.bilinear import Bilinear as Bilinear
from liehom.series.jet import Jet as Jet
from liehom.series.lie_series import bch as bch
from liehom.series.lie_series import bernoulli as bernoulli
from liehom.series.lie_series import cayley_magnus as cayley_magnus
from liehom.series.lie_series import cayley_series as cayley_series
from liehom.series.lie_series import commutator as commutator
from liehom.series.lie_series import dcayley_inverse as dcayley_inverse
from liehom.series.lie_series import dexp as dexp
from liehom.series.lie_series import dexp_inverse as dexp_inverse
from liehom.series.lie_series import exp_series as exp_series
from liehom.series.lie_series import log_series as log_series
from liehom.series.lie_series import magnus as magnus
from liehom.series.lie_series import without_constant as without_constant
