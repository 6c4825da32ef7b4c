"""Exact answers over number fields, and quadratic forms whose null vectors are not rational."""

from pathlib import Path

import liehom as lh

HERE = Path(__file__).resolve().parent

# sqrt(2) in a file: the field QQ(sqrt(2)) is found, and everything stays exact.
pair = lh.load(HERE / "ellipsoid_sqrt2.json")
print(pair)
assert pair.field.degree == 2
assert lh.decide_fullness(pair).full

# x^2 + y^2 - sqrt(2) z^2 has the conjugate form x^2 + y^2 + sqrt(2) z^2, but signs belong to the real field.
minus = [
    [[0, -1, 0], [1, 0, 0], [0, 0, 0]],
    [[0, 0, "sqrt(2)"], [0, 0, 0], [1, 0, 0]],
    [[0, 0, 0], [0, 0, "sqrt(2)"], [0, 1, 0]],
]
verdict = lh.decide_fullness(lh.Representation.from_matrices(minus).pair([1, 0, 0]))
print(verdict)
assert not verdict.full

# x^2 + y^2 - 3 z^2 has no rational null vector at all. The pair is not full all the same: eta lies in a
# quadratic extension, and the certificate names it by its minimal polynomial.
verdict = lh.decide_fullness(lh.load(HERE / "anisotropic.json"))
print(verdict)
print("eta =", verdict.eta, "over", verdict.eta_field)
assert not verdict.full
assert verdict.eta_field.degree == 2
assert verdict.verify()
