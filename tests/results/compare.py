"""Two recorded results, compared: each difference with the name of its case; exits with 1 if there is one.

python -m tests.results.compare BEFORE.json AFTER.json
"""

import json
import sys
from collections.abc import Iterator
from typing import Any

LISTED = "failure reports list all maximal invariant subspaces, over real number fields too"
NAMED = "the sentence of a full verdict names the row of the classification"
FULL = (
    *("so(4)/so(3)", "so(12)/so(11)", "su(4)/u(3)", "sp(2,1)/sp(2)+sp(1)", "f4/spin(9)", "g2/su(3)", "so(8)/spin(7)"),
    *("sl(3,C)/P1", "so(6,1)/P", "su(1,1)/P", "affine(form(1,2,5))", "affine(sp(2)+sp(1)+R)", "affine(sp(4,C)+u(1))"),
    *("affine(spin(7))", "affine(sl(2,Q(-1,-3)))", "affine(spiral(1,1))", "0/0", "sym(4;3,1)"),
    *(
        f"{name}, random basis"
        for name in (
            *(
                "so(5)/so(4)",
                "su(3)/u(2)",
                "su(2,1)/u(2)",
                "sp(1,1)/sp(1)+sp(1)",
                "sl(3)/P1",
                "sl(2,C)/P1",
                "so(4,1)/P",
            ),
            *("affine(u(2))", "affine(sl(2,C))", "affine(gl(3))", "affine(sp(4,R))", "e(3)/so(3)", "affine(gl(1,H))"),
            "sym(3;2,1)",
        )
    ),
    *("so(4)/so(3) over sqrt(2)", "su(2,1)/u(2) over sqrt(2)", "sl(3)/P1 over sqrt(5)"),
    *("affine(gl(1,C)) over cbrt(2)", "affine(su(2)) over heptagon"),
    *(f"diag(1, ..., 1 * sqrt(2)) of size {n}" for n in (2, 3, 4)),
)
"""Decisions of pairs that are full."""
INTENDED = (
    {
        f"decisions: [{name} over RR] [{key}] ": "numerical verdicts compare with propagated errors"
        for name in ("so(4)/so(3)", "so(3,1)/so(2,1)")
        for key in ("verdict", "eta_numerical", "smallest_singular_value", "gap")
    }
    | {f"decisions: [{name}] [verdict] ": NAMED for name in FULL}
    | {
        f"decisions: [{name}] [{key}] ": LISTED
        for name in (
            *("g2(2)/P1", "affine(form(1,-2)+R)", "affine(field(1,1,1,1))", "sl(3)/s(gl(2)+gl(1)), random basis"),
            *(
                "affine(field(-2,0,0)), random basis",
                "affine(upper(3)), random basis",
                "affine(diag(1,2)), random basis",
            ),
            *(
                "affine(form(1,-2)) over sqrt(2)",
                "affine(form(1,-2)+R) over sqrt(3)",
                "affine(field(-2,0,0)) over cbrt(2)",
            ),
            *("affine(sl(2,Q(sqrt(2)))) over sqrt(2)", "diag(1, ..., -1 * sqrt(2)) of size 2"),
            *(f"powers of a matrix, {i}" for i in (0, 2, 3, 4, 6, 7, 8, 9)),
        )
        for key in ("failure", "failure parts")
    }
    | {
        f"cards: [so of diag(1, -1, 5, 7)] [{key}] ": "the search meets another involution first"
        for key in ("Cartan involution", "maximal compact subalgebra")
    }
)
"""Values that differ from those of 0.1.0 on purpose, and why."""


def environment(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """What results may depend on besides liehom, where it is not the same."""
    one, other = before["header"], after["header"]
    names = [name for name in {**one, **other} if name != "liehom"]
    return [
        f"{name}: {one.get(name)} before, {other.get(name)} after" for name in names if one.get(name) != other.get(name)
    ]


def differences(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """One line for each value that differs, and for each case that only one of the two has."""
    sections = [name for name in {**before, **after} if name != "header"]
    return [
        line
        for section in sections
        for line in _differing(before.get(section, {}), after.get(section, {}), f"{section}: ")
    ]


def _differing(one: Any, other: Any, path: str) -> Iterator[str]:
    if isinstance(one, dict) and isinstance(other, dict):
        for key in {**one, **other}:
            name = f"{path}[{key}] "
            if key not in one or key not in other:
                yield f"{name}only {'after' if key not in one else 'before'}"
            else:
                yield from _differing(one[key], other[key], name)
    elif one != other and path not in INTENDED:
        yield f"{path}\n    before: {one!r}\n    after:  {other!r}"


def main(paths: list[str]) -> int:
    if len(paths) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    loaded = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            loaded.append(json.load(file))
    found = differences(*loaded)
    for line in found:
        print(line)
    changed = environment(*loaded)
    if changed:
        print("Recorded in different environments, so that floating-point results may differ in their last bits:")
        print("\n".join(f"    {line}" for line in changed))
    cases = sum(len(part) for name, part in loaded[0].items() if name != "header")
    print(f"{len(found)} differences in {cases} cases, besides up to {len(INTENDED)} values that changed on purpose")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
