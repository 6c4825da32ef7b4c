"""Pictures of the pages: each is on a page, and its program in the gallery draws it."""

import importlib
import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.benchmarks.integration_pictures import RATIOS, picture_name
from tests.benchmarks.integration_problems import problems
from tests.test_docs import DOCS
from tests.test_docs_copied import faults_of_pasting

FAST = ("dynkin_diagrams", "spirals")
"""The pictures that are drawn here, of which one has a helper and colours."""


@pytest.fixture(scope="module")
def pictures() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        module = importlib.import_module("pictures")
        module.load()
        yield module


@pytest.fixture(scope="module")
def script(pictures: Any) -> Callable[[str], str]:
    make = importlib.import_module("picture_source").script
    return lambda name: make(pictures.DRAWN[name])


def test_every_picture_is_on_a_page_with_words_for_those_who_do_not_see_it(pictures: Any) -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(DOCS.rglob("*.md")))
    used = dict(re.findall(r"^`{3,}\{picture\} (\w+)\n:alt: (.*)$", text, flags=re.MULTILINE))
    measured = {"energy_drift", "stability", RATIOS, *map(picture_name, problems())}
    assert set(used) == set(pictures.DRAWN) | measured
    assert min(len(alt) for alt in used.values()) > 20


def test_programs_of_the_gallery_are_complete_and_can_be_pasted(pictures: Any, script: Callable[[str], str]) -> None:
    undefined = importlib.import_module("example_imports").undefined
    for name in pictures.DRAWN:
        program = script(name)
        assert undefined(program) == set(), name
        assert faults_of_pasting(program) == [], name
        assert not re.search(r"^(from|import) pictures", program, flags=re.MULTILINE), (
            "a picture uses its own module only"
        )
        assert program.endswith(f'figure.savefig("{name}.svg")\n')


@pytest.mark.parametrize("name", FAST)
def test_the_program_of_the_gallery_draws_the_picture_of_the_page(
    name: str, pictures: Any, script: Callable[[str], str], tmp_path: Path
) -> None:
    from liehom.plotting.canvas import COLOURS, UNDATED, matplotlib_module

    pictures.write(name, tmp_path / "page.svg", COLOURS, dark=False)
    namespace: dict[str, Any] = {}
    with matplotlib_module("").rc_context():
        exec(script(name).rpartition("figure.savefig")[0], namespace)  # a second drawing would refine the layout
        namespace["figure"].patch.set_alpha(0.0)
        drawn = io.BytesIO()
        namespace["figure"].savefig(drawn, format="svg", metadata=UNDATED[".svg"])
    assert drawn.getvalue() == (tmp_path / "page.svg").read_bytes()


def test_every_line_of_the_quartics_is_in_the_legend_by_its_equation(pictures: Any) -> None:
    figure = importlib.import_module("pictures.strata").binary_quartics([f"C{i}" for i in range(8)])
    drawn = [line for line in figure.axes[0].lines if len(line.get_xdata())]
    lines = {str(line.get_label()): (np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in drawn}
    assert len(lines) == 4 and set(lines) <= {text.get_text() for text in figure.axes[0].get_legend().get_texts()}
    for label, (a, b) in lines.items():
        assert np.allclose(b, 0 if label.startswith(("b = 0", "x⁴")) else 9 * a**2)
        assert ("a > 0" not in label or min(a) >= 0) and ("a < 0" not in label or max(a) <= 0)
