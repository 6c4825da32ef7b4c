"""Commands `classify` and `full-pairs`: the row of a full pair in the classification, and all rows of a dimension."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from liehom.cli.guard import NO, NUMERICAL, YES
from liehom.cli.options import JsonOption, PairArgument, run
from liehom.cli.terminal.steps import step

if TYPE_CHECKING:
    from liehom.fullness import Classification
    from liehom.fullness.classification import Row
    from liehom.representations import Pair


def classify(pair: PairArgument, json: JsonOption = False) -> None:
    """Find the row of a full pair in the classification.

    The exit code is 1 if the pair is not full, and 3 if the answer is numerical or undecided.
    """
    run(lambda: _classify(pair, json))


def _classify(text: str, as_json: bool) -> int:
    from liehom.cli.inputs import pair_argument, pair_facts, pair_line
    from liehom.cli.show import show_answer, show_json
    from liehom.fullness import classify as classification_of
    from liehom.fullness import decide_fullness

    pair = pair_argument(text)
    step("isotropy representation")
    verdict = decide_fullness(pair, progress=step)
    if verdict.certificate is None or not verdict.full:
        code = NUMERICAL if verdict.certificate is None else NO
        if as_json:
            show_json({**verdict.to_json(), "classification": None, "pair": pair_facts(text, pair)})
        else:
            show_answer(
                f"{verdict}", [("pair", pair_line(text, pair)), ("row", "none: only full pairs have one")], code
            )
        return code
    step("row of the classification")
    found = classification_of(pair, verdict)
    step("check of the certificate and of the row")
    verdict.verify()
    found.verify(pair)
    if as_json:
        show_json({**verdict.to_json(), "classification": found.to_json(), "pair": pair_facts(text, pair)})
    else:
        show_answer(str(found), [("pair", pair_line(text, pair)), *_evidence(found, pair)])
    return YES


def _evidence(found: Classification, pair: Pair) -> list[tuple[str, str]]:
    """Labels and values below the name of the row."""
    from liehom.cli.show import short_vector

    key, write = found.key, pair.field.format
    row = f"{key.letter}, d = {key.d}, s = {key.s}, e = {key.e}, centre {key.centre or '0'}"
    if key.centre == "J+c":
        row += f", c^2 = {key.parameter}"
    elif key.parameter is not None:
        row += ", compact" if key.parameter == 1 else ", non-compact"
    rows = [("key", row), ("isotropy", found.row.isotropy)]
    ideal = [[write(x) for x in vector] for vector in found.ideal.rows()]
    rows += [("ideal inside h" if i == 0 else "", short_vector(vector)) for i, vector in enumerate(ideal[:6])]
    if len(ideal) > 6:
        rows.append(("", f"... and {len(ideal) - 6} more rows"))
    return [*rows, ("checked", "certificate of fullness and key, each by independent code")]


def full_pairs(
    d: Annotated[int, typer.Argument(metavar="D", min=0, help="Dimension of g/h.")], json: JsonOption = False
) -> None:
    """List all full pairs of a dimension, one for each row of the classification.

    In the name of a family of spirals, c stands for a positive number.
    """

    def action() -> int:
        from liehom.cli.show import show_json, show_table
        from liehom.fullness.classification import rows

        found = rows(d)
        if json:
            show_json({"dimension": d, "count": len(found), "pairs": [_row_json(row) for row in found]})
        else:
            show_table(["name", "space"], [[row.name, row.space] for row in found])
        return YES

    run(action)


def _row_json(row: Row) -> dict[str, Any]:
    data = {"name": row.name, "space": row.space, "isotropy": row.isotropy, "family": row.is_family}
    return {**data, "key": row.key._asdict()}
