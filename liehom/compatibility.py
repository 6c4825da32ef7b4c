"""Objects that liehom 0.1.0 has pickled: their classes are found where they are now, or refused by name.

A pickle refers to a class by the module in which it was defined. Since 0.1.0 modules have moved into subfolders, called
wings: ``liehom.algebra.lie_algebra`` has become ``liehom.algebra.core.lie_algebra``. `OldModules` is a finder that
Python's import system asks last. For an old name it gives an `OldModule`, whose attributes are those of the module at
the new place, so that old pickles load. It is asked for no name that exists, and so costs nothing.

Something is looked for by its name: in modules of the same name in the wings of the folder, in the folder, in its
wings. Changes of five kinds need an entry below. Classes with another name are in `CLASSES`, attributes with another
name in `ATTRIBUTES`, attributes that old pickles lack and the class fills in are in `GROWN`,
and attributes that the class leaves out are in `SHRUNK`. Classes whose objects
hold something else than in 0.1.0 are in `CHANGED` and refused.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast, final

from liehom.errors import FormatError

if TYPE_CHECKING:
    from importlib.abc import Loader

VERSION = "0.1.0"

MODULES = {
    "algebra": (
        "approximate_involution bracket_seeds cartan_decomposition cartan_involution cartan_subalgebra centroid "
        "chevalley classical closure cochain_complex cohomology commuting_maps compact_form complex_algebra "
        "composition_algebra constructions derivation_algebra derivation_equations derivations describe "
        "direct_sum_decomposition dynkin extensions families form_algebras free_nilpotent generated_span "
        "generating_words half_turn homomorphism ideals_modulo identification involution_obstruction "
        "isotropic_involution jacobi killing levi lie_algebra lie_order matrices_albert matrices_forms "
        "matrices_linear matrices_octonionic matrices_spin matrices_tensor matrix_basis matrix_families "
        "nilpotent_element radical rational_involution real_form real_form_names real_splitting root_data "
        "root_spaces root_system satake simple simple_ideals solvable_families sparse_commutators "
        "structure_constants structure_verbs subalgebra tables vogan"
    ),
    "atlas": "entry sweep",
    "catalog": "algebras claims families linear names pairs special subalgebras",
    "cli": "app convergence demo describe guard inputs integration numerical problem reproduce show",
    "correctors": (
        "closed_form completion conservation conserved_order conserving corrected exact_range expansion "
        "first_integral level_newton order order_condition points range_solver step symbolic_output "
        "symbolic_problem symbolic_range tower"
    ),
    "fullness": (
        "certificate decide describe dominance eigenwitness failure forms frame isotropy_algebra numerical "
        "positive_form proposals reducible spinor_form verdict verify verify_modular verify_pair verify_roots "
        "verify_sparse witnesses"
    ),
    "homogeneous": (
        "cayley exponential expression failure_cone field generator inner_product lazy_frame least_norm "
        "levi_classes many_ranks maps matrix_functions orbit_types own_exponential range_condition "
        "relative_invariant rodrigues scope space strata structure_name"
    ),
    "instances": (
        "attitude closed_forms elliptic exact_orbit free_motion isospectral joint_spins landau_lifshitz macrospin "
        "on_time rigid_body sphere sphere_frame spin_lattice sym_conjugation updates"
    ),
    "integrators": (
        "checkpoint clock collocation compiled conservation_account control convergence convergence_table dense "
        "ensemble events integration jax_integration jax_kernel merging named options orbit_error "
        "order_conditions path points problem products progress records reference rkmk rooted_trees run solution "
        "state steps tableau tableaux tableaux_data traced_size traced_step"
    ),
    "io": (
        "algebra_file files gap_format json_text latex_text pair_file problem representation_file sage_format "
        "solution_file sympy_format values"
    ),
    "paper": (
        "costs efficiency energy_errors figures kernels orders pictures printed_data samples separatrices tables "
        "trajectories"
    ),
    "parallel": "store tasks",
    "plotting": "canvas convergence trajectory",
    "representations": (
        "admissible_lattice analysis_verbs bracket_proof characters commutant_type complete_reducibility "
        "constructions decomposition equivalence generating_matrices generator_proof hermitian_forms "
        "highest_weight induced intertwiners irreducibility isotypic matrix_algebra pair real_form_module "
        "real_structure representation spin splitting stabilizer submodules symbolic weight_multiplicities "
        "weights"
    ),
    "scalars": (
        "algebraic_number balls complex_conjugation conic exact exact_field exact_matrix extension field "
        "fixed_point floating forms function_field generator grammar integral_basis joint_multiplicities "
        "joint_spectrum lattice linear_forms modular modular_maps modular_span number_fields pickling "
        "placed_entries polynomial quotient rational rational_function real_rows roots sparse subspace"
    ),
    "series": "arrays assembly bilinear jet jet_functions jet_ufuncs jet_views lie_series node recurrences",
    "testing": "numerical",
    "tracing": "array elements expr graph jax_code kernel llvm_text loop",
}
"""The modules of 0.1.0 in each folder."""

CLASSES: dict[str, str] = {
    "liehom.homogeneous.own_exponential:OwnExponential": "CustomExponential",
}
"""Classes and functions with another name, 'old module:old name' -> new name."""

ATTRIBUTES: dict[str, dict[str, str]] = {
    "liehom.algebra.root_system:RootSystem": {"_places": "_index"},
    "liehom.fullness.verdict:Full": {"reason": "_reason"},
}
"""Attributes with another name, 'old module:old name' -> {old: new}."""

GROWN: dict[str, tuple[str, ...]] = {
    "liehom.instances.landau_lifshitz:LandauLifshitz": (
        "_bonds",
        "cubic",
        "cubic_axes",
        "dmi",
        "polarization",
        "spin_torque",
        "temperature",
    ),
    "liehom.representations.symbolic:SymbolicIsotropy": ("exact_dimension", "sharp"),
    "liehom.fullness.failure:FailureReport": ("searched", "not_searched"),
    "liehom.homogeneous.orbit_types:OrbitType": ("invariants", "groups", "proofs"),
    "liehom.representations.representation:Representation": ("coordinates", "dropped"),
    "liehom.algebra.structure_constants:StructureConstants": ("error",),
    "liehom.scalars.floating:FloatMatrix": ("_norm", "_spectral", "error"),
    "liehom.scalars.floating:RankDecision": ("error",),
    "liehom.homogeneous.field:GeneratorField": ("_sites",),
    "liehom.homogeneous.rodrigues:Rodrigues": ("_power",),
    "liehom.atlas.entry:Entry": ("family", "facts"),
    "liehom.integrators.solution:Solution": ("_steps",),
    "liehom.integrators.solution:Report": ("near_steps", "unkept_from", "stopped_at", "diagnostics"),
}
"""Attributes since 0.1.0 that `__setstate__` of the class fills in, 'old module:old name' -> names."""

SHRUNK: dict[str, tuple[str, ...]] = {
    "liehom.correctors.step:Generator": ("prepared",),
}
"""Attributes of 0.1.0 that `__setstate__` of the class leaves out, 'old module:old name' -> names."""

CHANGED: frozenset[str] = frozenset()
"""Classes whose objects hold something else than in 0.1.0, 'old module:old name'."""


@final
class OldModules:
    """Finder and loader for modules of 0.1.0 that have another name now.

    Examples
    --------
    >>> import pickle
    >>> import liehom as lh
    >>> pickle.loads(b"cliehom.algebra.lie_algebra\\nLieAlgebra\\n.") is lh.LieAlgebra  # where 0.1.0 had it
    True
    """

    def find_spec(self, name: str, path: Sequence[str] | None, target: Any = None) -> ModuleSpec | None:
        """The module of an old name, None if there was none."""
        root, _, rest = name.partition(".")
        folder, _, stem = rest.partition(".")
        known = root == "liehom" and stem in MODULES.get(folder, "").split()
        return ModuleSpec(name, cast("Loader", self)) if known else None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """The stand-in for an old module."""
        return OldModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing: attributes are looked up when they are asked for."""


