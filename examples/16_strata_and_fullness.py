"""On which orbits of matrices and binary forms is the isotropy full, and where does the range condition fail elsewhere?

Symmetric, Hermitian, rectangular and skew-symmetric matrices, and binary forms: one decision for each stratum, with the
cone on which (6.3) fails if there is one to describe.
"""

import liehom as lh

STUDIES = {
    "SO(k) on symmetric k x k matrices": [lh.symmetric_strata(k) for k in (2, 3, 4, 5)],
    "SU(k) on Hermitian k x k matrices": [lh.orbits.hermitian_strata(k) for k in (2, 3, 4)],
    "SO(p) x SO(q) on p x q matrices": [
        lh.rectangular_strata(p, q) for p, q in ((1, 3), (2, 2), (2, 3), (3, 3), (4, 4))
    ],
    "SO(k) on skew-symmetric k x k matrices": [lh.orbits.skew_strata(k) for k in (3, 4, 5, 6, 7)],
    "SL(2, R) on binary forms of degree n": [lh.orbits.binary_form_strata(n) for n in (2, 3, 4, 6)],
}


def where_it_fails(verdict) -> str:
    """The failure cone in a few words."""
    report = verdict.where_it_fails()
    if report.generic.holds is False:
        return "(6.3) holds for no psi"
    shown = [part.description for part in report.parts if len(part.description) < 40]
    return "(6.3) fails on " + (shown[0] if shown else "a cone")


full = []
for title, studies in STUDIES.items():
    print(title)
    for strata in studies:
        size = strata[0].representation.size
        for stratum in strata:
            if stratum.orbit_dimension < 2:
                continue
            verdict = lh.decide_fullness(stratum.representation.pair(stratum.point))
            assert verdict.verify()
            text = "full" if verdict.full else f"not full, {where_it_fails(verdict)}"
            label = ", ".join(map(str, stratum.label))
            print(
                f"  R^{size:<3} ({label})".ljust(24), f"d = {stratum.orbit_dimension:<3} {stratum.structure:<20} {text}"
            )
            if verdict.full:
                full.append((title.split()[0], size, stratum.label))

print(len(full), "strata are full")
assert len(full) == 15
