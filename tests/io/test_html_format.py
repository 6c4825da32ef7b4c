"""Rich display: what notebooks are handed is short, well-formed and escaped, for every class that they show."""

import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

import liehom as lh
from liehom import paper, pauli
from liehom.base.objects import Displayed, DisplayedTable, Typeset
from liehom.io.renderings import html
from tests.clock import seconds
from tests.html_structure import Balance

FIELD = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/2"])
EVIL = "</div><script>alert(1)</script> & $x$ \\evil{"

SAMPLES: dict[str, Callable[[], object]] = {
    "LieAlgebra": lambda: lh.so(4),
    "LieAlgebraFamily": lambda: lh.algebra.LieAlgebraFamily({("x", "y"): {"z": "a"}}, ["a"]),
    "Homomorphism": lambda: lh.algebra.Homomorphism(lh.gl(2), lh.abelian(1), [[1, 0, 0, 1]]),
    "Subalgebra": lambda: lh.so(3).subalgebra([[1, "-1/2", 0]]),
    "Representation": lambda: lh.defining(lh.so(3)),
    "Pair": lambda: lh.pair("so(4)/so(3)"),
    "Full": lambda: lh.decide_fullness(lh.pair("so(4)/so(3)")),
    "NotFull": lambda: lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")),
    "NumericallyFull": lambda: lh.decide_fullness(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]])),
    "NumericallyNotFull": lambda: lh.decide_fullness(lh.Pair(lh.abelian(2).over(lh.RR), [])),
    "NumericallyUndecided": lambda: lh.decide_fullness(
        lh.Pair(lh.LieAlgebra({(0, 1): {2: 1.0}, (0, 2): {1: -1e-9}}, dimension=3), [[1, 0, 0]])
    ),
    "Certificate": lambda: lh.decide_fullness(lh.pair("so(4)/so(3)")).certificate,
    "Classification": lambda: lh.classify(lh.pair("so(6)/u(3)")),
    "RangeClassification": lambda: lh.classify_range(lh.pair("so(6)/u(3)")),
    "FailureReport": lambda: lh.failure_report(lh.pair("so(3,1)/so(2,1)")),
    "RootSystem": lambda: lh.root_system("B2"),
    "RealForm": lambda: lh.RealForm.of_name("so(4,1)"),
    "Decomposition": lambda: lh.defining(lh.so(3)).tensor(lh.defining(lh.so(3))).decomposition(),
    "HighestWeightModule": lambda: lh.highest_weight_module("A2", [1, 0]),
    "Branching": lambda: lh.branching_rule("E6", "so(10)+u(1)")([1, 0, 0, 0, 0, 0]),
    "RealModule": lambda: lh.real_module("su(2,1)", [1, 0]),
    "Stratum": lambda: lh.symmetric_strata(3)[1],
    "Subspace": lambda: lh.scalars.Subspace(lh.QQ, [[1, 2]], 2),
    "Solution": lambda: lh.integrate(FIELD, (0, 1), [1.0, 0.0], dt=0.25),
    "Tableau": lambda: lh.tableau("rk4"),
    "ConvergenceTable": lambda: lh.observed_order(FIELD, [1.0, 0.0], lh.Euler(), [0.1, 0.05]),
    "Atlas": lambda: lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"]),
    "WorkPrecisionTable": lambda: lh.work_precision(FIELD, ["rk4"], (0, 1), [1.0, 0.0], dts=[0.5, 0.25]),
    "Table": lambda: paper.Table("errors", ("dt", "a < b"), [(0.1, 1.25e-7)]),
    "DynamicalLieAlgebra": lambda: pauli.closure(["XX", "ZI", "IZ"]),
    "ExactMatrix": lambda: lh.so(3).killing_form(),
    "FloatMatrix": lambda: lh.RR.matrix([[0.5, 1.0]]),
    "LinearCombination": lambda: lh.so(3).show([1, "-1/2", 0]),
    "AlgebraicNumber": lambda: lh.number_field("sqrt(2)").convert("sqrt(2)/2 - 1"),
}
FORMULAS_ONLY = {"ExactMatrix", "FloatMatrix", "LinearCombination", "AlgebraicNumber"}
EVERY = pytest.mark.parametrize("name", SAMPLES)
CARDS = pytest.mark.parametrize("name", sorted(SAMPLES.keys() - FORMULAS_ONLY))


@cache
def sample(name: str) -> Typeset:
    found = SAMPLES[name]()
    assert isinstance(found, Typeset)
    assert type(found).__name__ == name
    return found


