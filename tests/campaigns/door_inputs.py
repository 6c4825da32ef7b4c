"""Inputs of the campaign against the doors: for each door a function that draws a call and describes it."""

import copy
import json
import os
import random
import tempfile
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from typer.testing import CliRunner

import liehom as lh
from liehom import io
from liehom.cli.app import app
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.catalog.algebras import EXAMPLES as ALGEBRAS
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import common_field, number_field
from liehom.exact.scalars.rational import QQ

Call = Callable[[], object]
Json = Any
EXAMPLES = Path(__file__).resolve().parent.parent.parent / "examples"

SENTINEL = "executed_by_liehom"
ATTACKS = [
    f"__import__('os').system('touch {SENTINEL}')",
    f'__import__("pathlib").Path("{SENTINEL}").touch()',
    f"open('{SENTINEL}', 'w')",
    f"exec(\"open('{SENTINEL}', 'w')\")",
    f"eval(\"open('{SENTINEL}', 'w')\")",
    f"(lambda: open('{SENTINEL}', 'w'))()",
    f"[open('{SENTINEL}', 'w')]",
    f"sqrt(open('{SENTINEL}', 'w'))",
    f"Symbol('x').__class__.__init__.__globals__['os'].system('touch {SENTINEL}')",
    "lambda: 0",
    "().__class__",
    "().__class__.__bases__[0].__subclasses__()",
    "__builtins__",
    "os.system",
    "sqrt.__globals__",
    "{0.__class__}",
    "%s%n",
    "1; 2",
    "1 if 1 else 2",
    "x := 1",
    "$(touch executed_by_liehom)",
    "`touch executed_by_liehom`",
    "!!python/object/apply:os.system ['touch executed_by_liehom']",
]
MONSTERS = [
    "9**9**9**9", "10**100000000", "2**4096**2", "((((2**4096)**4096)**4096)**4096)", "1/(1 - 1)", "0**-1",
    "(" * 10_000 + "1" + ")" * 10_000, "-" * 10_000 + "1", "sqrt(" * 10_000 + "2" + ")" * 10_000,
    "sqrt(" * 60 + "2" + ")" * 60, " + ".join(f"sqrt({p})" for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29)),
    "sqrt(" + "123456789" * 40 + "1)", "2**-4096", "1" + "+1" * 20_000, "1" + "*2" * 20_000, "1" + "/3" * 2_000, "\0",
    "1\n", "\ud800", "١٢٣", "1_000", "0x10", "1e5", "inf", "nan", "sqrt(4)", "", " ",
]  # fmt: skip
LONG = [
    "7" * 5_000,
    "-" + "7" * 12_000,
    "1/" + "3" * 9_000,
    f"sqrt({(2**97 - 141) * (2**98 - 51)})",
    "+".join(f"1/{n}" for n in range(1, 3_000)),
    "sqrt(2)**4096",
]
PLAIN = ["0", "1", "-1", "2", "1/2", "-3/7", "sqrt(2)", "sqrt(3)/2", "(1 + sqrt(5))/2", "sqrt(2)*sqrt(3)", "100", "7"]
HUGE = [10**21, -(10**21), 2**63, -(2**63) - 1, 10**5000, -(10**5000), 2**31, 10**9]


def text_of(rng: random.Random) -> str:
    """A string for a value: plain, an attack, very large, or random characters and tokens."""
    kind = rng.randrange(8)
    if kind < 2:
        return rng.choice(PLAIN)
    if kind == 2:
        return rng.choice(rng.choice((ATTACKS, MONSTERS, LONG)))
    if kind < 5:
        return "".join(rng.choice("0123456789+-*/() sqrtaem._[]'\"\\\0é") for _ in range(rng.randrange(20)))
    tokens = ["1", "2", "37", "(", ")", "+", "-", "*", "/", "**", "sqrt(", "a", "m0", "t", " ", "sin(", "10000000"]
    if kind == 5:
        return "".join(rng.choice(tokens) for _ in range(rng.randrange(1, 40)))
    return mutated_text(rng, rng.choice(PLAIN))


