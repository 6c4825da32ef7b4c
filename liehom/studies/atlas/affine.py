"""Affine pairs (S + V, S) with irreducible S: the full ones by the classification, and irreducible modules beyond.

Two linear Lie algebras give isomorphic pairs if and only if they are conjugate in GL(V). Modules whose highest weights
an automorphism of the real form exchanges, such as a module and its dual, have the same image and are listed once.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import chain, combinations_with_replacement, product
from typing import NamedTuple

from liehom.base.errors import InputError
from liehom.exact.algebra.constructions.families import affine_of
from liehom.exact.algebra.constructions.sums import semidirect_sum
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.real_form import RealForm, complex_form, parse_name, real_forms
from liehom.exact.algebra.roots.root_system import isomorphisms, root_system
from liehom.exact.catalog.pairs import pair as named_pair
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.characters import weyl_dimension
from liehom.exact.representations.highest_weight.real_modules import real_module, real_module_type
from liehom.exact.representations.highest_weight.weights import Weight
from liehom.exact.representations.invariants.irreducibility import traceless
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.rational import QQ
from liehom.studies.atlas.entry import Recipe
from liehom.studies.atlas.symmetric import short_name

TYPES = ("A1", "A2", "B2", "G2", "A3", "B3", "C3", "A4", "B4", "C4", "D4", "F4", "A5", "B5", "C5", "D5")
"""Complex types of the simple algebras whose modules are listed."""
DIMENSION = 28  # largest dimension of a module that is listed
TENSOR_DIMENSION = 16  # largest dimension of a tensor product that is listed


class _Module(NamedTuple):
    """An irreducible real module of a simple real algebra; modules are sorted by this tuple."""

    dimension: int
    algebra_dimension: int
    form: str
    weight: Weight
    commutant: str


def affine_pairs(transitive_dimension: int = 16, modules: int = 200) -> Iterator[Recipe]:
    """Affine pairs over the transitive linear algebras, over modules of simple algebras, and over tensor products.

    The facts known are ``transitive`` and, for modules of simple algebras, ``commutant``.

    Parameters
    ----------
    transitive_dimension : int
        The largest dimension d >= 2 of V for linear algebras that are transitive on rays; their pairs are full.
    modules : int
        The number of irreducible modules of simple real algebras that are not transitive, in order of dimension; at
        most 234.

    Notes
    -----
    A module V of S gives the algebras S and S + R of matrices, if its commutant is C also S + RJ and S + C, and if it
    is H also S + RJ, S + C, S + sp(1) and S + H. Spirals S + R(J + c) are listed for c = 1. Tensor products are those
    of two modules R^m and R^n of real linear algebras, with and without scalars.

    Examples
    --------
    >>> [recipe.name for recipe in affine_pairs(3, 0)][:6]
    ['affine(so(2))', 'affine(gl(1,C))', 'affine(spiral(1,1))', 'affine(sl(2))', 'affine(gl(2))', 'affine(sl(3))']
    >>> [recipe.name for recipe in affine_pairs(1, 4) if not recipe.known["transitive"]][:4]
    ['affine(so(2,1))', 'affine(so(2,1)+R)', 'affine(S3(sl(2)))', 'affine(S3(sl(2))+R)']
    """
    for name in chain.from_iterable(_transitive_names(d) for d in range(2, transitive_dimension + 1)):
        yield Recipe(name, "affine", named_pair, (name,), {"transitive": True})
    listed = _modules()
    if modules > len(listed):
        raise InputError(f"{len(listed)} modules are listed; found modules = {modules}")
    for module in listed[:modules]:
        known: dict[str, bool | int | str] = {"transitive": False, "commutant": module.commutant}
        base = _catalogue_name(module)
        for scalars in {"R": ("", "R"), "C": ("", "R", "u(1)", "u(1)+R")}.get(module.commutant, _QUATERNIONIC):
            suffix = f"+{scalars}" if scalars else ""
            if base is not None and (scalars in ("", "R") or base.startswith(_WITH_SCALARS) or base.endswith(",C)")):
                name = f"affine({base}{suffix})"
                yield Recipe(name, "affine", named_pair, (name,), known)
            else:
                weight = ",".join(map(str, module.weight))
                name = f"affine(V({weight}) of {module.form}{suffix})"
                yield Recipe(name, "affine", module_pair, (name, module.form, module.weight, scalars), known)
    for name in _tensor_names():
        yield Recipe(name, "affine", named_pair, (name,), {"transitive": False})


_WITH_SCALARS = ("su(", "sp(1,1)", "sp(2,1)", "sp(3,1)", "sp(2,2)", "sp(4,1)", "sp(3,2)", "so*(")
"""Beginnings of names of matrices over C and H, to which the catalogue adds scalars."""
_QUATERNIONIC = ("", "R", "u(1)", "u(1)+R", "sp(1)", "sp(1)+R")


def module_pair(name: str, form: str, weight: Weight, scalars: str = "") -> Pair:
    """The affine pair over an irreducible real module of a simple real algebra, with scalars that commute with it."""
    representation = real_module(form, weight).representation
    size = representation.size
    if extra := _scalars(representation, scalars):
        algebra = affine_of([*representation.matrices, *extra])
    else:
        algebra = semidirect_sum(representation.algebra, list(representation.matrices), name=None, check=False)
    rows = QQ.identity(algebra.dimension).select(rows=range(algebra.dimension - size))
    # no check: the linear part of an affine algebra is a subalgebra
    return Pair(algebra, Subalgebra(algebra, rows, check=False), name=name)


def _scalars(representation: Representation, scalars: str) -> list[ExactMatrix]:
    """Matrices of the commutant that span the scalars with this name."""
    parts, size = scalars.split("+"), representation.size
    matrices = [QQ.identity(size)] if "R" in parts else []
    if "u(1)" in parts or "sp(1)" in parts:
        units = [t.primitive() for t in traceless(representation.commutant(), size, QQ)]
        matrices += units if "sp(1)" in parts else units[:1]
    return matrices


def _transitive_names(d: int) -> Iterator[str]:
    """The rows with d-dimensional V in the list of full affine pairs, spirals with c = 1."""
    m = d // 2
    if d == 2:
        yield from ("affine(so(2))", "affine(gl(1,C))", "affine(spiral(1,1))")
    real = [f"so({d})"] * (d > 2) + [f"sp({d},R)"] * (d % 2 == 0 and d > 2)
    real += {7: ["g2"], 8: ["spin(7)"], 16: ["spin(9)", "spin(9,1)"]}.get(d, [])
    real += [f"sp({d // 4})+sp(1)", f"sl({d // 4},H)+sp(1)"] if d % 4 == 0 and d > 4 else []
    yield from (f"affine({name})" for name in ([f"sl({d})", f"gl({d})"]))
    for name in real:
        yield from (f"affine({name})", f"affine({name}+R)")
    other = [f"su({m})"] * (m > 2) + [f"sl({m},C)"] * (m > 1) + [f"sp({d // 2},C)"] * (d % 4 == 0 and m > 2)
    other += [f"sp({d // 4})"] + [f"sl({d // 4},H)"] * (d > 4) if d % 4 == 0 else []
    for name in other if d % 2 == 0 else []:
        for scalars in ("", "+R", "+u(1)", "+u(1)+R", "+spiral(1,1)"):
            yield f"affine({name}{scalars})"


@lru_cache(maxsize=1)
def _modules() -> tuple[_Module, ...]:
    """The modules of the listed algebras up to equivalence, without the transitive ones, by dimension."""
    modules = set()
    for form in chain.from_iterable((*real_forms(name), complex_form(name)) for name in TYPES):
        for weight in _weights(form):
            commutant = real_module_type(form, weight)
            dimension = weyl_dimension(form.vogan.type, weight) * (1 if commutant == "R" else 2)
            if dimension <= DIMENSION and weight not in _transitive_weights(form):
                modules.add(_Module(dimension, form.dimension, form.name, weight, commutant))
    return tuple(sorted(modules))


def _weights(form: RealForm) -> Iterator[Weight]:
    """The non-zero dominant weights of complex dimension at most 28, one for each orbit of the diagram symmetries."""
    symmetries = _symmetries(form)
    pending, seen = [(0,) * form.rank], set()
    while pending:
        weight = pending.pop()
        for i in range(form.rank):
            higher = (*weight[:i], weight[i] + 1, *weight[i + 1 :])
            if higher not in seen and weyl_dimension(form.vogan.type, higher) <= DIMENSION:
                seen.add(higher)
                pending.append(higher)
                if higher == max(tuple(higher[j] for j in p) for p in symmetries):
                    yield higher


def _symmetries(form: RealForm) -> list[tuple[int, ...]]:
    """Diagram automorphisms induced by a real form: all of order 2, and triality for so(8), so(4,4) and so(8,C)."""
    cartan = root_system(form.type).cartan
    symmetries = isomorphisms(cartan, cartan)
    if form.type == "D4" and not (form.is_compact or form.is_split or form.is_complex):
        symmetries = [p for p in symmetries if p[0] == 0]
    if form.is_complex:
        pairs = [(p, tuple(form.rank // 2 + i for i in p)) for p in symmetries]
        return [(*p, *moved) for p, moved in pairs] + [(*moved, *p) for p, moved in pairs]
    return symmetries


def _transitive_weights(form: RealForm) -> list[Weight]:
    """The highest weights of the modules whose images are transitive on rays, one for each orbit of `_symmetries`."""
    kind, _, letter = parse_name(form.name)
    usual = ((1, 1),) if kind == "sl" or (kind == "sp" and letter) or (form.is_compact and kind != "f4") else ()
    return [tuple(times * (i == k - 1) for i in range(form.rank)) for k, times in _TRANSITIVE.get(form.name, usual)]


_TRANSITIVE: dict[str, tuple[tuple[int, int], ...]] = {
    "so(3)": ((1, 1), (1, 2)), "so(5)": ((1, 1), (2, 1)), "su(4)": ((1, 1), (2, 1)), "so(3,2)": ((2, 1),),
    "so(5,C)": ((2, 1),), "so(7)": ((1, 1), (3, 1)), "so(9)": ((1, 1), (4, 1)), "so(9,1)": ((4, 1),),
}  # fmt: skip
"""By the name of a real form, the k and c of the weights c omega_k, omega_k the fundamental weights."""


def _catalogue_name(module: _Module) -> str | None:
    """The name of the linear Lie algebra in the catalogue, or None."""
    form, weight = RealForm.of_name(module.form), module.weight
    kind, _, letter = parse_name(module.form)
    if (module.form, weight) in _SPECIAL:
        return _SPECIAL[module.form, weight]
    support, short = [(i + 1, x) for i, x in enumerate(weight) if x], short_name(module.form)
    if len(support) != 1:
        return None
    ((k, times),) = support
    if (k, times) == (1, 1) and kind in ("su", "so", "sp", "so*"):
        return module.form
    if kind == "sl" and letter in ("", "R"):
        return f"S{times}({short})" if k == 1 else f"L{k}({short})" if times == 1 else None
    if kind == "sp" and letter == "R" and k == 1:
        return f"S{times}({short})"
    if module.form == "so(3,2)":
        return f"S{times}(sp(4,R))" if k == 2 else None
    if kind == "so" and not letter and times == 1:
        last = form.rank - (form.type[0] == "D") - 1
        return f"L{k}({short})" if k <= last and module.form != "so(3)" else None
    return None


_SPECIAL: dict[tuple[str, Weight], str] = {
    ("su(2,2)", (0, 1, 0)): "so(4,2)", ("su(3,1)", (0, 1, 0)): "so*(6)", ("sl(4,R)", (0, 1, 0)): "so(3,3)",
    ("sl(2,H)", (0, 1, 0)): "so(5,1)", ("sl(2,R)", (2,)): "so(2,1)", ("sl(2,C)", (1, 1)): "so(3,1)",
    ("sl(2,C)", (2, 0)): "so(3,C)", ("sl(4,C)", (0, 1, 0, 0, 0, 0)): "so(6,C)", ("so(4,1)", (0, 1)): "sp(1,1)",
    ("g2(2)", (1, 0)): "g2(2)",
}  # fmt: skip


def _tensor_names() -> Iterator[str]:
    """Tensor products of two modules of real matrices, the smaller first, with and without scalars."""
    factors: dict[int, list[str]] = {}
    for n in range(2, TENSOR_DIMENSION // 2 + 1):
        names = [f"sl({n})"] + [f"sp({n},R)"] * (n % 2 == 0 and n > 2)
        names += [f"so({n})", *(f"so({n - q},{q})" for q in range(1, n // 2 + 1))] if n > 2 else []
        factors[n] = [*names, *(["g2", "g2(2)"] if n == 7 else [])]
    for m, n in product(factors, factors):
        if m <= n and m * n <= TENSOR_DIMENSION:
            pairs = product(factors[m], factors[n]) if m < n else combinations_with_replacement(factors[n], 2)
            for (first, second), scalars in product(pairs, ("", "+R")):
                yield f"affine(tensor({first},{second}){scalars})"
