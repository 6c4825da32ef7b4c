"""Names of the symmetric pairs of simple real algebras: the lists of Berger, with the ideals of h.

For each h the lists give its ideals: dimensions of the intersections with k and p, and the ratio c of Killing forms,
B_h = c B_g on the ideal. If h is a block or scalar subalgebra of the matrices of g, c is a quotient of the dual Coxeter
numbers in the vector representation: n for sl(n), n - 2 for so(n), n + 1 for sp(n), with the factor 2 where a
representation W + W* or S^2 doubles the index. These data identify the conjugacy class of the involution, see
`liehom.algebra.roots.real_form_involutions`; the tests identify h itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from liehom.algebra.roots.real_form import RealForm, real_forms
from liehom.algebra.roots.real_form_names import parse_name

Ideals = tuple[tuple[Fraction, int, int], ...]
Parts = list[tuple[Fraction, int, int]]
Named = tuple[str, Parts]
"""A summand of h: its name ('' for 0) and ratio, dimension in k, dimension in p of its ideals."""


def isotropy_names(form: RealForm) -> dict[Ideals, str]:
    """The name of h for each class of involutions of a real form, by the ideals of h.

    Parameters
    ----------
    form : RealForm
        Classical, but not so*(2n) with n > 4, or of type G2 or F4.

    Examples
    --------
    >>> sorted(isotropy_names(RealForm.of_name("su(2,1)")).values())
    ['so(2,1)', 'u(1,1)', 'u(2)']
    """
    kind, numbers, letter = parse_name(form.name)
    found: dict[Ideals, str] = {}
    for name, parts in _LISTS[kind + letter](form, numbers):
        found.setdefault(merged(parts), name)
    return found


def merged(parts: Parts) -> Ideals:
    """The sums of the dimensions for each ratio, sorted, as in `InvolutionType.ideals`.

    Examples
    --------
    >>> merged([(Fraction(1, 2), 3, 0), (Fraction(1, 2), 1, 2)])
    ((Fraction(1, 2), 4, 2),)
    """
    sums: dict[Fraction, list[int]] = {}
    for ratio, compact, noncompact in parts:
        if compact + noncompact:
            entry = sums.setdefault(ratio, [0, 0])
            entry[0] += compact
            entry[1] += noncompact
    return tuple((ratio, sums[ratio][0], sums[ratio][1]) for ratio in sorted(sums))


def _so(a: int, b: int, whole: int) -> Named:
    n = a + b
    ratio = Fraction(max(n - 2, 0), whole)
    return _signed("so", a, b) if n > 1 else "", [(ratio, a * (a - 1) // 2 + b * (b - 1) // 2, a * b)]


def _so_complex(n: int, whole: int) -> Named:
    half = n * (n - 1) // 2
    return f"so({n},C)" if n > 1 else "", [(Fraction(max(n - 2, 0), whole), half, half)]


def _so_star(n: int, whole: int) -> Named:
    """so*(2n)."""
    return f"so*({2 * n})", [(Fraction(2 * n - 2, whole), n * n, n * (n - 1))]


def _sp(a: int, b: int, whole: int) -> Named:
    n = a + b
    return _signed("sp", a, b), [(Fraction(n + 1, whole), a * (2 * a + 1) + b * (2 * b + 1), 4 * a * b)]


def _sp_real(n: int, whole: int) -> Named:
    """sp(2n,R)."""
    return f"sp({2 * n},R)", [(Fraction(n + 1, whole), n * n, n * (n + 1))]


def _sp_complex(n: int, whole: int) -> Named:
    """sp(2n,C)."""
    return f"sp({2 * n},C)", [(Fraction(n + 1, whole), n * (2 * n + 1), n * (2 * n + 1))]


def _u(a: int, b: int, whole: int) -> Named:
    n = a + b
    return _signed("u", a, b), [(Fraction(n, whole), a * a + b * b - 1, 2 * a * b), (Fraction(0), 1, 0)]


def _gl(n: int, whole: int) -> Named:
    return f"gl({n})", [(Fraction(n, whole), n * (n - 1) // 2, n * (n + 1) // 2 - 1), (Fraction(0), 0, 1)]


def _gl_complex(n: int, whole: int) -> Named:
    return f"gl({n},C)", [(Fraction(n, whole), n * n - 1, n * n - 1), (Fraction(0), 1, 1)]


def _gl_quaternionic(n: int, whole: int) -> Named:
    return f"gl({n},H)", [(Fraction(2 * n, whole), n * (2 * n + 1), n * (2 * n - 1) - 1), (Fraction(0), 0, 1)]


def _sl_complex(n: int, whole: int, center: str) -> Named:
    """sl(n,C) + u(1) or sl(n,C) + R."""
    compact = center == "u(1)"
    parts = [(Fraction(n, whole), n * n - 1, n * n - 1), (Fraction(0), int(compact), int(not compact))]
    return f"sl({n},C)+{center}" if n > 1 else "so(2)" if compact else "so(1,1)", parts


def _plus(*named: Named) -> Named:
    """The sum of subalgebras, the larger first."""
    ordered = sorted(named, key=lambda one: -sum(k + p for _, k, p in one[1]))
    return "+".join(name for name, _ in ordered if name), [part for _, parts in ordered for part in parts]


def _special(first: Named, second: Named, center: tuple[int, int], unit: str) -> Named:
    """The traceless part of a sum, with the dimensions of its centre in k and p; a alone for su(p,q) and b = u(1)."""
    name, parts = _plus(first, second)
    parts = [part for part in parts if part[0]] + [(Fraction(0), *center)]
    one, two = name.split("+")
    return one if unit == "u" and two in ("u(1)", "u(0,1)") else f"s({name})", parts


def _signed(kind: str, a: int, b: int) -> str:
    return f"{kind}({a},{b})" if a and b else f"{kind}({a + b})"


def _splittings(p: int, q: int) -> Iterator[tuple[int, int]]:
    """The (a, b) with 0 <= a <= p, 0 <= b <= q that are neither (0, 0) nor (p, q) and a + b at least half."""
    pairs = ((a, b) for a in range(p, -1, -1) for b in range(q, -1, -1))
    return ((a, b) for a, b in pairs if p + q > a + b and 2 * (a + b) >= p + q)


def _of_su(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    n = p + q
    for a, b in _splittings(p, q):
        yield _special(_u(a, b, n), _u(p - a, q - b, n), (1, 0), "u")
    yield _so(p, q, 2 * n)
    if p % 2 == 0 and q % 2 == 0:
        yield _sp(p // 2, q // 2, n)
    if p == q:
        yield from (_so_star(p, 2 * n), _sp_real(p, n), _sl_complex(p, n, "R"))


def _of_sl_real(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_so(n - q, q, 2 * n) for q in range(n // 2 + 1))
    if n > 2:
        yield from (_special(_gl(n - q, n), _gl(q, n), (0, 1), "gl") for q in range(1, n // 2 + 1))
        if n % 2 == 0:
            yield from (_sp_real(n // 2, n), _sl_complex(n // 2, n, "u(1)"))


def _of_sl_quaternionic(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_sp(n - q, q, 2 * n) for q in range(n // 2 + 1))
    yield from (
        _special(_gl_quaternionic(n - q, 2 * n), _gl_quaternionic(q, 2 * n), (0, 1), "gl") for q in range(1, n // 2 + 1)
    )
    yield from (_so_star(n, 4 * n), _sl_complex(n, 2 * n, "u(1)"))


def _of_so(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    whole = p + q - 2
    for a, b in _splittings(p, q):
        yield _plus(_so(a, b, whole), _so(p - a, q - b, whole))
    if p % 2 == 0 and q % 2 == 0:
        yield _u(p // 2, q // 2, whole)
    if p == q:
        yield from (_so_complex(p, whole), _gl(p, whole))


def _of_sp(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    whole = p + q + 1
    for a, b in _splittings(p, q):
        yield _plus(_sp(a, b, whole), _sp(p - a, q - b, whole))
    yield _u(p, q, 2 * whole)
    if p == q:
        yield from (_gl_quaternionic(p, 2 * whole), _sp_complex(p, whole))


def _of_sp_real(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0] // 2
    yield from (_u(n - q, q, 2 * n + 2) for q in range(n // 2 + 1))
    yield from (_plus(_sp_real(n - q, n + 1), _sp_real(q, n + 1)) for q in range(1, n // 2 + 1))
    yield _gl(n, 2 * n + 2)
    if n % 2 == 0:
        yield _sp_complex(n // 2, n + 1)


def _of_sl_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield _so_complex(n, 2 * n)
    if n > 2:
        yield from (_special(_gl_complex(n - q, n), _gl_complex(q, n), (1, 1), "gl") for q in range(1, n // 2 + 1))
        if n % 2 == 0:
            yield _sp_complex(n // 2, n)
    yield from _conjugations(form)


def _of_so_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_plus(_so_complex(n - q, n - 2), _so_complex(q, n - 2)) for q in range(1, n // 2 + 1))
    if n % 2 == 0:
        yield _gl_complex(n // 2, n - 2)
    yield from _conjugations(form)


def _of_sp_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0] // 2
    yield from (_plus(_sp_complex(n - q, n + 1), _sp_complex(q, n + 1)) for q in range(1, n // 2 + 1))
    yield _gl_complex(n, 2 * n + 2)
    yield from _conjugations(form)


def _of_exceptional(form: RealForm, _: tuple[int, ...]) -> Iterator[Named]:
    yield from _EXCEPTIONAL[form.name]
    if form.is_complex:
        yield from _conjugations(form)


def _conjugations(form: RealForm) -> Iterator[Named]:
    """The real forms of a complex algebra, on which the Killing form is half that of the algebra as a real one."""
    for other in real_forms(form.type):
        compact = other.compact_dimension
        name = {"so(3)": "su(2)"}.get(other.name, other.name)  # as sl(2,C) is written
        name = name.replace(",R)", ")") if name.startswith("sl") else name
        yield name, [(Fraction(1, 2), compact, other.dimension - compact)]


def _exceptional(name: str, *parts: tuple[int, int]) -> Named:
    """An h of G2, with the ratios 1/6 and 1/2 of so(4), or of F4, with 2/9 and 4/9 of sp(3) + su(2) or 7/9 of so(9)."""
    ratios = {6: (1, 3, 6), 24: (2, 4, 9), 36: (7, 0, 9)}[sum(map(sum, parts)) // (2 if name.endswith("C)") else 1)]
    return name, [(Fraction(ratios[i], ratios[2]), k, p) for i, (k, p) in enumerate(parts)]


_EXCEPTIONAL: dict[str, list[Named]] = {
    "g2": [_exceptional("so(4)", (3, 0), (3, 0))],
    "g2(2)": [_exceptional("so(4)", (3, 0), (3, 0)), _exceptional("so(2,2)", (1, 2), (1, 2))],
    "f4": [_exceptional("sp(3)+su(2)", (3, 0), (21, 0)), _exceptional("spin(9)", (36, 0))],
    "f4(4)": [
        _exceptional("sp(3)+su(2)", (3, 0), (21, 0)),
        _exceptional("sp(2,1)+su(2)", (3, 0), (13, 8)),
        _exceptional("sp(6,R)+sl(2)", (1, 2), (9, 12)),
        _exceptional("spin(5,4)", (16, 20)),
    ],
    "f4(-20)": [
        _exceptional("sp(2,1)+su(2)", (3, 0), (13, 8)),
        _exceptional("spin(9)", (36, 0)),
        _exceptional("spin(8,1)", (28, 8)),
    ],
    "g2(C)": [_exceptional("so(4,C)", (3, 3), (3, 3))],
    "f4(C)": [_exceptional("sp(6,C)+sl(2,C)", (3, 3), (21, 21)), _exceptional("so(9,C)", (36, 36))],
}
"""The lists of exceptional algebras; those of complex algebras without their real forms."""

_LISTS = {
    "su": _of_su,
    "sl": _of_sl_real,
    "slR": _of_sl_real,
    "slH": _of_sl_quaternionic,
    "slC": _of_sl_complex,
    "so": _of_so,
    "soC": _of_so_complex,
    "sp": _of_sp,
    "spR": _of_sp_real,
    "spC": _of_sp_complex,
    **dict.fromkeys(("g2", "f4", "g2C", "f4C"), _of_exceptional),
}
