"""Entries of a sweep, each a pair with its verdict and certificate as JSON, and the table of entries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

from liehom.catalog import pair as named_pair
from liehom.display import DisplayedTable
from liehom.errors import FormatError, InputError, shown
from liehom.fullness import Certificate, verify_certificate
from liehom.representations import Pair

KINDS: dict[str, Any] = {
    "name": str,
    "dimension": int | None,
    "subalgebra_dimension": int | None,
    "verdict": Mapping,
    "verified": bool,
    "failure": str,
    "family": str,
    "facts": Mapping,
}
"""Types of the attributes of an entry in JSON."""

OPTIONAL = ("failure", "family", "facts")
"""Attributes that may be missing in JSON, in particular in entries that earlier versions have stored."""


@final
@dataclass(frozen=True, slots=True)
class Entry:
    """One pair of a sweep with its verdict.

    Attributes
    ----------
    name : str
        The catalogue name in canonical form, or the name of the given pair.
    dimension, subalgebra_dimension : int or None
        dim g and dim h; None if there is no verdict.
    verdict : mapping
        The JSON object ``verdict.to_json()``; empty if there is no verdict.
    verified : bool
        Whether the independent checker has accepted the certificate.
    failure : str
        The reason if there is no verdict; otherwise empty.
    family : str
        The family of the recipe; empty for other pairs.
    facts : mapping
        What is known of the pair besides the verdict: the facts of its recipe, and those of `liehom.atlas.facts` if the
        sweep was asked for them, with the CPU time ``"seconds"`` that the worker took for the pair.

    Examples
    --------
    >>> import liehom as lh
    >>> entry = lh.atlas.sweep(["so(4)/so(3)"])[0]
    >>> entry.full, entry.proved, entry.verified, entry.verify()
    (True, True, True, True)
    """

    name: str
    dimension: int | None
    subalgebra_dimension: int | None
    verdict: Mapping[str, Any]
    verified: bool
    failure: str = ""
    family: str = ""
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __setstate__(self, state: Sequence[Any]) -> None:
        for name, value in zip(KINDS, [*state, "", {}], strict=False):  # 0.1.0 had neither family nor facts
            object.__setattr__(self, name, value)

    @classmethod
    def from_json(cls, facts: Mapping[str, Any]) -> Entry:
        """The entry with these attributes, a JSON object as `to_json` gives.

        Raises
        ------
        FormatError
            If an attribute is missing or unknown, or is not of the type stated above.
        """
        if not KINDS.keys() - set(OPTIONAL) <= set(facts) <= KINDS.keys():
            raise FormatError(f"an entry has the keys {', '.join(KINDS)}; found {', '.join(map(str, facts))}")
        for key, value in facts.items():
            if not isinstance(value, KINDS[key]) or (isinstance(value, bool) and key != "verified"):
                raise FormatError(f"{key} of an entry is {shown(repr(value))}, which is not of its type")
        entry = cls(**facts)
        certificate = entry.certificate
        if certificate is not None and certificate.full is not entry.full:
            raise FormatError(f"the entry of {entry.name} and its certificate do not agree whether it is full")
        return entry

    def to_json(self) -> dict[str, Any]:
        """The attributes by name as a JSON object."""
        return {name: getattr(self, name) for name in KINDS}

    @property
    def full(self) -> bool | None:
        """Whether the pair is full; None if there is no verdict or a numerical one that leaves it undecided."""
        return self.verdict.get("full")

    @property
    def proved(self) -> bool:
        """Whether the verdict is proved; False for a numerical verdict or none."""
        return bool(self.verdict.get("proved"))

    @property
    def reason(self) -> str:
        """The reason for the verdict, or for its absence, in one sentence."""
        return str(self.verdict.get("reason", self.failure))

    @property
    def certificate(self) -> Certificate | None:
        """The certificate; None if the verdict is numerical or absent."""
        data = self.verdict.get("certificate")
        return None if data is None else Certificate.from_json(data)

    def verify(self, pair: Pair | None = None) -> bool:
        """True if the independent checker accepts the certificate; raises `CertificateError` otherwise.

        Parameters
        ----------
        pair : Pair, optional
            By default the pair with this name in the catalogue.

        Raises
        ------
        InputError
            If there is no certificate.
        CatalogError
            If `pair` is not given and the name is not in the catalogue.
        CertificateError
            If a check fails.
        """
        certificate = self.certificate
        if certificate is None:
            raise InputError(f"there is no certificate for {self.name}: {self.reason}")
        return verify_certificate(named_pair(self.name) if pair is None else pair, certificate)

    def __str__(self) -> str:
        return f"{self.name}: {self._answer()}: {self.reason}"

    def _answer(self) -> str:
        if self.full is None:
            return "undecided (numerical)" if self.verdict else "no verdict"
        return ("full" if self.full else "not full") + ("" if self.proved else " (numerical)")


@final
@dataclass(frozen=True, slots=True, repr=False)
class Atlas(DisplayedTable):
    """The entries of a sweep in the order of the given pairs, the result of `sweep`.

    Attributes
    ----------
    entries : tuple of Entry

    Examples
    --------
    >>> import liehom as lh
    >>> atlas = lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"])
    >>> len(atlas), [entry.name for entry in atlas.full], [entry.name for entry in atlas.not_full]
    (2, ['so(4)/so(3)'], ['so(3,1)/so(2,1)'])
    >>> print(atlas)
    pair             dim g  dim h  full  certificate
    so(4)/so(3)          6      3  yes   full
    so(3,1)/so(2,1)      6      3  no    witness
    """

    entries: tuple[Entry, ...]

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self.entries)

    def __getitem__(self, index: int) -> Entry:
        return self.entries[index]

    @property
    def full(self) -> tuple[Entry, ...]:
        """The entries of pairs that are full, numerical verdicts included."""
        return tuple(entry for entry in self.entries if entry.full is True)

    @property
    def not_full(self) -> tuple[Entry, ...]:
        """The entries of pairs that are not full, numerical verdicts included."""
        return tuple(entry for entry in self.entries if entry.full is False)

    @property
    def failures(self) -> tuple[Entry, ...]:
        """The entries without a verdict."""
        return tuple(entry for entry in self.entries if entry.full is None)

    def to_json(self) -> dict[str, Any]:
        """The table as a JSON object, certificates included."""
        return {
            "pairs": [
                {
                    "name": entry.name,
                    "dimension": entry.dimension,
                    "subalgebra_dimension": entry.subalgebra_dimension,
                    "verified": entry.verified,
                    **{key: value for key in OPTIONAL if (value := getattr(entry, key))},
                    **entry.verdict,
                }
                for entry in self.entries
            ]
        }

    def __repr__(self) -> str:
        full, not_full, rest = len(self.full), len(self.not_full), len(self.failures)
        return f"<atlas of {len(self)} pairs, {full} full, {not_full} not, {rest} undecided>"

    def _cells(self) -> list[list[str]]:
        return [["pair", "dim g", "dim h", "full", "certificate"], *(_cells_of(entry) for entry in self.entries)]


def _cells_of(entry: Entry) -> list[str]:
    if not entry.verdict:
        return [entry.name, "", "", "?", f"none: {entry.failure}"]
    answer = {True: "yes", False: "no", None: "?"}[entry.full]
    kind = entry.verdict["certificate"]["kind"] if entry.proved else "none, numerical"
    return [entry.name, str(entry.dimension), str(entry.subalgebra_dimension), answer, kind]
