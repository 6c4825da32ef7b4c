"""Bilinear control systems x' = (A + u_1 B_1 + ... + u_m B_m) x: where they are transitive, and where controllable.

docs/control.md has the theorems that `controllability` uses, with their proofs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, final

from liehom.base.errors import InputError, UndecidedError
from liehom.base.objects import Immutable
from liehom.exact.algebra.constructions.families import affine_of
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.linear.complex_matrices import list_of_matrices
from liehom.exact.fullness.decide import decide_fullness
from liehom.exact.fullness.verdict import Full, NotFull, Verdict, preserves_its_form
from liehom.exact.orbits.types import structure_name
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Matrix, MatrixLike

State = Literal["controllable", "accessible", "not transitive", "undecided"]


def controllability(
    *, drift: MatrixLike | None = None, controls: Iterable[MatrixLike] = (), hermitian: bool = False
) -> Controllability:
    """Where the system x' = (A + u_1 B_1 + ... + u_m B_m) x with controls u of any size is controllable.

    Parameters
    ----------
    drift : (n, n) array_like, optional
        A, real or complex; without it A = 0.
    controls : sequence of (n, n) array_like
        B_1, ..., B_m. Exact entries give proofs, floats numerical answers.
    hermitian : bool
        All matrices are Hamiltonians, and each is multiplied by i. The sign does not change the answers.

    Examples
    --------
    >>> import liehom as lh
    >>> turn = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]]
    >>> print(controllability(drift=turn[0], controls=turn[1:]))
    control system on R^3 with a drift: so(3)
      group, of dimension 3: controllable, since it is compact
      R^3 minus 0: not transitive, since orbits meet each ray once
      sphere S^2: controllable, since the group is compact
      projective space RP^2: controllable, since the group is compact
    """
    given = list_of_matrices(controls)
    matrices = [*given] if drift is None else [*given, *list_of_matrices([drift])]
    if not matrices:
        raise InputError("a control system needs at least one matrix: controls=[B1, ...], or drift=A")
    rho = Representation.from_matrices(matrices, hermitian=hermitian)
    if rho.matrices[0].nrows < 2:
        raise InputError("matrices of size 2 or more were expected, got size 1: x' = a x keeps the sign of x")
    steered = [i for i, k in enumerate(rho.kept) if k < len(given)]
    return Controllability(rho, drift is not None and len(given) in rho.kept, steered)


@final
@dataclass(frozen=True, slots=True)
class Reach:
    """Whether a control system reaches every point of a space from every other.

    Attributes
    ----------
    state : str
        'controllable': every point is reached from every point. 'accessible': from every point an open set is
        reached, and whether this is all remains open. 'not transitive': no controls lead from some points to all
        others. 'undecided': transitivity is undecided.
    reason : str
    """

    state: State
    reason: str

    def __bool__(self) -> bool:
        if self.state in ("accessible", "undecided"):
            raise UndecidedError(f"whether the system is controllable is undecided: {self.state}, {self.reason}")
        return self.state == "controllable"

    def __str__(self) -> str:
        return f"{self.state}, {self.reason}"


@final
class Controllability(Immutable):
    """Where a bilinear control system is transitive and controllable, a result of `controllability`.

    Attributes
    ----------
    representation : Representation
        Of the Lie algebra that all matrices generate; complex matrices of size n act on R^(2n).

    Examples
    --------
    >>> import liehom as lh
    >>> spin = controllability(drift=[[1, 0], [0, -1]], controls=[[[0, 1], [1, 0]]], hermitian=True)
    >>> spin.name, bool(spin.group), spin.projective.state
    ('so(3)', True, 'controllable')
    """

    def __init__(self, representation: Representation, drifts: bool, steered: list[int]) -> None:
        self.representation: Representation = representation
        self._drift: Matrix | None = representation.matrices[representation.given - 1] if drifts else None
        g = representation.algebra
        alone = g.subalgebra_generated_by(g.field.identity(g.dimension).select(rows=steered))
        self._whole: _Orbits = _Orbits(tuple(representation.matrices))
        self._alone: _Orbits | None = _Orbits(tuple(representation.restriction(alone).matrices)) if steered else None

    @property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra that the matrices generate."""
        return self.representation.algebra

    @property
    def drifts(self) -> bool:
        """Whether the drift is outside the span of the controls, so that no choice of u cancels it."""
        return self._drift is not None

    @cached_property
    def name(self) -> str:
        """The name of `algebra`, such as 'so(3)'; its dimension over floats."""
        return structure_name(self.algebra) if self.algebra.field.exact else "an algebra"

    @cached_property
    def group(self) -> Reach:
        """On the connected group of matrices with this Lie algebra, X' = (A + u_1 B_1 + ...) X."""
        if self._drift is None:
            return Reach("controllable", "since no drift is left")
        if self._alone is not None and len(self._alone.matrices) == self.algebra.dimension:
            return Reach("controllable", "since the controls alone generate the algebra")
        if _is_periodic(self._drift):
            return Reach("controllable", "since the drift is periodic")
        center = self.algebra.center().basis
        if self._whole.compact and all(_is_periodic(self.representation(row)) for row in center) and center.nrows < 2:
            return Reach("controllable", "since it is compact")
        return Reach("accessible", "since the matrices generate the algebra")

    @cached_property
    def space(self) -> Reach:
        """On R^n without 0; for complex matrices of size n on C^n without 0."""
        return self._reach(self._whole, self._alone, points=True)

    @cached_property
    def sphere(self) -> Reach:
        """On the unit sphere of R^n or C^n, for x/|x|; for a group that keeps lengths this is x itself."""
        return self._reach(self._whole, self._alone)

    @cached_property
    def projective(self) -> Reach:
        """On the projective space of R^n, or of C^n for complex matrices: pure states of a quantum system."""
        if self.representation.coordinates != "complex":
            return self.sphere
        phase = self.representation.complex_structure()
        return self._reach(
            self._whole.with_phases(phase), None if self._alone is None else self._alone.with_phases(phase)
        )

    def _reach(self, whole: _Orbits, alone: _Orbits | None, *, points: bool = False) -> Reach:
        transitive, reason = whole.transitivity(points)
        if not transitive:
            return Reach("undecided" if transitive is None else "not transitive", reason)
        if self._drift is None:
            return Reach("controllable", "since no drift is left")
        if alone is not None and alone.transitivity(points)[0]:
            return Reach("controllable", "since the controls alone are transitive")
        if whole.compact or (whole.conformal and not points):
            return Reach("controllable", "since the group is compact" + " up to scalars" * (not whole.compact))
        if _is_scalar(self._drift + self._drift.T) and not (points and self._drift.trace() != 0):
            return Reach("controllable", "since the flow of the drift is almost periodic")
        return Reach("accessible", "since the matrices generate a transitive group")

    def __bool__(self) -> bool:
        raise InputError(
            "a control system is controllable on one space and not on another: ask bool(system.group), of "
            "dimension system.algebra.dimension, bool(system.space), bool(system.sphere) or bool(system.projective)"
        )

    def __str__(self) -> str:
        rho = self.representation
        n, letter, real = rho.complex_size or rho.size, "R" if rho.complex_size is None else "C", rho.size
        places = {
            f"group, of dimension {self.algebra.dimension}": self.group,
            f"{letter}^{n} minus 0": self.space,
            f"sphere S^{real - 1}": self.sphere,
            f"projective space {letter}P^{n - 1}": self.projective,
        }
        numerical = "" if self.algebra.field.exact else " (numerical, not proved)"
        drift = "with a drift" if self.drifts else "without drift"
        lines = [f"control system on {letter}^{n} {drift}: {self.name}{numerical}"]
        return "\n  ".join([*lines, *(f"{place}: {reach}" for place, reach in places.items())])

    def __repr__(self) -> str:
        return f"<control system: {self.name} on R^{self.representation.size}>"


