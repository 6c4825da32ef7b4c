"""Lemma 2 on submanifolds of any dimension: orbits, level sets, embeddings."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.steps.curvature import Submanifold, curvature_defect, geodesic_curvature
from liehom.flow.steps.step import Generator
from liehom.studies.spheres import Sphere


def torus(q: Any) -> Any:
    r = 2 + np.cos(q[..., 1])
    return np.stack([r * np.cos(q[..., 0]), r * np.sin(q[..., 0]), np.sin(q[..., 1])], axis=-1)


def on_torus(m: Any) -> Any:
    return (np.sqrt(m[..., 0] ** 2 + m[..., 1] ** 2) - 2) ** 2 + m[..., 2] ** 2


def quadratic_field(rho: lh.Representation, seed: int) -> lh.GeneratorField:
    rng = np.random.default_rng(seed)
    first, second = rng.normal(size=(2, rho.algebra.dimension, rho.size)) / rho.size
    constant = rng.normal(size=rho.algebra.dimension)
    return lh.GeneratorField(rho, lambda m: constant + m @ first.T + (m * m) @ second.T)


SPACES: dict[str, tuple[lh.Representation, Any]] = {
    "S^2": (lh.defining(lh.so(3)), [0.6, 0.48, 0.64]),
    "S^3": (lh.defining(lh.so(4)), [0.5, 0.1, 0.7, 0.5]),
    "hyperboloid": (lh.defining(lh.so(2, 1)), [0.3, 0.4, np.sqrt(1.25)]),
    "RP^2 in Sym(3)": (lh.sym_conjugation(3), [1.0, 0.0, 0.0, 1.0, 0.0, 2.0]),
}


def start(name: str) -> tuple[lh.Representation, Any]:
    rho, m = SPACES[name]
    return rho, np.array(m, dtype=float)


def expansion(field: lh.GeneratorField, step: lh.Step, m: Any, n: int) -> lh.Jet:
    action = lh.Action(field.representation)
    dimension = lh.flow.action.field.check_point(field.representation, m)
    return lh.steps.step_series(action, step.at(action, Generator(field, dimension), m, np.zeros(1)), m, n)


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("name", ["S^2", "S^3", "hyperboloid", "RP^2 in Sym(3)"])
def test_lemma_2_on_orbits(name: str, n: int) -> None:
    """A step of order n - 1 captures orbits to order n after the isotropy correction, and not before."""
    rho, m = start(name)
    field = quadratic_field(rho, 3)
    flow = lh.steps.flow_series(field, m, n).points
    surface = Submanifold.orbits(rho)
    base = lh.LieTaylor(n - 1)
    # the condition is on orbits: the corrected step is late, by c t^n
    corrected = expansion(field, lh.Corrected(base, n), m, n)
    assert np.abs(corrected.coefficient(n) - flow.coefficient(n)).max() > 1e-3
    assert np.abs(curvature_defect(flow, corrected, surface)).max() < 1e-11
    assert np.abs(curvature_defect(flow, expansion(field, lh.LieTaylor(n), m, n), surface)).max() < 1e-11
    # (3.10): the defect of the base, and by how much
    result = expansion(field, base, m, n)
    difference, velocity = result.coefficient(n) - flow.coefficient(n), flow.coefficient(1)
    across = difference - velocity * (difference @ velocity) / (velocity @ velocity)
    expected = n * (n - 1) * across / (velocity @ velocity)
    assert np.abs(expected).max() > 1e-3
    assert np.allclose(curvature_defect(flow, result, surface), expected, atol=1e-11)


@pytest.mark.parametrize("k", [3, 4])
def test_orbits_and_level_sets_give_the_curvature_of_spheres(k: int) -> None:
    sphere = Sphere(k)
    m = np.array([0.6, 0.48, 0.64, 0.0])[:k]
    field = quadratic_field(sphere.representation, 5)
    curve = lh.steps.flow_series(field, m, 5).points
    curvature = [
        geodesic_curvature(curve, surface)
        for surface in (
            Submanifold.orbits(field.representation),
            Submanifold.level_set(lambda m: np.sum(m * m, axis=-1), k),
        )
    ]
    for j in range(4):
        assert np.allclose(curvature[0].coefficient(j), curvature[1].coefficient(j), atol=1e-12)
    at_start = sphere.curvature_of_flow(field, m)  # by another formula
    length = np.linalg.norm(curvature[0].value)
    assert np.isclose(length, np.abs(at_start) if k == 3 else np.linalg.norm(at_start), rtol=1e-13)


def test_embedding_and_level_set_give_the_same_curvature() -> None:
    q = lh.Jet(np.array([[0.3, 0.7], [1.0, -0.5], [0.2, 0.4], [0.1, 0.6], [-0.3, 0.2]]))
    inside = geodesic_curvature(q, Submanifold.embedded(torus, 2))
    outside = geodesic_curvature(torus(q), Submanifold.level_set(on_torus, 3))
    for j in range(3):
        assert np.allclose(inside.coefficient(j), outside.coefficient(j), atol=1e-12)
    assert np.abs(inside.value).max() > 0.1


def test_curvature_does_not_depend_on_the_parametrization() -> None:
    q = lh.Jet(np.array([[0.3, 0.7], [1.0, -0.5], [0.2, 0.4]]))
    slow = lh.Jet(np.array([[0.3, 0.7], [3.0, -1.5], [1.8 + 5.0, 3.6 - 2.5]]))  # t -> 3 t + 5 t^2
    surface = Submanifold.embedded(torus, 2)
    assert np.allclose(geodesic_curvature(q, surface).value, geodesic_curvature(slow, surface).value, atol=1e-13)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_lemma_2_for_curves_on_an_embedded_surface(n: int) -> None:
    """No group: a change along the velocity is a time reparametrization, a change across it is not."""
    rng = np.random.default_rng(n)
    q = np.zeros((n + 1, 2))
    q[:] = rng.normal(size=(n + 1, 2))
    surface = Submanifold.embedded(torus, 2)
    for direction, captured in ((q[1], True), (np.array([-q[1, 1], q[1, 0]]), False)):
        other = q.copy()
        other[n] += 0.3 * direction
        defect = np.abs(curvature_defect(lh.Jet(q), lh.Jet(other), surface)).max()
        assert bool(defect < 1e-11) is captured
        assert captured or defect > 1e-2


def test_orbits_of_two_level_sets() -> None:
    """S^1 x S^1 in R^4 as a level set of two functions: a product of two rotations is a geodesic."""
    surface = Submanifold.level_set(lambda m: [m[..., 0] ** 2 + m[..., 1] ** 2, m[..., 2] ** 2 + m[..., 3] ** 2], 4)
    t = lh.Jet(np.array([0.0, 1.0, 0.0, 0.0]))
    curve = np.stack([np.cos(t), np.sin(t), np.cos(2 * t), np.sin(2 * t)])
    assert np.abs(geodesic_curvature(curve, surface).coefficients).max() < 1e-14
    bent = np.stack([np.cos(t * t + t), np.sin(t * t + t), np.cos(2 * t), np.sin(2 * t)])
    assert np.abs(geodesic_curvature(bent, surface).value).max() > 0.1


def test_ensembles_are_projected_point_by_point() -> None:
    rho, m = start("RP^2 in Sym(3)")
    field = quadratic_field(rho, 3)
    points = np.stack([m, lh.Action(rho).act(np.array([0.3, 0.1, -0.4]), m), 2 * m])
    surface = Submanifold.orbits(rho)
    together = geodesic_curvature(lh.steps.flow_series(field, points, 3).points, surface)
    for i, point in enumerate(points):
        alone = geodesic_curvature(lh.steps.flow_series(field, point, 3).points, surface)
        assert np.allclose(together.coefficient(1)[i], alone.coefficient(1), atol=1e-12)


def test_what_has_no_curvature_is_refused() -> None:
    surface = Submanifold.orbits(lh.defining(lh.so(3)))
    line = lh.Jet(np.array([[1.0, 0, 0], [0, 1.0, 0]]))
    with pytest.raises(InputError, match="order 2 or more"):
        geodesic_curvature(line, surface)
    with pytest.raises(InputError, match="velocity"):
        geodesic_curvature(lh.Jet(np.array([[1.0, 0, 0], [0, 0, 0], [0, 1.0, 0]])), surface)
    curves = lh.Jet(np.array([[1.0, 0, 0], [0, 1.0, 0], [-0.5, 0, 0]])), line
    with pytest.raises(InputError, match="the same order"):
        curvature_defect(*curves, surface)
    with pytest.raises(InputError, match="Representation"):
        Submanifold.orbits(lh.so(3))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="tracers"):
        Submanifold.level_set(lambda m: float(m[0]), 3)
    with pytest.raises(ShapeError):
        Submanifold.embedded(lambda q: np.outer(q, q), 2)
    mixed = lh.Jet(np.stack([np.array([[1.0, 0, 0, 1, 0, 2], [1.0, 0, 0, 3, 0, 2]])] * 3))
    with pytest.raises(InputError, match="dimensions"):
        geodesic_curvature(mixed, Submanifold.orbits(lh.sym_conjugation(3)))
