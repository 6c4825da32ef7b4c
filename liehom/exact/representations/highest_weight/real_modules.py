"""Irreducible real modules of real forms, and spinors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from itertools import product
from typing import final

import numpy as np

from liehom.base.errors import InputError, RepresentationError, ShapeError, displayed
from liehom.base.objects import Displayed
from liehom.base.typing import IntegerArray
from liehom.exact.algebra import linear as families
from liehom.exact.algebra.constructions.classical import so
from liehom.exact.algebra.linear.linear_bases import require_room, require_size
from liehom.exact.algebra.roots.chevalley import real_form_of
from liehom.exact.algebra.roots.diagrams import VoganDiagram
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.algebra.roots.root_system import RootSystem
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.characters import weyl_dimension
from liehom.exact.representations.highest_weight.highest_weight import (
    OTHER_WAYS,
    AdmissibleLattice,
    Columns,
    Vector,
    add_multiple,
    applied,
    chevalley_matrices,
    divided_power,
    lattice_of,
    module_representation,
)
from liehom.exact.representations.highest_weight.weights import Weight, WeightSpace, checked_weight, weight_space
from liehom.exact.representations.invariants.representation_identity import SparseStack, failing_generator_pair
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis

# Let sigma be the conjugation of the complex algebra that fixes the real form.  On the Chevalley generators it is
# sigma(e_i) = -s_i f_i', where i' is the image of the node i under the automorphism of the Vogan diagram and s_i = -1
# for painted nodes, else 1.  The module V(lambda) is conjugate to itself if lambda' = -w_0(lambda); then there is an
# integer matrix T of the admissible lattice with
#
#     T e_i = -s_i f_i' T,   T f_i = -s_i e_i' T,   T v_highest = v_lowest,   T^2 = 1 or -1,
#
# and J(v) = T conj(v) commutes with the real form.  For T^2 = 1 the vectors with J(v) = v are a real module of
# dimension dim V.  For T^2 = -1, and if there is no T, the real space V of twice the dimension is irreducible.

Operator = tuple[bool, Columns]
"""(imaginary, M): the operator M on V, or i M."""

Reader = dict[int, int | Fraction]
"""Contributions of a coordinate in the old basis to the coordinates in the new basis."""


def commutant_letter(vogan: VoganDiagram, top: Weight) -> str:
    """Commutant of the real module: 'R' for T^2 = 1, 'H' for T^2 = -1, 'C' if there is no T.

    With lambda - w_0(lambda) = sum_i n_i alpha_i, T^2 = (-1)^n, where n is the sum of n_i over the nodes that are not
    painted. Along a reduced word of w_0 the lowest vector is a product of divided powers of the f_i, with n_i factors
    f_i in all, applied to the highest vector. T turns each factor into -s_i e_i', and these lead back to the highest
    vector.
    """
    roots = vogan.root_system()
    dual = weight_space(roots).dominant(tuple(-x for x in top))[0]
    if tuple(top[i] for i in vogan.automorphism) != dual:
        return "C"
    # lambda - w_0(lambda) = lambda + dual, in the simple roots
    total = [x + y for x, y in zip(top, dual, strict=True)]
    columns = zip(*roots.fundamental_weights(), strict=True)
    numbers = [int(sum(x * c for x, c in zip(total, column, strict=True))) for column in columns]
    return "H" if sum(n for i, n in enumerate(numbers) if i not in vogan.painted) % 2 else "R"


def conjugation(vogan: VoganDiagram, lattice: AdmissibleLattice) -> list[Vector]:
    """The columns of T, for a highest weight whose module is conjugate to itself."""
    columns: list[Vector] = [{len(lattice.weights) - 1: 1}]
    for recipe in lattice.recipes[1:]:
        total: Vector = {}
        for coefficient, i, power, source in recipe:
            # T f_i^(k) = (-s_i)^k e_i'^(k) T
            factor = coefficient * (1 if i in vogan.painted else (-1) ** power)
            add_multiple(total, divided_power(lattice.raising[vogan.automorphism[i]], columns[source], power), factor)
        columns.append({b: v for b, v in total.items() if v})
    return columns


@final
class RealBasis:
    """A basis of the integer vectors x + i y with T x = x and T y = -y: the x first, then the i y.

    T exchanges the spaces of the weights mu and -mu'.  If they differ, the basis has u + T u and u - T u for the basis
    vectors u at the first weight; if they agree, it has bases of the two eigenspaces of T.  Coordinates are read at the
    first weight.
    """

    __slots__ = ("readers", "vectors")

    def __init__(self, vogan: VoganDiagram, lattice: AdmissibleLattice) -> None:
        self.vectors: tuple[list[Vector], list[Vector]] = ([], [])
        # for x in V+ or V-: at the old coordinate b, the new coordinates it contributes to
        self.readers: tuple[dict[int, Reader], dict[int, Reader]] = ({}, {})
        conjugate = conjugation(vogan, lattice)
        places: dict[Weight, list[int]] = {}
        for b, mu in enumerate(lattice.weights):
            places.setdefault(mu, []).append(b)
        done: set[Weight] = set()
        for mu, block in places.items():
            partner = tuple(-mu[i] for i in vogan.automorphism)
            if partner == mu:
                self._add_block(block, conjugate)
            elif partner not in done:
                for b, (side, sign) in product(block, ((0, 1), (1, -1))):
                    self.readers[side][b] = {len(self.vectors[side]): 1}
                    self.vectors[side].append({b: 1, **{c: sign * v for c, v in conjugate[b].items()}})
            done.add(mu)

    def _add_block(self, block: list[int], conjugate: list[Vector]) -> None:
        m = len(block)
        table = QQ.matrix([[conjugate[b].get(c, 0) for c in block] for b in block])  # transposed
        for side, sign in ((0, 1), (1, -1)):
            rows = (table - QQ.identity(m).scale(sign)).left_null_space()
            if rows.nrows:
                basis = integral_basis(rows)
                inverse = basis.T @ (basis @ basis.T).inverse()  # x = c basis has the coordinates c = x inverse
                start = len(self.vectors[side])
                for b, row in zip(block, inverse.to_rows(), strict=True):
                    self.readers[side][b] = {start + k: _number(v) for k, v in enumerate(row) if v != 0}
                self.vectors[side].extend(
                    {b: int(QQ.convert(v)) for b, v in zip(block, row, strict=True) if v != 0}
                    for row in basis.to_rows()
                )

    def matrix(self, operator: Operator) -> list[Vector]:
        """The matrix of M, which maps V+ and V- to themselves, or of i M, which exchanges them: i M (i y) = -M y."""
        imaginary, columns = operator
        starts = (0, len(self.vectors[0]))
        matrix = []
        for side, vectors in enumerate(self.vectors):
            target = 1 - side if imaginary else side
            sign = -1 if imaginary and side else 1
            for vector in vectors:
                total: Reader = {}
                for b, v in applied(columns, vector).items():
                    for k, f in self.readers[target].get(b, {}).items():
                        total[k] = total.get(k, 0) + sign * v * f
                matrix.append({starts[target] + k: int(v) for k, v in total.items() if v})
        return matrix


def _number(value: Scalar) -> int | Fraction:
    rational = QQ.convert(value)
    return int(rational.p) if rational.q == 1 else Fraction(int(rational.p), int(rational.q))


# A real form is spanned by elements of the compact form, H_j = i h_j, X_a = e_a - f_a, Y_a = i (e_a + f_a), and by
# i times such elements.  Each acts on the complex module V by an integer matrix M or by i M.  The real module is the
# invariant real subspace of V if there is one (`RealBasis`), otherwise V as a real space of twice the dimension.


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

    Notes
    -----
    Let lambda' be the image of lambda under the automorphism of the Vogan diagram. The commutant is 'C' if
    lambda' differs from -w_0(lambda). Otherwise lambda - w_0(lambda) = sum_i n_i alpha_i, and with n the sum of n_i
    over the nodes that are not painted the commutant is 'R' for even n and 'H' for odd n.

    Examples
    --------
    >>> import liehom as lh
    >>> [lh.representations.real_module_type(name, [1]) for name in ("so(3)", "sl(2,R)")]
    ['H', 'R']
    >>> lh.representations.real_module_type("sl(2,C)", [1, 1])
    'R'
    """
    form = _form(form)
    return commutant_letter(form.vogan, _weight(form, weight_space(form.vogan.root_system()), weight))


