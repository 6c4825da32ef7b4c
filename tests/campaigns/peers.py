"""What other libraries do with the same malformed input, found by running them.

    python -m tests.campaigns.peers

Each call runs in a process of its own with bounded time and memory. The outcomes go to figures/peers.json.
"""

import importlib.metadata
import json
import resource
import subprocess
import sys
from pathlib import Path

FIGURES = Path(__file__).with_name("figures") / "peers.json"
SECONDS = 10
MEMORY = 4 * 1024**3
LIBRARIES = ("liehom", "sympy", "python-flint", "networkx")
BEGIN = "import liehom as lh, sympy, flint, networkx as nx, os\nfrom liehom.exact.scalars import QQ\n"

# input -> library: the call; no entry where a library has no such door
CALLS: dict[str, dict[str, str]] = {
    "a value that is code: `__import__('os').getpid()`": {
        "liehom": "QQ.convert(\"__import__('os').getpid()\")",
        "sympy": "assert sympy.sympify(\"__import__('os').getpid()\") == os.getpid(); print('EXECUTED')",
        "python-flint": "flint.fmpq(flint.fmpz(\"__import__('os').getpid()\"))",
        "networkx": "nx.parse_gml(\"graph [ node [ id __import__('os').getpid() ] ]\")",
    },
    "a tower of powers: `9**9**9**9`": {
        "liehom": "QQ.convert('9**9**9**9')",
        "sympy": "sympy.sympify('9**9**9**9')",
        "python-flint": "flint.fmpz(9) ** flint.fmpz(9) ** flint.fmpz(9) ** flint.fmpz(9)",
    },
    "an integer of 100,000 digits in a string": {
        "liehom": "QQ.convert('7' * 100_000)",
        "sympy": "sympy.sympify('7' * 100_000)",
        "python-flint": "flint.fmpz('7' * 100_000)",
        "networkx": "nx.parse_gml('graph [ node [ id ' + '7' * 100_000 + ' ] ]')",
    },
    "100,000 nested parentheses or lists": {
        "liehom": "QQ.convert('(' * 100_000 + '1' + ')' * 100_000)",
        "sympy": "sympy.sympify('(' * 100_000 + '1' + ')' * 100_000)",
        "networkx": "nx.parse_gml('graph ' + '[ a ' * 100_000)",
    },
    "an empty JSON object": {"liehom": "lh.from_json({})", "networkx": "nx.node_link_graph({})"},
    "NaN where a number is expected": {
        "liehom": "lh.LieAlgebra({(0, 1): {0: float('nan')}})",
        "sympy": "sympy.Matrix([[float('nan')]]).inv()",
        "python-flint": "flint.fmpq(float('nan'))",
    },
    "an object of a million dimensions": {
        "liehom": "lh.so(10**6)",
        "sympy": "sympy.zeros(10**6, 10**6)",
        "python-flint": "flint.fmpz_mat(10**6, 10**6)",
        "networkx": "nx.complete_graph(10**6)",
    },
    "a file without end: `/dev/zero`": {"liehom": "lh.load('/dev/zero')", "networkx": "nx.read_gml('/dev/zero')"},
}


def bounded() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def outcome(call: str) -> str:
    try:
        done = subprocess.run(
            [sys.executable, "-c", BEGIN + call],
            capture_output=True,
            text=True,
            timeout=SECONDS + 5,
            preexec_fn=bounded,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer in {SECONDS} s"
    if "EXECUTED" in done.stdout:
        return "executes it"
    if done.returncode == 0:
        return "reads it"
    if done.returncode < 0:
        return f"the process dies (signal {-done.returncode})"
    last = [line for line in done.stderr.splitlines() if line and not line.startswith(" ")][-1]
    return f"`{last.partition(':')[0].rpartition('.')[2]}`"


def main() -> None:
    versions = {name: importlib.metadata.version(name) for name in LIBRARIES if name != "liehom"}
    rows = [{"input": text, **{name: outcome(call) for name, call in calls.items()}} for text, calls in CALLS.items()]
    data = {"seconds": SECONDS, "memory": MEMORY, "versions": versions, "rows": rows}
    FIGURES.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(data, indent=1))


if __name__ == "__main__":
    main()
