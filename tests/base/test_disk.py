"""Files are written whole or not at all: full disks, interruptions, threads, links, permissions, devices."""

import json
import os
import resource
import signal
import subprocess
import sys
import threading
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest

import liehom as lh
from liehom.base import disk
from liehom.base.disk import checksum, write_atomically
from liehom.base.errors import FormatError, InputError, LimitError
from liehom.base.store import open_store

FILL = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
import liehom as lh
try:
    lh.dump(lh.pair("so(5)/so(4)"), sys.argv[1])
except lh.errors.FormatError as error:
    print(error)
"""
WRITE_FOREVER = """
import sys
from liehom.base.disk import write_atomically
n = 0
while True:
    n += 1
    write_atomically(sys.argv[1], (str(n) + chr(10)).encode() * 20000)
"""


def names(folder: Path) -> list[str]:
    return sorted(os.listdir(folder))


def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path: Path) -> None:
    path = tmp_path / "file"
    write_atomically(path, b"old")

    def fails(file: BinaryIO) -> None:
        file.write(b"half of the new")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_atomically(path, fails)
    assert path.read_bytes() == b"old" and names(tmp_path) == ["file"]


def test_a_full_disk_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "pair.json"
    lh.dump(lh.pair("so(3)/so(2)"), path)
    before = path.read_bytes()
    made = subprocess.run([sys.executable, "-c", FILL, str(path)], capture_output=True, text=True)
    assert "cannot be written" in made.stdout, made.stderr
    assert path.read_bytes() == before and names(tmp_path) == ["pair.json"]


def test_a_killed_writer_leaves_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    for _ in range(3):
        with subprocess.Popen([sys.executable, "-c", WRITE_FOREVER, str(path)]) as writer:
            while not path.exists():
                assert writer.poll() is None
            for _ in range(20):
                lines = path.read_bytes().split(b"\n")
                assert len(lines) == 20001 and len(set(lines[:-1])) == 1
            writer.send_signal(signal.SIGKILL)
        lines = path.read_bytes().split(b"\n")
        assert len(lines) == 20001 and len(set(lines[:-1])) == 1


def test_threads_that_write_one_file_all_succeed(tmp_path: Path) -> None:
    path, errors = tmp_path / "file", []

    def write(number: int) -> None:
        try:
            for _ in range(20):
                write_atomically(path, f"{number}".encode() * 1000)
        except OSError as error:
            errors.append(error)

    threads = [threading.Thread(target=write, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors and len(set(path.read_bytes())) == 1 and names(tmp_path) == ["file"]


def test_threads_share_a_store_without_loss(tmp_path: Path) -> None:
    errors: list[Exception] = []

    def work(number: int) -> None:
        try:
            store = open_store(tmp_path / "runs", "abc")
            for i in range(10):
                store.save("shared", {}, {"i": i})
                store.save(f"own-{number}-{i}", {"y": np.full(3, i)}, {"i": i})
        except (lh.LiehomError, OSError) as error:
            errors.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    store = open_store(tmp_path / "runs", "abc")
    assert not errors and len(store.names()) == 41
    assert all(store.load(f"own-{n}-{i}")[1] == {"i": i} for n in range(4) for i in range(10))


def test_links_permissions_and_devices_are_respected(tmp_path: Path) -> None:
    path, link = tmp_path / "file", tmp_path / "link"
    write_atomically(path, b"1")
    assert path.stat().st_mode & 0o777 == 0o666 & ~current_umask()
    path.chmod(0o640)
    link.symlink_to(path)
    write_atomically(link, b"2")
    assert link.is_symlink() and path.read_bytes() == b"2" and path.stat().st_mode & 0o777 == 0o640
    write_atomically(os.devnull, b"3")
    assert not Path(os.devnull).is_file()
    with pytest.raises(FormatError, match="No space left"):
        lh.dump(lh.pair("so(3)/so(2)"), "/dev/full")


def current_umask() -> int:
    made = subprocess.run([sys.executable, "-c", "import os; print(os.umask(0))"], capture_output=True, text=True)
    return int(made.stdout)


def test_long_names_have_short_temporary_names(tmp_path: Path) -> None:
    write_atomically(tmp_path / ("a" * 250), b"1")
    assert names(tmp_path) == ["a" * 250]


def test_the_command_does_not_overwrite_its_input(tmp_path: Path) -> None:
    path = tmp_path / "pair.json"
    lh.dump(lh.pair("so(3)/so(2)"), path)
    before = path.read_bytes()
    (tmp_path / "same.json").hardlink_to(path)
    for target in (path, tmp_path / "same.json"):
        command = [sys.executable, "-m", "liehom", "fullness", str(path), "--certificate", str(target)]
        made = subprocess.run(command, capture_output=True, text=True)
        assert (made.returncode, made.stdout) == (2, "") and "is read by this command" in made.stderr
    assert path.read_bytes() == before
    other = tmp_path / "certificate.json"
    command = [sys.executable, "-m", "liehom", "fullness", str(path), "--certificate", str(other)]
    assert subprocess.run(command, capture_output=True).returncode == 0 and json.loads(other.read_text())


def test_checksums_see_names_types_shapes_and_order_of_texts() -> None:
    a = np.arange(6)
    same = checksum({"a": a}, "x", "y")
    others = [
        checksum({"b": a}, "x", "y"),
        checksum({"a": a.astype(np.int32)}, "x", "y"),
        checksum({"a": a.reshape(2, 3)}, "x", "y"),
        checksum({"a": a[::-1]}, "x", "y"),
        checksum({"a": a}, "y", "x"),
        checksum({"a": a}, "xy", ""),
        checksum({"a": a, "c": a}, "x", "y"),
    ]
    assert same == checksum({"a": a.copy()}, "x", "y") and same not in others and len(set(others)) == len(others)


def test_the_padding_of_long_doubles_is_not_part_of_a_digest() -> None:
    values = np.array([1.5, -2.25, 1e-30], dtype=np.longdouble) / 3
    other = values.copy()
    raw = other.view(np.uint8).reshape(3, -1)
    before = raw.copy()
    size = np.finfo(np.longdouble).nmant // 8 + 3  # bytes of an 80 bit number; doubles have no padding
    raw[:, size:] ^= 0xFF
    assert np.array_equal(values, other)
    assert (raw != before).any() or raw.shape[1] == 8
    assert disk.digest(values) == disk.digest(other)
    tail = values.copy()
    tail[1] = np.nextafter(tail[1], np.longdouble(0))
    assert disk.digest(values) != disk.digest(tail)


def test_an_unwritable_store_is_an_input_error(tmp_path: Path) -> None:
    store = open_store(tmp_path / "runs", "abc")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2048, hard))
        with pytest.raises(InputError, match="cannot be written: File too large"):
            store.save("big", {"y": np.zeros(10**4)}, {})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)
    assert store.names() == frozenset() and names(tmp_path / "runs") == ["store.json"]


# -- archives that are larger than they look -----------------------------------------------------------------------
def header(shape: str, kind: str = "<f8") -> bytes:
    """The first bytes of an array that states a shape."""
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}"
    line = text.ljust(117) + chr(10)
    return b"\x93NUMPY" + bytes([1, 0]) + len(line).to_bytes(2, "little") + line.encode()


def archive(path: Path, *, packed: bool, **members: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as file:
        for name, content in members.items():
            file.writestr(f"{name}.npy", content)
    return path


def readers(path: Path) -> list[Callable[[], object]]:
    """All doors that read archives of arrays, for one file."""
    folder = path.parent / "runs"
    store = open_store(folder, "abc")
    (folder / "part.npz").write_bytes(path.read_bytes())
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/3"])
    return [
        lambda: lh.Solution.load(path),
        lambda: store.load("part"),
        lambda: lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], dt=0.5, checkpoint=path),
    ]


@pytest.mark.parametrize(("shape", "kind"), [
    ("(1000000000000000,)", "<f8"), ("(1000000000000000,)", "<U0"), ("(-1,)", "<f8"), ("(3,)", "<f8"),
    ("(100000, 10000000000)", "|u1"),
])  # fmt: skip
def test_a_header_that_states_another_size_is_damage(shape: str, kind: str, tmp_path: Path) -> None:
    content = header(shape, kind) + bytes(16)
    for packed in (False, True):
        for read in readers(archive(tmp_path / "run.npz", packed=packed, y=content)):
            with pytest.raises(FormatError, match=r"(run|part)\.npz"):
                read()


def test_what_unpacks_to_more_than_the_limit_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    size = 80_000_000  # more than the limit of 64 MiB
    path = archive(tmp_path / "run.npz", packed=True, y=header(f"({size},)", "|u1") + bytes(size))
    assert path.stat().st_size < 100_000
    for read in readers(path):
        tracemalloc.start()
        with pytest.raises(LimitError, match="file_bytes"):
            read()
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()
    with lh.limits(file_bytes=2 * size), pytest.raises(FormatError, match="its format is ''"):
        lh.Solution.load(path)


def test_an_array_before_an_archive_is_not_read(tmp_path: Path) -> None:
    path = archive(tmp_path / "whole.npz", packed=False, y=header("(2,)") + bytes(16))
    other = tmp_path / "run.npz"
    other.write_bytes(header("(1000000000000000,)") + path.read_bytes())
    with pytest.raises(FormatError, match="its format is ''"):
        lh.Solution.load(other)


def test_large_files_of_the_library_itself_are_read(tmp_path: Path) -> None:
    """They are not compressed, so that they are as large on disk as in memory."""
    store = open_store(tmp_path / "runs", "abc")
    store.save("part", {"y": np.arange(1000.0)}, {})
    with lh.limits(file_bytes=100):
        assert store.load("part")[0]["y"][-1] == 999.0