def mutated_text(rng: random.Random, text: str) -> str:
    """The text with a few characters removed, repeated, exchanged or inserted."""
    characters = list(text)
    for _ in range(rng.randrange(1, 4)):
        place = rng.randrange(len(characters) + 1)
        kind = rng.randrange(4)
        if kind == 0:
            characters[place : place + 1] = []
        elif kind == 1:
            characters[place:place] = characters[max(0, place - rng.randrange(1, 12)) : place] * rng.choice((1, 2, 50))
        elif kind == 2:
            characters[place:place] = rng.choice(
                ["(", ")", ",", "/", "+", "-", "9" * rng.choice((1, 30, 5000)), "é", "\0"]
            )
        elif characters:
            characters[place % len(characters)] = characters[rng.randrange(len(characters))]
    return "".join(characters)


def number_of(rng: random.Random) -> object:
    """Anything that may stand for a number, or should not."""
    kind = rng.randrange(14)
    if kind < 4:
        return rng.randrange(-3, 6)
    if kind < 6:
        return text_of(rng)
    if kind == 6:
        return rng.choice(HUGE)
    if kind == 7:
        return rng.choice([0.5, 1e308, -1e308, 1e-320, 1e-200, float("nan"), float("inf"), -0.0, 3.0])
    if kind == 8:
        return rng.choice([Fraction(1, 3), Decimal("0.1"), Decimal("NaN"), 1 + 2j, True, None, b"1", QQ.one])
    if kind == 9:
        return rng.choice([sympy.sqrt(2), sympy.Rational(1, 3), sympy.pi, sympy.I, sympy.Symbol("x"), sympy.Float(0.1)])
    if kind == 10:
        return rng.choice(
            [np.int8(3), np.float32(0.5), np.complex128(1j), np.bool_(True), np.datetime64("2020"), np.str_("1")]
        )
    if kind == 11:
        return rng.choice(
            [number_field("sqrt(2)").generator, number_field("sqrt(3)").one, np.array(1), [1], {}, lambda: 1]
        )
    return rng.randrange(-1, 3)


def vector_of(rng: random.Random, length: int) -> object:
    kind = rng.randrange(10)
    length = max(0, length + rng.choice([0, 0, 0, 0, 1, -1, 5]))
    if kind < 5:
        return [rng.choice([0, 0, 1, -1, "1/2", 2]) for _ in range(length)]
    if kind < 7:
        return [number_of(rng) for _ in range(length)]
    return odd(rng) if kind == 7 else array_of(rng, (length,))


def matrix_of(rng: random.Random, rows: int, columns: int) -> object:
    kind = rng.randrange(10)
    if kind < 4:
        return [[rng.choice([0, 0, 0, 1, -1, 2]) for _ in range(columns)] for _ in range(rows)]
    if kind < 7:
        return [vector_of(rng, columns) for _ in range(rows)]
    if kind == 7:
        return odd(rng)
    if kind == 8:
        return sympy.Matrix(rows, columns, lambda i, j: rng.choice([0, 1, sympy.sqrt(2)]))
    return array_of(rng, (rows, columns))


def array_of(rng: random.Random, shape: tuple[int, ...]) -> object:
    kind = rng.choice(
        ["int8", "int64", "uint8", "float32", "float64", "complex128", "object", "U3", "bool", "datetime64[D]"]
    )
    values = np.array([rng.choice([0, 0, 1, 2, 1]) for _ in range(int(np.prod(shape)))]).reshape(shape).astype(kind)
    if kind == "float64" and values.size and rng.random() < 0.5:
        values.flat[rng.randrange(values.size)] = rng.choice([np.nan, np.inf, 1e308, 1e-320, 0.3])
    return values


