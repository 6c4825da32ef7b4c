"""Results of liehom, written to a file that another version can be compared with bit for bit.

    python -m tests.results.record OUT.json              all cases (10 s on one core)
    python -m tests.results.record --show NAME           the values of one case in full, before they are hashed
    python -m tests.results.compare BEFORE.json AFTER.json

There are 100 decisions and 40 algebras with their structure. To record another version, run this script in an empty
folder with PYTHONPATH=OTHER:HERE: OTHER holds the package `liehom`, HERE this folder `tests`. The results are exact, so
they do not depend on the machine, except where a floating-point search proposes an element, a form or an involution
that is then proved.
"""

import argparse
import json
import platform
import sys
import time
from importlib import metadata
from typing import Any

import numpy as np

import liehom as lh
from tests.results import cards, decisions

SECTIONS = {"decisions": decisions.CASES, "cards": cards.CASES}
LIBRARIES = ("numpy", "scipy", "python-flint", "llvmlite")

REWORDED: dict[str, str] = {
    "annihilates an invariant subspace": "kills an invariant subspace",
    "the isotropy preserves": "the isotropy keeps",
    "the elements that preserve a definite form": "the elements that keep a definite form",
}
"""Words as they are now -> as they were in 0.1.0; replaced in every recorded string, longest first."""


def header() -> dict[str, Any]:
    simd = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[call-overload]
    return {
        "liehom": lh.__version__,
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in LIBRARIES},
        "machine": platform.machine(),
        "SIMD": " ".join(simd["found"]) or " ".join(simd["baseline"]),
    }


def recorded(section: str, name: str) -> Any:
    """The values of a case, hashed where they are long, in the words of 0.1.0."""
    return in_words_of_0_1_0(shortened(SECTIONS[section][name]()))


def shortened(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: shortened(item) for key, item in value.items()}
    return value.short() if hasattr(value, "short") else value


def in_words_of_0_1_0(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: in_words_of_0_1_0(item) for key, item in value.items()}
    if isinstance(value, list):
        return [in_words_of_0_1_0(item) for item in value]
    if isinstance(value, str):
        for now, then in sorted(REWORDED.items(), key=lambda pair: -len(pair[0])):
            value = value.replace(now, then)
    return value


def main() -> None:
    parser = argparse.ArgumentParser(description="Record results of liehom.")
    parser.add_argument("out", nargs="?", help="the file to write")
    parser.add_argument("--show", metavar="NAME", help="print the values of the cases with this name in full")
    parser.add_argument("--times", action="store_true", help="print the time of each case")
    given = parser.parse_args()
    if given.show:
        for cases in SECTIONS.values():
            if given.show in cases:
                for key, value in cases[given.show]().items():
                    print(f"{key}: {value}")
        return
    if not given.out:
        parser.error("give the file to write")
    made: dict[str, Any] = {"header": header()}
    for section, cases in SECTIONS.items():
        made[section] = {}
        for name in cases:
            begin = time.process_time()
            made[section][name] = recorded(section, name)
            if given.times:
                print(f"{time.process_time() - begin:8.2f} s  {section}: {name}", file=sys.stderr, flush=True)
    with open(given.out, "w", encoding="utf-8") as file:
        json.dump(made, file, indent=1, sort_keys=False)
        file.write("\n")


if __name__ == "__main__":
    main()
