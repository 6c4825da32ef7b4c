"""Bases of the classes that notebooks show as formulas, cards and tables.

IPython asks an object for its methods ``_repr_latex_`` and ``_repr_html_``. The classes of all layers inherit them from
here. The renderers know every class and are therefore above all of them, in `liehom.io`. The two imports below, made
when a notebook asks, are the only ones outside the class files that point upwards; tests/test_layers.py lists them.
"""

from __future__ import annotations

SHOWN_LINES = 8
"""Lines of brackets, and rows and columns of matrices, that a notebook shows."""


class Typeset:
    """Objects that a notebook shows as a formula; `liehom.latex` has it in full.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.heisenberg(1).killing_form().select(rows=[0])._repr_latex_()
    '$\\\\displaystyle \\\\begin{pmatrix}\\n0 & 0 & 0\\n\\\\end{pmatrix}$'
    """

    __slots__ = ()

    def _repr_latex_(self) -> str:
        from liehom.io.latex_format import latex

        return rf"$\displaystyle {latex(self, most=SHOWN_LINES)}$"


class Displayed(Typeset):
    """Objects that a notebook shows as a card: a title, a few facts, and details that unfold.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.simple("E8")._repr_html_()[:60]
    '<div class="liehom"><p><b>Lie algebra e8(8) of dimension 248'
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        from liehom.io.html_format import html

        return html(self)


class DisplayedTable(Displayed):
    """Tables; `_caption`, `_cells` and `_notes` of a derived class are what is shown.

    Examples
    --------
    >>> class Squares(DisplayedTable):
    ...     def _cells(self) -> list[list[str]]:
    ...         return [["n", "n^2"], ["2", "4"]]
    ...
    >>> print(Squares()._repr_latex_())
    $\\displaystyle \\begin{array}{ll}
    \\text{n} & \\text{n\\textasciicircum{}2} \\\\ \\hline
    \\text{2} & \\text{4}
    \\end{array}$
    """

    __slots__ = ()

    def _caption(self) -> str:
        """Line above the table."""
        return ""

    def _cells(self) -> list[list[str]]:
        """Strings of the cells, the head of the table first."""
        raise NotImplementedError

    def _notes(self) -> list[str]:
        """Lines below the table."""
        return []
