"""The summary that `LieAlgebra.describe` returns, with every line computed exactly."""

from __future__ import annotations

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.roots.dynkin import join_types
from liehom.algebra.roots.real_form import RealForm
from liehom.algebra.roots.real_form_names import canonical_real_form, join_real_forms
from liehom.algebra.structure.identification import simple_parts
from liehom.errors import InputError, UndecidedError


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
        found = semisimple_lines(algebra)
        lines[0] = lines[0].replace(title, title + _other_name(algebra.name, found[0]), 1)
        lines += found
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
    forms.sort(key=lambda form: (form.dimension, form.real_rank > 0, form.name))  # the order of join_real_forms
    rank = sum(form.rank for form in forms)
    real_rank = sum(form.real_rank for form in forms)
    compact = "+".join(form.maximal_compact for form in forms if form.maximal_compact != "0") or "0"
    word = "simple" if len(forms) == 1 else "semisimple"
    name = join_real_forms(form.name for form in forms)
    first = f"{word}, real form {name}, rank {rank}, real rank {real_rank}, maximal compact {compact}"
    return [first, f"complex type {kind}, {_restricted(forms)}"]


def _other_name(name: str | None, line: str) -> str:
    """' = so(3)' for the name su(2), if `line` says that the algebra is this real form; otherwise an empty string."""
    try:
        canonical = canonical_real_form(name) if name and len(name) < 40 else ""
    except InputError:
        return ""
    differs = canonical.replace(" ", "").replace(",R)", ")") != (name or "").replace(" ", "").replace(",R)", ")")
    return f" = {canonical}" if canonical and differs and f"real form {canonical}, rank" in line else ""


def _restricted(forms: list[RealForm]) -> str:
    if all(form.real_rank == 0 for form in forms):
        return "compact"
    shown = []
    for form in forms:
        if form.real_rank == 0:
            continue
        multiplicities = form.multiplicities
        if set(multiplicities) == {"all"}:
            counts = f"multiplicity {multiplicities['all']}"
        else:
            counts = "multiplicities " + ", ".join(f"{m} ({length})" for length, m in multiplicities.items())
        shown.append(f"{form.restricted_type} with {counts}")
    return "restricted roots " + "; ".join(shown)


def _with_radical(algebra: LieAlgebra) -> list[str]:
    found = algebra.levi_decomposition()
    radical, center, nilradical = found.radical, algebra.center(), algebra.nilradical()
    lines = []
    if radical.dimension == algebra.dimension:
        lines.append(_solvable_kind(algebra, nilradical))
    else:
        kind = "reductive" if center.dimension == radical.dimension else "neither solvable nor semisimple"
        levi = found.levi.as_algebra()
        lines.append(f"{kind}: Levi factor of dimension {levi.dimension}, radical of dimension {radical.dimension}")
        lines.append(f"Levi factor: {semisimple_lines(levi)[0]}")
    lines.append(f"nilradical of dimension {nilradical.dimension}, centre of dimension {center.dimension}")
    return lines + _series(algebra)


def _solvable_kind(algebra: LieAlgebra, nilradical: Subalgebra) -> str:
    if algebra.is_abelian():
        return "abelian"
    if nilradical.dimension == algebra.dimension:
        return f"nilpotent of class {len(algebra.lower_central_series()) - 1}"
    return "solvable, not nilpotent"


def _series(algebra: LieAlgebra) -> list[str]:
    derived = [term.dimension for term in algebra.derived_series()]
    lower = [term.dimension for term in algebra.lower_central_series()]
    return [f"derived series {_arrows(derived)}, lower central series {_arrows(lower)}"]


def _arrows(dimensions: list[int]) -> str:
    return " > ".join(map(str, dimensions))
