"""Write gap_characters.json: dominant characters and tensor products by GAP, in Bourbaki's numbering.

Run `python tests/oracles/gap_characters.py` where `gap` is installed.
"""

import datetime
import json
import re
import subprocess
from pathlib import Path

CHARACTERS = [
    *(("A1", [n]) for n in (0, 1, 7)),
    *(("A2", w) for w in ([1, 1], [3, 1], [10, 10])),
    *(("A3", w) for w in ([1, 1, 1], [0, 2, 0], [3, 0, 1])),
    *(("B2", w) for w in ([0, 3], [2, 1])),
    *(("B3", w) for w in ([1, 0, 1], [0, 2, 0], [2, 1, 1])),
    *(("B4", w) for w in ([0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 2])),
    *(("C3", w) for w in ([0, 0, 1], [1, 1, 1])),
    *(("C4", w) for w in ([0, 1, 0, 1], [2, 0, 1, 0])),
    *(("D4", w) for w in ([0, 0, 1, 1], [1, 1, 1, 1])),
    *(("D5", w) for w in ([0, 0, 0, 0, 1], [1, 0, 0, 2, 0])),
    *(("G2", w) for w in ([1, 0], [0, 1], [2, 1], [0, 4])),
    *(("F4", w) for w in ([0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 1])),
    *(("E6", w) for w in ([1, 0, 0, 0, 0, 1], [0, 0, 0, 1, 0, 0], [2, 1, 0, 0, 0, 0])),
    *(("E7", w) for w in ([0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1], [0, 1, 0, 0, 0, 0, 1])),
    *(("E8", w) for w in ([0, 0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0, 1, 1])),
]

PRODUCTS = [
    ("A1", [3], [5]),
    ("A2", [1, 1], [1, 1]),
    ("A3", [1, 1, 0], [0, 1, 2]),
    ("B3", [0, 0, 1], [1, 0, 1]),
    ("C3", [0, 1, 0], [1, 0, 1]),
    ("D4", [1, 1, 0, 0], [0, 0, 1, 2]),
    ("G2", [1, 1], [2, 0]),
    ("F4", [0, 0, 0, 1], [0, 0, 1, 0]),
    ("E6", [1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0]),
    ("E7", [0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1]),
    ("E8", [0, 0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 0, 0]),
]

# GAP numbers the nodes of F4 otherwise: place k of a weight there is place F4_NODES[k] of ours.
F4_NODES = [3, 0, 2, 1]


def to_gap(kind: str, weight: list[int]) -> list[int]:
    return [weight[k] for k in F4_NODES] if kind == "F4" else weight


def from_gap(kind: str, weight: list[int]) -> list[int]:
    return [weight[F4_NODES.index(k)] for k in range(4)] if kind == "F4" else weight


def algebra(kind: str) -> str:
    return f'SimpleLieAlgebra("{kind[0]}", {kind[1:]}, Rationals)'


def run_gap(lines: list[str]) -> list[str]:
    text = "SizeScreen([4096, 24]);;\n" + "".join(f'Print("@", {line}, "\\n");\n' for line in lines) + "QUIT;\n"
    out = subprocess.run(["gap", "-q"], input=text, capture_output=True, text=True, check=True).stdout
    return [" ".join(part.split()) for part in out.split("@")[1:]]


def weights(kind: str, text: str) -> list[list[object]]:
    found, counts = json.loads(text)
    return sorted(([from_gap(kind, weight), count] for weight, count in zip(found, counts, strict=True)), reverse=True)


def main() -> None:
    questions = [f"DominantCharacter({algebra(t)}, {to_gap(t, w)})" for t, w in CHARACTERS]
    questions += [f"DimensionOfHighestWeightModule({algebra(t)}, {to_gap(t, w)})" for t, w in CHARACTERS]
    questions += [f"DecomposeTensorProduct({algebra(t)}, {to_gap(t, v)}, {to_gap(t, w)})" for t, v, w in PRODUCTS]
    version, *answers = run_gap(["GAPInfo.Version", *questions])
    n = len(CHARACTERS)
    oracle = {
        "provenance": {
            "tool": "GAP",
            "tool_version": version,
            "script": "tests/oracles/gap_characters.py",
            "date": datetime.date.today().isoformat(),
            "licence": "GAP is under GPL-2.0-or-later; the numbers are facts that it computed",
        },
        "characters": [
            {"type": t, "weight": w, "dimension": int(dimension), "dominant": weights(t, character)}
            for (t, w), character, dimension in zip(CHARACTERS, answers[:n], answers[n : 2 * n], strict=True)
        ],
        "products": [
            {"type": t, "left": v, "right": w, "parts": weights(t, parts)}
            for (t, v, w), parts in zip(PRODUCTS, answers[2 * n :], strict=True)
        ],
    }
    text = json.dumps(oracle, indent=1)
    text = re.sub(r"\[\s+([-\d,\s]+?)\s+\]", lambda m: "[" + " ".join(m[1].split()) + "]", text)
    text = re.sub(r"\[\s+(\[[-\d, ]+\],)\s+(\d+)\s+\]", r"[\1 \2]", text)
    Path(__file__).with_suffix(".json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
