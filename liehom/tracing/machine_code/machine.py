"""Machine code of LLVM assembly on this processor, with a cache in memory and on disk."""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import sys
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, TypeAlias

from liehom.disk import write_atomically
from liehom.errors import TraceError
from liehom.tracing.machine_code.writer import LIBM

Engine: TypeAlias = Any
"""An execution engine of llvmlite, which has no types."""

TargetMachine: TypeAlias = Any
"""A target machine of llvmlite."""

_ENGINES: dict[str, Engine] = {}


def lanes_per_register() -> int:
    """Number of doubles in a vector register of this processor.

    Examples
    --------
    >>> lanes_per_register() in (2, 4, 8)
    True
    """
    features = _host()[2]
    if features.get("avx512f"):
        return 8
    return 4 if features.get("avx") else 2


@cache
def _host() -> tuple[ModuleType, str, dict[str, bool]]:
    """(llvmlite.binding, a string that stands for this processor, its features)."""
    try:
        import llvmlite.binding as llvm
    except ImportError:
        raise TraceError('engine="llvm" needs the extra: pip install "liehom[llvm]"') from None
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    _add_symbols(llvm)
    name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features()
    triple = llvm.get_process_triple()
    return llvm, f"{llvm.llvm_version_info}{name}{features.flatten()}{triple}", dict(features)


def _target_machine(llvm: ModuleType) -> TargetMachine:
    """A target machine for this processor; an engine owns its own."""
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3, jit=True)


def cache_directory() -> Path | None:
    """Folder of the cached machine code, LIEHOM_CACHE_DIR or ~/.cache/liehom; None if that variable is empty."""
    given = os.environ.get("LIEHOM_CACHE_DIR")
    if given is not None:
        return Path(given) if given else None
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(home) / "liehom"


def engine_of(text: str) -> tuple[Engine, bool]:
    """(engine with the code of a module, whether the code was cached)."""
    llvm, stamp, _ = _host()
    key = hashlib.sha256((stamp + text).encode()).hexdigest()
    if key in _ENGINES:
        return _ENGINES[key], True
    machine = _target_machine(llvm)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    code = _read(key)
    found = code is not None
    if code is None:
        code = _compiled(llvm, machine, text)
        _write(key, code)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _ENGINES[key] = engine
    return engine, found


def _compiled(llvm: ModuleType, machine: TargetMachine, text: str) -> bytes:
    module = llvm.parse_assembly(text)
    module.verify()
    options = llvm.PipelineTuningOptions(2)
    options.slp_vectorization = options.loop_vectorization = options.loop_interleaving = options.loop_unrolling = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def _add_symbols(llvm: ModuleType) -> None:
    """Tell LLVM where the functions of the C library are; on Windows they are in its universal runtime."""
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None)
    for name in sorted({*LIBM.values(), "memset", "memcpy"}):
        llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)


def _read(key: str) -> bytes | None:
    folder = cache_directory()
    if folder is None:
        return None
    try:
        whole = (folder / f"{key}.o").read_bytes()
    except OSError:
        return None
    digest, code = whole[:32], whole[32:]
    return code if hashlib.sha256(code).digest() == digest else None


def _write(key: str, code: bytes) -> None:
    """Cache the code, by renaming a complete file; if that fails, it is compiled again next time."""
    folder = cache_directory()
    if folder is None:
        return
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / f"{key}.o", hashlib.sha256(code).digest() + code)
