"""Writes the JSON files of this folder; run it to see where they come from. Seeded, so it writes them identically."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import liehom as lh
from liehom import io
from liehom.exact.algebra import linear as families
from liehom.testing import random_unimodular

HERE = Path(__file__).resolve().parent


def sphere_algebra(signs: list[Any]) -> list[list[list[Any]]]:
    """Basis of so(Q), Q = sum_i q_i x_i^2: the matrices q_i E_ji - q_j E_ij, i < j, as rows of values."""
    n = len(signs)
    matrices = []
    for i in range(n):
        for j in range(i + 1, n):
            a: list[list[Any]] = [["0"] * n for _ in range(n)]
            a[i][j], a[j][i] = f"-({signs[j]})", str(signs[i])
            matrices.append(a)
    return matrices


def representation(matrices: Any, point: list[Any] | None = None, **options: Any) -> dict[str, Any]:
    """A representation file from integer or text matrices."""
    rows = matrices.tolist() if hasattr(matrices, "tolist") else matrices
    data: dict[str, Any] = {"format": "liehom-representation", "version": 1}
    data["matrices"] = [[[str(x) for x in row] for row in a] for a in rows]
    if point is not None:
        data["point"] = [str(x) for x in point]
    return data | options


def affine_pair(matrices: list[list[list[Any]]]) -> lh.Pair:
    """h x| V over V: the Lie algebra of the affine matrices (A, v; 0, 0), with h those without translation."""
    n = len(matrices[0])
    affine = [[[*row, "0"] for row in a] + [["0"] * (n + 1)] for a in matrices]
    for i in range(n):
        shift = [["0"] * (n + 1) for _ in range(n + 1)]
        shift[i][n] = "1"
        affine.append(shift)
    algebra = lh.LieAlgebra.from_matrices(affine)
    size = algebra.dimension
    return lh.Pair(algebra, [[int(i == j) for j in range(size)] for i in range(len(matrices))])


def scrambled(pair: lh.Pair, seed: int) -> lh.Pair:
    """The pair in a random unimodular basis."""
    return pair.change_of_basis(random_unimodular(pair.algebra.dimension, random.Random(seed)))


def files() -> dict[str, Any]:
    """File name -> JSON object."""
    so4 = lh.Representation.from_matrices(families.so(4)).pair([0, 0, 0, 1])
    so5 = lh.Representation.from_matrices(families.so(5)).pair([0, 0, 0, 0, 1])
    sl3 = lh.Representation.from_matrices(families.sl(3))
    line = lh.Pair(sl3.algebra, families.stabilizer_rows(families.sl(3), [1, 0, 0], up_to_scale=True).tolist())
    minkowski = lh.Representation.from_matrices(families.so(3, 1)).pair([0, 0, 1, 0])
    numerical = io.to_json(so4)
    numerical["arithmetic"] = "float64"
    numerical["structure_constants"] = [[i, j, k, float(v)] for i, j, k, v in numerical["structure_constants"]]
    numerical["subalgebra"] = [[float(x) for x in row] for row in numerical["subalgebra"]]
    return {
        "so4_so3": io.to_json(so4),
        "so4_so3_float": numerical,
        "so5_so4_scrambled": io.to_json(scrambled(so5, seed=5)),
        "g2_su3": representation(families.g2(), [1, 0, 0, 0, 0, 0, 0]),
        "sl3_P1": io.to_json(line),
        "so31_so21": io.to_json(minkowski),
        "sym3": representation(families.congruence(families.so(3)), [1, 0, 0, 1, 0, 2]),
        "ellipsoid_sqrt2": representation(sphere_algebra(["1", "1", "sqrt(2)"]), [1, 0, 0]),
        "anisotropic": io.to_json(affine_pair(sphere_algebra([1, 1, -3]))),
        "rigid_body": representation(
            families.so(3),
            ["3/5", "0", "4/5"],
            # omega = -(m0, m1/2, m2/3) in the basis of rotations about z, -y, x
            generator=["-m2/3", "m1/2", "-m0"],
            t_span=[0, 10],
            dt=0.1,
        ),
        **problems(),
    }


def problems() -> dict[str, Any]:
    """Files for `liehom integrate` and `liehom order`, besides the rigid body."""
    rotations, conjugation = families.so(3), families.congruence(families.so(3))
    flow = {"generator": ["1 + m1", "m0 - m2/2", "m4 + m5/3"], "t_span": [0, 2], "base": "euler", "order": 4}
    return {
        # symmetric matrices with eigenvalues 1, 1, 2: the isotropy is full; with 1, 2, 3 there is none
        "sym3_flow": representation(conjugation, [1, 0, 0, 1, 0, 2], **flow, dt=0.05),
        "sym3_generic": representation(conjugation, [1, 0, 0, 2, 0, 3], **flow, dt=0.05),
        # m' = m x H - a m x (m x H), H along the last axis, a = 1/5: a damped spin, by its vector field
        "vector_field": representation(
            rotations,
            ["3/5", "0", "-4/5"],
            vector_field=["m1 - m0*m2/5", "-m0 - m1*m2/5", "(m0**2 + m1**2)/5"],
            t_span=[0, 20],
            rtol=1e-8,
        ),
        "driven_spin": representation(
            rotations,
            ["0", "0", "1"],
            generator=["1", "cos(2*t)/2", "sin(2*t)/2"],
            t_span=[0, 6],
            t_eval=[0, 1, 2, 3, 4, 5, 6],
            base="heun",
            order=4,
            dt=0.05,
        ),
    }


def main() -> None:
    """Write all files."""
    for name, data in files().items():
        io.dump(data, HERE / f"{name}.json")
        print(f"{name}.json")


if __name__ == "__main__":
    main()
