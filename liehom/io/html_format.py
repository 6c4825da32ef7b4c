r"""HTML of objects for notebooks: a card with a title, facts, a table, and details that unfold.

    <div class="liehom"><p><b>title</b></p><table> facts </table><details> what unfolds </details></div>

Every text is cut to a few hundred characters and escaped, so that a name with < or & stays text, and one with $ does
not become a formula. Only data that the object holds, or that take milliseconds to compute, are shown.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape

import numpy as np

from liehom.algebra import Homomorphism, LieAlgebra, RealForm, RootSystem, Subalgebra
from liehom.display import SHOWN_LINES, DisplayedTable
from liehom.fullness import (
    Certificate,
    Classification,
    FailureReport,
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
)
from liehom.integrators import Solution
from liehom.representations import Pair, Representation

SHOWN_TABLE_ROWS = 20
SHOWN_CHARACTERS = 500
"""Characters of a title, a fact or a cell; the sentences of verdicts are shorter."""
SHOWN_DETAILS = 2000
"""Characters of the details of a card."""


@dataclass(frozen=True, slots=True)
class Card:
    """Content of the HTML of an object, as plain text.

    Attributes
    ----------
    title : str
    facts : sequence of (str, object)
        What is known, by its name; facts that are None are left out.
    details : sequence of (str, str)
        Summaries, and the text that each unfolds.
    """

    title: str
    facts: Sequence[tuple[str, object]] = ()
    details: Sequence[tuple[str, str]] = ()


def html(obj: object) -> str:
    """HTML of an object for a notebook, as a string: one element `div`, which needs no script and no style sheet.

    Parameters
    ----------
    obj : object
        For an object that is not of liehom, its `repr`.

    Returns
    -------
    str

    Examples
    --------
    >>> import liehom as lh
    >>> print(html(lh.LieAlgebra({}, dimension=1, name="<b>")))  # doctest: +ELLIPSIS
    <div class="liehom"><p><b>Lie algebra &lt;b&gt; of dimension 1 over QQ</b></p>...</div>
    """
    if isinstance(obj, DisplayedTable):
        return _div(_table_of(obj))
    card = card_of(obj)
    parts = [f"<p><b>{_text(card.title)}</b></p>"]
    facts = [(name, value) for name, value in card.facts if value is not None]
    if facts:
        rows = "".join(f'<tr><th style="text-align:left">{_text(n)}</th><td>{_text(v)}</td></tr>' for n, v in facts)
        parts.append(f"<table>{rows}</table>")
    parts += [_details(summary, text) for summary, text in card.details]
    return _div("".join(parts))


@singledispatch
def card_of(obj: object) -> Card:
    """Content of an object's HTML; by default its `repr`, and its `str` in the details.

    Examples
    --------
    >>> import liehom as lh
    >>> card_of(lh.heisenberg(1).center()).facts
    (('basis', 'z'),)
    """
    title, text = repr(obj), str(obj)
    return Card(title.removeprefix("<").removesuffix(">"), (), [] if text == title else [("details", text)])


@card_of.register
def _(obj: LieAlgebra) -> Card:
    names = ", ".join(obj.basis_names[:SHOWN_LINES]) + (", ..." if obj.dimension > SHOWN_LINES else "")
    brackets = str(obj).partition("\n")[2].partition("\n")[2]
    title = " ".join(filter(None, ["Lie algebra", obj.name, f"of dimension {obj.dimension} over {obj.field.name}"]))
    return Card(title, (("basis", names or None),), [("brackets", brackets or "  all brackets vanish")])


@card_of.register
def _(obj: Subalgebra) -> Card:
    rows = obj.basis.select(rows=range(min(obj.dimension, SHOWN_LINES)))
    basis = [obj.algebra.show(row) for row in rows] + ["..."] * (obj.dimension > SHOWN_LINES)
    return Card(_bare(obj), (("basis", ", ".join(basis) or None),))


@card_of.register
def _(obj: Representation) -> Card:
    title = " ".join(filter(None, ["representation", obj.name, f"on {obj.field.name}^{obj.size}"]))
    return Card(title, (("algebra", _bare(obj.algebra)), ("coordinates", obj.coordinates)))


@card_of.register
def _(obj: Pair) -> Card:
    title = f"pair {obj.name or 'g/h'} of dimension {obj.dimension}"
    return Card(title, (("g", _bare(obj.algebra)), ("h", _bare(obj.subalgebra))))


@card_of.register
def _(obj: Homomorphism) -> Card:
    return Card(_bare(obj), (("source", _bare(obj.source)), ("target", _bare(obj.target))))


@card_of.register
def _(obj: RootSystem) -> Card:
    roots = ", ".join(map(str, obj.positive_roots[:SHOWN_LINES]))
    more = f", ... ({len(obj.positive_roots)} in all)" if len(obj.positive_roots) > SHOWN_LINES else ""
    facts = (("type", obj.type), ("rank", obj.rank), ("roots", obj.number_of_roots))
    cartan = "\n".join(" ".join(f"{x:>2}" for x in row) for row in obj.cartan)
    return Card("root system", facts, [("positive roots", roots + more), ("Cartan matrix", cartan)])


@card_of.register
def _(obj: RealForm) -> Card:
    facts = (("type", obj.type), ("dimension", obj.dimension), ("real rank", obj.real_rank))
    return Card(f"real form {obj.name}", (*facts, ("maximal compact", obj.maximal_compact)))


# -- verdicts ------------------------------------------------------------------------------------------------
@card_of.register
def _(obj: Full | NotFull) -> Card:
    defect = obj.rank_defect if isinstance(obj, NotFull) else None
    facts = (("because", obj.reason), ("certificate", f"kind {obj.certificate.kind!r}"), ("rank defect", defect))
    return Card(_sentence(obj.pair, obj.full), facts, [("certificate", str(obj.certificate))])


@card_of.register(NumericallyFull)
@card_of.register(NumericallyNotFull)
@card_of.register(NumericallyUndecided)
def _(obj: NumericallyFull | NumericallyNotFull | NumericallyUndecided) -> Card:
    facts = (
        ("because", obj.reason),
        ("certificate", "none: a numerical verdict is not proved"),
        ("least singular value", f"{obj.smallest:.3g}"),
    )
    return Card(_sentence(obj.pair, obj.full), facts)


def _sentence(pair: Pair, full: bool | None) -> str:
    answer = {True: "is full", False: "is not full", None: "is undecided"}[full]
    return f"The pair {pair.name or f'of dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}'} {answer}."


@card_of.register
def _(obj: Certificate) -> Card:
    head, _, body = str(obj).partition("\n")
    return Card(head, (), [("fields", body)] if body else [])


@card_of.register
def _(obj: Classification) -> Card:
    facts = (
        ("space", obj.space),
        ("isotropy", obj.row.isotropy),
        ("dimension of the ideal inside h", obj.ideal.dimension or None),
    )
    return Card(f"classification: {obj.name or 'no catalogue name'}", facts)


@card_of.register
def _(obj: FailureReport) -> Card:
    facts = (
        ("fails on", ", and ".join(part.description for part in obj.parts) or None),
        ("complete for", ", ".join(obj.searched) or None),
        ("not searched", ", ".join(obj.not_searched) or None),
    )
    return Card(str(obj).partition(";")[0], facts)


# -- trajectories --------------------------------------------------------------------------------------------
@card_of.register
def _(obj: Solution) -> Card:
    facts: list[tuple[str, object]] = [("status", obj.status)]
    if np.ndim(obj.n_steps) == 0:
        facts.append(("steps", int(obj.n_steps)))
    if obj.t.ndim == 1 and obj.t.size:
        last = ", ".join(f"{x:.6g}" for x in obj.y[:SHOWN_LINES, -1]) + (", ..." if len(obj.y) > SHOWN_LINES else "")
        facts += [("t", f"{obj.t[0]:.6g} to {obj.t[-1]:.6g}, {obj.t.size} points"), ("last point", f"({last})")]
    else:
        facts.append(("y", f"array of shape {obj.y.shape}"))
    return Card(obj.message, facts, [("report", str(obj.report))])


# -- elements of HTML ----------------------------------------------------------------------------------------
def _table_of(table: DisplayedTable) -> str:
    head, *body = table._cells()
    rows = [_row("th", head), *(_row("td", row) for row in body[:SHOWN_TABLE_ROWS])]
    notes = list(table._notes())
    if len(body) > SHOWN_TABLE_ROWS:
        notes.insert(0, f"... and {len(body) - SHOWN_TABLE_ROWS} further rows")
    caption = f"<p><b>{_text(table._caption())}</b></p>" if table._caption() else ""
    return f"{caption}<table>{''.join(rows)}</table>" + "".join(f"<p>{_text(note)}</p>" for note in notes[:SHOWN_LINES])


def _row(tag: str, cells: Iterable[str]) -> str:
    return f"<tr>{''.join(f'<{tag}>{_text(x)}</{tag}>' for x in cells)}</tr>"


def _details(summary: str, text: str) -> str:
    short = text if len(text) <= SHOWN_DETAILS else f"{text[:SHOWN_DETAILS]}\n..."
    return f"<details><summary>{_text(summary)}</summary><pre>{escape(short)}</pre></details>"


def _div(content: str) -> str:
    return f'<div class="liehom">{content}</div>'


def _text(value: object) -> str:
    # MathJax reads no formula across elements, so a dollar or backslash that stands alone in one begins none
    text = str(value)
    short = text if len(text) <= SHOWN_CHARACTERS else f"{text[:SHOWN_CHARACTERS]} ..."
    return re.sub(r"[$\\]", r"<span>\g<0></span>", escape(short))


def _bare(obj: object) -> str:
    return repr(obj).removeprefix("<").removesuffix(">")