def is_balanced(text: str) -> bool:
    """Whether braces balance, those after a backslash not counted, and environments end in the order they begin."""
    depth, environments, i = 0, [], 0
    while i < len(text):
        if text[i] == "\\":
            for word in ("begin", "end"):
                if text.startswith(f"{word}{{", i + 1):
                    name = text[i + len(word) + 2 : text.index("}", i)]
                    if word == "begin":
                        environments.append(name)
                    elif not environments or environments.pop() != name:
                        return False
            i += 1
        depth += {"{": 1, "}": -1}.get(text[i], 0) * (text[i - 1 : i] != "\\")
        if depth < 0:
            return False
        i += 1
    return depth == 0 and not environments


def public_classes() -> Iterator[type]:
    for owner in (lh, *(value for name in dir(lh) if isinstance(value := getattr(lh, name), ModuleType))):
        for value in (getattr(owner, name) for name in dir(owner)):
            if isinstance(value, type) and value.__module__.startswith("liehom."):
                yield value


def test_every_public_class_that_notebooks_show_has_a_sample_here() -> None:
    shown = {cls.__name__ for cls in public_classes() if issubclass(cls, Typeset)} - {"Matrix"}
    assert shown <= SAMPLES.keys(), f"add a sample: {sorted(shown - SAMPLES.keys())}"


@EVERY
def test_latex_is_one_formula_with_balanced_braces(name: str) -> None:
    text = sample(name)._repr_latex_()
    assert text.startswith(r"$\displaystyle ")
    assert text.endswith("$")
    assert is_balanced(text)
    assert "$" not in text[1:-1].replace(r"\$", "")
    assert len(text) < 5000
    assert is_balanced(lh.latex(sample(name)))


@CARDS
def test_html_is_well_formed_and_short(name: str) -> None:
    obj = sample(name)
    assert isinstance(obj, Displayed)
    text = obj._repr_html_()
    assert Balance(text).seen[0] == "div"
    assert len(text) < 5000


def test_the_controls_find_what_is_not_balanced() -> None:
    assert not is_balanced(r"\text{a")
    assert not is_balanced(r"\begin{aligned} \end{pmatrix}")
    assert is_balanced(r"\text{a\{} \begin{aligned} x \end{aligned}")
    with pytest.raises(AssertionError):
        Balance("<div><p></div>")


@pytest.mark.parametrize("name", sorted(FORMULAS_ONLY))
def test_matrices_elements_and_numbers_are_shown_as_formulas_alone(name: str) -> None:
    assert not hasattr(sample(name), "_repr_html_")


# -- names that try to break out -------------------------------------------------------------------------------
def evil_objects() -> Iterator[Typeset]:
    algebra = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}, basis=[EVIL, "y", "z"], name=EVIL)
    pair = lh.Pair(algebra, [[0, 0, 1]], name=EVIL)
    yield algebra
    yield algebra.subalgebra([[1, 0, 0]])
    yield lh.algebra.Homomorphism.identity(algebra)
    yield lh.Representation(algebra, lh.adjoint(algebra).matrices, name=EVIL)
    yield pair
    yield lh.decide_fullness(pair)
    yield paper.Table(EVIL, (EVIL, "x"), [(EVIL, 1.0)])
    yield lh.methods.Tableau([[0]], [1], 1, name=EVIL)


def test_names_are_escaped() -> None:
    for obj in evil_objects():
        assert isinstance(obj, Displayed)
        assert "script" not in Balance(obj._repr_html_()).seen, type(obj)
        outside = re.sub("<pre>.*?</pre>", "", obj._repr_html_(), flags=re.DOTALL)  # where MathJax reads no formulas
        assert not set("$\\") & set(re.sub(r"<span>[$\\]</span>", "", outside)), "a notebook would read a formula"
        latex = obj._repr_latex_()
        assert is_balanced(latex)
        assert r"\evil" not in latex


def test_an_escaped_name_is_still_read() -> None:
    assert "a < b & c" in Balance(lh.LieAlgebra({}, dimension=1, name="a < b & c")._repr_html_()).text


def test_long_names_are_cut() -> None:
    assert len(lh.LieAlgebra({}, dimension=1, name="x" * 10**5)._repr_html_()) < 5000
    assert len(lh.LieAlgebra({}, dimension=1, name="x" * 10**5, basis=["y" * 10**5])._repr_html_()) < 5000


