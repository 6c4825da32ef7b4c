"""Names of semisimple algebras, and the summary of any."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liehom.base.errors import InputError, UndecidedError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.real_form import (
    RealForm,
    canonical_real_form,
    complex_form,
    join_real_forms,
    real_forms_with,
)
from liehom.exact.algebra.roots.root_system import join_types
from liehom.exact.algebra.structure.centroid import exact_field
from liehom.exact.algebra.structure.ideals import (
    CentroidField,
    Place,
    centroid_field,
    direct_sum_decomposition,
    field_places,
)
from liehom.exact.algebra.structure.levi import levi_decomposition
from liehom.exact.algebra.structure.naming import identify
from liehom.exact.algebra.structure.root_spaces import cartan_subalgebra, root_data

MOST_DEGREE = 2  # of a field over which a summary looks for a name; `identify` has no such limit

# Complex type and real form of a semisimple algebra by name, exactly and in any basis.
# A simple algebra over the field splits over the reals by the places of its centroid (`ideals`).  The complex
# type of each part follows from its dimension and rank.  If several types have these (B_n, C_n and E6), the Dynkin
# diagram of the enclosed roots decides (`root_spaces`).  A real form is then determined by its Killing signature
# (Helgason, Differential Geometry, Lie Groups, and Symmetric Spaces, X.6), except for so*(18) and so(12,6), sl(7,H) and
# su(9,5) and larger pairs.


@final
@dataclass(frozen=True, slots=True)
class SimplePart:
    """An ideal of a semisimple algebra or a Levi factor that is simple over the field of the algebra."""

    ideal: Subalgebra
    type: str  # of each simple ideal of the complexification
    centroid: CentroidField  # its degree is the number of these ideals

    @property
    def places(self) -> list[Place]:
        """The simple ideals over the reals."""
        return field_places(self.centroid)

    def real_forms(self) -> list[RealForm]:
        """The real form of each simple ideal over the reals, in the order of `places`."""
        return [_real_form(self.type, place) for place in self.places]


def semisimple_part(algebra: LieAlgebra) -> LieAlgebra:
    """The algebra itself if it is semisimple, else a Levi factor as an algebra in its own basis."""
    exact_field(algebra, "real forms")
    semisimple = int(algebra.killing_form().rank()) == algebra.dimension
    return algebra if semisimple else levi_decomposition(algebra).levi.as_algebra()


def simple_parts(algebra: LieAlgebra) -> list[SimplePart]:
    """The simple ideals, over its field, of a semisimple algebra or of a Levi factor, with their types."""
    return [
        SimplePart(ideal, _type(centroid := centroid_field(ideal)), centroid)
        for ideal in direct_sum_decomposition(semisimple_part(algebra))
    ]


def semisimple_type(algebra: LieAlgebra) -> str:
    """Implements `LieAlgebra.semisimple_type`."""
    return join_types(part.type for part in simple_parts(algebra) for _ in range(part.centroid.degree))


def real_forms_of(algebra: LieAlgebra) -> list[RealForm]:
    """Implements `LieAlgebra.real_forms`."""
    return [form for part in simple_parts(algebra) for form in part.real_forms()]


def real_form(algebra: LieAlgebra) -> str:
    """Implements `LieAlgebra.real_form`."""
    return join_real_forms(form.name for form in real_forms_of(algebra))


def _type(centroid: CentroidField) -> str:
    """The type of the simple ideals of the complexification of a simple algebra."""
    algebra, degree = centroid.algebra, centroid.degree
    cartan = cartan_subalgebra(algebra)
    candidates = types_of(algebra.dimension // degree, cartan.dimension // degree)
    if len(candidates) == 1:
        return candidates[0]
    return root_data(algebra, cartan).root_system.components()[0][0]


def types_of(dimension: int, rank: int) -> list[str]:
    """The simple types of a dimension and a rank."""
    exceptional = {(14, 2): "G2", (52, 4): "F4", (78, 6): "E6", (133, 7): "E7", (248, 8): "E8"}
    least = {"A": (rank * (rank + 2), 1), "B": (rank * (2 * rank + 1), 2)}
    least |= {"C": (rank * (2 * rank + 1), 3), "D": (rank * (2 * rank - 1), 4)}
    classical = [f"{letter}{rank}" for letter, (size, low) in least.items() if dimension == size and rank >= low]
    return [exceptional[dimension, rank], *classical] if (dimension, rank) in exceptional else classical


def _real_form(type_name: str, place: Place) -> RealForm:
    if place.kind == "complex":
        return complex_form(type_name)
    noncompact, compact = place.killing_signature
    forms = real_forms_with(type_name, noncompact - compact)
    if len(forms) == 1:
        return forms[0]
    names = " and ".join(form.name for form in forms)
    raise UndecidedError(f"type {type_name} and Killing signature {place.killing_signature} belong to {names}")


# The summary that `LieAlgebra.describe` returns, with every line computed exactly.


def describe(algebra: LieAlgebra) -> str:
    """Implements `LieAlgebra.describe`."""
    title = algebra.name or "Lie algebra"
    lines = [f"{title}, dimension {algebra.dimension} over {algebra.field.name}"]
    killing = algebra.killing_signature()
    if not algebra.field.exact:
        lines += _series(algebra)
        lines.append(f"Killing form of signature {killing} (positive, negative, zero), numerically")
        lines.append("structure theory is exact: lh.rationalize(g).exact has more")
        return "\n  ".join(lines)
    if algebra.dimension == 0:
        return "\n  ".join([*lines, "the zero algebra"])
    if killing[2] == 0:
        semisimple = semisimple_lines(algebra)
        lines[0] = lines[0].replace(title, title + _other_name(algebra.name, semisimple[0]), 1)
        lines += semisimple
    else:
        lines += _with_radical(algebra)
    lines.append(f"Killing form of signature {killing} (positive, negative, zero)")
    return "\n  ".join(lines)


def semisimple_lines(algebra: LieAlgebra) -> list[str]:
    """The lines of the summary for a semisimple algebra: name and ranks, complex type and restricted roots."""
    parts = simple_parts(algebra)
    kind = join_types(part.type for part in parts for _ in range(part.centroid.degree))
    try:
        forms = [form for part in parts for form in part.real_forms()]
    except UndecidedError as undecided:
        return [f"semisimple of complex type {kind}; {undecided}"]
    return lines_of_forms(kind, forms)


def lines_of_forms(kind: str, forms: list[RealForm]) -> list[str]:
    """The lines of the summary for the sum of simple algebras of a complex type: name and ranks, restricted roots."""
    forms = sorted(forms, key=lambda form: (form.dimension, form.real_rank > 0, form.name))  # as join_real_forms
    rank = sum(form.rank for form in forms)
    real_rank = sum(form.real_rank for form in forms)
    compact = "+".join(form.maximal_compact for form in forms if form.maximal_compact != "0") or "0"
    word = "simple" if len(forms) == 1 else "semisimple"
    name = join_real_forms(form.name for form in forms)
    first = f"{word}, real form {name}, rank {rank}, real rank {real_rank}, maximal compact {compact}"
    roots = "; ".join(_restricted_roots(form) for form in forms if form.real_rank)
    return [first, f"complex type {kind}, {f'restricted roots {roots}' if roots else 'compact'}"]


def _other_name(name: str | None, line: str) -> str:
    """' = so(3)' for the name su(2), if `line` says that the algebra is this real form; otherwise an empty string."""
    try:
        canonical = canonical_real_form(name) if name and len(name) < 40 else ""
    except InputError:
        return ""
    differs = canonical.replace(" ", "").replace(",R)", ")") != (name or "").replace(" ", "").replace(",R)", ")")
    return f" = {canonical}" if canonical and differs and f"real form {canonical}, rank" in line else ""


def _restricted_roots(form: RealForm) -> str:
    multiplicities = form.multiplicities
    if set(multiplicities) == {"all"}:
        return f"{form.restricted_type} with multiplicity {multiplicities['all']}"
    counts = ", ".join(f"{m} ({length})" for length, m in multiplicities.items())
    return f"{form.restricted_type} with multiplicities {counts}"


def _with_radical(algebra: LieAlgebra) -> list[str]:
    (factor, radical), center, nilradical = algebra.levi_decomposition(), algebra.center(), algebra.nilradical()
    name = small_name(algebra) if center.dimension < radical.dimension else ""  # else the lines below name it
    lines = [f"isomorphic to {name}"] if name not in ("", algebra.name) else []
    if (known := familiar_name(name)) != name:
        lines = [f"{name} in the tables" if algebra.name == known else f"isomorphic to {known}, {name} in the tables"]
    if radical.dimension == algebra.dimension:
        lines.append(_solvable_kind(algebra, nilradical))
    else:
        kind = "reductive" if center.dimension == radical.dimension else "neither solvable nor semisimple"
        levi = factor.as_algebra()
        lines.append(f"{kind}: Levi factor of dimension {levi.dimension}, radical of dimension {radical.dimension}")
        lines.append(f"Levi factor: {semisimple_lines(levi)[0]}")
    lines.append(f"nilradical of dimension {nilradical.dimension}, centre of dimension {center.dimension}")
    return lines + _series(algebra)


FAMILIAR = {
    "A2,1": "aff(1)", "A3,1": "heisenberg(1)", "A3,4": "iso(1,1)", "A3,6": "e(2)", "A3,8": "sl(2,R)", "A3,9": "so(3)",
    "A4,10": "oscillator(1)", "A5,4": "heisenberg(2)",
}  # fmt: skip
"""Names of the catalogue by names of the tables."""


def familiar_name(name: str) -> str:
    """A name of the tables with the names that everybody knows, such as 'aff(1)+R' for 'A2,1+R'."""
    return "+".join(FAMILIAR.get(part, part) for part in name.split("+"))


def small_name(algebra: LieAlgebra) -> str:
    """The name of an algebra of dimension at most 6 in the tables, an empty string if that is unknown or takes long."""
    if algebra.dimension > 6:
        return ""
    try:
        return identify(algebra, MOST_DEGREE).name
    except UndecidedError:
        return ""


def _solvable_kind(algebra: LieAlgebra, nilradical: Subalgebra) -> str:
    if algebra.is_abelian():
        return "abelian"
    if nilradical.dimension == algebra.dimension:
        return f"nilpotent of class {len(algebra.lower_central_series()) - 1}"
    return "solvable, not nilpotent"


def _series(algebra: LieAlgebra) -> list[str]:
    both = (algebra.derived_series(), algebra.lower_central_series())
    derived, lower = (" > ".join(str(term.dimension) for term in series) for series in both)
    return [f"derived series {derived}, lower central series {lower}"]
