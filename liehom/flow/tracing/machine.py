"""Machine code on this processor: compilation, its cache, and the kernel of a run."""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import platform
import stat
import struct
import sys
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.disk import write_atomically
from liehom.base.errors import LiehomError, TraceError
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, LaneConstant, RunConstant, TrajectoryConstant
from liehom.flow.tracing.llvm_text import LIBM
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.run_text import FIELDS, FLOATS, Constant, run_module, state_names

Engine: TypeAlias = Any  # an execution engine, or a target machine, of llvmlite, which has no types
_ENGINES: dict[str, Engine] = {}
NEAR = sys.platform == "linux" and platform.machine() == "x86_64"
"""Whether code and constants are allocated as one piece: constants then cost no instructions of their own."""
LIBRARY = sorted({*LIBM.values(), "memset", "memcpy", "malloc", "free", "floor", "ceil", "rint", "fmax", "fmin"})
"""Functions of the C library that code may call, the last five on old processors."""
ELF_SYMBOL = "<I2xH16x"  # its name and its section


def lanes_per_register() -> int:
    """Number of doubles in a vector register of this processor."""
    features = _host()[2]
    return 8 if features.get("avx512f") else 4 if features.get("avx") else 2


@cache
def _host() -> tuple[ModuleType, str, dict[str, bool]]:
    """(llvmlite.binding, a string that stands for this processor, its features)."""
    try:
        import llvmlite
        import llvmlite.binding as llvm
    except ImportError:
        raise TraceError('engine="llvm" needs llvmlite: pip install llvmlite') from None
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    # where the functions of the C library are; on Windows they are in its universal runtime
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None)
    for symbol in LIBRARY:
        llvm.add_symbol(symbol, ctypes.cast(getattr(library, symbol), ctypes.c_void_p).value)
    name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features()
    triple = llvm.get_process_triple()
    return (
        llvm,
        f"{llvmlite.__version__}{llvm.llvm_version_info}{name}{features.flatten()}{triple} {NEAR}",
        dict(features),
    )


def engine_of(text: str) -> tuple[Engine, bool]:
    """(engine with the code of a module, whether the code was cached)."""
    llvm, stamp, _ = _host()
    key = hashlib.sha256((stamp + text).encode()).hexdigest()
    if key in _ENGINES:
        return _ENGINES[key], True
    machine = _target_machine(llvm)  # an engine owns its machine
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine, use_lmm=NEAR or None)
    folder = _private_cache()
    cached = None if folder is None else _read(folder / f"{key}.o", key)
    code = _compiled(llvm, text) if cached is None else cached
    if cached is None and folder is not None:
        with contextlib.suppress(OSError):  # it is compiled again next time
            write_atomically(folder / f"{key}.o", _mark(key, code) + code)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _ENGINES[key] = engine
    return engine, cached is not None


def _target_machine(llvm: ModuleType, *, near: bool = False) -> Engine:
    target, features = llvm.Target.from_triple(llvm.get_process_triple()), llvm.get_host_cpu_features().flatten()
    model = {"reloc": "pic", "codemodel": "small"} if near else {}
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3, jit=True, **model)


def _compiled(llvm: ModuleType, text: str) -> bytes:
    """The code of a module, with its constants next to it unless it calls a function, which is further away."""
    near = NEAR and not any(f"@{name}(" in text for name in LIBRARY)
    code = _emitted(llvm, _target_machine(llvm, near=near), text)
    if near and _calls_out(llvm, code):  # LLVM calls a function of its own accord, as for a copy
        return _emitted(llvm, _target_machine(llvm), text)
    return code


def _calls_out(llvm: ModuleType, code: bytes) -> bool:
    """Whether an ELF object has symbols without a section: they are elsewhere, out of reach of the small code model."""
    tables = [part.data() for part in llvm.ObjectFileRef.from_data(code).sections() if part.name() == b".symtab"]
    return any(name and not section for table in tables for name, section in struct.iter_unpack(ELF_SYMBOL, table))


