"""Figures, their style and their files."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from liehom.base.disk import check_target, write_file
from liehom.base.errors import FormatError, InputError, displayed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Figures, their style and their files; the one module that loads matplotlib. The colours are those of Okabe and Ito,
# which people with any kind of colour vision can distinguish. Lines also differ in their markers or dashes.

# Okabe and Ito without yellow, which is pale on white; grey for the background
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
DASHES = ("-", "--", "-.", ":")
GREY, PALE = "#6b6b6b", "#d9d9d9"
DARK_GREY, DARK_PALE = "#999999", "#4a4a4a"
# the same hues, light enough for a dark page
DARK_COLOURS = ("#56B4E9", "#E69F00", "#2ECC9A", "#E59AC4", "#F0E442", "#FF8C5A", "#DDDDDD")

MAX_NAME = 20  # Characters of a name in a picture

STYLE: dict[str, object] = {
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.labelsize": 10,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": "black",
    "ytick.labelcolor": "black",
    "savefig.dpi": 160,
    "svg.hashsalt": "liehom",  # equal plots are equal files
}
TEXT = ("text.color", "axes.labelcolor", "axes.titlecolor", "xtick.labelcolor", "ytick.labelcolor", "legend.labelcolor")
# What `style` sets for a dark page, besides `STYLE`
DARK: dict[str, object] = {
    **dict.fromkeys(TEXT, "#dddddd"),
    "grid.color": "#3a3a3a",
    "axes.edgecolor": DARK_GREY,
    "axes.facecolor": "none",
    "figure.facecolor": "#131416",
}
# metadata that would contain the time of writing, so that equal plots would be different files
UNDATED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def matplotlib_module(name: str) -> Any:
    """Module of matplotlib such as ``matplotlib_module("figure")``, imported at the first call."""
    try:
        import_module("matplotlib")
    except ModuleNotFoundError:
        raise InputError("plots need matplotlib: install it with  pip install matplotlib") from None
    return import_module(f"matplotlib.{name}" if name else "matplotlib")


def style(*, dark: bool = False) -> AbstractContextManager[None]:
    """Context manager that sets the style of the library's plots: all that is drawn in it has this style.

    Parameters
    ----------
    dark : bool, optional
        Light text on a dark background, with lines in lighter colours.

    Examples
    --------
    >>> import liehom as lh
    >>> with style(dark=True):  # doctest: +SKIP
    ...     ax = lh.plotting.plot_dynkin("E8")
    """
    return matplotlib_module("").rc_context({**STYLE, **(DARK if dark else {})})


def style_unless(ax: Axes | None) -> AbstractContextManager[object]:
    """The style of the library for new figures, unless `style` is active; for given axes, the caller's."""
    if ax is not None:
        figure_of(ax)
        return nullcontext()
    return nullcontext() if matplotlib_module("").rcParams["svg.hashsalt"] == STYLE["svg.hashsalt"] else style()


def plain(name: str) -> str:
    """A name as text of a picture: short, of characters that a file can hold, and without a formula."""
    short = name if len(name) <= MAX_NAME else f"{name[:MAX_NAME]}..."
    return "".join(c if c.isprintable() else "\ufffd" for c in short).replace("$", r"\$")


def new_figure(width: float, height: float) -> Figure:
    """Figure of this size in inches, in no window and not registered with pyplot; notebooks show it as a picture."""
    figure: Any = matplotlib_module("figure").Figure(figsize=(width, height), layout="constrained")
    # IPython asks for this method; matplotlib has it only for figures that are registered with pyplot
    figure._repr_svg_ = partial(_svg, figure)
    figure.add_axobserver(_share_svg)
    return figure


def _share_svg(figure: Any) -> None:
    for axes in figure.axes:
        axes._repr_svg_ = figure.figure._repr_svg_  # a subfigure has none


def _svg(figure: Figure) -> str:
    return rendered(figure, "svg").decode()


