"""Structure constants in GAP's notation: round trips, GAP itself where it is installed, bad input."""

import shutil
import subprocess

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom import io
from liehom.base import errors
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from tests.sampling import examples

GAP = shutil.which("gap")
# What GAP 4.12.1 prints for StructureConstantsTable( Basis( SimpleLieAlgebra( "A", 1, Rationals ) ) ).
A1 = """[ [ [ [  ], [  ] ], [ [ 3 ], [ 1 ] ], [ [ 1 ], [ -2 ] ] ],
  [ [ [ 3 ], [ -1 ] ], [ [  ], [  ] ], [ [ 2 ], [ 2 ] ] ],
  [ [ [ 1 ], [ 2 ] ], [ [ 2 ], [ -2 ] ], [ [  ], [  ] ] ], -1, 0 ]"""
# GAP breaks lines inside of numbers.
LONG = """[ [ [ [  ], [  ] ],
      [ [ 1 ],
          [
              1234567890123456789012345678901234567890123456789012345678901234567\\
8901234567890123456789012345678901234567890/7 ] ] ],
  [
      [ [ 1 ],
          [
              -123456789012345678901234567890123456789012345678901234567890123456\\
78901234567890123456789012345678901234567890/7 ] ], [ [  ], [  ] ] ], -1, 0 ]"""


def algebras() -> dict[str, LieAlgebra]:
    return {
        "zero": lh.abelian(0),
        "line": lh.abelian(1),
        "abelian": lh.abelian(3),
        "heisenberg": lh.heisenberg(2),
        "so(3,1)": lh.so(3, 1),
        "su(2,1)": lh.su(2, 1),
        "fractions": lh.so(4).change_of_basis([[i + 1 if i == j else j % 2 for j in range(6)] for i in range(6)]),
        "odd names": lh.LieAlgebra({(0, 1): {1: 1}}, basis=['a"b', "c\\d # [e]"]),
    }


@pytest.mark.parametrize("key", sorted(algebras()))
def test_round_trip(key: str) -> None:
    algebra = algebras()[key]
    found = io.from_gap(io.to_gap(algebra), name=algebra.name)
    assert found == algebra
    assert (found.basis_names, found.name) == (algebra.basis_names, algebra.name)


def test_the_list_that_gap_prints() -> None:
    algebra = io.from_gap(A1)
    assert [algebra.field.format(x) for x in algebra.bracket([0, 0, 1], [1, 0, 0])] == ["2", "0", "0"]
    assert algebra.killing_signature() == (2, 1, 0)


def test_numbers_over_several_lines() -> None:
    (entry,) = io.from_gap(LONG).structure_constants()
    assert str(entry[3]) == "1234567890" * 11 + "/7"


def test_ranges_comments_and_assignments() -> None:
    text = """# a comment with [ brackets ]
    T:= EmptySCTable(3,0,"antisymmetric"); SetEntrySCTable(T,1,2,[1/2,1,-3,3]);;
    SetEntrySCTable(T,1,2,[1,3]);  # the last entry counts
    L:=LieAlgebraByStructureConstants(Rationals,T,"x","y","z");"""
    assert str(io.from_gap(text)).splitlines()[1:] == ["  basis x, y, z", "  [x, y] = z"]
    three = "[ [ [ [  ], [  ] ], [ [ 1 .. 2 ], [ 1, 1 ] ] ], [ [ [ 1 .. 2 ], [ -1, -1 ] ], [ [  ], [  ] ] ], -1, 0 ]"
    assert str(io.from_gap(three)).splitlines()[-1] == "  [e0, e1] = e0 + e1"


