"""Is this pair full, and why?  Files in, verdicts with proofs out."""

from pathlib import Path

import liehom as lh

HERE = Path(__file__).resolve().parent

# A file holds structure constants and the rows of h, or matrices and a point.
pair = lh.load(HERE / "g2_su3.json")
print(pair)  # <pair of dimensions 14/8 over QQ>

# h is full in g if [h, eta] + R eta + h = g for EVERY eta outside h.
verdict = lh.decide_fullness(pair)
print(verdict)
assert verdict.full
assert "su(3)" in verdict.reason

# The verdict carries a certificate; the checker shares no code with the search that found it.
assert verdict.verify()

# De Sitter space is not full: there is an eta, on the null cone, where the rank drops from 3 to 2.
verdict = lh.decide_fullness(lh.load(HERE / "so31_so21.json"))
print(verdict)
print("eta =", verdict.eta)
assert not verdict.full
assert (verdict.rank, verdict.rank_defect) == (2, 1)

# A change of basis changes every number of the file, and not the verdict.
verdict = lh.decide_fullness(lh.load(HERE / "so5_so4_scrambled.json"))
print(verdict)
assert verdict.full

# Floats give a numerical answer, labelled so, with the gap it rests on; it has no truth value.
verdict = lh.decide_fullness(lh.load(HERE / "so4_so3_float.json"))
print(repr(verdict))
assert verdict.full
assert verdict.certificate is None
