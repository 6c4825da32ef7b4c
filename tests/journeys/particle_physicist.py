"""Three jobs of a particle physicist: `python tests/journeys/particle_physicist.py`."""

from fractions import Fraction

import liehom as lh
from liehom import representations as reps


def pati_salam() -> tuple[str, str, Fraction]:
    """The 16 of SO(10) under Pati and Salam's group and under the Standard Model with B - L, and the anomaly of X."""
    above = lh.branching_rule("so(10)", "su(4)+su(2)+su(2)")
    flipped = lh.branching_rule("so(10)", "su(5)+u(1)")
    anomaly = sum(t.multiplicity * t.dimension * Fraction(t.charges[0]) ** 3 for t in flipped("16").terms)
    return str(above("16")), str(flipped("16")), Fraction(anomaly)


def running() -> list[Fraction]:
    """One-loop coefficients 11/3 C - 2/3 T(Weyl) - 1/3 T(complex scalars) of SU(3) and SU(2), from 5bar + 10."""
    rule = lh.branching_rule("su(5)", "su(3)+su(2)+u(1)", charges="-1/6")
    higgs = (1, 2)
    b = []
    for factor, (kind, rank) in enumerate((("A2", 2), ("A1", 1))):
        index = Fraction(0)
        for name in ("5bar", "10"):
            for term in rule(name).terms:
                own = term.highest_weights[factor]
                dimension = lh.weyl_dimension(kind, own)
                index += (
                    Fraction(reps.dynkin_index(kind, own), 2) * term.multiplicity * Fraction(term.dimension, dimension)
                )
        scalars = Fraction(1, 2) if higgs[factor] > 1 else Fraction(0)
        b.append(Fraction(11, 3) * (rank + 1) - Fraction(2, 3) * 3 * index - Fraction(1, 3) * scalars)
    return b


def yukawas() -> tuple[int, int, list[str]]:
    """Invariants in 27^3 of E6 and in 16 16 10 of SO(10), and the modules in the square of the 16."""
    cubic = reps.symmetric_power_decomposition("E6", [1, 0, 0, 0, 0, 0], 3).get((0,) * 6, 0)
    square = reps.tensor_product_decomposition("D5", [0, 0, 0, 0, 1], [0, 0, 0, 0, 1])
    ten = square.get((1, 0, 0, 0, 0), 0)
    return cubic, ten, [str(lh.weyl_dimension("D5", weight)) for weight in square]


JOBS = (pati_salam, running, yukawas)

if __name__ == "__main__":
    for job in JOBS:
        print(f"{job.__name__}: {job()}")
