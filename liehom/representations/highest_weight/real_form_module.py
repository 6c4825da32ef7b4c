"""Irreducible real modules of real forms, by a highest weight of the complexification and integer matrices.

A real form is spanned by elements of the compact form, H_j = i h_j, X_a = e_a - f_a, Y_a = i (e_a + f_a), and by
i times such elements.  Each acts on the complex module V by an integer matrix M or by i M.  The real module is the
invariant real subspace of V if there is one (`real_structure`), otherwise V as a real space of twice the dimension.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

from liehom.algebra.matrices.matrix_basis import require_room
from liehom.algebra.roots.compact_form import real_form_of
from liehom.algebra.roots.real_form import RealForm
from liehom.algebra.roots.root_system import RootSystem
from liehom.algebra.roots.vogan import VoganDiagram
from liehom.display import Displayed
from liehom.errors import InputError, RepresentationError, ShapeError
from liehom.representations.core.representation import Representation
from liehom.representations.highest_weight.admissible_lattice import AdmissibleLattice, Vector, add_multiple, lattice_of
from liehom.representations.highest_weight.characters import weyl_dimension
from liehom.representations.highest_weight.highest_weight import (
    OTHER_WAYS,
    Columns,
    chevalley_matrices,
    sparse_matrix,
)
from liehom.representations.highest_weight.real_structure import Operator, RealBasis, commutant_letter
from liehom.representations.highest_weight.weights import Weight, WeightSpace, checked_weight, weight_space
from liehom.representations.invariants.generator_proof import SparseStack, failing_generator_pair


@final
@dataclass(frozen=True, slots=True)
class RealModule(Displayed):
    """An irreducible real module of a real form; see `real_module`.

    Attributes
    ----------
    form : RealForm
    highest_weight : tuple of int
        The highest weight of the complexified module, or of one of its two parts.
    division_algebra : str
        'R', 'C' or 'H', the commutant of the representation.
    representation : Representation
        Of ``liehom.algebra.real_form_of(form.vogan)``.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.real_module("su(2,1)", [1, 0])
    <real module of highest weight (1, 0) of su(2,1), dimension 6 over R, commutant C>
    """

    form: RealForm
    highest_weight: Weight
    division_algebra: str
    representation: Representation = field(repr=False)

    @property
    def dimension(self) -> int:
        """Dimension over the reals, an int."""
        return self.representation.size

    def __repr__(self) -> str:
        shown = f"({', '.join(map(str, self.highest_weight))})"
        size = f"dimension {self.dimension} over R, commutant {self.division_algebra}"
        return f"<real module of highest weight {shown} of {self.form.name}, {size}>"


def real_module_type(form: RealForm | str, weight: Sequence[int]) -> str:
    """Commutant, 'R', 'C' or 'H', of the irreducible real module of a real form with a given highest weight.

    Parameters
    ----------
    form : RealForm or str
        Such as 'so(4,1)', 'e6(-26)', 'sl(2,C)'.
    weight : sequence of int
        Dominant, in fundamental coordinates of the complexification, in Bourbaki's numbering for ``form.type``, the
        type of the canonical form: 'sp(4,R)' is 'so(3,2)' of type B2, not C2. For a complex algebra: the coordinates
        for its two factors, one after the other.

    Raises
    ------
    ShapeError, InputError
        If it is not a dominant integral weight.
    CatalogError
        If there is no such real form.

    Notes
    -----
    Let lambda' be the image of lambda under the automorphism of the Vogan diagram. The commutant is 'C' if
    lambda' differs from -w_0(lambda). Otherwise lambda - w_0(lambda) = sum_i n_i alpha_i, and with n the sum of n_i
    over the nodes that are not painted the commutant is 'R' for even n and 'H' for odd n.

    Examples
    --------
    >>> import liehom as lh
    >>> [lh.real_module_type(name, [1]) for name in ("so(3)", "sl(2,R)")]
    ['H', 'R']
    >>> lh.real_module_type("e7(-25)", [0, 0, 0, 0, 0, 0, 1]), lh.real_module_type("sl(2,C)", [1, 1])
    ('R', 'R')
    """
    made = _form(form)
    return commutant_letter(made.vogan, _weight(made, weight_space(made.vogan.root_system()), weight))


def real_module(form: RealForm | str, weight: Sequence[int], *, check: bool = True) -> RealModule:
    """The irreducible real module of a real form with a given highest weight.

    Parameters
    ----------
    form : RealForm or str
        Such as 'so(4,1)', 'e6(-26)', 'e8', 'sl(2,C)'.
    weight : sequence of int
        As in `real_module_type`, numbered by ``RealForm.of_name(form).type``; see the examples.
    check : bool, optional
        Prove the identity of the matrices, for generators with all basis elements (default).

    Returns
    -------
    RealModule
        Its ``representation`` is a representation of ``liehom.algebra.real_form_of(form.vogan)`` by integer matrices.
        Its dimension is the dimension of the complex module if the commutant is R, else twice as large.

    Raises
    ------
    ShapeError, InputError
        If it is not a dominant integral weight, or if the dense matrices would take more than 2 GB.
    CatalogError
        If there is no such real form.

    Notes
    -----
    Every irreducible real module is constructed in this way, from one highest weight if its commutant is R or H, and
    from two conjugate ones if it is C. For the commutant R the coordinates refer to the vectors u + T u, i (u - T u) in
    the admissible lattice; otherwise they are the real and then the imaginary parts.

    Examples
    --------
    The compact g2 on R^7, e6(-26) on R^27 and the spinors of so(3,1):

    >>> import liehom as lh
    >>> lh.real_module("g2", [1, 0]).representation.isotropy([1, 0, 0, 0, 0, 0, 0]).dimension
    8
    >>> lh.real_module("e6(-26)", [1, 0, 0, 0, 0, 0]).dimension
    27
    >>> lh.real_module("sl(2,C)", [1, 0])
    <real module of highest weight (1, 0) of sl(2,C), dimension 4 over R, commutant C>

    The canonical form of sp(4,R) is so(3,2), of type B2: (1, 0) are its vectors, and (0, 1) is R^4.

    >>> lh.RealForm.of_name("sp(4,R)")
    <real form so(3,2) of type B2>
    >>> [lh.real_module("sp(4,R)", weight).dimension for weight in ([1, 0], [0, 1])]
    [5, 4]
    """
    made = _form(form)
    vogan = made.vogan
    roots = vogan.root_system()
    space = weight_space(roots)
    top = _weight(made, space, weight)
    kind = commutant_letter(vogan, top)
    size = weyl_dimension(roots, top) * (1 if kind == "R" else 2)
    require_room(roots.rank + roots.number_of_roots, size, OTHER_WAYS)
    lattice = lattice_of(space, top)
    operators, generators = _operators(vogan, roots, lattice)
    if kind == "R":
        matrices = RealBasis(vogan, lattice).matrices(operators)
    else:
        matrices = [_realified(operator, len(lattice.weights)) for operator in operators]
    size = len(matrices[0])
    algebra = real_form_of(vogan, made.name)
    if check:
        failure = failing_generator_pair(algebra.table, SparseStack(size, matrices), generators)
        if failure is not None:
            raise RepresentationError(failure, f"not a representation: the bracket of {failure} is not respected")
    name = f"V({', '.join(map(str, top))})"
    # A homomorphism restricted to the real form, on an invariant real subspace; proved if `check`.
    rho = Representation(algebra, [sparse_matrix(m, size) for m in matrices], size=size, name=name, check=False)
    return RealModule(made, top, kind, rho)


def _form(form: RealForm | str) -> RealForm:
    made = RealForm.of_name(form) if isinstance(form, str) else form
    if not isinstance(made, RealForm):
        raise InputError(f"a real form or its name, such as 'so(4,1)', is needed, got {form!r}")
    return made


def _weight(form: RealForm, space: WeightSpace, weight: Sequence[int]) -> Weight:
    try:
        return checked_weight(space, weight)
    except ShapeError as error:
        raise ShapeError(f"{error}; weights of {form.name} are numbered by its type {form.vogan.type}") from None


# -- the basis of the real form -------------------------------------------------------------------------------
def _operators(vogan: VoganDiagram, roots: RootSystem, lattice: AdmissibleLattice) -> tuple[list[Operator], list[int]]:
    """Operators of the basis k_1, ..., p_1, ... of `real_form_of` on the complex module, and indices of generators.

    In the compact form H_j = i h_j, X_a = e_a - f_a and Y_a = i (e_a + f_a); theta permutes these up to signs.
    """
    rank, count = roots.rank, len(roots.positive_roots)
    matrices = chevalley_matrices(roots, lattice)
    raising, lowering = matrices[rank : rank + count], matrices[rank + count :]
    compact: list[Operator] = [(True, h) for h in matrices[:rank]]
    compact += [(False, _sum(e, f, -1)) for e, f in zip(raising, lowering, strict=True)]
    compact += [(True, _sum(e, f, 1)) for e, f in zip(raising, lowering, strict=True)]
    image, sign = _involution(vogan, roots)
    kept = [(i, s) for s in (1, -1) for i, j in enumerate(image) if i < j or (i == j and sign[i] == s)]
    made: list[Operator] = []
    generators: list[int] = []
    for i, s in kept:
        imaginary, columns = compact[i]
        if image[i] != i:
            columns = _sum(columns, compact[image[i]][1], s * sign[i])
        if s < 0:  # i times an element of the compact form
            imaginary, columns = (
                not imaginary,
                [{b: -v for b, v in c.items()} for c in columns] if imaginary else columns,
            )
        # X and Y of simple roots and of their images span, over the complex numbers, the generators e_i, f_i
        if (i - rank) % max(count, 1) < rank <= i:
            generators.append(len(made))
        made.append((imaginary, columns))
    return made, generators


def _involution(vogan: VoganDiagram, roots: RootSystem) -> tuple[list[int], list[int]]:
    """The involution theta on H_1, ..., X_1, ..., Y_1, ...: index and sign of each image."""
    rank, count = roots.rank, len(roots.positive_roots)
    moved = [roots.index(tuple(alpha[i] for i in vogan.automorphism)) for alpha in roots.positive_roots]
    signs = vogan.signs()[:count].tolist()
    image = [*vogan.automorphism, *(rank + x for x in moved), *(rank + count + x for x in moved)]
    return image, [*[1] * rank, *signs, *signs]


def _sum(left: Columns, right: Columns, factor: int) -> list[Vector]:
    made = []
    for x, y in zip(left, right, strict=True):
        total = dict(x)
        add_multiple(total, y, factor)
        made.append({b: v for b, v in total.items() if v})
    return made


def _realified(operator: Operator, size: int) -> list[Vector]:
    """The columns of an operator on the real parts and then the imaginary parts."""
    imaginary, columns = operator
    if not imaginary:
        return [*(dict(c) for c in columns), *({b + size: v for b, v in c.items()} for c in columns)]
    return [*({b + size: v for b, v in c.items()} for c in columns), *({b: -v for b, v in c.items()} for c in columns)]