def real_module(form: RealForm | str, weight: Sequence[int], *, check: bool = True) -> RealModule:
    """The irreducible real module of a real form with a given highest weight.

    Its ``representation`` is a representation of ``liehom.algebra.real_form_of(form.vogan)`` by integer matrices. Its
    dimension is the dimension of the complex module if the commutant is R, else twice as large.

    Parameters
    ----------
    form : RealForm or str
        Such as 'so(4,1)', 'e6(-26)', 'e8', 'sl(2,C)'.
    weight : sequence of int
        As in `real_module_type`, numbered by ``RealForm.of_name(form).type``; see the examples.
    check : bool, optional
        Prove the identity of the matrices, for generators with all basis elements (default).

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
    form = _form(form)
    vogan = form.vogan
    roots = vogan.root_system()
    space = weight_space(roots)
    top = _weight(form, space, weight)
    kind = commutant_letter(vogan, top)
    size = weyl_dimension(roots, top) * (1 if kind == "R" else 2)
    require_room(roots.rank + roots.number_of_roots, size, OTHER_WAYS)
    lattice = lattice_of(space, top)
    operators, generators = _operators(vogan, roots, lattice)
    if kind == "R":
        basis = RealBasis(vogan, lattice)
        matrices = [basis.matrix(operator) for operator in operators]
    else:
        matrices = [_realified(operator, len(lattice.weights)) for operator in operators]
    size = len(matrices[0])
    algebra = real_form_of(vogan, form.name)
    if check and (failure := failing_generator_pair(algebra.table, SparseStack(size, matrices), generators)):
        raise RepresentationError(failure, f"not a representation: the bracket of {failure} is not respected")
    # A homomorphism restricted to the real form, on an invariant real subspace; proved if `check`.
    return RealModule(form, top, kind, module_representation(algebra, matrices, size, top))


def _form(form: RealForm | str) -> RealForm:
    if isinstance(form, str):
        return RealForm.of_name(form)
    if not isinstance(form, RealForm):
        raise InputError(f"a real form or its name, such as 'so(4,1)', is needed, got {displayed(form)}")
    return form


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
    pairs = list(zip(raising, lowering, strict=True))
    compact: list[Operator] = [(True, h) for h in matrices[:rank]]
    compact += [(imaginary, _sum(e, f, sign)) for imaginary, sign in ((False, -1), (True, 1)) for e, f in pairs]
    image, sign = _involution(vogan, roots)
    kept = [(i, s) for s in (1, -1) for i, j in enumerate(image) if i < j or (i == j and sign[i] == s)]
    operators: list[Operator] = []
    for i, s in kept:
        imaginary, columns = compact[i]
        if image[i] != i:
            columns = _sum(columns, compact[image[i]][1], s * sign[i])
        if s < 0 and imaginary:  # i times an element of the compact form
            columns = [{b: -v for b, v in c.items()} for c in columns]
        operators.append((imaginary == (s > 0), columns))
    # X and Y of simple roots and of their images span, over the complex numbers, the generators e_i, f_i
    return operators, [x for x, (i, _) in enumerate(kept) if (i - rank) % max(count, 1) < rank <= i]


def _involution(vogan: VoganDiagram, roots: RootSystem) -> tuple[list[int], list[int]]:
    """The involution theta on H_1, ..., X_1, ..., Y_1, ...: index and sign of each image."""
    rank, count = roots.rank, len(roots.positive_roots)
    moved = [roots.index(tuple(alpha[i] for i in vogan.automorphism)) for alpha in roots.positive_roots]
    signs = vogan.signs()[:count].tolist()
    image = [*vogan.automorphism, *(rank + x for x in moved), *(rank + count + x for x in moved)]
    return image, [*[1] * rank, *signs, *signs]


def _sum(left: Columns, right: Columns, factor: int) -> list[Vector]:
    sums = [dict(x) for x in left]
    for total, y in zip(sums, right, strict=True):
        add_multiple(total, y, factor)
    return [{b: v for b, v in total.items() if v} for total in sums]


def _realified(operator: Operator, size: int) -> list[Vector]:
    """The columns of an operator on the real parts and then the imaginary parts."""
    imaginary, columns = operator
    below = [{b + size: v for b, v in c.items()} for c in columns]
    return [*below, *({b: -v for b, v in c.items()} for c in columns)] if imaginary else [*map(dict, columns), *below]


# In the Clifford algebra v w + w v = 2 <v, w>.  For orthogonal x, y the rotation x ^ y : u -> <y, u> x - <x, u> y acts
# on spinors by x y / 2, since [x y / 2, u] = (x ^ y) u.  The products e_i e_j lie in the even Clifford algebra.  It is
# the Clifford algebra of signature (p, q - 1), or (0, p - 1) if q = 0, generated by g_i = e_i e_n: e_i e_j = -<e_n,
# e_n> g_i g_j.  Its simple modules over the reals are the spin modules.

MAX_VECTOR_DIMENSION = 64


@final
@dataclass(frozen=True, slots=True)
class SpinorType:
    """The commutant, dimension and number of the spin modules of so(p, q) over the reals.

    Attributes
    ----------
    division_algebra : str
        'R', 'C' or 'H': the commutant of a module.
    dimension : int
        The real dimension of a module.
    modules : int
        2 if there are two half-spin modules that are not isomorphic, otherwise 1.
    """

    division_algebra: str
    dimension: int
    modules: int


def spinor_type(p: int, q: int = 0) -> SpinorType:
    """The commutant, real dimension and number of the spin modules of so(p, q), without their matrices.

    With n = p + q, by p - q modulo 8:

    ======  ==========  ==============  =========
    p - q   commutant   real dimension  modules
    ======  ==========  ==============  =========
    0       R           2^(n/2 - 1)     2
    1, 7    R           2^((n - 1)/2)   1
    2, 6    C           2^(n/2)         1
    3, 5    H           2^((n + 1)/2)   1
    4       H           2^(n/2)         2
    ======  ==========  ==============  =========

    Examples
    --------
    >>> import liehom as lh
    >>> lh.spinor_type(9, 1)
    SpinorType(division_algebra='R', dimension=16, modules=2)
    >>> lh.spinor_type(3), lh.spinor_type(3, 1).division_algebra
    (SpinorType(division_algebra='H', dimension=4, modules=1), 'C')
    """
    _require_signature(p, q)
    kind = (p - q) % 8
    letter = "RRCHHHCR"[kind]
    exponent = (p + q) // 2 + {"R": 0 if kind else -1, "C": 0, "H": 0 if kind == 4 else 1}[letter]
    return SpinorType(letter, 2**exponent, 1 if kind % 4 else 2)


def spin_representation(p: int, q: int = 0, *, chirality: int = 1) -> Representation:
    """The representation of so(p, q) on real spinors, or on one of the two kinds of half-spinors.

    It is irreducible, in the basis of ``liehom.so(p, q)``, proved at construction, and its dimension is that of
    `spinor_type`. The matrices are sums of signed permutation matrices divided by 2.

    Parameters
    ----------
    p, q : int
        Not negative, with p + q at least 2.
    chirality : 1 or -1
        The value of the product e_1 e_2 ... e_n, if p - q is divisible by 4 and there are two half-spin modules.
        Otherwise both values give the same module.

    Notes
    -----
    The even Clifford algebra is simple or the sum of two simple ones, and is generated by so(p, q): its simple
    modules over R are irreducible representations. ``liehom.defining("spin(p,q)")`` is the same module in the basis
    of the products e_i e_j.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.spin_representation(7)
    >>> rho.algebra == lh.so(7), rho.size
    (True, 8)
    >>> rho.isotropy([1, 0, 0, 0, 0, 0, 0, 0]).dimension  # g2
    14
    >>> lh.spin_representation(3).matrices[0].to_strings()[0]
    ['0', '0', '0', '-1/2']
    """
    _require_signature(p, q)
    if chirality not in (1, -1):
        raise InputError(f"chirality must be 1 or -1; got {displayed(chirality)}")
    if p + q > MAX_VECTOR_DIMENSION:
        raise InputError(f"the spinors of so({p}, {q}) have at least 2^{(p + q) // 2 - 1} dimensions: too many")
    # The products e_i e_j are in an array with all pairs i, j.
    hint = f"liehom.spinor_type({p}, {q}) gives the dimension and the commutant"
    require_room((p + q) ** 2, spinor_type(p, q).dimension, hint)
    algebra, products = so(p, q), _bivectors(p, q, chirality)
    size = products.shape[-1]
    signs = np.array([1] * p + [-1] * q)
    # x = sum_(i < j) x[i, j] <e_j, e_j> e_i ^ e_j
    images = [np.tensordot(np.triu(x * signs, 1), products, 2) for x in families.so(p, q)]
    matrices = [QQ.from_integers(image.ravel().tolist(), size, size).scale(QQ.one / 2) for image in images]
    kind = "spin" if (p - q) % 4 else f"half-spin {'+' if chirality > 0 else '-'}"
    return Representation(algebra, matrices, name=kind)


def _bivectors(p: int, q: int, chirality: int) -> IntegerArray:
    """The matrices e_i e_j, i < j, as an array (n, n, N, N) with zeros elsewhere."""
    n = p + q
    generators = families.clifford(p, q - 1) if q else families.clifford(0, p - 1)
    last = -1 if q else 1  # <e_n, e_n>
    size = generators.shape[-1]
    if n % 2 == 0:
        # e_1 ... e_n is 1 or -1 for p - q = 0, 4 modulo 8; otherwise it is not a multiple of 1, and nothing is chosen.
        # It is the last of the g_1, ..., g_(n-1) times the products of (g_1, g_2), (g_3, g_4), ...
        pairs = zip(generators[:-1:2], generators[1::2], strict=True)
        volume = reduce(np.matmul, [-last * a @ b for a, b in pairs], generators[-1])
        if np.array_equal(volume, -chirality * np.eye(size, dtype=np.int64)):
            generators = -generators
    products = np.zeros((n, n, size, size), dtype=np.int64)
    for i in range(n - 1):
        products[i, n - 1] = generators[i]
        for j in range(i + 1, n - 1):
            products[i, j] = -last * generators[i] @ generators[j]
    return products


def _require_signature(p: int, q: int) -> None:
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q, 2)
