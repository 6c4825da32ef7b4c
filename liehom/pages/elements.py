"""Elements of HTML as strings. Arguments named `content` are elements; all other arguments are text and are escaped."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from liehom.scalars import Matrix, Scalar

MOST_ROWS = 12
"""Rows and columns of matrices, and rows of most tables, that are shown."""
MOST_CHARACTERS = 400
"""Characters of one number or linear combination."""
MOST_IN_BLOCK = 4000
"""Characters of a block of lines."""

# characters that HTML does not allow, and halves of pairs, which UTF-8 cannot write
_NOT_ALLOWED = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def text(value: object, most: int | None = None) -> str:
    """An escaped string, cut to `most` characters.

    Examples
    --------
    >>> text("<b>"), text("a long name", most=6)
    ('&lt;b&gt;', 'a long ...')
    """
    found = str(value)
    if most is not None and len(found) > most:
        found = f"{found[:most]} ..."
    return escape(_NOT_ALLOWED.sub("\ufffd", found))


def paragraph(words: object, kind: str = "") -> str:
    """A paragraph of text, with a class of the style sheet.

    Examples
    --------
    >>> paragraph("1 < 2", "note")
    '<p class="note">1 &lt; 2</p>'
    """
    return f'<p class="{kind}">{text(words)}</p>' if kind else f"<p>{text(words)}</p>"


def code_block(lines: object) -> str:
    """Lines of code or of a summary, which scroll sideways in their box."""
    return f"<pre>{text(lines, MOST_IN_BLOCK)}</pre>"


def items(lines: Iterable[object]) -> str:
    """A list of short strings."""
    return f"<ul>{''.join(f'<li>{text(line)}</li>' for line in lines)}</ul>"


def section(name: str, heading: str, *content: str) -> str:
    """A section with a heading that links point to as ``#name``."""
    return f'<section id="{text(name)}"><h2>{text(heading)}</h2>{"".join(content)}</section>'


def details(summary: str, *content: str) -> str:
    """Content that unfolds.

    Examples
    --------
    >>> details("more", paragraph("x"))
    '<details><summary>more</summary><div><p>x</p></div></details>'
    """
    return f"<details><summary>{text(summary)}</summary><div>{''.join(content)}</div></details>"


def facts(rows: Iterable[tuple[str, object]], most: int = 1000) -> str:
    """A table of names and values; values that are None are left out."""
    body = "".join(
        f'<tr><th scope="row">{text(name)}</th><td>{text(value, most)}</td></tr>'
        for name, value in rows
        if value is not None
    )
    return f'<div class="box"><table class="facts">{body}</table></div>'


def table(head: Sequence[str], rows: Sequence[Sequence[object]], what: str, most: int = MOST_ROWS) -> str:
    """A table; below it, if it is cut to `most` rows, how many of `what` there are.

    Examples
    --------
    >>> table(["n"], [[1], [2]], "numbers", most=1).partition("</div>")[2]
    '<p class="note">The first 1 of 2 numbers.</p>'
    """
    top = "".join(f'<th scope="col">{text(x)}</th>' for x in head)
    body = "".join(f"<tr>{''.join(f'<td>{text(x, MOST_CHARACTERS)}</td>' for x in row)}</tr>" for row in rows[:most])
    made = f'<div class="box"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'
    return made + (paragraph(f"The first {most} of {len(rows):,} {what}.", "note") if len(rows) > most else "")


def number(matrix: Matrix, value: Scalar) -> str:
    """Text of an entry of a matrix: exact, or a float with six digits."""
    return matrix.field.show(value) if matrix.field.exact else f"{float(value):.6g}"


def matrix_table(matrix: Matrix, label: str) -> str:
    """A matrix with its name before it; of a large one the first rows and columns, and a line that says so.

    Examples
    --------
    >>> import liehom as lh
    >>> matrix_table(lh.QQ.matrix([["1/2", 0]]), "A").count("<td")
    2
    """
    rows, columns = min(matrix.nrows, MOST_ROWS), min(matrix.ncols, MOST_ROWS)
    more = "<td>...</td>" if columns < matrix.ncols else ""
    body = [f"<tr>{''.join(_cell(matrix, i, j) for j in range(columns))}{more}</tr>" for i in range(rows)]
    body += [f"<tr>{'<td>...</td>' * (columns + bool(more))}</tr>"] * (rows < matrix.nrows)
    note = f"{label} is {matrix.nrows} x {matrix.ncols}; the first {rows} rows and {columns} columns are shown."
    grid = f'<table class="matrix" aria-label="{text(label)}">{"".join(body)}</table>' if body else "empty"
    named = f'<div class="box equation"><span>{text(label)} =</span>{grid}</div>'
    return named + (paragraph(note, "note") if (rows, columns) != matrix.shape else "")


def _cell(matrix: Matrix, i: int, j: int) -> str:
    value = matrix[i, j]
    return "<td class=z>0</td>" if value == 0 else f"<td>{text(number(matrix, value), MOST_CHARACTERS)}</td>"


def figure(content: str, caption: str) -> str:
    """A picture with its caption, which is also its description for readers of screens."""
    return f"<figure>{content}<figcaption>{text(caption)}</figcaption></figure>"


def download(data: Mapping[str, Any], file: str, most: int) -> str | None:
    """A link that saves a JSON object, which the link itself contains, as a file; None if it has over `most` bytes.

    Examples
    --------
    >>> download({"a": 1}, "a.json", most=1000)
    '<a download="a.json" href="data:application/json;base64,eyJhIjogMX0=">a.json</a> (8 bytes)'
    """
    content = json.dumps(data, allow_nan=False).encode()
    if len(content) > most:
        return None
    size = f"{len(content):,} bytes" if len(content) < 10_000 else f"{len(content) / 1000:,.0f} kB"
    link = f"data:application/json;base64,{base64.b64encode(content).decode()}"
    return f'<a download="{text(file)}" href="{link}">{text(file)}</a> ({size})'


def json_script(name: str, data: object) -> str:
    """Data for a script of the page; no string in them can end the element.

    Examples
    --------
    >>> json_script("data", "</script>")
    '<script type="application/json" id="data">"\\\\u003c/script\\\\u003e"</script>'
    """
    content = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        content = content.replace(character, f"\\u{ord(character):04x}")
    return f'<script type="application/json" id="{text(name)}">{content}</script>'
