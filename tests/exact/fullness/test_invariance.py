"""What the verdict may not depend on: the basis, conjugation, ideals in h, scalars, duality, the field."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, event, given, settings, strategies as st

import liehom as lh
from liehom.exact.fullness import decide
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests import sampling
from tests.exact.fullness.strategies import changes, linear_pairs, pairs, subalgebra_pairs
from tests.exact.fullness.support import affine, in_basis, over, proved, without_cheap_points

QUICK, SLOW = 100, 1500
FIELDS = [NumberField("a", [-d, 0, 1], (0, d)) for d in (2, 3, 5)] + [NumberField("a", [-2, 0, 0, 1], (1, 2))]


def examples(count: int) -> Callable[[Any], Any]:
    return settings(
        max_examples=sampling.examples(count), suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much]
    )


def both_sizes(check: Callable[..., None], **strategies: Any) -> tuple[Any, Any]:
    """The test at reduced size, and the slow one."""

    def fresh(data: Any) -> None:
        check(data, **{name: data.draw(s, label=name) for name, s in strategies.items()})

    quick = examples(QUICK)(given(data=st.data())(fresh))
    return quick, pytest.mark.slow(examples(SLOW)(given(data=st.data())(fresh)))


def decided(pair: lh.Pair) -> bool:
    verdict = lh.decide_fullness(pair)
    assert verdict.verify()
    event("full" if verdict.full else f"not full by {verdict.certificate.kind}")
    return bool(verdict.full)


def basis_change(data: Any, pair: lh.Pair) -> None:
    full = decided(pair)
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    proved(in_basis(pair, data.draw(changes(n)), data.draw(changes(k))), full)


test_change_of_basis, test_change_of_basis_slow = both_sizes(basis_change, pair=pairs())


def conjugation(data: Any, pair: lh.Pair) -> None:
    """exp(ad x) is an automorphism of g for ad x nilpotent."""
    g = pair.algebra
    nilpotent = [i for i in range(g.dimension) if _is_nilpotent(g.ad(_unit(g, i)))]
    assume(nilpotent)
    full, matrix = decided(pair), g.field.identity(g.dimension)
    for _ in range(data.draw(st.integers(1, 3))):
        ad = g.ad(_unit(g, data.draw(st.sampled_from(nilpotent)))).scale(data.draw(st.sampled_from([1, -2, "1/2"])))
        matrix = _exponential(ad) @ matrix
    proved(lh.Pair(g, pair.subalgebra.basis @ matrix.T), full)


def _unit(g: lh.LieAlgebra, i: int) -> Any:
    return g.field.unit(g.dimension, i)


def _is_nilpotent(a: Any) -> bool:
    return all(c == 0 for c in a.characteristic_coefficients()[:-1])


def _exponential(a: Any) -> Any:
    total = term = a.field.identity(a.nrows)
    for k in range(1, a.nrows + 1):
        term = (term @ a).scale(QQ.convert(f"1/{k}"))
        total = total + term
    return total


test_conjugation, test_conjugation_slow = both_sizes(conjugation, pair=pairs())


def ideal_in_h(_: Any, pair: lh.Pair) -> None:
    """(g, h) and (g/N, h/N), N the largest ideal of g in h."""
    g, h = pair.algebra, pair.subalgebra
    rows, before = h.basis, -1
    while rows.nrows != before:
        before = rows.nrows
        rows = _stable_part(g, rows)
    event(f"ideal of dimension {min(rows.nrows, 3)}")
    ideal = g.subalgebra(rows)
    images = (h.basis @ ideal.quotient().projection).row_space()
    proved(lh.Pair(ideal.quotient_algebra(), images), decided(pair))


def _stable_part(g: lh.LieAlgebra, rows: Any) -> Any:
    """The elements x of the span of the rows with [g, x] in it."""
    if not rows.nrows:
        return rows
    outside = rows.null_space().T  # columns: the linear forms that vanish on the span
    conditions = [rows @ g.ad(_unit(g, i)).T @ outside for i in range(g.dimension)]
    kernel = g.field.stack_columns(conditions, rows.nrows).left_null_space() if outside.ncols else None
    return rows if kernel is None else kernel @ rows


test_ideal_in_h, test_ideal_in_h_slow = both_sizes(ideal_in_h, pair=subalgebra_pairs())


def action(pair: lh.Pair) -> list[Any]:
    return list(pair.isotropy_matrices())


def scalars(_: Any, pair: lh.Pair) -> None:
    """Scalars move no ray."""
    identity = QQ.identity(pair.dimension)
    proved(affine([*action(pair), identity]), decided(pair))


test_scalars, test_scalars_slow = both_sizes(scalars, pair=linear_pairs())


def later_steps(_: Any, pair: lh.Pair) -> None:
    """Where the cheap sample points do not decide, the later steps come to the same verdict."""
    full = decided(pair)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(decide, "_sample", without_cheap_points)
        certificate = proved(pair, full).certificate
    event(f"then by {certificate.kind}, degree {len(certificate.fields.get('minpoly', '01')) - 1}")


test_later_steps, test_later_steps_slow = both_sizes(later_steps, pair=pairs())


def duality(_: Any, pair: lh.Pair) -> None:
    """V and its dual: in an inner product in which an irreducible L0 is self-adjoint, -A^T runs through L0 again."""
    proved(affine([-a.T for a in action(pair)]), decided(pair))


test_duality, test_duality_slow = both_sizes(duality, pair=linear_pairs())


def isotropy_alone(_: Any, pair: lh.Pair) -> None:
    """Only the isotropy representation counts: (g, h) and rho(h) + g/h."""
    assume(pair.subalgebra.dimension and pair.dimension and any(not a.is_zero() for a in action(pair)))
    proved(affine(action(pair)), decided(pair))


test_isotropy_alone, test_isotropy_alone_slow = both_sizes(isotropy_alone, pair=subalgebra_pairs())


def larger_field(_: Any, pair: lh.Pair, field: Any) -> None:
    proved(over(pair, field), decided(pair))


test_larger_field, test_larger_field_slow = both_sizes(larger_field, pair=pairs(), field=st.sampled_from(FIELDS))


def products(_: Any, first: lh.Pair, second: lh.Pair) -> None:
    """g1 + g2 over h1 + h2 is full only where one factor is a point and the other full."""
    n, m = first.algebra.dimension, second.algebra.dimension
    h, k = first.subalgebra, second.subalgebra
    top = QQ.stack_columns([h.basis, QQ.zeros(h.dimension, m)], h.dimension)
    bottom = QQ.stack_columns([QQ.zeros(k.dimension, n), k.basis], k.dimension)
    joined = lh.Pair(lh.direct_sum(first.algebra, second.algebra), QQ.stack_rows([top, bottom], n + m))
    full = {0: second, 1: first}
    expected = min(first.dimension, second.dimension) == 0 and decided(full[first.dimension > 0])
    proved(joined, expected)


test_products, test_products_slow = both_sizes(products, first=pairs(), second=pairs())
