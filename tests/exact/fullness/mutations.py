"""Mutants of certificates, and why an accepted mutant is a proof as well; shared by `test_mutations`.

The reasons are checked by other means than those of the checker: brackets in g, eigenvalues by numpy.
"""

import copy
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np

import liehom as lh
from tests.exact.fullness.support import rank_at

Json = dict[str, Any]
HEADER = ("format", "version", "field")


# -- mutations ---------------------------------------------------------------------------------------------
def leaves(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all numbers written as texts (the header left out)."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        if isinstance(value, str) and key not in ("format", "kind", "name") and "field" not in path:
            yield (*path, key)
        elif key != "field":
            yield from leaves(value, (*path, key))


def lists(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all lists with at least one member."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        if isinstance(value, list) and value and key != "field":
            yield (*path, key)
        if key != "field":
            yield from lists(value, (*path, key))


def at(data: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        data = data[key]
    return data


def put(data: Any, path: tuple[Any, ...], value: Any) -> None:
    at(data, path[:-1])[path[-1]] = value


def change_a_number(data: Json, rng: random.Random) -> None:
    paths = list(leaves(data))
    if paths:
        path = rng.choice(paths)
        text = at(data, path)
        other = str(Fraction(rng.randint(-5, 5), rng.randint(1, 3)))
        put(data, path, rng.choice([f"{text} + 1", f"-({text})", "0", "1", f"2*({text})", f"({text})/3", other]))


def scale_a_field(data: Json, rng: random.Random) -> None:
    name = rng.choice([key for key in data if key not in (*HEADER, "kind", "also")] or ["kind"])
    factor = rng.choice(["-1", "2", "1/3", "-5/2"])
    for path in list(leaves({name: data[name]})):
        put(data, path, f"({factor})*({at(data, path)})")


def some_rows(data: Json, rng: random.Random, least: int = 1) -> list[Any]:
    """One of the lists with at least so many members; [] if there is none."""
    paths = [p for p in lists(data) if len(at(data, p)) >= least]
    return at(data, rng.choice(paths)) if paths else []


def drop_a_row(data: Json, rng: random.Random) -> None:
    if rows := some_rows(data, rng):
        del rows[rng.randrange(len(rows))]


def swap_two_rows(data: Json, rng: random.Random) -> None:
    if rows := some_rows(data, rng, 2):
        i, j = rng.sample(range(len(rows)), 2)
        rows[i], rows[j] = rows[j], rows[i]


def repeat_a_row(data: Json, rng: random.Random) -> None:
    if rows := some_rows(data, rng):
        rows.insert(rng.randrange(len(rows) + 1), copy.deepcopy(rng.choice(rows)))


def overwrite_a_row(data: Json, rng: random.Random) -> None:
    if rows := some_rows(data, rng, 2):
        i, j = rng.sample(range(len(rows)), 2)
        rows[i] = copy.deepcopy(rows[j])


def add_two_rows(data: Json, rng: random.Random) -> None:
    """One row of a matrix or vector plus another one."""
    if rows := some_rows(data, rng, 2):
        i, j = rng.sample(range(len(rows)), 2)
        both = rows[i], rows[j]
        if all(isinstance(r, str) for r in both):
            rows[i] = f"{both[0]} + {both[1]}"
        elif all(isinstance(r, list) and len(r) == len(both[0]) and all(isinstance(x, str) for x in r) for r in both):
            rows[i] = [f"{x} + {y}" for x, y in zip(*both, strict=True)]


def change_the_root(data: Json, rng: random.Random) -> None:
    """Another minimal polynomial or interval (of the witness)."""
    if "minpoly" in data and len(data.get("interval", [])) == 2:
        f = data["minpoly"]
        data["minpoly"] = rng.choice(
            [f, ["0", *f], ["-1", "1"], ["-2", "0", "1"], ["0", "-1", "0", "1"], [f"-({c})" for c in f], [*f, "1"]]
        )
        a, b = data["interval"]
        data["interval"] = rng.choice([[a, b], [b, a], ["0", "0"], ["-100", "100"], [b, f"{b} + 1"], [f"-({b})", a]])


def change_the_kind(data: Json, rng: random.Random) -> None:
    data["kind"] = rng.choice(["trivial", "full", "witness", "commutant", "dominance"])
    if data["kind"] == "trivial":
        for key in [k for k in data if k not in (*HEADER, "kind")]:
            del data[key]
    elif data["kind"] == "full" and "eta" in data:
        data.update(form=data.get("form", []), elements=data.get("elements", []))
        for key in ("minpoly", "interval", "phi", "also"):
            data.pop(key, None)


def drop_a_field(data: Json, rng: random.Random) -> None:
    del data[rng.choice([key for key in data if key not in ("format", "version", "kind")] or ["kind"])]


def change_the_field(data: Json, rng: random.Random) -> None:
    if "field" in data:
        if rng.random() < 0.5:
            a, b = data["field"]["interval"]
            data["field"]["interval"] = [f"-({b})", f"-({a})"]
        else:
            del data["field"]
    else:
        data["field"] = {"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]}


def shift_the_cut(data: Json, rng: random.Random) -> None:
    target = data.get("also", data)
    for key in ("cut", "eps"):
        if key in target and rng.random() < 0.7:
            step = Fraction(rng.randint(-8, 8), rng.choice((1, 3, 16, 50)))
            target[key] = f"{target[key]} + ({step})"


MUTATIONS: tuple[Callable[[Json, random.Random], None], ...] = (
    *(change_a_number,) * 5, scale_a_field, scale_a_field, drop_a_row, drop_a_row, swap_two_rows, swap_two_rows,
    repeat_a_row, overwrite_a_row, add_two_rows, add_two_rows, change_the_root, change_the_kind, drop_a_field,
    change_the_field, shift_the_cut, shift_the_cut,
)  # fmt: skip


def mutant(data: Json, rng: random.Random) -> tuple[str, Json]:
    """A mutant by one mutation, now and then by two."""
    built, names = copy.deepcopy(data), []
    for _ in range(2 if rng.random() < 0.15 else 1):
        mutation = rng.choice(MUTATIONS)
        if set(built) >= {"kind"} and built["kind"] in ("trivial", "full", "witness", "commutant", "dominance"):
            mutation(built, rng)
            names.append(mutation.__name__)
    return " and ".join(names), built


# -- explanations ------------------------------------------------------------------------------------------
def explained(pair: lh.Pair, before: lh.Certificate, after: lh.Certificate) -> str | None:
    """Why an accepted mutant proves the same verdict, or None if no reason is known."""
    if after.kind != before.kind:
        return "trivial: nothing to prove" if after.kind == "trivial" and pair.dimension <= 1 else None
    changed = {name for name in {*before.fields, *after.fields} if not _same(pair, before, after, name)}
    if not changed:
        return "the same numbers, written otherwise"
    return {"full": _full, "witness": _witness, "commutant": _commutant, "dominance": _dominance}[after.kind](
        pair, before, after, changed
    )


def _same(pair: lh.Pair, before: lh.Certificate, after: lh.Certificate, name: str) -> bool:
    if name not in before.fields or name not in after.fields:
        return False
    if name == "also":
        return bool(before.fields[name] == after.fields[name])
    return _numbers(pair, before, name) == _numbers(pair, after, name)


def _numbers(pair: lh.Pair, certificate: lh.Certificate, name: str) -> Any:
    n, value = pair.algebra.dimension, certificate.fields[name]
    if name in ("form", "elements", "complement", "matrix"):
        d = pair.dimension
        shape = {"form": (n, n), "elements": (None, n), "complement": (d, n), "matrix": (d, d)}[name]
        return certificate.matrix(name, *shape).to_rows()
    if not isinstance(value, tuple):
        return certificate.number(name)
    entries = [entry if isinstance(entry, tuple) else (entry,) for entry in value]
    return [list(entry[: max((k for k, x in enumerate(entry) if x != 0), default=0) + 1]) for entry in entries]


def _full(pair: lh.Pair, before: lh.Certificate, after: lh.Certificate, changed: set[str]) -> str | None:
    g, n, h = pair.algebra, pair.algebra.dimension, pair.subalgebra
    reasons = []
    first, form = (c.matrix("form", n, n) for c in (before, after))
    if "form" in changed:
        i, j = next((i, j) for i in range(n) for j in range(n) if first[i, j] != 0)
        factor = form[i, j] / first[i, j]
        if first.scale(factor) != form or not factor > 0:
            return None
        reasons.append("a positive multiple of the form")
    elements, eta = after.matrix("elements", None, n), g.row(after.vector("eta", n))
    moved = [eta @ g.ad(row).T for row in elements.to_rows()]
    if g.field.stack_rows([h.basis, eta, *moved], n).rank() < n:
        return None
    if "elements" in changed:
        similar = all(_is_similarity(g.ad(row), form) for row in elements.to_rows())
        if not similar or g.field.stack_rows([h.basis, elements], n).rank() > h.dimension:
            return None
        reasons.append("any similarities of the form in h that span")
    if "eta" in changed:
        reasons.append("any eta at which the elements span")
    return " and ".join(reasons)


def _is_similarity(ad: Any, form: Any) -> bool:
    left = form @ ad
    left = left + left.T
    i = next(i for i in range(form.nrows) if form[i, i] != 0)
    return bool(left == form.scale(left[i, i] / form[i, i]))


def _witness(pair: lh.Pair, before: lh.Certificate, after: lh.Certificate, changed: set[str]) -> str | None:
    also = after.fields.get("also")
    if "also" in changed:
        if also is not None and explained(pair, before.fields["also"], also) is None:
            return None
        changed = changed - {"also"}
        if not changed:
            return "a second proof may be absent" if also is None else "another second proof"
    if all(len(entry) == 1 for name in ("eta", "phi") for entry in _numbers(pair, after, name)):
        eta = [entry[0] for entry in _numbers(pair, after, "eta")]
        outside = rank_at(pair, eta) > 0
        if changed <= {"minpoly", "interval"}:
            return "eta and phi over the field itself use no root"
        return "any eta outside h at which the rank drops" if outside and rank_at(pair, eta) < pair.dimension else None
    roots = _real_roots(after.field, _numbers(pair, after, "minpoly"), _numbers(pair, after, "interval"))
    if not roots:
        return None
    for root in roots:
        x, phi = (np.array([_at(after.field, e, root) for e in _numbers(pair, after, name)]) for name in ("eta", "phi"))
        if not _annihilates(pair, x, phi):
            return None
    kept = [name for name in ("eta", "phi", "minpoly", "interval") if name in changed]
    return f"another {' and '.join(kept)} with phi[h, eta] = 0 at each root"


def _real_roots(field: Any, minpoly: Any, interval: Any) -> list[float]:
    low, high = (field.to_float(entry[0]) for entry in interval)
    coefficients = [field.to_float(entry[0]) for entry in minpoly]
    return [r.real for r in np.roots(coefficients[::-1]) if abs(r.imag) < 1e-9 and low <= r.real <= high]


def _at(field: Any, polynomial: Any, root: float) -> float:
    return sum(float(field.to_float(c)) * root**k for k, c in enumerate(polynomial))


def _annihilates(pair: lh.Pair, eta: Any, phi: Any) -> bool:
    """phi != 0 kills h, eta and [h, eta], and eta is outside h, in floats."""
    basis = pair.subalgebra.basis.to_numpy()
    moved = [pair.algebra.ad(row).to_numpy() @ eta for row in pair.subalgebra.basis.to_rows()]
    size = np.abs(phi).max() * max(np.abs(eta).max(), 1e-300)
    products = [basis @ phi, *(m @ phi for m in (eta, *moved))]
    small = all(np.abs(p).max(initial=0.0) < 1e-8 * max(size, np.abs(phi).max()) for p in products)
    outside = np.abs(eta @ pair.subalgebra.quotient().projection.to_numpy()).max() > 1e-8 * np.abs(eta).max()
    return bool(small and outside and np.abs(phi).max() > 0)


def _commutant(pair: lh.Pair, _: lh.Certificate, after: lh.Certificate, changed: set[str]) -> str | None:
    n, d = pair.algebra.dimension, pair.dimension
    complement, t = after.matrix("complement", d, n), after.matrix("matrix", d, d)
    basis = complement @ pair.subalgebra.quotient().projection
    if basis.rank() < d:
        return None
    acting = basis.T @ t @ basis.T.inverse()
    parts = np.linalg.eigvals(t.to_numpy()).real
    cut = after.field.to_float(after.number("cut"))
    commutes = all(acting @ a == a @ acting for a in pair.isotropy_matrices())
    between = 0 < (parts > cut).sum() < d and np.abs(parts - cut).min() > 1e-9
    return f"another {' and '.join(sorted(changed))} that splits V" if commutes and between else None


def _dominance(pair: lh.Pair, _: lh.Certificate, after: lh.Certificate, changed: set[str]) -> str | None:
    """The counts of the certificate by eigenvalues of numpy (roots nearer to a bound than 1e-6 count as unclear)."""
    cut, eps = (after.field.to_float(after.number(name)) for name in ("cut", "eps"))
    ad = pair.algebra.ad(after.vector("element", pair.algebra.dimension))
    data = pair.subalgebra.quotient()
    rho = (data.lift @ ad.T @ data.projection).T.to_numpy()
    if not (data.subspace @ ad.T @ data.projection).is_zero() or eps <= 0:
        return None
    d = pair.dimension
    weights = np.linalg.eigvals(rho - np.eye(d) * np.trace(rho) / d).real
    flat = np.array([a.to_numpy().ravel() for a in pair.isotropy_matrices()])
    image = np.linalg.svd(flat)[2][: np.linalg.matrix_rank(flat)]
    moved = [(rho @ b.reshape(d, d) - b.reshape(d, d) @ rho).ravel() for b in image]
    roots = np.linalg.eigvals(np.array(moved) @ image.T).real
    gap = np.abs(np.concatenate([weights - cut, weights - cut + eps, roots + eps])).min() > 1e-6
    above = (weights > cut).sum()
    clear = above == (weights > cut - eps).sum()
    fewer = above > 0 and above + (roots <= -eps).sum() < d
    return f"another {' and '.join(sorted(changed))} that dominates" if gap and clear and fewer else None
