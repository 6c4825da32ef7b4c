"""Writer: lines of a function in LLVM assembly, for vectors of W lanes."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import final

FLAGS = "contract"
LIBM = {
    "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "log", "sinh": "sinh", "cosh": "cosh",
    "tanh": "tanh", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arcsinh": "asinh", "arccosh": "acosh",
    "arctanh": "atanh", "expm1": "expm1", "log1p": "log1p", "log2": "log2", "log10": "log10", "exp2": "exp2",
    "cbrt": "cbrt", "arctan2": "atan2", "pow": "pow",
}  # fmt: skip


def number(x: float) -> str:
    """A float in LLVM's hexadecimal notation, exactly.

    Examples
    --------
    >>> number(1.0)
    '0x3FF0000000000000'
    """
    return f"0x{struct.unpack('>Q', struct.pack('>d', x))[0]:016X}"


@final
class Writer:
    """Lines of a function in LLVM assembly, and the functions that it calls.

    Parameters
    ----------
    width : int
        W; 1 for scalar code.

    Attributes
    ----------
    label : str
        The basic block of the traced step in which lines are written at the moment.
    """

    width: int
    label: str
    vector: str
    mask: str
    suffix: str

    def __init__(self, width: int) -> None:
        self.width, self.label = width, "step"
        self.vector = "double" if width == 1 else f"<{width} x double>"
        self.mask = "i1" if width == 1 else f"<{width} x i1>"
        self.suffix = "f64" if width == 1 else f"v{width}f64"
        self.lines: list[str] = []
        self.declared: dict[str, str] = {}
        self.functions: dict[str, str] = {}
        self._count = 0

    def fresh(self) -> str:
        """A new name for a value, "%v1", "%v2", ..."""
        self._count += 1
        return f"%v{self._count}"

    def emit(self, text: str) -> str:
        """Name of the value of a line that is appended."""
        name = self.fresh()
        self.lines.append(f"  {name} = {text}")
        return name

    def splat(self, x: float | bool) -> str:
        """Vector constant with x in all lanes."""
        if isinstance(x, bool):
            one = "true" if x else "false"
            return one if self.width == 1 else "<" + ", ".join([f"i1 {one}"] * self.width) + ">"
        one = number(float(x))
        return one if self.width == 1 else "<" + ", ".join([f"double {one}"] * self.width) + ">"

    def binary(self, op: str, a: str, b: str) -> str:
        """Name of a op b, for op = "fadd", "fsub", "fmul", "fdiv"."""
        return self.emit(f"{op} {FLAGS} {self.vector} {a}, {b}")

    def polynomial(self, coefficients: Sequence[float], x: str) -> str:
        """Name of the polynomial with these coefficients, constant term first; even and odd terms run in parallel."""
        if len(coefficients) > 3:
            square = self.binary("fmul", x, x)
            odd = self.binary("fmul", self.polynomial_in(coefficients[1::2], square), x)
            return self.binary("fadd", self.polynomial_in(coefficients[::2], square), odd)
        return self.polynomial_in(coefficients, x)

    def polynomial_in(self, coefficients: Sequence[float], x: str) -> str:
        """Name of the polynomial with these coefficients, by Horner's rule."""
        total = self.splat(coefficients[-1])
        for c in reversed(coefficients[:-1]):
            total = self.binary("fadd", self.binary("fmul", total, x), self.splat(c))
        return total

    def intrinsic(self, name: str, *args: str) -> str:
        """Name of an intrinsic function such as llvm.sqrt on all lanes."""
        full = f"llvm.{name}.{self.suffix}"
        self.declared[full] = f"declare {self.vector} @{full}({', '.join([self.vector] * len(args))})"
        return self.emit(f"call {self.vector} @{full}({', '.join(f'{self.vector} {a}' for a in args)})")

    def library(self, name: str, *args: str) -> str:
        """Name of a function of libm, called lane by lane."""
        self.declared[name] = f"declare double @{name}({', '.join(['double'] * len(args))}) memory(none)"
        if self.width == 1:
            return self.emit(f"call double @{name}({', '.join(f'double {a}' for a in args)})")
        made = "poison"
        for lane in range(self.width):
            one = [self.emit(f"extractelement {self.vector} {a}, i32 {lane}") for a in args]
            found = self.emit(f"call double @{name}({', '.join(f'double {x}' for x in one)})")
            made = self.emit(f"insertelement {self.vector} {made}, double {found}, i32 {lane}")
        return made

    def any(self, mask: str) -> str:
        """Name of the i1 that is true if a mask holds in some lane."""
        if self.width == 1:
            return mask
        self.declared[f"any{self.width}"] = f"declare i1 @llvm.vector.reduce.or.v{self.width}i1({self.mask})"
        return self.emit(f"call i1 @llvm.vector.reduce.or.v{self.width}i1({self.mask} {mask})")

    def all(self, mask: str) -> str:
        """Name of the i1 that is true if a mask holds in all lanes."""
        if self.width == 1:
            return mask
        self.declared[f"all{self.width}"] = f"declare i1 @llvm.vector.reduce.and.v{self.width}i1({self.mask})"
        return self.emit(f"call i1 @llvm.vector.reduce.and.v{self.width}i1({self.mask} {mask})")

    def maximum(self, x: str) -> str:
        """Name of the maximum over the lanes, a double."""
        if self.width == 1:
            return x
        name = f"llvm.vector.reduce.fmax.{self.suffix}"
        self.declared[name] = f"declare double @{name}({self.vector})"
        return self.emit(f"call double @{name}({self.vector} {x})")

    def spread(self, x: str) -> str:
        """Name of the vector with the double x in all lanes."""
        if self.width == 1:
            return x
        first = self.emit(f"insertelement {self.vector} poison, double {x}, i32 0")
        zeros = f"<{self.width} x i32> zeroinitializer"
        return self.emit(f"shufflevector {self.vector} {first}, {self.vector} poison, {zeros}")
