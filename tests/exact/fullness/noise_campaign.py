"""Catalogue pairs with noise: numerical verdicts compared with proved ones, in three kinds of bases.

    python -m tests.exact.fullness.noise_campaign [NOISE [RTOL [STEP]]]

perturbs every STEP-th pair with dim g <= 16 by noise (default 1e-6) and decides it with the tolerance declared (default
1e-4). It prints each answer that is wrong or undecided, and a table of counts. Pairs are the same in every run.
"""

import sys
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from tests.exact.catalog.claims import CLAIMS
from tests.floats import constants_of, pair_of, rotated, rotation

NAMES = [name for name, claim in CLAIMS.items() if claim.algebra_dimension <= 16]
KINDS = ("given", "rotated", "random")


def in_basis(constants: Any, rows: Any, basis: Any) -> tuple[Any, Any]:
    """Structure constants and subalgebra in the basis given by the rows of a matrix (n, n)."""
    inverse = np.linalg.inv(basis)
    turned = np.einsum("ai,bj,ijk,kc->abc", basis, basis, constants, inverse, optimize=True)
    return (turned - turned.transpose(1, 0, 2)) / 2, rows @ inverse


def noisy(constants: Any, rows: Any, size: float, rng: np.random.Generator) -> tuple[Any, Any]:
    """Antisymmetric noise in the table, and noise in the rows, of a size relative to their Frobenius norms."""
    noise = rng.standard_normal(constants.shape)
    noise -= noise.transpose(1, 0, 2)
    constants = constants + noise * (size * np.linalg.norm(constants) / (np.linalg.norm(noise) or 1))
    other = rng.standard_normal(rows.shape)
    return constants, rows + other * (size * np.linalg.norm(rows) / (np.linalg.norm(other) or 1))


def data(name: str, kind: str, size: float, scale: float = 1.0) -> tuple[Any, Any]:
    """A catalogue pair in a kind of basis, perturbed."""
    constants, rows = constants_of(lh.pair(name))
    n = len(constants)
    rng = np.random.default_rng([NAMES.index(name), KINDS.index(kind)])
    if kind == "rotated":
        constants, rows = rotated(constants, rows, rotation(n, rng))
    if kind == "random":
        constants, rows = in_basis(constants, rows, rng.standard_normal((n, n)))
    return noisy(constants * scale, rows, size, rng)


def answers(names: Sequence[str], kind: str, size: float, rtol: float) -> Counter[tuple[bool, Any]]:
    """Counts of (claimed answer, numerical answer); undecided are the pairs that are refused, too."""
    counts: Counter[tuple[bool, Any]] = Counter()
    for name in names:
        try:
            verdict: Any = lh.decide_fullness(pair_of(*data(name, kind, size), lh.FloatField(rtol)))
            full = verdict.full
        except (InputError, UndecidedError) as error:
            verdict, full = error, None
        counts[CLAIMS[name].full, full] += 1
        if full is not CLAIMS[name].full:
            print(f"{name}, {kind} basis, claimed {CLAIMS[name].full}: {verdict}")
    return counts


def wrong(counts: Counter[tuple[bool, Any]]) -> int:
    """Number of answers that contradict the claims."""
    return sum(n for (claim, full), n in counts.items() if full is not None and full is not claim)


if __name__ == "__main__":
    noise, rtol, step = [float(x) for x in [*sys.argv[1:], "1e-6", "1e-4", "1"][:3]]
    for kind in KINDS:
        table = answers(NAMES[:: int(step)], kind, noise, rtol)
        print(kind, dict(sorted(table.items(), key=str)), "wrong:", wrong(table))
