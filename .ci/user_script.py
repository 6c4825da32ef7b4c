"""A user's script, read by type checkers only: `mypy --strict .ci/user_script.py`, `pyright .ci/user_script.py`.

Each `assert_type` says what an editor shows of a result.
"""

from __future__ import annotations

from typing import Any, assert_type

import numpy as np
import numpy.typing as npt

import liehom as lh
from liehom.base.typing import Array
from liehom.exact.scalars import ExactMatrix, Matrix
from liehom.flow.run import DenseSolution
from liehom.studies.atlas import Atlas

g = lh.so(3)
assert_type(g.bracket([1, 0, 0], [0, 1, 0]), npt.NDArray[Any])
assert_type(g.killing_form(), Matrix)
assert_type(g.center(), lh.Subalgebra)
assert_type(g.root_system(), lh.algebra.RootSystem)
assert_type(lh.adjoint(g).isotropy([1, 0, 0]), lh.Subalgebra)
assert_type(lh.QQ.matrix([[1, 2]]), ExactMatrix)
assert_type(lh.decide_fullness(lh.pair("so(4)/so(3)")).certificate, lh.Certificate | None)

assert_type(lh.atlas.sweep(["so(4)/so(3)"]), Atlas)

field = lh.GeneratorField(lh.adjoint(g), lambda m: -m / np.array([1.0, 2.0, 3.0]))
sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=lh.Corrected(lh.Euler(), order=4), dt=0.1)
assert_type(sol.t, Array)
assert_type(sol.y, Array)
assert_type(sol.success, bool)
assert_type(sol.sol, DenseSolution | None)
