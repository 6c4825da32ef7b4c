"""The cache of machine code: what is run was compiled from the same text, and nobody else can have written it."""

import ctypes
import math
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

from liehom.flow.tracing import machine
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.loop import StepGraph

pytest.importorskip("llvmlite")


def kernel(factor: float) -> machine.Kernel:
    """A step that multiplies a number, compiled or read as in a new process."""
    machine._ENGINES.clear()
    tape = Tape()
    point = Traced(tape, tape.input(0)) * factor
    return machine.Kernel(StepGraph([point.entries[()]], None, None, {}, {}), 1)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LIEHOM_CACHE_DIR", str(tmp_path / "code"))
    return tmp_path / "code"


def test_a_file_under_the_name_of_another_is_not_run(folder: Path) -> None:
    assert not kernel(2.0).cached
    (first,) = folder.iterdir()
    assert not kernel(3.0).cached
    (second,) = set(folder.iterdir()) - {first}
    assert kernel(2.0).cached and kernel(3.0).cached  # a control
    code = second.read_bytes()
    second.write_bytes(first.read_bytes())
    assert not kernel(3.0).cached
    assert second.read_bytes() == code  # it is written again


def test_a_folder_to_which_others_may_write_is_not_used(folder: Path) -> None:
    assert not kernel(2.0).cached and kernel(2.0).cached
    assert folder.stat().st_mode & 0o777 == 0o700
    for mode in (0o770, 0o707):
        folder.chmod(mode)
        with pytest.warns(UserWarning, match="others may write to it"):
            assert not kernel(2.0).cached
    folder.chmod(0o755)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert kernel(2.0).cached


def test_a_folder_of_another_user_is_not_used(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not kernel(2.0).cached
    content = {file: file.read_bytes() for file in folder.iterdir()}
    other = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: other)
    with pytest.warns(UserWarning, match="belongs to another user"):
        assert not kernel(2.0).cached
    with pytest.warns(UserWarning, match="belongs to another user"):
        assert not kernel(4.0).cached
    assert {file: file.read_bytes() for file in folder.iterdir()} == content


@pytest.mark.parametrize("name", ["sin", "memcpy"])
def test_code_that_calls_functions_finds_them(name: str, folder: Path) -> None:
    """There is no room for the way to them next to code whose constants are next to it; LLVM calls memcpy itself."""
    declared, called = {
        "sin": ("double @sin(double)", "%y = call double @sin(double 2.5)\n store double %y, ptr %to"),
        "memcpy": (
            "void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
            "%n = load i64, ptr %from\n call void @llvm.memcpy.p0.p0.i64(ptr %to, ptr %from, i64 %n, i1 false)",
        ),
    }[name]
    text = f"declare {declared}\ndefine void @run(ptr %from, ptr %to) {{\n {called}\n ret void\n}}"
    engine, _ = machine.engine_of(text)
    run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(engine.get_function_address("run"))
    given, found = np.array([16, 7]), np.zeros(2, dtype=int)
    run(given.ctypes.data, found.ctypes.data)
    assert found.view(float)[0] == math.sin(2.5) if name == "sin" else np.array_equal(found, given)


@pytest.mark.skipif(not machine.NEAR, reason="code and constants are allocated apart here")
@pytest.mark.parametrize("name", [None, "sin", "a_function_of_no_library"])
def test_calls_that_leave_the_code_are_seen(name):
    llvm, *_ = machine._host()
    called = "fadd double %x, 1.0" if name is None else f"call double @{name}(double %x)"
    text = f"define double @f(double %x) {{ %y = {called}\n ret double %y }}"
    text = text if name is None else f"declare double @{name}(double)\n{text}"
    code = machine._emitted(llvm, machine._target_machine(llvm, near=True), text)
    assert machine._calls_out(llvm, code) == (name is not None)
