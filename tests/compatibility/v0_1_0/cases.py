"""What the files of version 0.1.0 hold, by names that every version has: objects, certificates, runs, stores."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import liehom as lh
from liehom.errors import DependentRowsError, JacobiError
from tests.results.integrations import STEPS, TIMES, energy, sphere
from tests.results.values import Numbers, flat

POINT = np.array([0.6, 0.0, 0.8])
SPINNING = ["-m0", "-m1/2 + sin(t)/5", "-m2/4"]


class Case(NamedTuple):
    """An object, and what is asked of it: plain values that must be the same for the object that is read."""

    make: Callable[[], Any]
    ask: Callable[[Any], Any]


def text(x: Any) -> Any:
    return str(x), repr(x)


def answers(*names: str) -> Callable[[Any], Any]:
    """The values of attributes, and of methods without parameters, as strings."""

    def ask(x: Any) -> Any:
        found = (getattr(x, name) for name in names)
        return [str(value() if callable(value) else value) for value in found]

    return ask


def as_json(x: Any) -> Any:
    return json.dumps(lh.to_json(x), sort_keys=True)


def verdict(x: Any) -> Any:
    return json.dumps(x.to_json(), sort_keys=True), str(x)


def numerical(x: Any) -> Any:
    """Without the numbers and the sentence, which say by which method they were found."""
    return x.full, sorted(x.to_json()), str(x).split(":")[0], x.gap > 100


def proved(x: Any) -> Any:
    return verdict(x), x.verify()


def field() -> Any:
    return lh.GeneratorField(lh.adjoint(lh.so(3)), SPINNING)


def free() -> Any:
    return lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])


def moved(x: Any) -> Any:
    """Where a generator field, a step or a space takes a point, as bytes."""
    if isinstance(x, lh.GeneratorField):
        return Numbers(x.psi(POINT, 0.5)).short(), Numbers(x.vector(POINT, 0.5)).short()
    run = lh.integrate(field(), (0, 1), POINT, step=x, dt=0.25)
    return Numbers(run.y).short(), str(run.report), repr(x)


def conserved(x: Any) -> Any:
    run = lh.integrate(free(), (0, 1), POINT, step=x, dt=0.1)
    return Numbers(run.y).short(), str(run.report)


def solution(x: Any) -> Any:
    arrays = [Numbers(x.t).short(), Numbers(x.y).short(), Numbers(x.n_steps).short(), Numbers(x.statuses).short()]
    events = None if x.t_events is None else [list(flat(np.asarray(a))) for a in x.t_events]
    dense = None if x.sol is None else Numbers(x.sol(np.linspace(0.0, 1.0, 5))).short()
    return arrays, events, dense, x.nfev, x.status, x.message, str(x.report)


def solved(**options: Any) -> Any:
    return lh.integrate(field(), (0, 1), POINT, **options)


def sphere_over_a_number_field() -> Any:
    return lh.Pair(lh.so(3).over(lh.number_field("sqrt(2)")), [[0, 0, 1]])


def not_full_over_a_number_field() -> Any:
    name = "affine(form(1,-2))"
    g, h = lh.pair(name).algebra, lh.pair(name).subalgebra
    wider = lh.number_field("sqrt(3)")
    return lh.Pair(g.over(wider), wider.matrix(h.basis.to_rows(), (h.dimension, g.dimension)))


def in_floats() -> Any:
    return lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]], name="sphere in floats")


def decided(name: str) -> Callable[[], Any]:
    return lambda: lh.decide_fullness(lh.pair(name))


def twisted() -> Any:
    """An algebra without a name, with denominators."""
    return lh.so(3).change_of_basis([[1, "1/2", 0], [0, "2/3", 1], [1, 0, -1]])


EXACT = lh.scalars.exact_value
OBJECTS: dict[str, Case] = {
    # numbers, fields, matrices
    "integer": Case(lambda: lh.QQ.convert(-7), text),
    "fraction": Case(lambda: lh.QQ.convert("-1/3"), text),
    "root": Case(lambda: EXACT("sqrt(2)/2"), text),
    "nested root": Case(lambda: EXACT("1/2 + sqrt(2 + sqrt(3))"), text),
    "QQ": Case(lambda: lh.QQ, lambda x: (repr(x), x == lh.QQ)),
    "RR": Case(lambda: lh.RR, lambda x: (repr(x), x == lh.RR)),
    "number field": Case(lambda: lh.number_field("sqrt(2)"), lambda x: (repr(x), x == lh.number_field("sqrt(2)"))),
    "cubic field": Case(lambda: lh.NumberField("a", [-2, 0, 0, 1], (1, 2)), answers("name", "minpoly", "interval")),
    "matrix": Case(
        lambda: lh.QQ.matrix([["1/2", 0, -2], [0, 3, 0]]), lambda x: (str(x), x.rank(), str(x.null_space()))
    ),
    "matrix over a number field": Case(
        lambda: lh.number_field("sqrt(2)").matrix([["sqrt(2)", 1], [2, "sqrt(2)"]]), lambda x: (str(x), x.rank())
    ),
    "matrix of floats": Case(lambda: lh.RR.matrix([[1.0, 2.0], [3.0, 5.0]]), lambda x: (str(x), x.rank())),
    "subspace": Case(
        lambda: lh.Subspace(lh.QQ, lh.QQ.matrix([[1, 2, 0], [0, 0, 1]]), 3), answers("basis", "dimension")
    ),
    "jet": Case(lambda: np.sin(lh.Jet.variable(0.5, 4)), lambda x: Numbers(np.array(x.coefficients)).short()),
    # algebras
    "sl(2)": Case(lambda: lh.sl(2), lambda x: (as_json(x), x.killing_signature(), x.describe())),
    "so(3,1)": Case(lambda: lh.so(3, 1), lambda x: (as_json(x), x.real_form(), repr(x))),
    "twisted": Case(twisted, lambda x: (as_json(x), x.describe())),
    "algebra over a number field": Case(lambda: lh.sl(2).over(lh.number_field("sqrt(2)")), as_json),
    "algebra over floats": Case(lambda: lh.so(3).over(lh.RR), as_json),
    "catalogue algebra": Case(lambda: lh.catalog.algebra("g2"), lambda x: (as_json(x), repr(x))),
    "subalgebra": Case(lambda: lh.gl(3).radical(), answers("basis", "dimension", "is_ideal")),
    "Levi decomposition": Case(
        lambda: lh.euclidean(3).levi_decomposition(), lambda x: (str(x.levi.basis), str(x.radical.basis))
    ),
    "Cartan decomposition": Case(
        lambda: lh.sl(3).cartan_decomposition(), lambda x: (str(x.k.basis), str(x.p.basis), str(x.theta))
    ),
    "root space decomposition": Case(
        lambda: lh.sl(3).root_space_decomposition(), lambda x: (str(x.cartan.basis), len(x.spaces))
    ),
    "derivations": Case(lambda: lh.heisenberg(1).derivations(), answers("dimension")),
    "cohomology": Case(lambda: lh.heisenberg(1).cohomology(1), answers("dimension")),
    "root system": Case(
        lambda: lh.sl(3).root_system(), answers("type", "roots", "highest_roots", "weyl_group_order", "simple_roots")
    ),
    "real form": Case(lambda: lh.su(2, 1).real_forms()[0], answers("name", "restricted_type", "multiplicities")),
    # representations and pairs
    "representation": Case(lambda: lh.defining(lh.so(3)), lambda x: (as_json(x), repr(x))),
    "adjoint representation": Case(lambda: lh.adjoint(lh.sl(2)), as_json),
    "highest weight module": Case(
        lambda: lh.highest_weight_module("A2", (1, 1)), lambda x: (repr(x), as_json(x.representation))
    ),
    "decomposition": Case(
        lambda: lh.defining(lh.so(3)).tensor(lh.defining(lh.so(3))).decomposition(), lambda x: (repr(x), str(x))
    ),
    "pair": Case(lambda: lh.pair("so(4)/so(3)"), lambda x: (as_json(x), repr(x), x.dimension)),
    "pair of P1": Case(lambda: lh.pair("sl(3)/P1"), lambda x: ([str(m) for m in x.isotropy_matrices()], repr(x))),
    "pair over a number field": Case(sphere_over_a_number_field, lambda x: (as_json(x), x.dimension)),
    "pair over floats": Case(in_floats, lambda x: (repr(x), x.dimension)),
    # verdicts
    "full": Case(decided("so(4)/so(3)"), proved),
    "trivially full": Case(decided("so(2)/so(1)"), proved),
    "not full": Case(decided("so(3,1)/so(2,1)"), proved),
    "not full by the commutant": Case(decided("affine(field(1,1,1,1))"), proved),
    "not full over a number field": Case(lambda: lh.decide_fullness(not_full_over_a_number_field()), proved),
    "numerically full": Case(lambda: lh.decide_fullness(in_floats()), numerical),
    "numerically not full": Case(
        lambda: lh.decide_fullness(lh.Pair(lh.so(2, 1).over(lh.RR), [[0.0, 0.0, 1.0]])), numerical
    ),
    "certificate": Case(lambda: lh.decide_fullness(lh.pair("g2/su(3)")).certificate, lambda x: (x.to_json(), str(x))),
    "atlas": Case(
        lambda: lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"]),
        lambda x: (x.to_json(), str(x), [entry.verify() for entry in x]),
    ),
    # fields and steps
    "generator field of strings": Case(field, moved),
    "generator field of an array": Case(
        lambda: lh.GeneratorField(lh.defining(lh.so(3)), np.array([1.0, 0.0, 2.0])), moved
    ),
    "generator field of a function": Case(lambda: lh.GeneratorField(lh.defining(lh.so(3)), np.sin), moved),
    "generator field of a vector field": Case(
        lambda: lh.GeneratorField.from_vector_field(lh.adjoint(lh.so(3)), ["m1", "-m0", "0"]), moved
    ),
    "action": Case(
        lambda: lh.Action(lh.defining(lh.so(3)), "cayley"),
        lambda x: Numbers(x.act(np.array([0.1, 0.2, 0.3]), POINT)).short(),
    ),
    "tableau": Case(lambda: lh.tableau("rk45"), lambda x: (repr(x), x.order, str(x.a), str(x.b), str(x.c))),
    **{f"step {name}": Case(STEPS[name], moved) for name in STEPS if "energy" not in name},
    "conserving step": Case(lambda: lh.Conserving(lh.Heun(), energy), conserved),
    "conserving step of a string": Case(lambda: lh.Conserving(lh.Heun(), "m0**2 + m1**2/2 + m2**2/4"), conserved),
    # solutions
    "solution": Case(lambda: solved(dt=0.125, step=lh.Corrected(lh.Euler(), 3)), solution),
    "adaptive solution": Case(lambda: solved(rtol=1e-7, step=lh.RKMK("rk45"), dense_output=True), solution),
    "solution with energy": Case(
        lambda: lh.integrate(free(), (0, 1), POINT, step=lh.Conserving(lh.Heun(), energy), dt=0.1), solution
    ),
    "ensemble solution": Case(
        lambda: lh.integrate(field(), (0, 1), sphere(3, 4), step=lh.LieTaylor(6), t_eval=np.array([0.5, 1.0])), solution
    ),
    "report": Case(lambda: solved(dt=0.25, step=lh.Corrected(lh.Heun(), 3)).report, text),
    # systems of the paper
    "sphere": Case(lambda: lh.Sphere(3), repr),
    "rigid body": Case(lambda: lh.RigidBody([1.0, 2.0, 3.0]), lambda x: (repr(x), Numbers(x.vector(POINT)).short())),
    "symmetric matrices": Case(
        lambda: lh.SymmetricMatrices(3), lambda x: (repr(x), Numbers(x.to_matrix(np.arange(6.0))).short())
    ),
    "exact orbit": Case(lambda: lh.instances.ExactOrbit(lh.RigidBody([1, 2, 3])), lambda x: (repr(x), repr(x.order))),
    # errors
    "Jacobi error": Case(lambda: JacobiError((0, 1, 2), {0: "1"}, ("a", "b", "c")), lambda x: (str(x), vars(x))),
    "dependent rows error": Case(lambda: DependentRowsError(1, [2]), lambda x: (str(x), vars(x))),
}

CERTIFICATES = {
    "trivial": "so(2)/so(1)",
    "full": "f4/spin(9)",
    "witness": "so(3,1)/so(2,1)",
    "commutant": "affine(field(1,1,1,1))",
    "witness and dominance": "affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))",
}
ATLAS = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1", "affine(field(1,1,1,1))"]


class Run(NamedTuple):
    """An integration: problem and step by their names, and options."""

    problem: str
    step: str
    span: tuple[float, float]
    options: dict[str, Any]


RUNS: dict[str, Run] = {
    "fixed": Run("forced", "Euler to 3", (0, 3), {"dt": 0.1}),
    "adaptive": Run("body", "Taylor 6", (0, 10), {"rtol": 1e-8}),
    "dense": Run("forced", "RK45", (0, 3), {"rtol": 1e-6, "dense_output": True}),
    "ensemble": Run("many forced", "Taylor 3", (0, 3), {"rtol": 1e-5, "t_eval": TIMES}),
    "nominal": Run("many forced", "Euler to 3", (0, 2), {"dt": 0.1, "clock": "nominal"}),
    "conserving": Run("body", "Heun with energy", (0, 5), {"dt": 0.1}),
    "conserving corrected": Run("an equilibrium among others", "Euler to 2 with energy", (0, 2), {"dt": 0.1}),
    "compiled": Run("many forced", "RK4", (0, 3), {"dt": 0.05, "t_eval": TIMES, "compile": True}),
    "compiled adaptive": Run("many forced", "RK45", (0, 3), {"rtol": 1e-6, "t_eval": TIMES, "compile": True}),
}


def ensemble(store: Any, **options: Any) -> Any:
    """An ensemble in three chunks, kept in a store."""
    return lh.integrate_ensemble(
        field(), (0, 1), sphere(3, 6, seed=2), chunk=2, store=store, step=lh.RKMK("rk4"), dt=0.25, **options
    )
