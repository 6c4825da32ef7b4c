"""SVG of a picture for a page of HTML that contains it, instead of a file of its own."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from liehom.plotting.canvas import UNDATED, figure_of, matplotlib_module, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Drawing: TypeAlias = "Callable[[], Axes]"
"""A function that draws a picture."""

_HEAD = re.compile(r"^.*?(?=<svg )", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>|<style.*?</style>", re.DOTALL)
_SIZE = re.compile(r'(?<=<svg )(.*?)width="([0-9.]+)pt" height="([0-9.]+)pt"', re.DOTALL)
_NAMED = re.compile(r'(\bid="|url\(#|href="#)')
_DIGITS = re.compile(r"(\.\d\d)\d+")


def inline_svg(draw: Drawing, name: str, *, dark: bool = False) -> str:
    """An element `svg` for a page of HTML, as a string.

    Parameters
    ----------
    draw : callable
        Returns the axes of the picture; called in the style of the library.
    name : str
        The beginning of all ids in the element, which must be unique in the page.
    dark : bool, optional
        Whether the picture is for a dark page.

    Returns
    -------
    str
        Without the title of the axes, and hidden from readers of screens: the caption of the figure around it says what
        it shows. Text stays text, and lengths are rounded to hundredths of a point.

    Raises
    ------
    InputError
        If matplotlib is not installed, or `draw` does not return axes.

    Examples
    --------
    >>> import liehom as lh
    >>> inline_svg(lambda: lh.plotting.plot_dynkin("A2"), "a")[:34]  # doctest: +SKIP
    '<svg aria-hidden="true" style="wid'
    """
    file = io.BytesIO()
    text_stays = matplotlib_module("").rc_context({"svg.fonttype": "none"})
    with style(dark=dark), text_stays, warnings.catch_warnings():
        # the browser has fonts of its own
        warnings.filterwarnings("ignore", r"Glyph .* missing from font")
        axes = draw()
        axes.set_title("", loc="left")
        figure = figure_of(axes)
        figure.patch.set_alpha(0.0)
        figure.savefig(file, format="svg", metadata=UNDATED[".svg"])
    text = _METADATA.sub("", _HEAD.sub("", file.getvalue().decode(), count=1))
    text = _SIZE.sub(lambda m: f'aria-hidden="true" style="width:{float(m[2]) * 4 / 3:.0f}px" {m[1]}', text, count=1)
    text = _NAMED.sub(rf"\1{name}-", _DIGITS.sub(r"\1", text))
    return re.sub(r"\s*\n\s*", " ", text).replace("> <", "><").strip()
