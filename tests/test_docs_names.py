"""Names in prose lead to the entry that they denote, and to none where they denote several things."""

import re
from pathlib import Path

import pytest

from tests.test_docs import DOCS, resolve
from tests.test_docs_api import api_pages, load

cross_references = load("cross_references")
ERRORS = [f"liehom.base.errors.{name}" for name in api_pages.public_names("liehom.base.errors")]
NAMES = cross_references.Names([*api_pages.entries(), *ERRORS])

DENOTES = {
    "lh.integrate": "liehom.flow.propagation.integrate",
    "liehom.integrate": "liehom.flow.propagation.integrate",
    "lh.propagation.integrate": "liehom.flow.propagation.integrate",
    "liehom.flow.propagation.integration.integrate": "liehom.flow.propagation.integrate",
    "lh.so(3)": "liehom.exact.algebra.so",
    "with lh.limits(seconds=60):": "liehom.base.budget.limits",
    "lh.decide_fullness(lh.Pair(g, h))": "liehom.exact.fullness.decide_fullness",
    "lh.QQ": "liehom.exact.scalars.QQ",
    "lh.LieAlgebra.killing_form": "liehom.exact.algebra.LieAlgebra.killing_form",
    "Pair.is_primitive": "liehom.exact.representations.Pair.is_primitive",
    "NotFull.verify": "liehom.exact.fullness.NotFull.verify",
    "RKMK.prepare": "liehom.flow.steps.Step.prepare",
    "Solution.y": "liehom.flow.run.Solution",
    "g.killing_form()": "liehom.exact.algebra.LieAlgebra.killing_form",
    "rho.isotropy(point)": "liehom.exact.representations.Representation.isotropy",
    "algebra.over(RR)": "liehom.exact.algebra.LieAlgebra.over",
    "atlas.sweep": "liehom.studies.atlas.sweep",
    "decide_fullness": "liehom.exact.fullness.decide_fullness",
    "UndecidedError": "liehom.base.errors.UndecidedError",
    'RKMK("rk4")': "liehom.flow.methods.RKMK",
    "levi_decomposition": "liehom.exact.algebra.LieAlgebra.levi_decomposition",
}
DENOTES_NOTHING = [
    "so",  # a word of two letters
    "so(3)",  # a name of the catalogue
    "affine(so(3))",
    "pair",  # a variable
    "order",  # a parameter of several functions, and a method
    "dimension",  # of many classes
    "Problem",  # of the integrators and of the files
    "np.where",
    "g.no_such_method()",
    "t_eval=None",
    "x + y",
]


@pytest.mark.parametrize("text", DENOTES)
def test_name_denotes_its_entry(text: str) -> None:
    assert NAMES.meant(text) == DENOTES[text]
    assert resolve(DENOTES[text]) is not None


@pytest.mark.parametrize("text", DENOTES_NOTHING)
def test_ambiguous_name_denotes_nothing(text: str) -> None:
    assert NAMES.meant(text) is None


@pytest.mark.parametrize(
    "text", ["lh.no_such_name", "liehom.exact.algebra.no_such_name", "lh.LieAlgebra.no_such_method()"]
)
def test_path_that_leads_nowhere_is_an_error(text: str) -> None:
    with pytest.raises(LookupError, match="no_such"):
        NAMES.meant(text)


def test_docstring_means_members_of_its_own_class_first_and_parameters_never() -> None:
    assert NAMES.meant("order", "liehom.flow.methods.RKMK") == "liehom.flow.methods.RKMK.order"
    assert NAMES.meant("order", "liehom.flow.methods.Composition") is None  # a parameter there
    assert (
        NAMES.meant("quotient", "liehom.exact.algebra.Subalgebra.places") == "liehom.exact.algebra.Subalgebra.quotient"
    )
    assert (
        NAMES.meant("quotient", "liehom.exact.algebra.LieAlgebra.center") == "liehom.exact.algebra.LieAlgebra.quotient"
    )
    assert "ideal" in cross_references.parameters("liehom.exact.algebra.LieAlgebra.quotient")
    assert NAMES.meant("ideal", "liehom.exact.algebra.LieAlgebra.quotient") is None


def test_pages_of_a_package_mean_its_own_names() -> None:
    assert NAMES.meant("chi") is None
    assert NAMES.meant("chi", "liehom.flow.steps") == "liehom.flow.steps.chi"
    assert NAMES.meant("Problem", "liehom.io") == "liehom.io.Problem"


def test_keys_of_files_are_not_names() -> None:
    assert NAMES.meant("structure_constants") == "liehom.exact.algebra.LieAlgebra.structure_constants"
    assert NAMES.meant("structure_constants", bare_names_are_keys=True) is None
    assert NAMES.meant("lh.load", bare_names_are_keys=True) == "liehom.io.load"


def code(path: Path) -> list[str]:
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"`([^`\n]+)`", text)


def test_paths_on_the_pages_lead_somewhere_and_most_to_an_entry() -> None:
    pages = [path for path in DOCS.rglob("*.md") if path.stem != "changelog" and "_" not in path.parts]
    paths = [text for page in pages for text in code(page) if list(NAMES.paths(text))]
    assert len(paths) > 100
    entries = [NAMES.meant(text) for text in paths]
    assert sum(entry is not None for entry in entries) > 0.8 * len(entries)
