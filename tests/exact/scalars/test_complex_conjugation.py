"""Complex conjugation as an automorphism of a number field: where it is one, and where it is proved to be none."""

import numpy as np
import pytest

from liehom.base.errors import InputError
from liehom.exact.scalars.joint_spectrum import complex_conjugation
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ

TOTALLY_REAL = [[-1, 1], [-2, 0, 1], [1, -3, 0, 1]]
COMPLEX_MULTIPLICATION = [[1, 0, 1], [1, 1, 1, 1, 1], [1, 0, 0, 0, 1], [5, 0, 5, 0, 1], [13, 0, 14, 0, 1]]
NEITHER = [[-2, 0, 0, 1], [2, 0, 0, 0, 1], [1, 1, 0, 0, 1], [3, 0, 1, 0, 1]]


@pytest.mark.parametrize("coefficients", [*TOTALLY_REAL, *COMPLEX_MULTIPLICATION])
def test_the_polynomial_conjugates_every_root(coefficients: list[int]) -> None:
    result = complex_conjugation(Polynomial(QQ, coefficients))
    assert result is not None
    roots = np.roots(coefficients[::-1])
    values = np.polynomial.polynomial.polyval(roots, [float(c) for c in result.coefficients])
    assert np.abs(values - roots.conj()).max() < 1e-9


@pytest.mark.parametrize("coefficients", NEITHER)
def test_conjugation_without_a_rational_polynomial_is_none(coefficients: list[int]) -> None:
    assert complex_conjugation(Polynomial(QQ, coefficients)) is None


@pytest.mark.parametrize("coefficients", [[1, 0, 2], [QQ.one / 2, 0, 1]])
def test_conjugation_of_non_integral_polynomials_raises_input_error(coefficients: list[object]) -> None:
    with pytest.raises(InputError, match="monic"):
        complex_conjugation(Polynomial(QQ, coefficients))
