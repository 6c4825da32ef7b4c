"""Figures, their style and their files; the one module that loads matplotlib.

The colours are those of Okabe and Ito, which people with any kind of colour vision can distinguish. Lines also differ
in their markers or dashes.
"""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liehom.disk import check_target, write_file
from liehom.errors import FormatError, InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito without yellow, which is pale on white; grey for the background
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
DASHES = ("-", "--", "-.", ":")
GREY, PALE = "#6b6b6b", "#d9d9d9"
DARK_GREY, DARK_PALE = "#999999", "#4a4a4a"
# the same hues, light enough for a dark page
DARK_COLOURS = ("#56B4E9", "#E69F00", "#2ECC9A", "#E59AC4", "#F0E442", "#FF8C5A", "#DDDDDD")

MAX_NAME = 20
"""Characters of a name in a picture."""

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
DARK: dict[str, object] = {
    **dict.fromkeys(TEXT, "#dddddd"),
    "grid.color": "#3a3a3a",
    "axes.edgecolor": DARK_GREY,
    "axes.facecolor": "none",
    "figure.facecolor": "#131416",
}
"""What `style` sets for a dark page, besides `STYLE`."""
# metadata that would contain the time of writing, so that equal plots would be different files
UNDATED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def matplotlib_module(name: str) -> Any:
    """Module of matplotlib such as ``matplotlib_module("figure")``, imported at the first call.

    Raises
    ------
    InputError
        If matplotlib is not installed; names the extra.

    Examples
    --------
    >>> matplotlib_module("figure").__name__  # doctest: +SKIP
    'matplotlib.figure'
    """
    try:
        import_module("matplotlib")
    except ModuleNotFoundError:
        raise InputError("plots need matplotlib: install it with  pip install 'liehom[plot]'") from None
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
    context: AbstractContextManager[None] = matplotlib_module("").rc_context({**STYLE, **(DARK if dark else {})})
    return context


def style_unless(ax: Axes | None) -> AbstractContextManager[object]:
    """The style of the library for new figures, unless `style` is active; for axes that are given, that of the caller.

    Raises
    ------
    InputError
        If `ax` is not None and not axes of matplotlib.
    """
    if ax is not None:
        figure_of(ax)
        return nullcontext()
    return nullcontext() if matplotlib_module("").rcParams["svg.hashsalt"] == STYLE["svg.hashsalt"] else style()


def plain(name: str) -> str:
    """A name as text of a picture: not too long, every character can be written to a file, no dollar begins a formula.

    Examples
    --------
    >>> plain("x_$1$")
    'x_\\\\$1\\\\$'
    """
    short = name if len(name) <= MAX_NAME else f"{name[:MAX_NAME]}..."
    writable = "".join(c if c.isprintable() else "\ufffd" for c in short)
    return writable.replace("$", r"\$")


def new_figure(width: float, height: float) -> Figure:
    """Figure of this size in inches, in no window and not registered with pyplot.

    A notebook shows it, or any of its axes, as a picture if it is the last line of a cell.
    """
    figure: Any = matplotlib_module("figure").Figure(figsize=(width, height), layout="constrained")
    # IPython asks for this method; matplotlib has it only for figures that are registered with pyplot
    figure._repr_svg_ = partial(_svg, figure)
    figure.add_axobserver(_share_svg)
    made: Figure = figure
    return made


def _share_svg(figure: Any) -> None:
    for axes in figure.axes:
        axes._repr_svg_ = figure.figure._repr_svg_  # a subfigure has none


def _svg(figure: Figure) -> str:
    return rendered(figure, "svg").decode()


def axes_of_dimension(ax: Axes | None, dimension: int, size: float = 4.8) -> Axes:
    """The axes that the caller gives, or else new ones: low for dimension 1, square for 2, in space for 3.

    Raises
    ------
    InputError
        If the given axes have another dimension.
    """
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
    """The axes in the plane that the caller gives, or else those of a new figure of this size in inches.

    Raises
    ------
    InputError
        If the given axes are in space, or have polar coordinates.
    """
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
    """Figure that the axes of the caller belong to.

    Raises
    ------
    InputError
        If `axes` are not axes of matplotlib.
    """
    if not isinstance(axes, matplotlib_module("axes").Axes):
        raise InputError(f"expected axes of matplotlib, got {axes!r}")
    figure: Figure = axes.figure.figure  # of axes in a subfigure, the figure that has all of them
    return figure


def rendered(figure: Figure, kind: str, about: Mapping[str, str] | None = None) -> bytes:
    """Content of a file of this kind, such as "svg", with the same bytes for equal figures.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    kind : str
        Suffix of the file without its dot.
    about : dict of str to str, optional
        Metadata of the file, with the keys of its format: `Title`, and `Description` or for PDF `Subject`.
    """
    file = io.BytesIO()
    with style_unless(None):
        figure.savefig(file, format=kind, metadata={**UNDATED.get(f".{kind}", {}), **(about or {})} or None)
    return file.getvalue()


def finished(figure: Figure, path: str | os.PathLike[str] | None) -> Figure:
    """The figure, after it is written to a file if a path is given.

    Raises
    ------
    FormatError
        If matplotlib has no format with this suffix, the folder does not exist, or the file cannot be written.
    """
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
