"""Number fields from user input: 'sqrt(2)', a polynomial with an interval, a sympy expression.

`number_field` constructs the field of one number, `common_field` one that contains all values of a list of strings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import gcd, prod
from typing import Any

import flint

from liehom.budget import current_limits, within
from liehom.errors import FieldError, displayed, shown
from liehom.scalars.fields import grammar
from liehom.scalars.fields.balls import real_root_balls, working_precision
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.rational import QQ, RationalField
from liehom.typing import Number, ScalarLike

TRIAL_PRIMES = 6542
"""Primes below 2^16, by which the number under a square root is divided."""
FACTORED_BITS = 128
"""A rest of more bits after these divisions is not factored."""


def number_field(
    generator: str | Sequence[ScalarLike] | Number,
    interval: tuple[ScalarLike, ScalarLike] | None = None,
    name: str = "a",
) -> RationalField | NumberField:
    """The real number field QQ(a).

    Parameters
    ----------
    generator : str, sympy expression, or sequence of coefficients
        The number a ('sqrt(2)', 'sqrt(2 + sqrt(2))', ``sympy.root(2, 3)``), or the ascending rational
        coefficients of its minimal polynomial.
    interval : pair, optional
        With a polynomial: rational ends of an interval that contains exactly one of its real roots.
    name : str
        Symbol of a generator that is not a plain square root.

    Returns
    -------
    RationalField or NumberField
        QQ if a is rational.

    Raises
    ------
    FieldError
        If the number is not real algebraic, or the polynomial and interval do not define a real number.
    ParseError
        If a string is not in the grammar of values.

    Examples
    --------
    >>> K = number_field("sqrt(2)")
    >>> K, K.convert("1/sqrt(2)")
    (QQ(sqrt(2)), 1/2*sqrt(2))
    >>> number_field([-1, -1, 0, 1], (1, 2), name="p").degree
    3
    """
    if isinstance(generator, str):
        return _field_of_tree(grammar.parse(generator), name)
    if isinstance(generator, Sequence):
        if interval is None:
            raise FieldError("a polynomial needs an interval that contains exactly one of its real roots")
        return NumberField(name, generator, interval)
    if hasattr(generator, "free_symbols"):
        return _field_of_sympy(generator, name)
    raise FieldError(
        f"{displayed(generator)} does not describe a number field; write 'sqrt(2)' or coefficients and an interval"
    )


def common_field(texts: Iterable[str]) -> RationalField | NumberField:
    """A field that contains all values: QQ, QQ(sqrt(d)), or a field with several radicals.

    Examples
    --------
    >>> common_field(["1/2", "sqrt(8)"])
    QQ(sqrt(2))
    """
    radicals: list[int] = []
    nested: list[grammar.Node] = []
    for text in texts:
        if "s" not in text:  # no sqrt: the common case, decided without parsing
            continue
        for argument in grammar.sqrt_arguments(grammar.parse(text)):
            if grammar.sqrt_arguments(argument):
                nested += [grammar.Call("sqrt", argument)] if grammar.Call("sqrt", argument) not in nested else []
                continue
            kernel = _kernel(grammar.evaluate(argument, flint.fmpq, {}, {}))
            if kernel != 1 and kernel not in radicals:
                radicals.append(kernel)
            _check_radicals((len(radicals) + len(nested) - 1) // 16)
    radicals = _independent(radicals)
    _check_radicals(len(radicals) + len(nested))
    if not nested and len(radicals) <= 1:
        return _quadratic(radicals[0]) if radicals else QQ
    terms: list[grammar.Node] = [grammar.Call("sqrt", grammar.Number(flint.fmpz(d))) for d in radicals]
    tree = terms[0] if terms else nested.pop(0)
    for weight, term in enumerate([*terms[1:], *nested], start=1):
        tree = grammar.Operation("+", (tree, grammar.Operation("*", (grammar.Number(flint.fmpz(weight)), term))))
    return _field_of_tree(tree, "a")


def exact_value(text: str) -> Scalar:
    """The real algebraic number that a string denotes, in the field that `common_field` finds.

    Examples
    --------
    >>> exact_value("(1 + sqrt(5))/2")
    1/2 + 1/2*sqrt(5)
    """
    return common_field([text]).convert(text)


def _check_radicals(count: int) -> None:
    within(
        "radicals",
        count,
        "the values have {} different square roots or more, and a field with all of them has a large degree: state a "
        "field by its minimal polynomial, or use fewer",
    )


def _kernel(value: flint.fmpq) -> int:
    """An integer d such that sqrt(value) is a rational multiple of sqrt(d), 1 if that is rational.

    It is squarefree if at most `FACTORED_BITS` bits are left after trial division. Of a larger rest only squares are
    recognized, so the field is the same, but its generator may be a multiple of the smallest square root.
    """
    if value < 0:
        raise FieldError(f"sqrt({shown(str(value))}) is not real")
    rest = flint.fmpz(value.p) * flint.fmpz(value.q)
    if rest == 0 or rest.is_square():
        return 1
    kernel = flint.fmpz(1)
    for factor, multiplicity in rest.factor(trial_limit=TRIAL_PRIMES):
        if multiplicity % 2:
            kernel *= _squarefree_rest(factor)
    return int(kernel)


def _squarefree_rest(factor: flint.fmpz) -> flint.fmpz:
    """The rest after trial division, prime or composite, without its squares if these are easy to find."""
    if factor.is_square():
        return flint.fmpz(1)
    if factor.bit_length() > FACTORED_BITS:
        return factor
    odd = [prime for prime, multiplicity in factor.factor() if multiplicity % 2]
    return prod(odd, start=flint.fmpz(1))


def _independent(radicals: list[int]) -> list[int]:
    """Radicals that are independent modulo squares (over F_2), so that none is in the field of the others."""
    kept: list[int] = []
    products = {1}
    for d in radicals:
        if len(kept) > current_limits().radicals:
            break
        if any(flint.fmpz(d * e).is_square() for e in products):
            continue
        kept.append(d)
        products |= {d * e // gcd(d, e) ** 2 for e in products}
    return kept


def _quadratic(d: int) -> NumberField:
    number = flint.fmpz(d)  # prints any number of digits
    root = int(number.isqrt())
    return NumberField(f"sqrt({number})", [-d, 0, 1], (root, root + 1))


def _field_of_tree(tree: grammar.Node, name: str) -> RationalField | NumberField:
    match tree:
        case grammar.Call("sqrt", argument) if not grammar.sqrt_arguments(argument):
            kernel = _kernel(grammar.evaluate(argument, flint.fmpq, {}, {}))
            return QQ if kernel == 1 else _quadratic(kernel)
    import sympy

    roots = {str(argument) for argument in grammar.sqrt_arguments(tree)}
    within("minpoly_degree", 2 ** len(roots), "the square roots of a value give a field of degree up to {}")
    # Trees hold only integers, operators and sqrt, so building the expression executes nothing else.
    expression = grammar.evaluate(tree, lambda n: sympy.Integer(int(n)), {}, {"sqrt": sympy.sqrt})
    arguments = grammar.sqrt_arguments(tree)
    nested = any(map(grammar.sqrt_arguments, arguments))
    kernels = [] if nested else [_kernel(grammar.evaluate(argument, flint.fmpq, {}, {})) for argument in arguments]
    return _field_of_sympy(expression, name, _independent([d for d in kernels if d != 1]))


def _field_of_sympy(expression: Any, name: str, radicals: Sequence[int] = ()) -> RationalField | NumberField:
    import sympy

    if expression.free_symbols or expression.is_real is False:
        raise FieldError(f"{expression} is not a real number")
    try:
        polynomial = sympy.minimal_polynomial(expression, polys=True)
    except (NotImplementedError, sympy.polys.polyerrors.BasePolynomialError) as error:
        raise FieldError(f"{expression} is not recognized as an algebraic number: {error}") from None
    coefficients = [flint.fmpq(int(c.p), int(c.q)) for c in reversed(polynomial.all_coeffs())]
    if len(coefficients) == 2:
        return QQ
    integral = flint.fmpq_poly(coefficients).numer()
    for digits in (30, 60, 120, 240, 480):
        value = sympy.re(sympy.N(expression, digits))
        near = flint.fmpq(flint.fmpz(int(value * 10**digits)), flint.fmpz(10) ** digits)
        margin = flint.fmpq(1, flint.fmpz(10) ** (digits // 2))
        balls = real_root_balls(integral, 8 * digits)
        with working_precision(8 * digits):
            low, high = flint.arb(near - margin), flint.arb(near + margin)
            inside = [b for b in balls if b > low and b < high]
        if len(inside) == 1:
            return NumberField(name, coefficients, (near - margin, near + margin), radicals)
    raise FieldError(f"{expression} could not be distinguished from its conjugates; give a polynomial and an interval")
