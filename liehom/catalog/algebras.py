"""Lie algebras and representations by name."""

from __future__ import annotations

from fractions import Fraction

from liehom.algebra import LieAlgebra, abelian, direct_sum, euclidean, heisenberg, semidirect_sum
from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.matrices.named_matrices import linear_lie_algebra
from liehom.catalog.families import family_algebra, is_family
from liehom.catalog.linear import is_linear, linear_matrices
from liehom.catalog.names import Expression, Sum, Term, parse_expression, unknown
from liehom.errors import CatalogError
from liehom.representations import Representation
from liehom.typing import IntegerArray

EXAMPLES = (
    "so(3)",
    "so(3,1)",
    "so(3,C)",
    "so*(6)",
    "su(3)",
    "su(2,1)",
    "u(2)",
    "sp(3)",
    "sp(2,1)",
    "sp(4,R)",
    "sp(4,C)",
    "sl(3)",
    "sl(3,C)",
    "sl(2,H)",
    "gl(2)",
    "spin(7)",
    "spin(9,1)",
    "g2",
    "g2(2)",
    "f4",
    "f4(-20)",
    "f4(4)",
    "e6(-26)",
    "e6(6)",
    "upper(3)",
    "heisenberg(1)",
    "e(3)",
    "R^2",
    "aff(1)",
    "affine(so(3))",
    "affine(su(2)+spiral(1,1))",
    "iso(3,1)",
    "galilei(3)",
    "bargmann(3)",
    "schroedinger(3)",
    "conformal(3,1)",
    "filiform(5)",
    "oscillator(1)",
    "free_nilpotent(2,3)",
    "bianchi(VII)",
    "bianchi(VII;1/2)",
    "A4,1",
    "A4,2(1/2)",
    "so(3)+sl(2)",
)
"""One name of each kind, for hints in messages."""


def algebra(name: str) -> LieAlgebra:
    """The Lie algebra with a catalogue name; '+' means the direct sum.

    Parameters
    ----------
    name : str
        Such as 'so(3)', 'su(2,1)', 'sp(4,R)', 'f4(-20)', 'e(3)', 'heisenberg(2)', 'R^2', 'so(3)+sl(2)'.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.algebra("sl(2, H)"), lh.catalog.algebra("so(3)+R").dimension
    (<Lie algebra sl(2,H) of dimension 15 over QQ>, 4)
    """
    return algebra_of(parse_expression(name))


def representation(name: str) -> Representation:
    """The representation with a catalogue name: the defining representation of a linear Lie algebra.

    Parameters
    ----------
    name : str
        Such as 'so(4)', 'g2', 'spin(9,1)', 'sl(2,H)+sp(1)', 'tensor(sl(4),sl(2))', 'S2(gl(2))', or 'sym(4)', the
        conjugation action of so(4) on Sym(4). See `liehom.catalog.linear` for all heads.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.representation("g2")
    <representation 'g2' of <Lie algebra g2 of dimension 14 over QQ> on QQ^7>
    """
    tree = parse_expression(name)
    if not is_linear(tree):
        raise unknown(name, EXAMPLES, "representation")
    return representation_of(linear_matrices(tree), str(tree))


def algebra_of(tree: Expression) -> LieAlgebra:
    """The Lie algebra of a parsed name."""
    if isinstance(tree, Sum):
        return direct_sum(*map(algebra_of, tree.terms), name=str(tree))
    if tree.head == "0" or tree.head.startswith("R"):
        return abelian(_power(tree))
    if tree.head == "e":
        return euclidean(_single(tree))
    if tree.head == "heisenberg":
        return heisenberg(_single(tree))
    if is_family(tree):
        return family_algebra(tree)
    if tree.head == "affine" and len(tree.items) == 1 and not isinstance(tree.items[0], int | Fraction):
        return affine_algebra(linear_matrices(tree.items[0]), str(tree))
    if tree.head == "sym" and not tree.after:
        return algebra_of(Term("so", tree.items))
    if not is_linear(tree):
        raise unknown(str(tree), EXAMPLES, "algebra")
    return linear_lie_algebra(linear_matrices(tree), str(tree))


def affine_algebra(matrices: IntegerArray, name: str | None = None) -> LieAlgebra:
    """The affine algebra h + R^N of a linear Lie algebra h: first h, then the translations."""
    # no check: the matrices are the basis of h, so they are a representation
    return semidirect_sum(linear_lie_algebra(matrices), matrices, size=matrices.shape[1], name=name, check=False)


def representation_of(matrices: IntegerArray, name: str) -> Representation:
    """The defining representation of a matrix basis that is closed under commutators."""
    size = int(matrices.shape[1])
    if len(matrices) == 0:
        return Representation(linear_lie_algebra(matrices, name), [], size=size, name=name)
    made = lie_closure(matrices, close=False, name=name)
    # no check: the structure constants come from the matrices
    return Representation(made.algebra, made.matrices, size=size, name=name, check=False)


def _power(term: Term) -> int:
    """The n of R^n."""
    if term.items or term.after or not (term.head == "0" or term.head[2:].isdecimal() or not term.head[2:]):
        raise CatalogError(f"R^n is written with a circumflex, as in R^2; got {term}")
    return 0 if term.head == "0" else int(term.head[2:] or 1)


def _single(term: Term) -> int:
    """The only parameter of a term, an integer."""
    values = term.integers()
    if len(values) != 1 or term.after:
        raise CatalogError(f"{term.head} takes one integer, got {term}")
    return values[0]
