"""Every method of Representation and Pair over floats: an answer that agrees with the exact one, or a refusal."""

import inspect
from collections.abc import Callable
from operator import methodcaller
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import UndecidedError

RHO = lh.defining(lh.so(3))
ON_C2 = lh.defining(lh.su(2))
SPLIT = lh.adjoint(lh.gl(2))
PAIR = lh.pair("so(4)/so(3)")
LINE = [[1, 0, 0]]
GENERIC = [1, 2, 2]

ANSWERS: dict[str, Callable[[lh.Representation], Any]] = {
    "__call__": lambda rho: rho([1, 2, 3]),
    "__iter__": list,
    "__eq__": lambda rho: rho == RHO.over(rho.field),
    "field": lambda rho: rho.field.degree,
    "kept": lambda rho: rho.kept,
    "element": lambda rho: rho.element(RHO([1, 2, 3])),
    "subalgebra": lambda rho: rho.subalgebra([RHO([1, 2, 3])]).dimension,
    "real_point": lambda rho: rho.real_point([1, 2, 3]),
    "isotropy": lambda rho: [rho.isotropy(x).dimension for x in ([0, 0, 0], GENERIC)],
    "orbit_dimension": lambda rho: [rho.orbit_dimension(x) for x in ([0, 0, 0], GENERIC)],
    "pair": lambda rho: rho.pair(GENERIC).dimension,
    "dual": lambda rho: rho.dual(),
    "direct_sum": lambda rho: rho.direct_sum(rho),
    "tensor": lambda rho: rho.tensor(rho.dual()),
    "symmetric_power": lambda rho: rho.symmetric_power(3),
    "exterior_power": lambda rho: rho.exterior_power(2),
    "restriction": lambda rho: rho.restriction(rho.algebra.subalgebra(LINE)),
    "over": lambda rho: rho.over(lh.RR),
    "complex_size": lambda rho: ON_C2.over(rho.field).complex_size,
    "complex_structure": lambda rho: ON_C2.over(rho.field).complex_structure(),
    "complex_matrix": lambda rho: ON_C2.over(rho.field).complex_matrix([1, 2, 3]),
    "complex_matrices": lambda rho: ON_C2.over(rho.field).complex_matrices(),
    "on_hermitian_matrices": lambda rho: ON_C2.over(rho.field).on_hermitian_matrices(),
    "from_matrices": lambda rho: lh.Representation.from_matrices(rho.matrices[:2]),
}
ALONE = (
    *("commutant", "commutant_type", "invariant_forms", "invariant_vectors", "is_irreducible", "socle", "weights"),
    *("is_completely_reducible", "decomposition", "highest_weights", "maximal_submodules"),
)
REFUSED: dict[str, Callable[[lh.Representation], Any]] = {
    **{name: methodcaller(name) for name in ALONE},
    "symbolic_isotropy": lambda rho: rho.symbolic_isotropy([1, 2, 3]),
    "hermitian_forms": lambda rho: ON_C2.over(rho.field).hermitian_forms(),
    "hilbert_series": lambda rho: rho.hilbert_series(),
    "invariants": lambda rho: rho.invariants(2),
    "intertwiners": lambda rho: rho.intertwiners(rho),
    "equivalence": lambda rho: rho.equivalence(rho),
    "is_equivalent": lambda rho: rho.is_equivalent(rho),
    "submodule": lambda rho: SPLIT.over(rho.field).submodule([[1, 0, 0, 1]]),
    "subrepresentation": lambda rho: SPLIT.over(rho.field).subrepresentation([[1, 0, 0, 1]]),
    "quotient": lambda rho: SPLIT.over(rho.field).quotient([[1, 0, 0, 1]]),
    "invariant_complement": lambda rho: SPLIT.over(rho.field).invariant_complement([[1, 0, 0, 1]]),
}
OF_PAIRS: dict[str, Callable[[lh.Pair], Any]] = {
    "over": lambda pair: pair.over(lh.RR).dimension,
    "field": lambda pair: pair.field.degree,
    "dimension": lambda pair: pair.dimension,
    "isotropy_matrices": lambda pair: invariants(pair),
    "isotropy_representation": lambda pair: pair.isotropy_representation().size,
    "coordinates": lambda pair: pair.coordinates([1, 0, 0, 0, 0, 1]).shape,
    "change_of_basis": lambda pair: invariants(pair.change_of_basis(np.tri(6, dtype=int))),
    "__eq__": lambda pair: pair == pair,
    "__hash__": lambda pair: hash(pair) == hash(pair),
}


