"""A certificate is a small JSON file that proves a verdict; anybody can check it."""

import json
import tempfile
from pathlib import Path

import liehom as lh

HERE = Path(__file__).resolve().parent
FILE = HERE / "so31_so21.json"

pair = lh.load(FILE)
verdict = lh.decide_fullness(pair)

with tempfile.TemporaryDirectory() as folder:
    out = Path(folder) / "certificate.json"
    out.write_text(json.dumps(verdict.certificate.to_json()), encoding="utf-8")
    print(out.read_text(encoding="utf-8"))
    data = json.loads(out.read_text(encoding="utf-8"))

# This one is a witness: a covector phi that vanishes on h, on eta and on [h, eta], so eta misses a direction.
assert data["kind"] == "witness"
assert lh.verify_certificate(pair, data)

# Changing one number is noticed, and the error says which check failed.
data["phi"][0] = "17"
try:
    lh.verify_certificate(pair, data)
except lh.CertificateError as error:
    print("refused:", error)
else:
    raise SystemExit("a wrong certificate was accepted")

# Nor does it prove anything about another pair.
try:
    lh.verify_certificate(lh.load(HERE / "so4_so3.json"), verdict.certificate)
except lh.CertificateError as error:
    print("refused:", error)
else:
    raise SystemExit("a certificate of another pair was accepted")
