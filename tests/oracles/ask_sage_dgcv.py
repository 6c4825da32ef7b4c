"""Run by make_peer_errors.py in an interpreter with SageMath (or passagemath) or dgcv; prints one JSON object.

python ask_sage_dgcv.py sage MATRICES        python ask_sage_dgcv.py dgcv ALGEBRA ...
"""

import json
import sys
from typing import Any


def sage(matrices: list[Any]) -> dict[str, Any]:
    """Centralizers, and what is accepted without proof."""
    import sage.all__sagemath_modules  # noqa: F401
    from sage.algebras.lie_algebras.lie_algebra import LieAlgebra
    from sage.matrix.constructor import matrix
    from sage.misc.banner import version
    from sage.rings.rational_field import QQ

    so3 = LieAlgebra(QQ, {("x", "y"): {"z": 1}, ("y", "z"): {"x": 1}, ("z", "x"): {"y": 1}}, names=("x", "y", "z"))
    e6 = LieAlgebra(QQ, cartan_type=["E", 6])
    wrong = {("x", "y"): {"z": 3}, ("y", "z"): {"z": 1}, ("x", "z"): {"y": -1}}
    accepted = LieAlgebra(QQ, wrong, names=("x", "y", "z"))
    module = so3.representation(dict(zip(so3.gens(), [matrix(QQ, m) for m in matrices], strict=True)))
    x, y, _ = so3.gens()
    v = next(iter(module.basis()))
    return {
        "version": version().split(",")[0],
        "Sage centralizer in so(3)": int(so3.centralizer([x]).dimension()),
        "Sage centralizer in E6": int(e6.centralizer([e6.highest_root_basis_elt()]).dimension()),
        "Sage Jacobi": f"accepted: {accepted}",
        "Sage no representation": f"accepted, with [x, y] v = {so3.bracket(x, y) * v}, x y v - y x v = "
        f"{x * (y * v) - y * (x * v)}",
    }


def dgcv(algebras: dict[str, Any]) -> dict[str, Any]:
    import dgcv as package
    import sympy

    found: dict[str, Any] = {"version": package.__version__}
    for index, (name, data) in enumerate(algebras.items()):
        n = data["dimension"]
        c = [[[sympy.Integer(0)] * n for _ in range(n)] for _ in range(n)]
        for i, j, k, v in data["structure_constants"]:
            c[i][j][k], c[j][i][k] = sympy.Rational(v), -sympy.Rational(v)
        made = package.createAlgebra(c, f"algebra{index}", base_field="real", return_created_object=True)
        found[name] = bool(made.is_simple())
    return found


if __name__ == "__main__":
    which, data = sys.argv[1], json.loads(sys.argv[2])
    print("\n@" + json.dumps(sage(data) if which == "sage" else dgcv(data)))