# -- what is said ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("name", "sentence"), [("Full", "is full."), ("NotFull", "is not full.")])
def test_a_verdict_shows_sentence_kind_and_a_collapsed_certificate(name: str, sentence: str) -> None:
    verdict = sample(name)
    assert isinstance(verdict, lh.fullness.Full | lh.fullness.NotFull)
    page = Balance(verdict._repr_html_())
    assert f"The pair {verdict.pair.name} {sentence}" in page.text
    assert f"kind '{verdict.certificate.kind}'" in page.text
    assert "details" in page.seen
    assert str(verdict.certificate).splitlines()[1] in page.text


@pytest.mark.parametrize("name", ["NumericallyFull", "NumericallyNotFull", "NumericallyUndecided"])
def test_a_numerical_verdict_says_that_it_is_not_proved(name: str) -> None:
    verdict = sample(name)
    assert isinstance(verdict, Displayed)
    assert "not proved" in Balance(verdict._repr_html_()).text
    assert "numerical" in verdict._repr_latex_()


@pytest.mark.parametrize("name", ["ConvergenceTable", "WorkPrecisionTable", "Atlas", "Table"])
def test_tables_show_their_cells(name: str) -> None:
    table = sample(name)
    assert isinstance(table, DisplayedTable)
    page = Balance(table._repr_html_())
    for cell in (cell for row in table._cells() for cell in row):
        assert cell in page.text
    assert page.seen.count("tr") == len(table._cells())
    assert page.text.startswith(table._caption())


def test_a_convergence_table_names_its_method() -> None:
    table = sample("ConvergenceTable")
    assert isinstance(table, DisplayedTable)
    assert table._caption().startswith("Euler")
    assert str(table).startswith(table._caption())


def test_long_tables_say_how_many_rows_are_left_out() -> None:
    table = paper.Table("many", ("n",), [(n,) for n in range(1000)])
    assert "980 further rows" in table._repr_html_()
    assert table._repr_latex_().count(r"\\") == 9
    assert lh.latex(table).count(r"\\") == 1000


def test_formulas_of_named_objects() -> None:
    assert lh.latex(lh.pair("so(4,1)/so(4)")) == r"\mathfrak{so}(4,1)/\mathfrak{so}(4)"
    assert lh.latex(lh.root_system("B2")).startswith(r"B_{2} \colon\; \begin{pmatrix}")
    assert lh.latex(lh.RealForm.of_name("e6(-26)")) == r"\mathfrak{e}_{6}(-26)"


def test_formulas_of_elements() -> None:
    g = lh.heisenberg(1).over(lh.number_field("sqrt(2)"))
    assert lh.latex(g.show(["-1/2", 0, "1 + sqrt(2)"])) == r"-\frac{1}{2} x_{1} + \left(1 + \sqrt{2}\right) z"
    assert lh.latex(g.show([0, 0, 0])) == "0"
    assert lh.latex(g.over(lh.RR).show([0.5, 0.0, -1e-9])) == r"0.5 x_{1} - 1\cdot10^{-9} z"


@pytest.mark.parametrize(
    ("name", "formula"),
    [
        ("LieAlgebraFamily", r"\begin{aligned} [x, y] &= a z \end{aligned}"),
        (
            "FailureReport",
            r"\text{(6.3) fails on }\;\begin{aligned} &x_{0}^{2} + x_{1}^{2} - x_{2}^{2} = 0 \end{aligned}",
        ),
        ("Decomposition", r"\mathbf{1} \oplus \mathbf{3} \oplus \mathbf{5}"),
        ("HighestWeightModule", r"V_{(1, 0)}(A_{2}), \quad \dim V = 3"),
        ("RealModule", r"V_{(1, 0)}(\mathfrak{su}(2,1)), \quad \dim V = 6, \quad \operatorname{End} V = \mathbb{C}"),
        ("Stratum", r"\text{(2, 1)} \colon\; \dim G m = 2, \; \mathfrak{g}_{m} \cong \mathbb{R}"),
        ("Subspace", r"\left\langle (1, 2) \right\rangle"),
        ("Solution", r"y(1) = \left(0.218704, 0.975791\right)"),
    ],
)
def test_formulas_of_modules_families_strata_reports_and_solutions(name: str, formula: str) -> None:
    assert lh.latex(sample(name)).replace("\n", " ") == formula