def odd(rng: random.Random, depth: int = 0) -> object:
    kind = rng.randrange(12)
    if kind < 4 or depth > 3:
        return number_of(rng)
    if kind == 4:
        return [odd(rng, depth + 1) for _ in range(rng.randrange(4))]
    if kind == 5:
        return tuple(odd(rng, depth + 1) for _ in range(rng.randrange(4)))
    if kind == 6:
        return {str(rng.randrange(3)): odd(rng, depth + 1) for _ in range(rng.randrange(3))}
    if kind == 7:
        return array_of(rng, tuple(rng.randrange(4) for _ in range(rng.randrange(4))))
    if kind == 8:
        return rng.choice(
            [lh.so(3), lh.pair("so(3)/so(2)"), lh.adjoint(lh.so(3)), QQ.identity(2), RR.identity(2), QQ, int]
        )
    if kind == 9:
        return rng.choice([range(3), iter([1, 2]), {1, 2}, slice(1), ..., object(), np.zeros((2, 0)), bytearray(b"12")])
    if kind == 10:
        nested: Any = 1
        for _ in range(rng.choice((5, 100, 3000))):
            nested = [nested]
        return nested
    return text_of(rng)


# -- JSON ------------------------------------------------------------------------------------------------
@cache
def files() -> dict[str, Json]:
    """JSON objects of files of every kind, none large."""
    made = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(EXAMPLES.glob("*.json"))}
    for large in ("g2_su3", "so5_so4_scrambled"):
        made.pop(large, None)
    made["algebra"] = io.to_json(lh.heisenberg(1))
    made["subalgebra"] = io.to_json(lh.pair("so(4)/so(3)").subalgebra)
    made["representation"] = io.to_json(lh.adjoint(lh.so(3)))
    made["field"] = io.to_json(lh.algebra.so_form([["sqrt(2)", 0, 0], [0, 1, 0], [0, 0, -1]]))
    return made


CERTIFIED = ("so(3)/so(2)", "sl(2)/so(1,1)", "so(2,1)/so(2)", "affine(gl(2))", "affine(field(1,1,1,1))", "R^2/0")


@cache
def certificates() -> dict[str, Json]:
    return {name: lh.decide_fullness(lh.pair(name)).certificate.to_json() for name in CERTIFIED}


