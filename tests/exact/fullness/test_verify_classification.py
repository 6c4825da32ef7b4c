"""The check of a key, where no part of the key is wrong for a full pair: ideals and pairs that it does not take."""

from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError
from liehom.exact.fullness import verify_classification
from liehom.exact.fullness.classification_rows import Key
from liehom.exact.fullness.verify_classification import verify_key
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import Subspace


def refused(pair: lh.Pair, key: Key, ideal: Any = None) -> str:
    """The name of the check that fails."""
    with pytest.raises(CertificateError) as caught:
        verify_key(pair, key, Subspace(QQ, [], pair.algebra.dimension) if ideal is None else ideal)
    return caught.value.check


def test_no_letter_denotes_a_nilpotent_algebra() -> None:
    """The isotropy of x in the Heisenberg algebra is nilpotent: its trace and centre are those of a rotation."""
    pair = lh.Pair(lh.heisenberg(1), [[1, 0, 0]])
    assert refused(pair, Key("A", 2, 0, 4, "J", None)) == "letter"


@pytest.mark.parametrize("field", [QQ, NumberField("a", [-2, 0, 1], (1, 2))], ids=["QQ", "sqrt(2)"])
@pytest.mark.parametrize("ambient", [5, 6, 7])
def test_an_ideal_is_a_subspace_of_the_algebra(field: Any, ambient: int) -> None:
    pair = lh.pair("so(4)/so(3)")
    key, ideal = lh.classify(pair).key, Subspace(field, [], ambient)
    if field == QQ and ambient == 6:
        assert verify_key(pair, key, ideal) is None
    else:
        assert refused(pair, key, ideal) == "ideal"


def test_random_elements_that_show_nothing_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ideal of so(4)/u(2) is the largest one in h by the adjoints of all basis elements as well."""
    pair = lh.pair("so(4)/u(2)")
    result = lh.classify(pair)
    row = verify_classification._random_row
    none = lambda field, n, rng: field.zeros(1, n) if n == 6 else row(field, n, rng)  # noqa: E731
    monkeypatch.setattr(verify_classification, "_random_row", none)
    assert result.verify(pair)
    assert refused(pair, result.key, Subspace(QQ, [], 6)) == "ideal"
