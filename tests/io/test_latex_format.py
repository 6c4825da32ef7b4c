"""LaTeX: what is written, and that a TeX engine for mathematics accepts it."""

from typing import Any

import pytest

import liehom as lh
from liehom import io
from liehom.base import errors

K = lh.number_field("sqrt(2)")
CUBIC = lh.number_field([-2, 0, 0, 1], (1, 2), name="alpha")


def test_brackets_with_signs_fractions_and_radicals() -> None:
    algebra = lh.LieAlgebra(
        {(0, 1): {1: "-1/2", 2: 1}, (0, 2): {1: "sqrt(2) - 1", 2: "-sqrt(2)/3"}}, basis=["h", "e_1", "alpha"]
    )
    assert io.latex(algebra).splitlines()[1:3] == [
        r"[h, e_{1}] &= -\frac{1}{2} e_{1} + \alpha \\",
        r"[h, \alpha] &= \left(-1 + \sqrt{2}\right) e_{1} - \frac{1}{3}\sqrt{2} \alpha",
    ]


def test_an_abelian_algebra_says_that_brackets_vanish() -> None:
    assert "= 0" in io.latex(lh.abelian(2))
    assert "= 0" in io.latex(lh.abelian(0))


def test_the_table_is_antisymmetric() -> None:
    lines = io.latex(lh.so(3), table=True).splitlines()
    assert lines[0] == r"\begin{array}{c|ccc}"
    assert lines[1] == r" & e_{0} & e_{1} & e_{2} \\ \hline"
    assert lines[2] == r"e_{0} & 0 & e_{2} & -e_{1} \\"
    assert lines[3] == r"e_{1} & -e_{2} & 0 & e_{0} \\"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (3, "3"),
        (-2.5e-7, r"-2.5\cdot10^{-7}"),
        (0.125, "0.125"),
        (lh.QQ.convert("-7/3"), r"-\frac{7}{3}"),
        (K.convert("sqrt(2)/2 - 1"), r"-1 + \frac{1}{2}\sqrt{2}"),
        (K.convert(0), "0"),
        (CUBIC.convert("-alpha**2 + 2*alpha"), r"2\alpha - \alpha^{2}"),
    ],
)
def test_numbers(value: Any, text: str) -> None:
    assert io.latex(value) == text


def test_matrices_subalgebras_and_representations() -> None:
    assert io.latex(lh.so(3).killing_form()).splitlines()[1] == r"-2 & 0 & 0 \\"
    assert io.latex(lh.heisenberg(1).center()) == r"\left\langle z \right\rangle"
    assert io.latex(lh.so(3).center()) == r"\{0\}"
    assert io.latex(lh.so(3).subalgebra([[1, "-1/2", 0]])) == r"\left\langle e_{0} - \frac{1}{2} e_{1} \right\rangle"
    assert io.latex(lh.defining(lh.so(2))).startswith("\\begin{aligned}\n\\rho(e_{0}) &= \\begin{pmatrix}")


def test_wide_matrices_are_arrays() -> None:
    """amsmath's matrices end at ten columns."""
    assert "pmatrix" in io.latex(lh.QQ.zeros(2, 10))
    assert io.latex(lh.QQ.zeros(2, 11)).startswith(r"\left(\begin{array}{rrrrrrrrrrr}")


@pytest.mark.parametrize("thing", [None, "x", [1, 2], {}, lh.RR])
def test_other_things_are_refused(thing: Any) -> None:
    with pytest.raises(errors.InputError, match="has no LaTeX"):
        io.latex(thing)


def test_mathematics_is_accepted_by_a_parser_of_tex() -> None:
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    line = io.latex(lh.so(3).subalgebra([[1, "-1/2", "7/3"]]))
    parser.parse(f"${line}$".replace(r"\left\langle", "(").replace(r"\right\rangle", ")"))
    for name in ("e12", "alpha_1", "height", "e+"):
        algebra = lh.LieAlgebra({(0, 1): {0: "sqrt(2) - 1"}}, basis=[name, "z"])
        line = io.latex(algebra).splitlines()[1].replace("&", "").replace(r"\text", r"\mathrm")
        parser.parse(f"${line}$")
