"""A tour of everything that touches a dependency, for an environment with the lowest versions and no test tools.

Run in a folder of its own: `python smoke.py`. Ends with status 0 and one line, or with the exception that it met.
"""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys
from fractions import Fraction

import numpy as np
import sympy

import liehom as lh


def expect(what: str, found: object, right: object) -> None:
    """End with a message where a result is not what it should be."""
    if found != right:
        sys.exit(f"{what}: {found!r}, expected {right!r}")


def command(*arguments: str, status: int = 0) -> str:
    """The standard output of a `liehom` command."""
    done = subprocess.run([sys.executable, "-m", "liehom", *arguments], capture_output=True, text=True)
    if done.returncode != status:
        sys.exit(f"liehom {' '.join(arguments)}: status {done.returncode}, expected {status}\n{done.stderr}")
    return done.stdout


for module in pkgutil.walk_packages(lh.__path__, "liehom."):
    if module.name != "liehom.__main__":
        importlib.import_module(module.name)

for name, full in [("so(4)/so(3)", True), ("so(3,1)/so(2,1)", False), ("g2/su(3)", True), ("sl(3)/P1", True)]:
    verdict = lh.decide_fullness(lh.pair(name))
    expect(name, (verdict.full, verdict.verify()), (full, True))
    expect(f"{name} as JSON", lh.from_json(lh.to_json(lh.pair(name))).dimension, lh.pair(name).dimension)

g = lh.simple("E6", "e6(-26)")
expect("Killing signature of e6(-26)", g.killing_signature(), (26, 52, 0))
expect("real form of sl(2,C)", lh.poincare(3, 1).levi_decomposition().levi.as_algebra().real_form(), "sl(2,C)")
expect("Dynkin diagram", len(lh.so(8).root_system().dynkin_diagram()), 4)
field = lh.number_field("sqrt(2)")
expect("sympy's sqrt(2)", field.convert(sympy.sqrt(2)) ** 2, 2)
rho = lh.adjoint(lh.so(3)).over(field)
expect("isotropy", rho.isotropy(["sqrt(2)", Fraction(1, 2), 0]).dimension, 1)
expect("Einstein metrics", len(lh.pair("SU(3)/T^2").invariant_metrics().einstein()), 4)
expect("cohomology", lh.heisenberg(1).cohomology(1).dimension, 2)

euler = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))
start = [0.6, 0.0, 0.8]
step = lh.Corrected(lh.Euler(), order=4)
eager = lh.integrate(euler, (0, 1), start, step=step, dt=0.05)
compiled = lh.integrate(euler, (0, 1), start, step=step, dt=0.05, engine="llvm")
expect("compiled run", bool(np.allclose(eager.y, compiled.y, rtol=0, atol=1e-13)), True)
adaptive = lh.integrate(euler, (0, 1), start, rtol=1e-8, atol=1e-8, dense_output=True)
expect("adaptive run", bool(np.allclose(adaptive.y[:, -1], eager.y[:, -1], atol=1e-5)), True)
expect(
    "minimal generator",
    lh.GeneratorField.from_vector_field(lh.adjoint(lh.so(3)), lambda m: np.cross(m, m / np.array([1.0, 2.0, 3.0])))
    .psi(np.array(start))
    .shape,
    (3,),
)

command("fullness", "so(4)/so(3)")
command("fullness", "so(3,1)/so(2,1)", "--json", status=1)
command("describe", "so(4,1)")
command("catalog", "--json")
command("fullness", "no such pair", status=2)
command("fullness", status=2)
for name in ("--help", "fullness", "integrate", "reproduce"):
    command(*([name] if name == "--help" else [name, "--help"]))
command("demo")
print("smoke test passed")