@dataclass(frozen=True)
class _Orbits:
    """The orbits on points and rays of the group that closed real matrices generate."""

    matrices: tuple[Matrix, ...]

    @property
    def size(self) -> int:
        return self.matrices[0].nrows

    def with_phases(self, phase: Matrix) -> _Orbits:
        """The orbits of the group with multiplication by i added."""
        return _Orbits(tuple(Representation.from_matrices([*self.matrices, phase]).matrices))

    @cached_property
    def _rays(self) -> Verdict:
        g = affine_of(self.matrices)
        h = len(self.matrices)
        return decide_fullness(Pair(g, g.field.identity(g.dimension).select(rows=range(h))))

    def transitivity(self, points: bool) -> tuple[bool | None, str]:
        """Whether the group is transitive on rays, or on points other than 0, and why not."""
        try:
            verdict = self._rays
        except UndecidedError as error:
            return None, str(error)
        if isinstance(verdict, NotFull) and verdict.eta is not None and verdict.eta_field is not None:
            point = ", ".join(verdict.eta_field.format(x) for x in verdict.eta[len(self.matrices) :])
            return False, f"since L x + R x has dimension {verdict.rank} at x = ({point})"
        if not verdict.full or not points:
            return verdict.full, verdict.reason
        # dim L x is the same at all x, because rays are one orbit
        if self.compact or self._rank < self.size:
            return False, "since orbits meet each ray once" if self.compact else "since orbits are spirals"
        return True, verdict.reason

    @cached_property
    def _rank(self) -> int:
        field, n = self.matrices[0].field, self.size
        return field.stack_rows([a.T.select(rows=[0]) for a in self.matrices], n).rank()

    @cached_property
    def conformal(self) -> bool:
        """Whether the group is shown to keep a positive definite form up to scalars."""
        if all(_is_scalar(a + a.T) for a in self.matrices):
            return True
        try:
            return isinstance(self._rays, Full) and preserves_its_form(self._rays)
        except UndecidedError:
            return False

    @cached_property
    def compact(self) -> bool:
        """Whether the group is shown to keep a positive definite form."""
        if self.matrices[0].field.exact:
            return self.conformal and all(a.trace() == 0 for a in self.matrices)
        return all((a + a.T).is_zero() for a in self.matrices)


def _is_scalar(a: Matrix) -> bool:
    """Whether a matrix is a multiple of 1."""
    return (a - a.field.identity(a.nrows).scale(a.trace() / a.nrows)).is_zero()


def _is_periodic(a: Matrix) -> bool:
    """Whether exp(t a) is shown to be periodic: a is skew, and a^2 a multiple of 1."""
    return (a + a.T).is_zero() and _is_scalar(a @ a)
