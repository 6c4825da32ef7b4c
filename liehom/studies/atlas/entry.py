"""Recipes of pairs, entries of a sweep with verdict and certificate as JSON, and facts about a decided pair."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias, final

from liehom.base.budget import in_time, limits
from liehom.base.errors import FieldError, FormatError, InputError, LimitError, UndecidedError, shown
from liehom.base.objects import DisplayedTable
from liehom.exact.catalog.pairs import pair as named_pair
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.fullness.decide import classify
from liehom.exact.fullness.range_classification import classify_range
from liehom.exact.fullness.verdict import Full, Verdict
from liehom.exact.orbits.cone import counted_open_orbits, invariant_degree
from liehom.exact.orbits.range import orbit_dimension
from liehom.exact.representations.core.pair import Pair


@final
@dataclass(frozen=True, slots=True)
class Recipe:
    """One pair of a family: its name, and the function call that constructs it.

    A recipe is small and can be pickled. A family of thousands of pairs is therefore a generator of recipes, and each
    pair is constructed in the process that decides it.

    Attributes
    ----------
    name : str
        The pair in the notation of the field, such as ``"su(3)/so(3)"``; unique in its family. If it is a catalogue
        name, the pair is the one of the catalogue.
    family : str
        Name of the family.
    make : callable
        A function at the level of a module; ``make(*arguments)`` returns the pair.
    arguments : tuple
        Values with a `repr` that determines them: strings, numbers, and tuples of these.
    known : mapping
        Facts known from the construction by name, booleans, integers or strings: ``{"rank": 1}`` for a symmetric pair.

    Examples
    --------
    >>> import liehom as lh
    >>> recipe = lh.atlas.Recipe("so(4)/so(3)", "spheres", lh.pair, ("so(4)/so(3)",), {"rank": 1})
    >>> recipe.pair()
    pair('so(4)/so(3)')
    >>> recipe.key
    "liehom.exact.catalog.pairs.pair('so(4)/so(3)')"
    """

    name: str
    family: str
    make: Callable[..., Pair]
    arguments: tuple[object, ...] = ()
    known: Mapping[str, bool | int | str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        if not self.name or not self.family:
            raise InputError(f"a recipe has a name and a family; found {self.name!r} and {self.family!r}")
        if not getattr(self.make, "__qualname__", "").isidentifier():
            raise InputError(
                f"make is {shown(repr(self.make))}, expected a function at the level of a module; "
                "values that it needs are given in `arguments`"
            )

    @property
    def key(self) -> str:
        """The function call as a string; equal for two recipes of the same pair by the same function."""
        return f"{self.make.__module__}.{self.make.__qualname__}({', '.join(map(repr, self.arguments))})"

    def pair(self) -> Pair:
        """The pair, constructed at each call."""
        pair = self.make(*self.arguments)
        if not isinstance(pair, Pair):
            raise InputError(f"{self.key} returned {shown(repr(pair))}, expected a Pair")
        return pair


KINDS: dict[str, Any] = {
    "name": str, "dimension": int | None, "subalgebra_dimension": int | None, "verdict": Mapping, "verified": bool,
    "failure": str, "family": str, "facts": Mapping,
}  # fmt: skip
"""Types of the attributes of an entry in JSON."""

OPTIONAL = ("failure", "family", "facts")  # attributes that may be missing in JSON


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

    @classmethod
    def from_json(cls, facts: Mapping[str, Any]) -> Entry:
        """The entry with these attributes, a JSON object as `to_json` gives; `FormatError` for another object."""
        if not KINDS.keys() - set(OPTIONAL) <= set(facts) <= KINDS.keys():
            raise FormatError(f"an entry has the keys {', '.join(KINDS)}; found {', '.join(map(str, facts))}")
        for key, value in facts.items():
            if not isinstance(value, KINDS[key]) or (isinstance(value, bool) and key != "verified"):
                raise FormatError(f"{key} of an entry is {shown(repr(value))}, which is not of its type")
        entry = cls(**facts)
        if (certificate := entry.certificate) is not None and certificate.full is not entry.full:
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
        InputError, CatalogError
            If there is no certificate; if `pair` is not given and the name is not in the catalogue.
        """
        if (certificate := self.certificate) is None:
            raise InputError(f"there is no certificate for {self.name}: {self.reason}")
        return verify_certificate(named_pair(self.name) if pair is None else pair, certificate)

    def __str__(self) -> str:
        answer = {True: "full", False: "not full", None: "undecided"}[self.full] if self.verdict else "no verdict"
        return f"{self.name}: {answer}{' (numerical)' if self.verdict and not self.proved else ''}: {self.reason}"


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
                    **{key: getattr(entry, key) for key in ("name", "dimension", "subalgebra_dimension", "verified")},
                    **{key: value for key in OPTIONAL if (value := getattr(entry, key))},
                    **entry.verdict,
                }
                for entry in self.entries
            ]
        }

    def __repr__(self) -> str:
        counts = f"{len(self.full)} full, {len(self.not_full)} not, {len(self.failures)} undecided"
        return f"<atlas of {len(self)} pairs, {counts}>"

    def _cells(self) -> list[list[str]]:
        return [["pair", "dim g", "dim h", "full", "certificate"], *(_cells_of(entry) for entry in self.entries)]