def public(kind: type) -> set[str]:
    members = inspect.getmembers(kind)
    return {name for name, x in members if not name.startswith("_") and not inspect.ismemberdescriptor(x)}


def invariants(pair: lh.Pair) -> float:
    """A trace that does not depend on the bases of g/h and h: of the Casimir element for the Killing form of h."""
    rho = pair.isotropy_representation()
    dual = np.linalg.inv(rho.algebra.killing_form().to_numpy())
    matrices = np.array([a.to_numpy() for a in rho.matrices])
    return float(np.einsum("ij,ixy,jyx->", dual, matrices, matrices))


def numbers(value: Any) -> Any:
    """Matrices and representations as nested lists of floats, so that exact and float answers can be compared."""
    if isinstance(value, lh.Representation):
        lh.Representation(value.algebra, value.matrices, size=value.size)  # the bracket is checked
        return [value.size, value.algebra.dimension, *map(numbers, value.matrices)]
    if hasattr(value, "to_numpy"):
        return value.to_numpy()
    if hasattr(value, "applyfunc"):  # of sympy
        return np.array(value.tolist(), dtype=complex)
    return [numbers(x) for x in value] if isinstance(value, (list, tuple)) else value


def agree(found: Any, expected: Any) -> None:
    if isinstance(expected, list):
        assert len(found) == len(expected)
        for x, y in zip(found, expected, strict=True):
            agree(x, y)
    elif isinstance(expected, np.ndarray) or isinstance(found, np.ndarray):
        assert np.allclose(np.asarray(found, dtype=complex), np.asarray(expected, dtype=complex), atol=1e-12)
    elif isinstance(expected, bool) or not hasattr(expected, "__float__"):
        assert found == expected
    else:
        assert float(found) == pytest.approx(float(expected))


def test_every_public_method_is_in_a_table() -> None:
    assert public(lh.Representation) <= ANSWERS.keys() | REFUSED.keys()
    assert public(lh.Pair) <= OF_PAIRS.keys() | {"is_primitive", "is_naturally_reductive"} | GEOMETRY.keys()


GEOMETRY: dict[str, tuple[Any, ...]] = {
    "reductive_complement": (), "is_reductive": (), "is_symmetric": (),
    "invariant_metrics": (), "invariant_forms": (2,), "invariant_cohomology": (), "invariant_complex_structures": (),
    "invariant_symplectic_forms": (), "invariant_connections": (),
}  # fmt: skip


@pytest.mark.parametrize("name", GEOMETRY)
def test_the_geometry_of_a_pair_over_floats_is_left_to_exact_numbers(name: str) -> None:
    floating = PAIR.over(lh.RR)
    with pytest.raises(lh.LiehomError, match="rationalize"):
        getattr(floating, name)(*GEOMETRY[name])


def test_whether_a_pair_over_floats_is_primitive_is_left_to_exact_numbers() -> None:
    assert isinstance(PAIR.is_primitive(), bool)
    with pytest.raises(UndecidedError, match="rationalize"):
        PAIR.over(lh.RR).is_primitive()


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_over_floats_agrees_with_the_exact_one(name: str) -> None:
    agree(numbers(ANSWERS[name](RHO.over(lh.RR))), numbers(ANSWERS[name](RHO)))


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_names_the_way_to_exact_numbers(name: str) -> None:
    REFUSED[name](RHO)
    with pytest.raises(UndecidedError, match="rationalize"):
        REFUSED[name](RHO.over(lh.RR))


@pytest.mark.parametrize("name", OF_PAIRS)
def test_a_pair_over_floats_agrees_with_the_exact_one(name: str) -> None:
    floats = PAIR.over(lh.RR)
    agree(numbers(OF_PAIRS[name](floats)), numbers(OF_PAIRS[name](PAIR)))
