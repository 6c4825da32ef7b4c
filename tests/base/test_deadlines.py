"""How late `lh.limits(seconds=...)` ends 100 random computations, each in a process of its own.

    python -m tests.base.test_deadlines NUMBER [SEED]

prints what became of a computation, the seconds after its deadline, and what it was. The clock of the limit is
processor time there, so that other processes of the machine do not make it late. Odd numbers begin after small
computations of all kinds, which have imported and stored what they need.
"""

import json
import random
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

import liehom as lh
from liehom.base import budget
from liehom.testing import random_unimodular

ROOT = Path(__file__).resolve().parent.parent.parent
SEED, COUNT, MOST = 20261124, 100, 2.0
ALGEBRAS = (
    "so(6) so(7) su(4) sl(3,C) sp(6,R) e(4) e(5) galilei(4) schroedinger(4) aff(4) upper(6) strict(8) gl(5) so(4,4) "
    "g2(2) f4(4) so(9) sp(3) heisenberg(8) filiform(12) free_nilpotent(3,4) conformal(4) bargmann(4) e6(6) so*(8) "
    "su(5) A5,20 A6,18 so(5)+e(3) iso(5,1) sl(2,Q(sqrt(7)))+upper(3) form(1,2,-3,5)+galilei(3)"
)
PAIRS = (
    "so(8)/so(7) so(9)/so(8) su(4)/su(2)+su(2) gl(5)/gl(4) e6(-26)/f4 f4/so(9) so(10)/su(5) sl(4,C)/su(4) "
    "sp(4)/sp(2)+sp(2) so(7)/g2 so(16)/so(15) affine(so(6)) affine(gl(3)+sl(3)) affine(spin(9)) sl(8)/so(8) "
    "su(7)/so(7) so(4,4)/so(4,3) affine(tensor(sl(3),so(3))) affine(S2(gl(4))) affine(L3(gl(6)))"
)
SPACES = (
    "SU(3)/T^2 SU(4)/T^3 Sp(2)/T^2 G2/T^2 SO(8)/T^4 V(2,5) V(3,6) W(1,1) W(1,2) SU(5)/T^4 Fl(1,2,5) SO(7)/SO(3) "
    "Sp(3)/T^3 SU(2)^3/SU(2) su(2)^2/0 su(3)/0 G2/SU(2) F4/T^4"
)
Computation = tuple[str, Callable[[], object]]


def scrambled(name: str, rng: random.Random) -> lh.LieAlgebra:
    g = lh.catalog.algebra(name)
    return g.change_of_basis(random_unimodular(g.dimension, rng, rng.choice([0, 1, 3]) * g.dimension))


def closure(rng: random.Random) -> Computation:
    n = rng.randint(3, 7)
    sums = [
        {
            "".join(rng.choice("IIXYZ") for _ in range(n)): rng.choice([1, -1, 2, "1/64", "sqrt(2)"])
            for _ in range(rng.randint(1, 5))
        }
        for _ in range(rng.randint(2, 4))
    ]
    return f"closure of {sums}", lambda: lh.pauli.closure(sums).describe()


def identified(rng: random.Random) -> Computation:
    name = rng.choice(ALGEBRAS.split())
    return f"identify {name}", lambda: scrambled(name, rng).identify()


def described(rng: random.Random) -> Computation:
    name = rng.choice(ALGEBRAS.split())
    return f"describe {name}", lambda: scrambled(name, rng).describe()


def decided(rng: random.Random) -> Computation:
    name = rng.choice(PAIRS.split())
    return f"decide {name}", lambda: lh.decide_fullness(lh.pair(name))


def einstein(rng: random.Random) -> Computation:
    name = rng.choice(SPACES.split())
    return f"Einstein metrics of {name}", lambda: lh.pair(name).invariant_metrics().einstein()


def casimirs(rng: random.Random) -> Computation:
    name, degree = rng.choice(ALGEBRAS.split()), rng.randint(3, 8)
    return f"Casimirs of {name} to degree {degree}", lambda: scrambled(name, rng).casimirs(degree)


KINDS = (closure, identified, described, decided, einstein, casimirs)


def small() -> None:
    for name in ("so(3)", "e(3)"):
        g = lh.catalog.algebra(name)
        g.identify(), g.describe(), g.casimirs(2)
    lh.decide_fullness(lh.pair("so(4)/so(3)"))
    lh.pair("SU(3)/T^2").invariant_metrics().einstein()
    lh.pauli.closure([{"ZZ": 1}, {"XI": 1}]).describe()


def lateness(number: int, seed: int) -> tuple[str, float, str]:
    """What became of a computation, for how long it went on after its deadline, and what it was."""
    rng = random.Random(f"{seed}:{number}")
    what, compute = rng.choice(KINDS)(rng)
    seconds = rng.choice([0.02, 0.1, 0.3, 1.0, 3.0]) * rng.uniform(0.5, 1.5)
    if number == COUNT:  # 10,626 equations for 1,771 coefficients
        what, seconds, compute = "cubic Casimirs of sp(6,R)", 1.0, lambda: scrambled("sp(6,R)", rng).casimirs(3)
    if number == COUNT + 1:  # minors of the coadjoint matrix in a dense basis
        g = lh.catalog.algebra("bargmann(3)")
        g = g.change_of_basis(random_unimodular(g.dimension, random.Random(1), 3 * g.dimension))
        what, seconds, compute = "cubic Casimirs of bargmann(3)", 1.0, lambda: g.casimirs(3)
    if number == COUNT + 2:
        what, compute = "branching of C8", lambda: lh.branching_rule("C8", "sp(4)+sp(4)")([2, 1, 0, 0, 0, 0, 0, 1])
        seconds = 0.5
    if number % 2:
        small()
    budget.time = SimpleNamespace(monotonic=time.process_time)  # type: ignore[assignment]
    begin, outcome = time.process_time(), "ended"
    try:
        with lh.limits(seconds=seconds):
            compute()
    except lh.LiehomError as error:
        outcome = str(error)
    return outcome, time.process_time() - begin - seconds, what


@pytest.mark.parametrize("number", range(COUNT))
def test_a_random_computation_ends_with_its_deadline(number: int) -> None:
    ends_in_time(number)


def test_a_large_linear_system_ends_with_its_deadline() -> None:
    ends_in_time(COUNT)


@pytest.mark.parametrize("number", [COUNT + 1, COUNT + 2])
def test_minors_and_characters_end_with_their_deadline(number: int) -> None:
    ends_in_time(number)


def ends_in_time(number: int) -> None:
    command = [sys.executable, "-m", "tests.base.test_deadlines", str(number)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=True)
    outcome, late, what = json.loads(done.stdout)
    assert late < MOST, f"{what}: {outcome}"


if __name__ == "__main__":
    print(json.dumps(lateness(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else SEED)))