def _emitted(llvm: ModuleType, machine: Engine, text: str) -> bytes:
    module = llvm.parse_assembly(text)
    module.verify()
    options = llvm.PipelineTuningOptions(2)
    options.slp_vectorization = options.loop_interleaving = options.loop_unrolling = False
    options.loop_vectorization = "%memory" in text
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def _private_cache() -> Path | None:
    """LIEHOM_CACHE_DIR or ~/.cache/liehom; None if it is empty, or if others may write to it, whose code is not run."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    name = os.environ.get("LIEHOM_CACHE_DIR", os.path.join(home, "liehom"))
    folder = Path(name)
    try:
        if not name:
            return None
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = folder.stat()
    except OSError:
        return None
    # on Windows, where users have no numbers, profiles are private
    if hasattr(os, "getuid") and (found.st_uid != os.getuid() or found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)):
        warnings.warn(
            f"machine code is not cached in {str(folder)!r}: it belongs to another user, or others may write to it; "
            "chmod go-w, or set LIEHOM_CACHE_DIR to another folder",
            stacklevel=2,
        )
        return None
    return folder


def _mark(key: str, code: bytes) -> bytes:
    """The begin of a cached file: the key, of assembly, processor and versions, and a digest of key and code."""
    return key.encode() + hashlib.sha256(key.encode() + code).digest()


def _read(file: Path, key: str) -> bytes | None:
    try:
        content = file.read_bytes()
    except OSError:
        return None
    size = len(_mark(key, b""))
    return content[size:] if content[:size] == _mark(key, content[size:]) else None


PLACES = {name: place for place, name in enumerate(FIELDS)}


class Kernel:
    """Machine code of a whole run of a traced step, for blocks of `width` lanes.

    Attributes
    ----------
    names : list of str
        Rows of the state of a lane.
    run_constants : list of str
        Names of the numbers that a run gives, in their order.
    lane_constants : list of callable
        Functions of the initial points that did not run on tracers, and numbers that trajectories are given: numpy
        computes their values.
    cached : bool
        Whether the code was found in the cache.
    """

    engine: ClassVar[str] = "llvm"  # as reports name it
    in_lockstep: ClassVar[bool] = True  # whether lanes make steps of one size together, without stops of their own
    tracing: ClassVar[dict[str, Any]] = {}  # options of a trace
    _has_prologue: ClassVar[bool] = True  # whether it computes constants of the trajectories
    cost: ClassVar[int] = 1  # duration of an operation, in units of one of machine code

    def __init__(self, graph: StepGraph, width: int) -> None:
        self.graph, self.width = graph, width
        self.names = state_names(graph)
        self.run_constants: list[str] = []
        self.lane_constants: list[TrajectoryConstant] = []
        self._build([self._place(x) for x in graph.constant_functions])

    def _build(self, constants: Sequence[Constant]) -> None:
        """Compile the run, for inputs -1, -2, ... that come from given places."""
        self.text = run_module(self.graph, constants, self.width)
        self._engine, self.cached = engine_of(self.text)
        self.run: Any = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._engine.get_function_address("run"))

    def _place(self, function: TrajectoryConstant) -> Constant:
        if isinstance(function, RunConstant):
            self.run_constants.append(function.name)
            return "run", len(self.run_constants) - 1
        if self._has_prologue and not isinstance(function, LaneConstant):
            traced = _on_tracers(function, self.graph)
            if traced is not None:
                return traced
        self.lane_constants.append(function)
        return "lane", len(self.lane_constants) - 1

    def packed(self, lanes: int, given: Mapping[str, Any]) -> npt.NDArray[np.float64]:
        """Rows (names, lanes in whole blocks) of the state: given values, with "x" for the points (N, L), and else 0.

        The lanes that fill up the last block are at the first point, so that their numbers are not out of bounds.
        """
        state = np.zeros((len(self.names), padded(lanes, self.width)))
        for name, value in given.items():
            if name == "x":
                state[: len(value), :lanes], state[: len(value), lanes:] = value, value[:, :1]
            else:
                state[self.names.index(name), :lanes] = value
        return state

    def __call__(self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None) -> None:
        """Make steps of the lanes of a state (names, lanes), in place."""
        argument = self.argument(state, **fields)  # must live as long as the machine code runs
        self.run(argument.ctypes.data)

    def argument(
        self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None
    ) -> npt.NDArray[np.int64]:
        """The argument of the machine code for a state and other fields, which must outlive it."""
        argument = np.zeros(len(FIELDS), dtype=np.int64)
        count = state.shape[1]
        for name, value in {"state": state, "lanes": count, "last": count // self.width, **fields}.items():
            if name in FLOATS:
                argument.view(np.float64)[PLACES[name]] = value
            elif value is not None:
                argument[PLACES[name]] = value.ctypes.data if isinstance(value, np.ndarray) else value
        return argument

    def run_values(self, given: Mapping[str, float]) -> npt.NDArray[np.float64]:
        """The numbers of a run as an array, from their values by name; 0 by default."""
        return np.array([given.get(name, 0.0) for name in self.run_constants] or [0.0])


def _on_tracers(function: TrajectoryConstant, graph: StepGraph) -> Expr | None:
    """A trajectory constant as an expression of inputs 0..N-1; None if the function needs numbers."""
    tape: Any = graph.point[0].tape
    points = Traced(tape, Traced.inputs(tape, 0, graph.size)[None])
    try:
        constant = Traced(tape, function(points))
        return constant.entries.reshape(-1)[0] if constant.size == 1 else None
    except (LiehomError, TypeError, ValueError, AttributeError, IndexError):
        return None


def padded(count: int, width: int) -> int:
    """Number of lanes, rounded up to whole blocks."""
    return -(-count // width) * width
