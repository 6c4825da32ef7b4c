"""Ctrl-C ends every long operation within a second, with exit code 130 on the command line."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
WITHIN = 1.0
"""Seconds of the processor between the signal and the end; a loaded machine takes longer by the clock."""
PATIENCE = 30.0

BEGIN = """
import random, sys
import liehom as lh
from liehom.cli.guard import guarded
from liehom.exact.scalars import QQ

def dense(n, seed, size=3):
    rng = random.Random(seed)
    return [[rng.randrange(-size, size + 1) for _ in range(n)] for _ in range(n)]

def again(action):
    while True:
        action()

pair = lh.pair("so(12)/so(11)")
verdict = lh.decide_fullness(pair)
body = lh.RigidBody((1, 2, 4)).field()
step = lh.Corrected(lh.Euler(), order=6)
e6 = lh.simple("E6")
print("ready", flush=True)
"""
OPERATIONS = {
    "decide": 'again(lambda: lh.decide_fullness(lh.pair("so(20)/so(19)")))',
    "describe": 'again(lambda: lh.catalog.algebra("so(16)").describe())',
    "closure": "again(lambda: lh.LieAlgebra.from_matrices([dense(9, 1), dense(9, 2)]))",
    "root system": 'again(lambda: lh.simple("E6").root_system())',
    "root system by name": 'lh.root_system("A150").positive_roots',
    "Jacobi": "again(lambda: lh.LieAlgebra(e6.table))",
    "integrate": "lh.integrate(body, (0, 10**7), [0.6, 0, 0.8], dt=0.01)",
    "integrate corrected": "lh.integrate(body, (0, 10**7), [0.6, 0, 0.8], dt=0.01, step=step)",
    "verify": "again(lambda: lh.verify_certificate(pair, verdict.certificate))",
    "atlas": 'again(lambda: lh.atlas.sweep([f"so({n})/so({n - 1})" for n in range(10, 30)]))',
    "constructor": "again(lambda: lh.so(40))",
    "module": 'again(lambda: lh.highest_weight_module("F4", (0, 0, 0, 1)))',
    "characteristic polynomial": "again(lambda: QQ.matrix(dense(150, 3, 10**30)).characteristic_coefficients())",
    "free nilpotent": "again(lambda: lh.algebra.free_nilpotent(2, 9))",
}


def processor_time(process: int) -> float:
    """Seconds of the processor that a process has used."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="the time of a process is read from /proc")
@pytest.mark.parametrize("name", OPERATIONS)
def test_an_interrupt_ends_a_long_operation(name: str) -> None:
    script = f"{BEGIN}\ndef action():\n    {OPERATIONS[name]}\n    return 0\nsys.exit(guarded(action))\n"
    with subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            time.sleep(0.8)
            before, end = processor_time(process.pid), time.monotonic() + PATIENCE
            process.send_signal(signal.SIGINT)
            used = before
            while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                assert time.monotonic() < end, "the signal has no effect"
                used = processor_time(process.pid)
                time.sleep(0.01)
            out, err = process.communicate()
        finally:
            process.kill()
    assert (process.returncode, out, err) == (130, "", "liehom: interrupted\n")
    assert used - before < WITHIN
