"""sin(r)/r and cos(r) of r^2 in LLVM assembly: polynomials near 0, libm far from 0."""

from __future__ import annotations

import math

from liehom.tracing.machine_code.writer import Writer

SHORT_SERIES_REACH, LONG_SERIES_REACH = 0.25, 4.0
"""Largest |q| for which sin(r)/r and cos(r), r^2 = q, are a short and a long polynomial in q; above, libm is used."""


def rotation_series(reach: float, first: int) -> list[float]:
    """Taylor coefficients of sin(r)/r (first = 1) or cos(r) (first = 0) in r^2, enough for double precision to `reach`.

    Examples
    --------
    >>> rotation_series(1e-8, 0)
    [1.0, -0.5]
    """
    made, k = [], 0
    while True:
        made.append((-1) ** k / math.factorial(2 * k + first))
        k += 1
        if reach**k / math.factorial(2 * k + first) < 2e-17:
            return made


def define_rotation(w: Writer) -> None:
    """Write the function q -> (sin(r)/r, cos(r)), r^2 = q, if it is not there."""
    if "rotation" in w.functions:
        return
    f = Writer(w.width)
    v, pair = f.vector, f"{{{f.vector}, {f.vector}}}"
    size = f.intrinsic("fabs", "%q")
    f.lines.append("  br label %look")
    f.lines.append("look:")
    far = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(SHORT_SERIES_REACH)}"))
    f.lines.append(f"  br i1 {far}, label %farther, label %short, !prof !0")
    results = []
    for label, reach in (("short", SHORT_SERIES_REACH), ("long", LONG_SERIES_REACH)):
        f.lines.append(f"{label}:")
        results.append((label, [f.polynomial(rotation_series(reach, 1 - k), "%q") for k in (0, 1)]))
        f.lines.append("  br label %done")
    f.lines.append("farther:")
    out = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(LONG_SERIES_REACH)}"))
    f.lines.append(f"  br i1 {out}, label %far, label %long, !prof !0")
    f.lines.append("far:")
    results.append(("far", _by_library(f, size)))
    f.lines += ["  br label %done", "done:"]
    chosen = [f.emit(f"phi {v} " + ", ".join(f"[{made[k]}, %{label}]" for label, made in results)) for k in (0, 1)]
    first = f.emit(f"insertvalue {pair} poison, {v} {chosen[0]}, 0")
    whole = f.emit(f"insertvalue {pair} {first}, {v} {chosen[1]}, 1")
    head = f"define internal {pair} @rotation({v} %q) alwaysinline {{\nentry:"
    w.functions["rotation"] = "\n".join([head, *f.lines, f"  ret {pair} {whole}", "}"])
    w.declared |= f.declared


def _by_library(f: Writer, size: str) -> list[str]:
    """Names of sin(r)/r and cos(r) by libm; lanes with small r use the series."""
    v = f.vector
    r = f.intrinsic("sqrt", size)
    turns = f.emit(f"fcmp ogt {v} %q, {f.splat(0.0)}")
    near = f.emit(f"fcmp olt {v} {size}, {f.splat(SHORT_SERIES_REACH)}")
    # sinh of the large r of a rotation would overflow
    grown = f.emit(f"select {f.mask} {turns}, {v} {f.splat(0.0)}, {v} {r}")
    made = []
    for k, names in ((0, ("sin", "sinh")), (1, ("cos", "cosh"))):
        a, b = f.library(names[0], r), f.library(names[1], grown)
        whole = f.emit(f"select {f.mask} {turns}, {v} {a}, {v} {b}")
        if k == 0:
            whole = f.binary("fdiv", whole, r)
        short = f.polynomial(rotation_series(SHORT_SERIES_REACH, 1 - k), "%q")
        made.append(f.emit(f"select {f.mask} {near}, {v} {short}, {v} {whole}"))
    return made
