"""The key of a full pair, and its row in the classification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from liehom.base.errors import FormatError, InternalError, LiehomError, displayed
from liehom.base.objects import Displayed
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.fullness.certificate import number_field_json, read_number_field
from liehom.exact.fullness.classification_rows import SPIRAL, Key, Row, row_of, rows, square_root
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.fullness.verify_classification import verify_key
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import commutant
from liehom.exact.representations.invariants.irreducibility import combination, traceless
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import Subspace, echelon_quotient

# The largest ideal of g inside h is the limit of the decreasing sequence h, h_1, h_2, ... with h_(i+1) = {x in h_i :
# [x, g] in h_i}, where h_1 is the kernel of the isotropy representation. An ideal of g inside h changes neither g/h nor
# rho(h), so neither fullness. The effective pair is the quotient of g and h by it.


def isotropy_kernel(pair: Pair) -> ExactMatrix:
    """Rows in g, a basis of the elements of h that act as 0 on g/h."""
    subspace, square = as_exact(pair.subalgebra.quotient().subspace), pair.dimension**2
    if square == 0 or not pair.subalgebra.dimension:
        return subspace
    flat = as_exact(pair.field.stack_rows([a.reshape(1, square) for a in pair.isotropy_matrices()], square))
    if int(flat.modulo().rank()) == flat.nrows:
        return subspace.select(rows=[])
    return flat.left_null_space() @ subspace


def largest_ideal(pair: Pair, kernel: ExactMatrix) -> Subalgebra:
    """The largest ideal of g inside h, from the kernel of the isotropy representation."""
    # each h_i is an ideal of h, so only brackets with a complement of h can leave it
    ideal, lift = kernel, pair.subalgebra.quotient().lift
    while ideal.nrows and (inside := _staying(pair, ideal, lift)).nrows < ideal.nrows:
        ideal = inside
    return Subalgebra(pair.algebra, ideal, check=False)


def _staying(pair: Pair, space: ExactMatrix, lift: ExactMatrix) -> ExactMatrix:
    """Rows that span the x in a space with [x, v] in the space for all rows v of `lift`."""
    blocks = pair.algebra.table.contract(space, lift, echelon_quotient(space).projection)
    width = blocks[0].nrows * blocks[0].ncols
    if width == 0 or all(block.is_zero() for block in blocks):
        return space
    flat = as_exact(pair.field.stack_rows([block.reshape(1, width) for block in blocks], width))
    return flat.left_null_space() @ space


def effective_pair(pair: Pair, ideal: Subalgebra) -> Pair:
    """The pair (g/n, h/n) of an ideal n of g inside h; the given pair if n = 0."""
    if not ideal.dimension:
        return pair
    algebra = ideal.quotient_algebra()
    rows = (pair.subalgebra.basis @ ideal.quotient().projection).row_space()
    return Pair(algebra, Subalgebra(algebra, rows, check=False))  # the image of a subalgebra


# The key: let L0 be the traceless part of rho(h) on V = g/h. For a full pair of dimension d >= 2 it is reductive and
# irreducible, so its commutant is R, C = R + RJ or H, and its centre is 0 or RJ. The centre is RJ if and only if the
# commutant is C and tr(A J) is not 0 for some A in L0. Then S = [L0, L0] consists of the A in L0 with tr(A J) = 0.
# Otherwise S = L0.

UNKNOWN = "?"
"""Letter of a pair that no letter describes, which the theorem excludes."""


def key_of(action: TracelessIsotropyAction) -> tuple[Key, Subalgebra]:
    """The key of a full pair, and the largest ideal of g inside h."""
    pair = action.pair
    kernel = isotropy_kernel(pair)
    ideal = largest_ideal(pair, kernel)
    if action.size <= 1:
        return _small_key(action.size, pair.algebra.dimension - ideal.dimension), ideal
    s, e, centre, spiral = _isotropy_part(action, len(action.matrices) - kernel.nrows)
    letter, sign = _letter(effective_pair(pair, ideal), is_faithful=kernel.nrows == ideal.dimension)
    return Key(letter, action.size, s, e, centre, sign if spiral is None else spiral), ideal


def _small_key(d: int, dimension: int) -> Key:
    """The key of an effective pair with dim g/h = d <= 1 and this dimension of g."""
    centre = "R" if dimension > d else ""
    letter = "A" if dimension <= 2 * d else "B" if dimension == 3 else UNKNOWN
    return Key(letter, d, 0, d, centre)


def _isotropy_part(action: TracelessIsotropyAction, dimension: int) -> tuple[int, int, str, Scalar | None]:
    """The part (s, e, centre, c^2 of a spiral) of the key; `dimension` is that of rho(h)."""
    basis, scalars = action.commutant(), dimension > action.dimension
    i, weight, j = _central(action) if len(basis) == 2 else (0, action.field.zero, basis[0])
    if weight == 0:
        return action.dimension, len(basis), "R" if scalars else "", None
    s, norm = action.dimension - 1, (j @ j).trace()
    e = _commutant_dimension(action, j)
    if scalars:
        return s, e, "C", None
    # rho(h) has one element J + t. Traces vanish on S, so they are proportional to tr(A J) on L0
    t = action.matrices[action.members[i]].trace() * norm / weight / action.size
    return (s, e, "J", None) if t == 0 else (s, e, SPIRAL, -t * t * action.size / norm)


def _central(action: TracelessIsotropyAction) -> tuple[int, Scalar, ExactMatrix]:
    """An index i with tr(A_i J) != 0, the trace, and J, for a commutant R + RJ; the trace 0 if J is not in L0.

    If the centre of L0 is 0, then L0 = [L0, L0] and all these traces vanish; if it is RJ, then tr(J J) does not.
    """
    (j,) = traceless(action.commutant(), action.size, action.field)
    weights = (action.flat(action.traceless) @ j.T.reshape(action.size**2, 1)).entries()
    i = next((i for i, weight in enumerate(weights) if weight != 0), 0)
    return i, weights[i], j


def _commutant_dimension(action: TracelessIsotropyAction, j: ExactMatrix) -> int:
    """Dimension e of the commutant of S = {A in L0 : tr(A J) = 0}, for L0 = S + RJ: 2 or 4."""
    d, s, norm = action.size, action.dimension - 1, (j @ j).trace()
    possible = {row.key.e for row in rows(d) if (row.key.s, row.key.centre) == (s, "J")}
    if len(possible) == 1:
        return possible.pop()
    # su(2m) and sl(m,H)
    inside = [combination([a, j], [1, -(a @ j).trace() / norm]) for a in action.traceless]
    return len(commutant(inside, d, action.field))


def _letter(effective: Pair, *, is_faithful: bool) -> tuple[str, int | None]:
    """The letter of an effective pair and, in C, the sign; `is_faithful` says whether its isotropy acts faithfully."""
    form = as_exact(effective.algebra.killing_form())
    degenerate = form.rank() < effective.algebra.dimension
    if degenerate or not is_faithful:
        return ("A" if is_faithful else UNKNOWN) if degenerate else "B", None
    # the Killing form is definite on the orthogonal complement of h, so that one vector has its sign
    v = (effective.subalgebra.basis @ form).null_space().select(rows=[0])
    return "C", -effective.field.sign((v @ form @ v.T)[0, 0])


FORMAT, VERSION = "liehom-classification", 1


@final
@dataclass(frozen=True, slots=True, repr=False)
class Classification(Displayed):
    """The row of a full pair in the classification, a result of `classify`.

    Attributes
    ----------
    key : Key
        (letter, d, s, e, centre, parameter), which determines the row and the pair up to isomorphism over the reals
        and up to the ideal.
    ideal : Subspace
        The largest ideal of g inside h. Key, name and space describe the quotients of g and h by it.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(6)/u(3)")
    >>> result = lh.classify(pair)
    >>> tuple(result.key), result.name, result.space
    (('C', 6, 8, 2, 'J', 1), 'su(4)/u(3)', 'CP^3 = SU(4)/U(3)')
    >>> result.verify(pair), Classification.from_json(result.to_json()) == result
    (True, True)
    """

    key: Key
    ideal: Subspace

    @property
    def row(self) -> Row:
        """Row of the key; raises `InternalError` if the key is in no row."""
        row = row_of(self.key)
        if row is None:
            raise InternalError(
                f"the key {tuple(self.key)} of a full pair is in no row of the classification, so the pair is a "
                "counterexample to the theorem or the key is wrong: please report this pair"
            )
        return row

    @property
    def name(self) -> str | None:
        """Catalogue name of the quotients of g and h by the ideal; None for a spiral whose c no name can hold."""
        if self.key.centre != SPIRAL:
            return self.row.name
        text = square_root(self.key.parameter)
        return None if text is None else self.row.name.replace("(c,1)", f"({text},1)")

    @property
    def space(self) -> str:
        """The homogeneous space, a string such as 'S^6 = G2/SU(3)'."""
        if self.key.centre != SPIRAL:
            return self.row.space
        text = square_root(self.key.parameter)
        return f"{self.row.space}, " + (f"c = {text}" if text is not None else f"c^2 = {self.key.parameter}")

    def verify(self, pair: Pair) -> bool:
        """True if ideal and key are those of the pair; otherwise raises `CertificateError`.

        The check shares no code with `classify` except for scalars and the bracket table. It takes for granted that
        the pair is full, which `Full.verify` proves.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.classify(lh.pair("so(4)/so(3)")).verify(lh.pair("so(3,1)/so(3)"))
        Traceback (most recent call last):
        ...
        liehom.base.errors.CertificateError: parameter: the key says 1, the pair has -1
        """
        verify_key(pair, self.key, self.ideal)
        return True

    def to_json(self) -> dict[str, Any]:
        """The JSON object: key, name, space, isotropy and the basis of the ideal."""
        field: Any = self.ideal.field
        key = self.key._asdict()
        if self.key.centre == SPIRAL:
            key["parameter"] = field.format(self.key.parameter)
        out: dict[str, Any] = {"format": FORMAT, "version": VERSION, "key": key}
        out |= {"name": self.name, "space": self.space, "isotropy": self.row.isotropy}
        out |= {"field": number_field_json(field)} if isinstance(field, NumberField) else {}
        return out | {"dimension": self.ideal.ambient, "ideal": self.ideal.basis.to_strings()}

    @classmethod
    def from_json(cls, data: object) -> Classification:
        """The classification that a parsed JSON object holds.

        Raises
        ------
        FormatError
            If a part of the object is missing or malformed, the key is in no row, or the key is that of another name,
            space or isotropy.
        """
        if not isinstance(data, Mapping) or data.get("format") != FORMAT or data.get("version") != VERSION:
            raise FormatError(f"expected a JSON object with format {FORMAT!r} and version {VERSION}")
        try:
            field = read_number_field(data["field"]) if "field" in data else QQ
            require_size("dimension", data["dimension"], 0)
            result = cls(_read_key(field, data["key"]), Subspace(field, data["ideal"], data["dimension"]))
            said = {part: data[part] for part in ("name", "space", "isotropy")}
        except KeyError as error:
            raise FormatError(f"not a classification: {error} is missing") from None
        except (LiehomError, TypeError) as error:
            raise FormatError(f"not a classification: {error}") from None
        for part, value in (("name", result.name), ("space", result.space), ("isotropy", result.row.isotropy)):
            if said[part] != value:
                raise FormatError(f"{part} is {displayed(said[part])}, by the key it is {displayed(value)}")
        return result

    def __str__(self) -> str:
        inside = f", up to an ideal of dimension {self.ideal.dimension} inside h" if self.ideal.dimension else ""
        return f"{self.name or 'no catalogue name'}: {self.space}{inside}"

    def __repr__(self) -> str:
        return f"<classification {tuple(self.key)}: {self.space}>"


def _read_key(field: ExactField, data: Mapping[str, Any]) -> Key:
    key = Key(**data)
    if key.centre == SPIRAL:
        square = field.convert(data["parameter"])
        if field.sign(square) <= 0:
            raise FormatError(f"c^2 must be positive, got {displayed(square)}")
        key = key._replace(parameter=square)
    if any(isinstance(x, (bool, float)) for x in key) or row_of(key) is None:
        raise FormatError(f"the key {displayed(tuple(key))} is in no row of the classification")
    return key
