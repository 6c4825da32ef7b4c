"""Classification: the row of a full pair, with the ideal of g inside h, as a frozen object and as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from liehom.algebra.matrices.matrix_basis import require_size
from liehom.display import Displayed
from liehom.errors import FormatError, InternalError, LiehomError, displayed
from liehom.fullness.certificates.certificate_fields import number_field_json, read_number_field
from liehom.fullness.classification.rows import SPIRAL, Key, Row, row_of, square_root
from liehom.fullness.classification.verify import verify_key
from liehom.representations import Pair
from liehom.scalars import QQ, ExactField, NumberField, Subspace

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
    >>> found = lh.classify(pair)
    >>> tuple(found.key), found.name, found.space
    (('C', 6, 8, 2, 'J', 1), 'su(4)/u(3)', 'CP^3 = SU(4)/U(3)')
    >>> found.verify(pair), Classification.from_json(found.to_json()) == found
    (True, True)
    """

    key: Key
    ideal: Subspace

    @property
    def row(self) -> Row:
        """Row of the key; raises `InternalError` if the key is in no row."""
        found = row_of(self.key)
        if found is None:
            raise InternalError(
                f"the key {tuple(self.key)} of a full pair is in no row of the classification, so the pair is a "
                "counterexample to the theorem or the key is wrong: please report this pair"
            )
        return found

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
        liehom.errors.CertificateError: parameter: the key says 1, the pair has -1
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
        if isinstance(field, NumberField):
            out["field"] = number_field_json(field)
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
            found = cls(_read_key(field, data["key"]), Subspace(field, data["ideal"], data["dimension"]))
            said = {part: data[part] for part in ("name", "space", "isotropy")}
        except KeyError as error:
            raise FormatError(f"not a classification: {error} is missing") from None
        except (LiehomError, TypeError) as error:
            raise FormatError(f"not a classification: {error}") from None
        for part, value in (("name", found.name), ("space", found.space), ("isotropy", found.row.isotropy)):
            if said[part] != value:
                raise FormatError(f"{part} is {displayed(said[part])}, by the key it is {displayed(value)}")
        return found

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
