"""ClosedForm: the isotropy correction and the clock of a step as simplified formulas."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import ObjectArray, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.door import RationalFunction, Representation
from liehom.flow.series.arrays import as_values, is_jax, namespace
from liehom.flow.steps.expansion import Clock, Flow, flow_series, step_series
from liehom.flow.steps.step import ExponentialLike, Generator, Step, zero_series
from liehom.flow.steps.symbolic_problem import (
    ExpressionLike,
    SymbolicRange,
    Symbols,
    object_array,
    read_symbols,
    simple,
)

TERMS_PER_CHUNK = 100


def compiled_function(symbols: Symbols, elements: Sequence[RationalFunction]) -> Callable[..., Any]:
    """Function (m, t=0, **parameters) -> values of the elements, array of shape (..., number of elements)."""
    import sympy

    order = [symbols.symbols[name] for name in symbols.names]
    parts: list[Any] = []  # sums of at most TERMS_PER_CHUNK terms, as a compiler reads a long sum as a deep tree
    plans: list[tuple[tuple[int, int], list[tuple[list[int], int]]]] = []
    for element in elements:
        content, factors = symbols.factors(element)
        plan = []
        for p, k in factors:
            chunks = symbols.chunks(p, TERMS_PER_CHUNK)
            plan.append((list(range(len(parts), len(parts) + len(chunks))), k))
            parts += chunks
        plans.append(((int(content.p), int(content.q)), plan))
    run = sympy.lambdify(order, parts, modules="numpy", cse=True)

    def function(m: ArrayLike, t: Real = 0.0, **parameters: Real) -> Values:
        point = as_values(m)
        if point.ndim == 0 or point.shape[-1] != symbols.size:
            raise ShapeError(f"a point has {symbols.size} coordinates (on its last axis), got shape {point.shape}")
        if set(parameters) != set(symbols.parameters):
            raise InputError(f"the parameters are {list(symbols.parameters)}, got {sorted(parameters)}")
        values: list[Any] = (
            [point[..., i] for i in range(symbols.size)] + [t] + [parameters[name] for name in symbols.parameters]
        )
        values = [v if is_jax(v) else np.asarray(v) for v in values]
        xp = namespace(*values)
        shape = np.broadcast_shapes(*(v.shape for v in values))
        sums = run(*values)
        quotients = []
        for (above, below), plan in plans:
            top, bottom = xp.ones(shape) * above, xp.ones(shape) * below
            for chunks, k in plan:
                base = sum(sums[i] for i in chunks)
                top, bottom = (top * base**k, bottom) if k > 0 else (top, bottom * base**-k)
            defined = bottom != 0
            quotients.append(xp.where(defined, top / xp.where(defined, bottom, 1), 0 * top))
        return xp.stack(quotients, axis=-1)

    return function


# ClosedForm: the isotropy correction and the clock of a step as simplified formulas. The point, the parameters and the
# time are elements of a field of rational functions modulo the constraints, such as |m|^2 = 1. The code that expands
# flow and step in numbers expands them over this field, so a formula belongs to the step that integrates. The system of
# Theorem 5 is solved by normal equations (`symbolic_range`). It is proved, coefficient by coefficient, that the
# corrected step agrees with the flow.


@final
@dataclass(frozen=True, slots=True, repr=False)
class ClosedForm:
    """Isotropy correction and clock of a step as formulas.

    Attributes
    ----------
    order : int
        n, the order to which the corrected step captures the orbit, and at times tau(h) the trajectory.
    leading : int
        l, the order of the first coefficient of the flow that is not identically zero.
    zeta : dict of int to tuple of sympy expressions
        zeta_k, the coefficients in g of h^k in the generator, for the k with zeta_k not identically zero.
    clock : dict of int to sympy expression
        c_k for all k >= 2, zeros included, with tau(h) = h + c_2 h^2 + ....
    isotropy : tuple of sympy expressions, or None
        If the isotropy has dimension 1, its generator, given or (for at most one constraint) computed, such as
        m -> hat(m) on the sphere.
    factor : dict of int to sympy expression
        If there is such a generator, the scalars with zeta_k = factor[k] isotropy.
    orbit_dimension : int
    residual_is_zero : bool
        Whether the corrected step was proved to agree with F_tau through order n wherever the constraints hold.
    reached : int
        The order to which it agrees.
    nonvanishing : sympy expression
        Product of the different factors of the denominators; the formulas hold where it is not 0.
    representation, step, exponential, symbols
        The problem that the formulas belong to.

    Examples
    --------
    A symmetric top, with (h - Om) m as its generator; the coordinates of hat(m) in the basis of so(3) are m2, -m1, m0:

    >>> import liehom as lh
    >>> from liehom.flow.steps import closed_form
    >>> top = ["a*m2**3 - a*m2", "-a*m1*m2**2", "a*m0*m2**2"]
    >>> formula = closed_form(lh.defining(lh.so(3)), top, lh.Euler(), 2)
    >>> print(formula.factor[1])
    -a*m2**2
    """

    order: int
    leading: int
    zeta: dict[int, tuple[Any, ...]]
    clock: dict[int, Any]
    isotropy: tuple[Any, ...] | None
    factor: dict[int, Any]
    orbit_dimension: int
    residual_is_zero: bool
    reached: int
    nonvanishing: Any
    representation: Representation
    step: str
    exponential: str
    symbols: Symbols
    _elements: dict[tuple[str, int], Any] = field(repr=False)

    def equal(self, a: ExpressionLike, b: ExpressionLike) -> bool:
        """Whether two expressions in the symbols are equal wherever the constraints hold, by proof, not by sampling."""
        return bool(self.symbols.element(a) == self.symbols.element(b))

    def function(self, k: int | None = None) -> Callable[..., Any]:
        """Function (m, t=0, **parameters) -> zeta_k, an array of shape (..., dim g).

        Parameters
        ----------
        k : int, optional
            Default: the last k for which zeta_k is not identically zero.

        Returns
        -------
        callable
            It takes m (..., N), numpy of any precision or JAX, and parameters that are numbers or arrays (...,). Its
            value is 0 where a denominator is 0, as at equilibria.

        Examples
        --------
        >>> import liehom as lh
        >>> from liehom.flow.steps import closed_form
        >>> top = ["a*m2**3 - a*m2", "-a*m1*m2**2", "a*m0*m2**2"]
        >>> formula = closed_form(lh.defining(lh.so(3)), top, lh.Euler(), 2)
        >>> formula.function()([0.6, 0.0, 0.8], a=2.0).round(12).tolist()  # -a m2^2 (m2, -m1, m0)
        [-1.024, 0.0, -0.768]
        """
        zeros = [self.symbols.field.zero] * self.representation.algebra.dimension
        last = max(self.zeta, default=0)
        return compiled_function(self.symbols, self._elements.get(("zeta", last if k is None else k), zeros))

    def clock_function(self, k: int | None = None) -> Callable[..., Any]:
        """Function (m, t=0, **parameters) -> c_k, an array of shape (...,); by default for the last k."""
        run = compiled_function(self.symbols, [self._elements["clock", max(self.clock) if k is None else k]])
        return lambda m, t=0.0, **parameters: run(m, t, **parameters)[..., 0]

    def latex(self) -> str:
        """String with the formulas in LaTeX, an aligned display without its environment.

        Examples
        --------
        >>> import liehom as lh
        >>> from liehom.flow.steps import closed_form
        >>> top = ["a*m2**3 - a*m2", "-a*m1*m2**2", "a*m0*m2**2"]
        >>> print(closed_form(lh.defining(lh.so(3)), top, lh.Euler(), 2).latex())
        \\zeta_{1} &= - a m_{2}^{2} \\begin{pmatrix} m_{2} \\\\ - m_{1} \\\\ m_{0} \\end{pmatrix} \\\\
        c_{2} &= 0
        """
        import sympy

        def column(entries: Sequence[Any]) -> str:
            return r"\begin{pmatrix} " + r" \\ ".join(sympy.latex(x) for x in entries) + r" \end{pmatrix}"

        lines = []
        for k, value in self.zeta.items():
            if k in self.factor:
                scalar = sympy.latex(self.factor[k])
                scalar = rf"\left({scalar}\right)" if self.factor[k].is_Add else scalar
                lines.append(rf"\zeta_{{{k}}} &= {scalar} {column(self.isotropy or ())}")
            else:
                lines.append(rf"\zeta_{{{k}}} &= {column(value)}")
        lines += [rf"c_{{{k}}} &= {sympy.latex(value)}" for k, value in self.clock.items()]
        return " \\\\\n".join(lines)

    def __str__(self) -> str:
        constraints = " and ".join(f"{c} = 0" for c in self.symbols.constraints)
        state = ("proved" if self.residual_is_zero else "not solvable beyond") + f" where {constraints}" * bool(
            constraints
        )
        lines = [f"{self.step} corrected to order {self.reached} ({self.exponential}), {state}"]
        for k, value in self.zeta.items():
            shown = f"({self.factor[k]}) * {self.isotropy}" if k in self.factor else str(value)
            lines.append(f"  zeta_{k} = {shown}")
        lines += [f"  c_{k} = {value}" for k, value in self.clock.items()]
        lines.append(f"  where {self.nonvanishing} != 0")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<closed form of order {self.order} for {self.step}>"


def closed_form(
    representation: Representation,
    psi: Sequence[Any],
    step: Step,
    order: int,
    *,
    exponential: ExponentialLike = "exp",
    constraints: Sequence[Any] | None = None,
    isotropy: Sequence[Any] | None = None,
) -> ClosedForm:
    """`ClosedForm`: the isotropy correction and the clock that raise a step to a given order, as formulas.

    Parameters
    ----------
    representation : Representation
        rho, over QQ.
    psi : sequence of sympy expressions, strings or rational numbers
        The generator, rational functions of m0, ..., m(N-1), the time t and parameters, which are all other symbols.
    step : Step
        The base, such as ``Euler()``, ``Heun()``, ``LieTaylor(4)`` or a user-defined step.
    order : int
        n. If the base has an order below n - 1, all orders between are corrected in turn.
    exponential : str, Exponential or callable
    constraints : sequence of sympy expressions or strings, optional
        Polynomials that vanish on the orbits and define an irreducible variety. Default: |m|^2 - 1 if the matrices of
        rho are skew-symmetric, else none.
    isotropy : sequence of dim g expressions, optional
        If g_m has dimension 1, the generator of g_m in which to write the correction; by default one is computed.

    Raises
    ------
    FieldError
        If the representation is not over QQ, or a coefficient is a float.

    Notes
    -----
    Theorem 5 with its factor, one order after the other. The solution is the one with the smallest |c| and, among
    those, the smallest |zeta|, as in `liehom.steps.correction`. If the system has no solution, `reached` is below
    `order`. With several constraints, factors are not unique: formulas are longer, and lose digits near equilibria. The
    first correction depends on the order of the orbit. If the orbits of the base have a higher order than its
    trajectories, zeta_k = 0 for the orders between, while c_k is not 0.

    Examples
    --------
    The correction of Euler's step for the rigid body, proved to be the paper's sigma_i:

    >>> import liehom as lh
    >>> from liehom.flow.steps import closed_form
    >>> h = "(w1*m0**2 + w2*m1**2 + w3*m2**2)"
    >>> psi = [f"m2*({h} - w3)", f"-m1*({h} - w2)", f"m0*({h} - w1)"]  # (h - Om) m in the basis of so(3)
    >>> formula = closed_form(lh.defining(lh.so(3)), psi, lh.Euler(), 2)
    >>> v2 = "((w3 - w2)**2*m1**2*m2**2 + (w1 - w3)**2*m0**2*m2**2 + (w2 - w1)**2*m0**2*m1**2)"
    >>> formula.equal(formula.factor[1], f"({h} - w1)*({h} - w2)*({h} - w3)/{v2}"), formula.residual_is_zero
    (True, True)
    """
    symbols, components = read_symbols(representation, psi, constraints, isotropy or ())
    generator = GeneratorField(representation, symbols.generator(components))
    action = Action(representation, exponential)
    solver = SymbolicRange(action, symbols.field, object_array(symbols.point))
    if isotropy is not None:
        solver.row = _given_isotropy(symbols, solver, isotropy, action.dimension)
    recursion = _SymbolicRecursion(action, generator, step, symbols, solver, order)
    recursion.run(step.order)
    return _result(recursion, step)


@final
class _SymbolicRecursion:
    """The recursion over orders; values have one leading axis of length 1."""

    def __init__(
        self, action: Action, generator: GeneratorField, step: Step, symbols: Symbols, solver: SymbolicRange, order: int
    ) -> None:
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order <= step.order:
            raise InputError(f"the order is an integer above {step.order}, the order of {step!r}; got {order!r}")
        self.action, self.symbols, self.solver, self.order = action, symbols, solver, int(order)
        point = object_array(symbols.point)[None]
        time = object_array([symbols.time])
        self.flow: Flow = flow_series(generator, point, self.order, time)
        local = step.at(action, Generator(generator, solver.orbit_dimension), point, time[:, None])
        self.zeta = zero_series(object_array([symbols.field.zero] * action.dimension)[None], self.order)
        self.step = step_series(action, local, point, self.order, self.zeta)
        self.clock = Clock(self.flow, self.order, (1,))
        self.factor = symbols.field.one / 2 if step.one_exponential else symbols.field.one
        self.leading = next((k for k in range(1, self.order + 1) if any(self.flow.point(k)[0])), 0)
        self.reached = 0
        self.zeta_of: dict[int, ObjectArray] = {}
        self.clock_of: dict[int, RationalFunction] = {}

    def in_algebra(self, solution: ObjectArray) -> ObjectArray:
        """Solution of the solver as an array of dim g coefficients."""
        row = self.solver.row
        return solution if row is None else simple(solution[0] * row)

    def difference(self, n: int) -> ObjectArray:
        """Coefficient [t^n] (F_tau - corrected step), an array of N elements."""
        return simple((self.clock.point(n) - self.step.coefficient(n))[0])

    def run(self, base_order: int) -> None:
        if self.leading == 0:
            raise InputError(
                "rho(psi(m)) m is identically 0: every point is an equilibrium, there is nothing to correct"
            )
        for n in range(1, max(base_order, self.leading) + 1):
            if any(self.difference(n)):
                raise InputError(
                    f"the step does not agree with the flow at order {n}, at which isotropy does not enter "
                    f"(order of the step {base_order}, leading order of the flow {self.leading})"
                )
        self.reached = max(base_order, self.leading)
        self.solver.prepare(self.flow.point(self.leading)[0], self.leading, self.factor)
        for n in range(self.reached + 1, self.order + 1):
            zeta, c = self.solver.solve(self.difference(n))
            k = n - self.leading
            self.zeta_of[k], self.clock_of[k + 1] = zeta, c
            self.zeta.replace(k, self.in_algebra(zeta)[None], self.step)
            self.clock.set(k + 1, object_array([c]))
            if any(self.difference(n)):
                return
            self.reached = n


def _given_isotropy(symbols: Symbols, solver: SymbolicRange, isotropy: Sequence[Any], dimension: int) -> ObjectArray:
    left = dimension - solver.orbit_dimension
    if left != 1:
        raise InputError(f"isotropy can be given where g_m has dimension 1; here it has dimension {left}")
    row = object_array([symbols.element(x) for x in isotropy])
    if len(row) != dimension:
        raise ShapeError(f"isotropy has {len(row)} coefficients, the algebra has dimension {dimension}")
    if not any(row) or not solver.fixes(row):
        raise InputError(f"isotropy = {list(isotropy)} does not generate g_m where the constraints hold")
    return row


def _result(recursion: _SymbolicRecursion, step: Step) -> ClosedForm:
    symbols, row = recursion.symbols, recursion.solver.row
    elements: dict[tuple[str, int], Any] = {("clock", k): c for k, c in recursion.clock_of.items()}
    for k, value in sorted(recursion.zeta_of.items()):
        if any(value):
            if row is not None:
                elements["factor", k] = value[0]
            elements["zeta", k] = list(recursion.in_algebra(value))
    factor = {k: symbols.expression(x) for (name, k), x in elements.items() if name == "factor"}
    generator = None if row is None else tuple(map(symbols.expression, row))
    zeta = {
        k: tuple(map(symbols.expression, row)) if generator is None else tuple(factor[k] * x for x in generator)
        for (name, k), row in elements.items()
        if name == "zeta"
    }
    return ClosedForm(
        order=recursion.order,
        leading=recursion.leading,
        zeta=zeta,
        clock={k: symbols.expression(c) for k, c in sorted(recursion.clock_of.items())},
        isotropy=generator,
        factor=factor,
        orbit_dimension=recursion.solver.orbit_dimension,
        residual_is_zero=recursion.reached == recursion.order,
        reached=recursion.reached,
        nonvanishing=symbols.nonvanishing(elements.values()),
        representation=recursion.action.representation,
        step=repr(step),
        exponential=recursion.action.exponential.name,
        symbols=symbols,
        _elements=elements,
    )
