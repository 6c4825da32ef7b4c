"""Number fields from user input: 'sqrt(2)', a polynomial with an interval, a sympy expression.

`number_field` constructs the field of one number, `common_field` one that contains all values of a list of strings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import flint

from liehom.errors import FieldError
from liehom.scalars.fields import grammar
from liehom.scalars.fields.balls import real_root_balls, working_precision
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.rational import QQ, RationalField
from liehom.typing import Number, ScalarLike

MAX_RADICALS = 4
MAX_RADICAND_BITS = 200


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
    raise FieldError(f"{generator!r} does not describe a number field; write 'sqrt(2)' or coefficients and an interval")


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
            if len(radicals) + len(nested) > 16 * MAX_RADICALS:
                raise _too_many_radicals()
    radicals = _independent(radicals)
    if len(radicals) + len(nested) > MAX_RADICALS:
        raise _too_many_radicals()
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


def _too_many_radicals() -> FieldError:
    return FieldError(
        f"more than {MAX_RADICALS} different square roots: a field with all of them has a very large degree; "
        "state a field by its minimal polynomial, or use fewer"
    )


def _kernel(value: flint.fmpq) -> int:
    """The squarefree integer d with sqrt(value) a rational multiple of sqrt(d)."""
    if value < 0:
        raise FieldError(f"sqrt({value}) is not real")
    product = flint.fmpz(value.p) * flint.fmpz(value.q)
    if product == 0 or product.isqrt() ** 2 == product:
        return 1
    if product.bit_length() > MAX_RADICAND_BITS:
        raise FieldError(f"the number under a square root has {product.bit_length()} bits, too many to factor")
    kernel = flint.fmpz(1)
    for prime, multiplicity in product.factor():
        if multiplicity % 2:
            kernel *= prime
    return int(kernel)


def _independent(radicals: list[int]) -> list[int]:
    """Radicals that are independent modulo squares (over F_2), so that none is in the field of the others."""
    kept: list[int] = []
    products = {1}
    for d in radicals:
        if len(kept) > MAX_RADICALS:
            break
        if d in products:
            continue
        kept.append(d)
        products |= {_kernel(flint.fmpq(d * e)) for e in products}
    return kept


def _quadratic(d: int) -> NumberField:
    root = int(flint.fmpz(d).isqrt())
    return NumberField(f"sqrt({d})", [-d, 0, 1], (root, root + 1))


def _field_of_tree(tree: grammar.Node, name: str) -> RationalField | NumberField:
    match tree:
        case grammar.Call("sqrt", argument) if not grammar.sqrt_arguments(argument):
            kernel = _kernel(grammar.evaluate(argument, flint.fmpq, {}, {}))
            return QQ if kernel == 1 else _quadratic(kernel)
    import sympy

    # Trees hold only integers, operators and sqrt, so building the expression executes nothing else.
    expression = grammar.evaluate(tree, lambda n: sympy.Integer(int(n)), {}, {"sqrt": sympy.sqrt})
    return _field_of_sympy(expression, name)


def _field_of_sympy(expression: Any, name: str) -> RationalField | NumberField:
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
            return NumberField(name, coefficients, (near - margin, near + margin))
    raise FieldError(f"{expression} could not be distinguished from its conjugates; give a polynomial and an interval")
