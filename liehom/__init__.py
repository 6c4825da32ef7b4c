"""liehom: Lie algebras and isotropy analysis, exact where the input is exact.

The library has two halves, `exact` and `flow`, above one base. Each package imports only those listed before it:

`base`      errors, types, limits, files that are written whole, tasks on executors.
`exact`     scalars, Lie algebras, representations, orbits, invariant geometry, full pairs, qubits, names; no engine.
`flow`      actions, Taylor series, steps, runs and engines: trajectories on orbits. `flow.door` leads to `exact`.
`plotting`  pictures.
`studies`   the systems and figures of the paper, the atlas of pairs.
`io`        files, other programs, LaTeX and HTML of every object, pages for the browser.
`testing`   the public conformance suite.
`cli`       the command line.

Names load when they are first used; `__init__.pyi` lists those of this level.
"""

import logging

from liehom.base.lazy import lazy, place_of
from liehom.base.objects import providers

__getattr__, __dir__ = lazy(__name__, place_of)

# the library logs under its name, at level DEBUG, and prints nothing by itself
logging.getLogger("liehom").addHandler(logging.NullHandler())

providers["latex"] = "liehom.io.renderings", "latex"
providers["html"] = "liehom.io.renderings", "html"
providers["step by name"] = "liehom.flow.methods.named", "step_named"
providers["work precision"] = "liehom.plotting.error_plot", "plot_work_precision"

__version__ = "0.2.0"