def _cells_of(entry: Entry) -> list[str]:
    if not entry.verdict:
        return [entry.name, "", "", "?", f"none: {entry.failure}"]
    answer = {True: "yes", False: "no", None: "?"}[entry.full]
    kind = entry.verdict["certificate"]["kind"] if entry.proved else "none, numerical"
    return [entry.name, str(entry.dimension), str(entry.subalgebra_dimension), answer, kind]


Fact: TypeAlias = bool | int | str | list[int | str | None] | dict[str, str] | None
"""A fact as a JSON value: it is exact, or missing for a stated reason."""


def facts(pair: Pair, verdict: Verdict, *, seconds: float = 60.0) -> dict[str, Fact]:
    """Facts about a decided pair, a JSON object.

    ``"key"``, ``"row"`` and ``"space"`` are key, name and space of the row of a full pair in the classification, see
    `liehom.classify`, and None for other pairs. ``"range_condition"``: whether [h, eta] + R eta + h = g for generic
    eta, see `liehom.classify_range`. ``"orbit_dimension"``: the dimension of [h, eta] + R eta in g/h for generic eta,
    see `liehom.orbits.orbit_dimension`. ``"invariant_degree"``: see `liehom.orbits.invariant_degree`, None if the
    range condition holds for no eta. ``"open_orbits"``: the number of open orbits on g/h, see
    `liehom.orbits.open_orbit_count`. ``"missing"``: the reasons why facts are missing, by name. Missing facts are
    None.

    Parameters
    ----------
    pair : Pair
    verdict : Full, NotFull or another verdict
        Of `liehom.decide_fullness` for this pair.
    seconds : float
        Limit for each fact. One that takes longer is missing.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(3,1)/so(2,1)")
    >>> known = facts(pair, lh.decide_fullness(pair))
    >>> known["range_condition"], known["orbit_dimension"], known["invariant_degree"], known["open_orbits"]
    (True, 3, 2, 3)
    """
    d, full = pair.dimension, isinstance(verdict, Full)
    missing: dict[str, str] = {}

    def fact(name: str, compute: Callable[[Pair], int | None]) -> int | None:
        try:
            return _in(seconds, compute, pair)
        except (FieldError, UndecidedError) as error:
            missing[name] = str(error)
        return None

    holds = True if full else fact("range_condition", _generic)
    dimension = d if holds else fact("orbit_dimension", orbit_dimension)
    degree = fact("invariant_degree", invariant_degree) if holds else None
    orbits = None if holds is None else 0
    if full:
        orbits = 2 if d == 1 else 1  # the connected group is transitive on rays
    elif holds:
        orbits = fact("open_orbits", lambda pair: counted_open_orbits(pair, True)[0])
    if holds is None:
        missing |= dict.fromkeys(("invariant_degree", "open_orbits"), missing["range_condition"])
    row = classify(pair, verdict) if isinstance(verdict, Full) else None
    return {
        "key": row and [value if isinstance(value, int | str | None) else str(value) for value in row.key],
        "row": row and row.name, "space": row and row.space, "range_condition": holds, "orbit_dimension": dimension,
        "invariant_degree": degree, "open_orbits": orbits, "missing": missing,
    }  # fmt: skip


def _generic(pair: Pair) -> bool:
    """Whether the range condition holds for generic eta; `UndecidedError` if that is undecided."""
    result = classify_range(pair)
    if result.generic is None:
        raise UndecidedError(result.undecided)
    return result.generic


def _in(seconds: float, compute: Callable[[Pair], int | None], pair: Pair) -> int | None:
    """The value; `UndecidedError` if it takes longer, or is larger than another limit allows."""
    try:
        with limits(seconds=seconds):
            return compute(pair)
    except LimitError as error:
        if error.limit != "seconds":
            raise UndecidedError(str(error)) from None
    in_time()  # a limit of the caller has passed
    raise UndecidedError(f"not computed within {seconds:g} seconds")