def test_formulas_of_decompositions_have_multiplicities_and_dots() -> None:
    rho = lh.defining(lh.so(3))
    found = rho.tensor(rho).tensor(rho).decomposition()
    assert lh.latex(found) == r"\mathbf{1} \oplus 3 \,\mathbf{3} \oplus 2 \,\mathbf{5} \oplus \mathbf{7}"
    assert lh.latex(found, most=2) == r"\mathbf{1} \oplus 3 \,\mathbf{3} \oplus \dots"


def test_formulas_of_tableaux_leave_zeros_on_and_above_the_diagonal_out() -> None:
    lines = lh.latex(lh.tableau("rk4")).splitlines()
    assert lines[0] == r"\begin{array}{c|cccc}"
    assert lines[3] == r"\frac{1}{2} & 0 & \frac{1}{2} &  &  \\"
    assert lines[5] == r" & \frac{1}{6} & \frac{1}{3} & \frac{1}{3} & \frac{1}{6}"
    assert lh.latex(lh.tableau("rk45")).count("\\hline\n") == 1
    assert len(lh.latex(lh.tableau("rk45")).splitlines()) == 7 + 2 + 2


def test_a_report_of_a_pair_without_directions_says_so() -> None:
    verdict = lh.decide_fullness(lh.pair("su(3)/su(2)"))
    assert isinstance(verdict, lh.fullness.NotFull)
    assert lh.latex(verdict.where_it_fails()) == r"\text{(6.3) holds for no }\psi"
    point = lh.decide_fullness(lh.pair("so(3)/so(3)"))
    assert isinstance(point, lh.fullness.Full)
    assert lh.latex(point.where_it_fails()) == r"\text{(6.3) holds for every }\psi"


def test_a_report_shows_the_equation_of_zeros_of_codimension_2() -> None:
    verdict = lh.decide_fullness(lh.pair("sl(3,C)/P{1,2}"))
    assert isinstance(verdict, lh.fullness.NotFull)
    assert r"&x_{2}^{2} + x_{3}^{2} = 0 \\" in lh.latex(verdict.where_it_fails()).splitlines()


def test_most_cuts_and_none_does_not() -> None:
    matrix = lh.QQ.matrix([[1, 2, 3], [4, 5, 6]])
    assert lh.latex(matrix, most=2).splitlines()[1:-1] == [r"1 & 2 & \cdots \\", r"4 & 5 & \cdots"]
    assert lh.latex(matrix, most=3) == lh.latex(matrix)
    assert lh.latex(lh.so(4), most=12) == lh.latex(lh.so(4))
    assert lh.latex(lh.so(4), most=11).splitlines()[:-2] == lh.latex(lh.so(4)).splitlines()[:-2]
    assert lh.latex(lh.so(4).subalgebra([[1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1]]), most=1).count(r"\dots") == 1


def test_dimension_248_is_shown_in_100_ms_and_5_kB() -> None:
    for obj in [lh.simple("E8"), lh.adjoint(lh.simple("E8")), lh.root_system("E8"), lh.simple("E8").killing_form()]:
        for show in [obj._repr_latex_, *([obj._repr_html_] if isinstance(obj, Displayed) else [])]:
            assert len(show()) < 5000
            assert seconds(show) < 0.1


@pytest.mark.parametrize("obj", ["<i>", None, 3])
def test_other_objects_are_shown_by_their_repr(obj: object) -> None:
    assert repr(obj).removeprefix("<").removesuffix(">") in Balance(html(obj)).text


@EVERY
def test_ipython_finds_the_methods(name: str) -> None:
    formatters = pytest.importorskip("IPython.core.formatters")
    data, _ = formatters.DisplayFormatter().format(sample(name), include={"text/html", "text/latex"})
    assert data.keys() == ({"text/latex"} if name in FORMULAS_ONLY else {"text/html", "text/latex"})


def test_the_card_of_the_docs_is_the_one_that_is_made() -> None:
    page = Path(__file__).resolve().parents[2] / "docs" / "notebooks" / "index.md"
    shown = page.read_text(encoding="utf-8").partition("```{raw} html\n")[2].partition("\n```")[0]
    assert shown == html(lh.decide_fullness(lh.pair("so(3)/so(2)")))


def test_sentences_of_verdicts_are_not_cut() -> None:
    for name in ("Full", "NotFull", "NumericallyFull", "NumericallyNotFull", "NumericallyUndecided"):
        verdict = sample(name)
        assert isinstance(verdict, Displayed)
        assert getattr(verdict, "reason") in Balance(verdict._repr_html_()).text  # noqa: B009
