"""A user's script, read by type checkers only: `mypy --strict .ci/user_script.py`, `pyright .ci/user_script.py`.

Each `assert_type` says what an editor shows of a result.
"""

from __future__ import annotations

import numpy as np

import liehom as lh

g = lh.so(3)
reveal_type(g.bracket([1, 0, 0], [0, 1, 0]))
reveal_type(g.killing_form())
reveal_type(g.levi_decomposition())
reveal_type(g.root_system())
reveal_type(lh.decide_fullness(lh.pair("so(4)/so(3)")).certificate)
field = lh.GeneratorField(lh.adjoint(g), lambda m: -m / np.array([1.0, 2.0, 3.0]))
sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=lh.Corrected(lh.Euler(), order=4), dt=0.1, dense_output=True)
reveal_type(sol.t)
reveal_type(sol.y)
reveal_type(sol.sol)
reveal_type(lh.adjoint(g).isotropy([1, 0, 0]))
reveal_type(lh.atlas.sweep(["so(4)/so(3)"]))
reveal_type(lh.QQ.matrix([[1, 2]]))