def axes_of_dimension(ax: Axes | None, dimension: int, size: float = 4.8) -> Axes:
    """The axes that the caller gives, or else new ones: low for dimension 1, square for 2, in space for 3."""
    solid = dimension == 3
    if ax is None:
        return new_figure(size, 0.4 * size if dimension == 1 else size).add_subplot(
            **({"projection": "3d", "proj_type": "ortho"} if solid else {})
        )
    if solid != (ax.name == "3d"):
        remedy = "in space: add_subplot(projection='3d')" if solid else "in the plane"
        raise InputError(f"this picture has dimension {dimension}, which needs axes {remedy}")
    return ax


def plane_axes(ax: Axes | None, width: float, height: float) -> Axes:
    """The axes in the plane that the caller gives, or else those of a new figure of this size in inches."""
    if ax is None:
        return new_figure(width, height).add_subplot()
    check_straight(ax)
    return axes_of_dimension(ax, 2)


def check_straight(ax: Axes) -> None:
    """Raise `InputError` if axes have polar coordinates."""
    if ax.name == "polar":
        raise InputError("this picture has straight coordinates, which polar axes have not: use add_subplot() for it")


def current_colours() -> tuple[str, ...]:
    """`DARK_COLOURS` if text is light in the current style, as on a dark page, otherwise `COLOURS`."""
    return DARK_COLOURS if _is_dark() else COLOURS


def paper_colour() -> str:
    """The colour, 'white' or 'black', that contrasts with `current_colours`."""
    return "black" if _is_dark() else "white"


def pale_colour() -> str:
    """The grey of grids and other lines in the background, which is near the color of the page."""
    return DARK_PALE if _is_dark() else PALE


def muted_colour() -> str:
    """The gray, `GREY` or `DARK_GREY`, of remarks and unresolved points, which contrasts with the page."""
    return DARK_GREY if _is_dark() else GREY


def _is_dark() -> bool:
    red, green, blue = matplotlib_module("colors").to_rgb(matplotlib_module("").rcParams["text.color"])
    return bool(red + green + blue > 1.5)


def figure_of(axes: Axes) -> Figure:
    """Figure that the axes of the caller belong to."""
    if not isinstance(axes, matplotlib_module("axes").Axes):
        path = f": write path={axes!r}" if isinstance(axes, str | os.PathLike) else ""
        raise InputError(f"expected axes of matplotlib, got {displayed(axes)}{path}")
    return axes.figure.figure  # of axes in a subfigure, the figure that has all of them


def rendered(figure: Figure, kind: str, about: Mapping[str, str] | None = None) -> bytes:
    """Content of a file of this kind, such as "svg", with the same bytes for equal figures."""
    file = io.BytesIO()
    with style_unless(None):
        figure.savefig(file, format=kind, metadata={**UNDATED.get(f".{kind}", {}), **(about or {})} or None)
    return file.getvalue()


def finished(figure: Figure, path: str | os.PathLike[str] | None) -> Figure:
    """The figure, after it is written to a file if a path is given."""
    if path is None:
        return figure
    target = Path(os.fspath(path))
    suffix = target.suffix.lower()
    known = sorted(f".{kind}" for kind in figure.canvas.get_supported_filetypes())
    if suffix not in known:
        raise FormatError(f"{os.fspath(path)!r} is not the name of a plot: it must end in one of {', '.join(known)}")
    check_target(target, force=True)
    write_file(target, rendered(figure, suffix[1:]))
    return figure


def written(axes: Axes, path: str | os.PathLike[str] | None) -> Axes:
    """The axes, after their figure is written to a file if a path is given."""
    finished(figure_of(axes), path)
    return axes


# SVG of a picture for a page of HTML that contains it, instead of a file of its own.

Drawing: TypeAlias = "Callable[[], Axes]"  # A function that draws a picture

_HEAD = re.compile(r"^.*?(?=<svg )", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>|<style.*?</style>", re.DOTALL)
_SIZE = re.compile(r'(?<=<svg )(.*?)width="([0-9.]+)pt" height="([0-9.]+)pt"', re.DOTALL)
_NAMED = re.compile(r'(\bid="|url\(#|href="#)')
_DIGITS = re.compile(r"(\.\d\d)\d+")


def inline_svg(draw: Drawing, name: str, *, dark: bool = False) -> str:
    """An element `svg` for a page of HTML, as a string."""
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