def test_an_entry_of_an_antisymmetric_table_sets_both_orders() -> None:
    head = 'T := EmptySCTable( 2, 0, "antisymmetric" ); SetEntrySCTable( T, 1, 2, [ 5, 1 ] );'
    assert str(io.from_gap(head + "SetEntrySCTable( T, 2, 1, [ 1, 2 ] ); T;")).splitlines()[-1] == "  [e0, e1] = -e1"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "nested list"),
        ("[", "the end"),
        ("7", "nested list"),
        ("[ -1, 0", "expected ,"),
        ("[ [ [ [ 1 ], [ 1 ] ] ] ]", "ends with the flag"),
        ("[ [ [ [  ], [  ] ] ], 1, 0 ]", "symmetric"),
        ("[ [ [ [  ], [  ] ] ], [ ], -1, 0 ]", "must have 2 entries"),
        ("[ [ 3 ], -1, 0 ]", r"entry \(1, 1\)"),
        ("[ [ [ [ 2 ], [ 1 ] ] ], -1, 0 ]", "index 2 is out of range"),
        ("[ [ [ [ 1/2 ], [ 1 ] ] ], -1, 0 ]", "index 1/2 is out of range"),
        ("[ [ [ [ 1 ], [  ] ] ], -1, 0 ]", "1 indices, 0 coefficients"),
        ("[ [ [ [ 1, 1 ], [ 1, 1 ] ] ], -1, 0 ]", "2 indices"),
        ("[ [ [ [ 1 ], [ E(4) ] ] ], -1, 0 ]", r"E with 1 arguments is not read"),
        ("[ [ [ [ 1 ], [ 1/0 ] ] ], -1, 0 ]", "denominator 0"),
        ("[ [ [ [ 1 ], [ 0.5 ] ] ], -1, 0 ]", "is not read"),
        ("[" * 100, "nested too deeply"),
        ("EmptySCTable(" * 10, "nested too deeply"),
        ('T := EmptySCTable( 2, 0, "symmetric" );', "EmptySCTable"),
        ("T := EmptySCTable( 10^6, 0 );", "is not read"),
        ("T := EmptySCTable( 2, 0 ); SetEntrySCTable( T, 1, 2, [ 1 ] );", r"entry \(1, 2\)"),
        ("T := EmptySCTable( 2, 0 ); SetEntrySCTable( T, 1, 3, [ 1, 1 ] );", "index 3"),
        ("L := LieAlgebraByStructureConstants( GF(2), [ -1, 0 ] );", "GF with 1 arguments"),
        ('Exec( "ls" );', "Exec"),
        ("for i in [ 1 .. 3 ] do od;", "'for' is not read"),
    ],
)
def test_malformed_table_raises_with_the_fault(text: str, says: str) -> None:
    with pytest.raises(errors.FormatError, match=says):
        io.from_gap(text)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("T := EmptySCTable( 1000000, 0 );", "dimension of the table"),
        ("T := EmptySCTable( 1" + "0" * 5000 + ", 0 );", "dimension of the table"),
        ("x := [ 1 .. 1000000 ];", "range"),
        ("x := [ " + "1 .. 4000, " * 6000 + " ];", "ranges"),
    ],
)
def test_a_table_that_is_too_large_is_refused(text: str, says: str) -> None:
    with lh.limits(entries=10**6), pytest.raises(errors.LimitError, match=says):
        io.from_gap(text)


def test_the_axioms_are_proved() -> None:
    with pytest.raises(errors.StructureError, match="not antisymmetric"):
        io.from_gap("T := EmptySCTable( 2, 0 ); SetEntrySCTable( T, 1, 2, [ 1, 1 ] );")
    with pytest.raises(errors.StructureError, match="not antisymmetric"):
        io.from_gap("[ [ [ [ 1 ], [ 1 ] ] ], -1, 0 ]")
    text = 'T := EmptySCTable( 3, 0, "antisymmetric" ); SetEntrySCTable( T, 1, 2, [ 1, 3 ] );'
    with pytest.raises(errors.JacobiError):
        io.from_gap(text + "SetEntrySCTable( T, 2, 3, [ 1, 2 ] );")


@pytest.mark.parametrize("value", ["sqrt(2)", 0.5])
def test_only_rational_numbers_are_carried(value: object) -> None:
    with pytest.raises(errors.FormatError, match=r"rational structure constants, these are over (QQ\(sqrt|float64)"):
        io.to_gap(lh.LieAlgebra({(0, 1): {1: value}}))


@pytest.mark.parametrize("name", ["", "1L", "L;Exec", None])
def test_the_variable_is_an_identifier(name: object) -> None:
    with pytest.raises(errors.FormatError, match="variable"):
        io.to_gap(lh.so(3), name)  # type: ignore[arg-type]


@settings(max_examples=examples(20))
@given(st.text(alphabet='[]",;:=.0123456789/-TE( )\\\n#', max_size=40))
def test_no_text_does_anything_but_raise_or_give_an_algebra(text: str) -> None:
    try:
        found = io.from_gap(text)
    except errors.InputError:
        return
    assert isinstance(found, LieAlgebra)


@pytest.mark.skipif(GAP is None, reason="GAP is not installed")
def test_gap_runs_what_is_exported_and_prints_the_same_table() -> None:
    chosen = algebras()
    statements = ["SizeScreen( [ 100, 24 ] );;"]
    for x, key in enumerate(sorted(chosen)):
        statements.append(io.to_gap(chosen[key], f"L{x}"))
        statements.append(f'Print( "@", StructureConstantsTable( Basis( L{x} ) ), "@\\n" );;')
    code = "\n".join([*statements, "QUIT;\n"])
    run = subprocess.run([str(GAP), "-q", "-r"], input=code, capture_output=True, text=True, timeout=120, check=True)
    printed = run.stdout.split("@")[1::2]
    assert len(printed) == len(chosen)
    for key, table in zip(sorted(chosen), printed, strict=True):
        assert io.from_gap(table) == chosen[key], key