@final
class OldModule(ModuleType):
    """A module of 0.1.0: hands out what is at the new place.

    Importing a module makes it an attribute of its folder. Some names of old modules are functions of the folder now,
    `liehom.integrators.tableau` for one: the first look into an old module gives the folder its attribute back.

    Parameters
    ----------
    name : str
        The old name.

    Examples
    --------
    >>> OldModule("liehom.scalars.subspace").Subspace
    <class 'liehom.scalars.spaces.subspace.Subspace'>
    >>> OldModule("liehom.scalars.subspace").Nothing
    Traceback (most recent call last):
    ...
    liehom.errors.FormatError: liehom.scalars.subspace.Nothing is from liehom 0.1.0, and this version has nothing ...
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        folder, _, self._stem = name.rpartition(".")
        self._folder = importlib.import_module(folder)
        self._before = vars(self._folder).get(self._stem, self)

    def __getattr__(self, name: str) -> Any:
        if vars(self._folder).get(self._stem) is self:
            if self._before is self:
                delattr(self._folder, self._stem)
            else:
                setattr(self._folder, self._stem, self._before)
        if name.startswith("__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        written = f"{self.__name__}:{name}"
        wanted = CLASSES.get(written, name)
        for place in _places(self._folder, self._stem) if written not in CHANGED else ():
            if hasattr(place, wanted):
                found = getattr(place, wanted)
                return _renaming(found, ATTRIBUTES[written]) if written in ATTRIBUTES else found
        raise FormatError(
            f"{self.__name__}.{name} is from liehom {VERSION}, and this version has nothing that its pickled objects "
            f"fit: in {VERSION} write what they hold as JSON or .npz (liehom.dump, to_json, "
            "liehom.io.save_solution), and read that"
        )


def _places(folder: ModuleType, stem: str) -> Iterator[ModuleType]:
    """Where something of an old module may be: modules of this name in the wings, the folder, its wings."""
    import pkgutil

    wings = [wing.name for wing in pkgutil.iter_modules(folder.__path__, f"{folder.__name__}.") if wing.ispkg]
    for wing in wings:
        if importlib.util.find_spec(f"{wing}.{stem}") is not None:
            yield importlib.import_module(f"{wing}.{stem}")
    yield folder
    yield from map(importlib.import_module, wings)


def _renaming(kind: Any, names: dict[str, str]) -> Any:
    """A class for pickle to fill, whose objects take attributes by their old names and are then of the class `kind`."""
    if hasattr(kind, "__setstate__"):  # dataclasses with slots: by position
        return kind

    def fill(self: Any, state: Any) -> None:
        object.__setattr__(self, "__class__", kind)
        for values in state if isinstance(state, tuple) else (state,):
            for name, value in (values or {}).items():
                object.__setattr__(self, names.get(name, name), value)

    return type(kind)(kind.__name__, (kind,), {"__slots__": (), "__setstate__": fill})