def places(data: Json, here: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths to everything inside a JSON value."""
    items: Any = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*here, key)
        yield from places(value, (*here, key))


def json_of(rng: random.Random, depth: int = 0) -> Json:
    kind = rng.randrange(10)
    if kind < 2 and depth < 4:
        return [json_of(rng, depth + 1) for _ in range(rng.randrange(4))]
    if kind == 2 and depth < 4:
        return {
            rng.choice(["", "a", "name", "format", "kind"]): json_of(rng, depth + 1) for _ in range(rng.randrange(3))
        }
    if kind < 6:
        return text_of(rng)
    return rng.choice([None, True, False, 0, 1, -1, 7, 0.5, 1e308, 1e-320, float("nan"), 10**21, 10**5000, -(2**63)])


def mutated(rng: random.Random, original: Json) -> Json:
    data = copy.deepcopy(original)
    for _ in range(rng.randrange(1, 4)):
        paths = list(places(data))
        if not paths:
            break
        *way, key = rng.choice(paths)
        around = data
        for step in way:
            around = around[step]
        kind = rng.randrange(7)
        if kind < 2:
            around[key] = json_of(rng)
        elif kind < 4:
            around[key] = rng.choice([*PLAIN, 0, 1, 2, 3, -1, 0.5, None, 10**21, rng.choice(LONG)])
        elif kind == 4:
            del around[key]
        elif kind == 5 and isinstance(around, list):
            around.append(copy.deepcopy(around[key]))
        elif isinstance(around, dict):
            around[rng.choice([f"{key}_", "field", "arithmetic", "point", "basis"])] = around.pop(key)
    return data


def door_json(rng: random.Random) -> tuple[Call, str]:
    data = mutated(rng, rng.choice(list(files().values()))) if rng.random() < 0.9 else json_of(rng)
    reader = rng.choice([io.from_json, lambda x: io.loads(written(x)), lambda x: io.loads(written(x), problem=True)])
    return (lambda: reader(data)), written(data)


def written(data: Json) -> str:
    before = sys_digits()
    try:
        return json.dumps(data)
    finally:
        sys_digits(before)


def sys_digits(value: int = 0) -> int:
    """Set the digits that Python writes; the bound before."""
    import sys

    before = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(value)
    return before


def door_text(rng: random.Random) -> tuple[Call, str]:
    text = mutated_text(rng, written(rng.choice([*files().values(), *certificates().values()])))
    return (lambda: rng.choice([io.loads, io.json_reader.parse_object])(text)), text


def door_certificate(rng: random.Random) -> tuple[Call, str]:
    name = rng.choice(CERTIFIED)
    data = mutated(rng, certificates()[name])

    def call() -> object:
        certificate = lh.Certificate.from_json(data)
        return certificate, certificate.to_json(), lh.verify_certificate(lh.pair(name), certificate)

    return call, f"{name} {written(data)}"


def door_value(rng: random.Random) -> tuple[Call, str]:
    text = text_of(rng)
    readers: list[Callable[[str], object]] = [
        QQ.convert,
        number_field("sqrt(2)").convert,
        number_field,
        lambda x: common_field([x, "sqrt(2)"]),
        lambda x: lh.LieAlgebra({(0, 1): {0: x}}),
    ]
    reader = rng.choice(readers)
    return (lambda: reader(text)), text


def door_number_field(rng: random.Random) -> tuple[Call, str]:
    coefficients: Any = [number_of(rng) for _ in range(rng.choice([1, 2, 3, 3, 3, 5, 20, 70]))]
    if rng.random() < 0.5:
        coefficients = [-rng.randrange(1, 30), *[0] * rng.randrange(5), rng.choice([1, 2, "1/2"])]
    ends: Any = rng.choice([(0, 100), ("1", "2"), (number_of(rng), number_of(rng)), None, (1,), odd(rng)])
    name: Any = rng.choice(["a", "x y", "sqrt", "", 3, "sqrt(2)", "sqrt(" + "9" * 50 + ")"])
    return (lambda: number_field(coefficients, ends, name)), f"{str_of(coefficients)} {str_of(ends)} {name}"


def str_of(value: object) -> str:
    try:
        return repr(value)[:300]
    except Exception as error:  # noqa: BLE001  a repr of numbers too long, or too deep
        return f"<{type(value).__name__}, {type(error).__name__}>"


# -- objects ---------------------------------------------------------------------------------------------
def mapping_of(rng: random.Random, n: int) -> object:
    """Structure constants as a mapping, mostly of the right form."""
    made: dict[Any, Any] = {}
    for _ in range(rng.randrange(4)):
        pair = (
            (rng.randrange(n), rng.randrange(n))
            if rng.random() < 0.8
            else rng.choice([(0,), 3, ("a", 1), (0, -1), (0, 2**70)])
        )
        value = number_of(rng) if rng.random() < 0.5 else 1
        made[pair] = (
            {rng.choice([0, 1, 2, n, "z"]): value} if rng.random() < 0.8 else rng.choice([[1], 3, {}, {2**70: 1}])
        )
    return made


def door_algebra(rng: random.Random) -> tuple[Call, str]:
    n = rng.randrange(1, 4)
    kind = rng.randrange(4)
    constants: Any = mapping_of(rng, n) if kind < 2 else array_of(rng, (n, n, n)) if kind == 2 else odd(rng)
    options: dict[str, Any] = {}
    if rng.random() < 0.3:
        options["dimension"] = rng.choice([n, 0, -1, 10**9, 10**21, "3", None, 2.0])
    if rng.random() < 0.2:
        options["field"] = rng.choice([QQ, RR, number_field("sqrt(2)"), "QQ", 3])
    if rng.random() < 0.2:
        options["basis"] = rng.choice([["x"] * n, list("abc")[:n], "abc"[:n], 3, [1] * n])
    return (lambda: lh.LieAlgebra(constants, **options)), f"{str_of(constants)} {str_of(options)}"


SMALL = ["so(3)", "sl(2)", "heisenberg(1)", "e(3)", "so(2,1)", "R^3", "aff(1)", "so(3)+R"]


@cache
def algebra(name: str) -> lh.LieAlgebra:
    return lh.catalog.algebra(name)


def door_methods(rng: random.Random) -> tuple[Call, str]:
    """Methods of an algebra with vectors and rows."""
    g = algebra(rng.choice(SMALL))
    if rng.random() < 0.3:
        g = g.over(RR)
    n = g.dimension
    name = rng.choice(
        ["bracket", "ad", "subalgebra", "subalgebra_generated_by", "quotient", "centralizer", "killing_form", "over"]
    )
    arguments: list[Any] = {"bracket": [vector_of(rng, n), vector_of(rng, n)], "ad": [vector_of(rng, n)]}.get(
        name, [matrix_of(rng, rng.randrange(1, 3), n)]
    )
    if name == "killing_form":
        arguments = []
    if name == "over":
        arguments = [rng.choice([QQ, RR, number_field("sqrt(3)"), odd(rng)])]
    return (lambda: getattr(g, name)(*arguments)), f"{g!r}.{name}{str_of(arguments)}"


def door_pair(rng: random.Random) -> tuple[Call, str]:
    g: Any = algebra(rng.choice(SMALL)) if rng.random() < 0.9 else odd(rng)
    rows = matrix_of(rng, rng.randrange(3), getattr(g, "dimension", 3))

    def call() -> object:
        pair = lh.Pair(g, rows)
        return pair, lh.decide_fullness(pair), lh.range_condition(pair)

    return call, f"Pair({str_of(g)}, {str_of(rows)})"


def door_matrices(rng: random.Random) -> tuple[Call, str]:
    n = rng.randrange(1, 4)
    matrices: Any = [matrix_of(rng, n, n) for _ in range(rng.randrange(1, 4))] if rng.random() < 0.8 else odd(rng)
    point = vector_of(rng, n)
    makers: list[Callable[[], object]] = [
        lambda: lh.LieAlgebra.from_matrices(matrices),
        lambda: lh.Representation.from_matrices(matrices).isotropy(point),
        lambda: lh.Representation(algebra("so(3)"), matrices),
        lambda: lh.affine_of(matrices),
        lambda: lh.semidirect_sum(algebra("so(3)"), matrices),
        lambda: lh.algebra.central_extension(algebra("so(3)"), matrices),
        lambda: lh.algebra.almost_abelian(matrices),
        lambda: lh.algebra.so_form(matrices),
        lambda: lh.algebra.sp_form(matrices),
        lambda: lh.algebra.realification(matrices),
        lambda: QQ.matrix(matrices).inverse(),
        lambda: RR.matrix(matrices).rank(),
    ]
    chosen = rng.randrange(len(makers))
    return makers[chosen], f"{chosen} {str_of(matrices)} {str_of(point)}"


def door_representation(rng: random.Random) -> tuple[Call, str]:
    rho = lh.adjoint(algebra(rng.choice(["so(3)", "sl(2)", "e(3)"])))
    name = rng.choice(["isotropy", "pair", "matrix", "submodule", "weights", "decompose", "invariant_forms", "over"])
    size = rho.size
    argument: Any = rng.choice([vector_of(rng, size), matrix_of(rng, 1, size), odd(rng)])
    plain = name in ("weights", "decompose", "invariant_forms")
    return (
        lambda: getattr(rho, name, rho.isotropy)(*([] if plain else [argument]))
    ), f"{rho!r}.{name}({str_of(argument)})"


# -- names and constructors ------------------------------------------------------------------------------
def name_of(rng: random.Random) -> str:
    known = [
        *ALGEBRAS,
        "so(3)/so(2)",
        "su(3)/u(2)",
        "sl(3)/P1",
        "affine(gl(2))",
        "sym(3;2,1)",
        "su(4)/sp(2)",
        "A4,2(1/2)",
    ]
    text = rng.choice(known)
    kind = rng.randrange(5)
    if kind == 0:
        digits = [i for i, c in enumerate(text) if c.isdigit()]
        if digits:
            at = rng.choice(digits)
            return (
                text[:at]
                + str(rng.choice([0, 1, 7, 12, 33, 64, 100, 4096, 10**6, 10**19, "9" * 5000, -1]))
                + text[at + 1 :]
            )
    if kind == 1:
        wrap = rng.choice(
            ["affine({})", "copies(3,{})", "S2({})", "L2({})", "tensor({0},{0})", "blocks({0},{0})", "dual({})"]
        )
        for _ in range(rng.choice((1, 1, 2, 3, 300))):
            text = wrap.format(text) if "{0}" not in wrap or len(text) < 2000 else text
        return text
    if kind == 2:
        return f"{text}/{rng.choice(known)}"
    return mutated_text(rng, text)


def door_name(rng: random.Random) -> tuple[Call, str]:
    name: Any = name_of(rng) if rng.random() < 0.95 else odd(rng)
    readers = [lh.pair, lh.catalog.algebra, lh.catalog.representation, RealForm.of_name, lh.tableau, lh.root_system]
    reader: Any = rng.choice(readers)
    return (lambda: reader(name)), f"{getattr(reader, '__name__', '')} {str_of(name)}"


CONSTRUCTORS = [
    "abelian", "affine", "bargmann", "bianchi", "canonical_real_form", "cartan_matrix", "character", "chevalley",
    "conformal", "direct_sum", "dominant_character", "dual_weight", "dynkin_diagram", "euclidean", "filiform",
    "free_nilpotent", "frobenius_schur_indicator", "galilei", "gl", "heisenberg", "highest_weight_module",
    "oscillator", "parabolic_subalgebra", "poincare", "real_forms", "real_module", "real_module_type", "root_system",
    "simple", "sl", "so", "so_star", "sp", "spin_representation", "spinor_type", "strictly_upper_triangular", "su",
    "sym_conjugation", "tensor_product_decomposition", "trivial", "u", "upper_triangular", "weyl_dimension",
    "weyl_orbit", "defining", "low_dimensional", "schroedinger",
]  # fmt: skip


def door_constructor(rng: random.Random) -> tuple[Call, str]:
    name = rng.choice(CONSTRUCTORS)
    pool: list[Any] = [
        "A2", "B3", "G2", "E8", "so(3,1)", "R", "C", "H", (1, 0), [1, 1], (0, 0, 1), (10**6, 1), algebra("so(3)"),
    ]  # fmt: skip
    arguments = [
        rng.choice(
            [rng.randrange(-1, 5), rng.choice(pool), rng.choice([33, 64, 100, 4096, 10**9]), odd(rng), number_of(rng)]
        )
        for _ in range(rng.choice([1, 1, 2, 2, 3]))
    ]
    home = next(home for home in (lh, lh.algebra, lh.representations) if hasattr(home, name))
    return (lambda: getattr(home, name)(*arguments)), f"{name}{str_of(arguments)}"


# -- other programs, integration, the command line -------------------------------------------------------
def door_programs(rng: random.Random) -> tuple[Call, str]:
    g = algebra(rng.choice(SMALL))
    if rng.random() < 0.5:
        text = mutated_text(rng, io.to_gap(g))
        return (lambda: io.from_gap(text)), text
    if rng.random() < 0.7:
        text = mutated_text(rng, io.to_sage(g))
        return (lambda: io.from_sage(text)), text
    thing: Any = odd(rng)
    reader = rng.choice(
        [io.from_gap, io.from_sage, io.to_sympy, io.latex, io.to_json, io.loads, io.load, io.load_problem]
    )
    return (lambda: reader(thing)), str_of(thing)


def door_integrate(rng: random.Random) -> tuple[Call, str]:
    options: dict[str, Any] = {"dt": 0.2, "max_steps": 5}
    keys = [
        "dt",
        "rtol",
        "atol",
        "t_eval",
        "dense_output",
        "events",
        "exponential",
        "step",
        "max_steps",
        "progress",
        "engine",
    ]
    for _ in range(rng.randrange(1, 3)):
        options[rng.choice(keys)] = rng.choice([odd(rng), number_of(rng), text_of(rng), lh.Euler(), "exp"])
    span = rng.choice([(0, 1), (0, 1), (1, 0), (0, 0), (0, float("inf")), odd(rng)])
    start = rng.choice([[0.6, 0, 0.8], vector_of(rng, 3), matrix_of(rng, 3, 2)])
    compiled = options.get("engine")
    if not (isinstance(compiled, str) and compiled in ("llvm", "jax")):
        psi: Any = rng.choice([["m0", "m1", "2*m2"], [text_of(rng) for _ in range(3)], vector_of(rng, 3), odd(rng)])
    else:
        psi = ["m0", "m1", "2*m2"]

    def call() -> object:
        return lh.integrate(lh.GeneratorField(lh.adjoint(algebra("so(3)")), psi), span, start, **options)

    return call, f"{str_of(psi)} {str_of(span)} {str_of(start)} {str_of(options)}"


def door_problem(rng: random.Random) -> tuple[Call, str]:
    problems = [data for data in files().values() if {"generator", "vector_field"} & data.keys()]
    data = mutated(rng, rng.choice(problems))

    def call() -> object:
        return io.loads(written(data), problem=True).integrate(max_steps=5)

    return call, written(data)


class ExitCodeError(Exception):
    """A command ended with a code that is not documented, or with output beside an error."""


def door_command(rng: random.Random) -> tuple[Call, str]:
    command = rng.choice(["fullness", "verify", "isotropy", "range", "describe", "catalog", "integrate", "order"])
    data = mutated(rng, rng.choice([*files().values(), *certificates().values()]))
    words = [command]
    if rng.random() < 0.6:
        words.append("FILE")
    else:
        words.append(name_of(rng)[:2000])
    if command == "verify":
        words.append("FILE")
    if command == "integrate":
        words += ["--max-steps", "3", "--out", "OUT"]
    if rng.random() < 0.3:
        words.append(
            rng.choice(["--json", f"--psi={text_of(rng)[:100]}", f"--point={text_of(rng)[:100]}", "--limit=digits=50"])
        )
        words.append(rng.choice(["--json", f"--dt={text_of(rng)[:30]}", f"--base={name_of(rng)[:30]}", "--order=4"]))

    def call() -> object:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / rng.choice(["f.json", "f.json", "f.g", "f.sage"])
            file.write_text(written(data), encoding="utf-8")
            given = [str(file) if w == "FILE" else os.path.join(folder, "out.npz") if w == "OUT" else w for w in words]
            result = CliRunner().invoke(app, given)
        if result.exit_code not in (0, 1, 2, 3):
            raise ExitCodeError(f"{result.exit_code}: {result.stderr[:150]}")
        if result.exit_code == 2 and result.stdout:
            raise ExitCodeError(f"2 with output {result.stdout[:150]}")
        return result.exit_code

    return call, f"{words} {written(data)}"


DOORS: dict[str, Callable[[random.Random], tuple[Call, str]]] = {
    "values": door_value,
    "number fields": door_number_field,
    "JSON objects": door_json,
    "text of files": door_text,
    "certificates": door_certificate,
    "problem files": door_problem,
    "structure constants": door_algebra,
    "elements and rows": door_methods,
    "pairs": door_pair,
    "matrices": door_matrices,
    "representations": door_representation,
    "names": door_name,
    "constructors": door_constructor,
    "GAP, Sage, sympy": door_programs,
    "integrate": door_integrate,
    "command line": door_command,
}
