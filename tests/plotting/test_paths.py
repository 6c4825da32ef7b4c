"""Every plot function writes its picture to a path, and refuses other kinds of files before it draws over one."""

import inspect

import numpy as np
import pytest

import liehom as lh
from liehom import plotting

BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
SOLUTION = lh.integrate(BODY, (0, 1), [0.6, 0, 0.8], dt=0.5, step="euler")
SPECTRUM = lh.integrate(
    lh.GeneratorField(lh.sym_conjugation(2), lambda m: m[..., :1]), (0, 1), [1.0, 0.5, 2.0], dt=0.5, step="euler"
)

CALLS = {
    "plot_bracket_table": (lh.so(3),),
    "plot_convergence": None,  # has a test of its own
    "plot_dynkin": ("A3",),
    "plot_eigenvalues": (),
    "plot_energy_drift": ({"Euler": SOLUTION}, lambda m: (m * m).sum(-1)),
    "plot_failure_cone": (lh.pair("so(3,1)/so(2,1)"),),
    "plot_phase_portrait": (BODY,),
    "plot_quadric": (np.diag([1, 1, -1]), [1, 0, 0]),
    "plot_root_system": ("A2",),
    "plot_satake": ("su(2,1)",),
    "plot_spectrum": (SPECTRUM,),
    "plot_trajectory": (SOLUTION,),
    "plot_vogan": ("su(2,1)",),
    "plot_weights": ("A2", [1, 0]),
    "plot_weyl_chamber": ("A2",),
    "plot_work_precision": None,  # has a test of its own
}


def test_every_plot_function_is_here():
    drawing = {name for name in plotting.__all__ if name.startswith("plot_")}
    assert drawing == set(CALLS)
    assert all("path" in inspect.signature(getattr(plotting, name)).parameters for name in drawing)


@pytest.mark.parametrize("name", [name for name, arguments in CALLS.items() if arguments is not None])
def test_the_picture_is_written(name, tmp_path):
    target = tmp_path / "picture.svg"
    getattr(plotting, name)(*CALLS[name], path=target)
    assert target.read_text(encoding="utf-8").rstrip().endswith("</svg>")
    with pytest.raises(lh.FormatError, match="not the name of a plot"):
        getattr(plotting, name)(*CALLS[name], path=tmp_path / "picture.doc")
    assert list(tmp_path.iterdir()) == [target]
