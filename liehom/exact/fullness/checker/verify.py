"""Verification of certificates from exact arithmetic alone.

The input is the structure constants of g and the basis of h. The checker shares no code with the procedure that finds
certificates, and it uses no theorem except those that the docstrings here prove in a few lines. Throughout, V = g/h,
d = dim V, n = dim g, rho: h -> gl(V), and the pair is full if rho(h)x + Rx = V for every x != 0 in V. `verify_pair`
defines the coordinates and checks that rho is a representation; `verify_roots` counts roots.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement
from math import comb
from typing import Any

from liehom.base.budget import in_time
from liehom.base.errors import CertificateError
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify_pair import CheckedPair, PairData, check_pair, check_same_field
from liehom.exact.fullness.checker.verify_roots import (
    characteristic_polynomial,
    coprime,
    count_right_of,
    derivative,
    trimmed,
    value,
)
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar


def verify_certificate(pair: PairData, certificate: Certificate | Mapping[str, Any]) -> bool:
    """True if a certificate proves its verdict for a pair; otherwise raises an error that names the check.

    Parameters
    ----------
    pair : Pair
        Over an exact field.
    certificate : Certificate or its parsed JSON object

    Returns
    -------
    bool
        Always True: a certificate that does not prove its verdict raises an error.

    Raises
    ------
    CertificateError
        If a check fails; its attribute `check` is the name of the check.
    CertificateFormatError
        If the JSON object is malformed.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from liehom.exact.scalars import QQ
    >>> so3 = [(0, 1, 2, QQ.one), (1, 2, 0, QQ.one), (0, 2, 1, -QQ.one)]
    >>> g = SimpleNamespace(field=QQ, dimension=3, structure_constants=lambda: so3)
    >>> sphere = SimpleNamespace(algebra=g, subalgebra=SimpleNamespace(basis=QQ.matrix([[0, 0, 1]])))
    >>> metric = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "0"]]
    >>> fields = {"form": metric, "elements": [["0", "0", "1"]], "eta": ["1", "0", "0"]}
    >>> verify_certificate(sphere, Certificate("full", fields))
    True
    >>> verify_certificate(sphere, Certificate("full", fields | {"elements": []}))
    Traceback (most recent call last):
    ...
    liehom.base.errors.CertificateError: rank: h, eta and the brackets of eta with the elements span 2 dimensions of 3
    """
    given = certificate
    certificate = given.copied() if isinstance(given, Certificate) else Certificate.from_json(given)
    checked = check_pair(pair)
    check_same_field(checked.field, certificate.field)
    _verify(checked, certificate)
    return True


def _verify(pair: CheckedPair, certificate: Certificate) -> None:
    match certificate.kind:
        case "trivial":
            _verify_trivial(pair)
        case "full":
            _verify_full(pair, certificate)
        case "witness":
            _verify_witness(pair, certificate)
        case "commutant":
            _verify_commutant(pair, certificate)
        case "dominance":
            _verify_dominance(pair, certificate)
        case kind:
            raise CertificateError("kind", f"there is no check for the kind {kind!r}")


def verify_range(pair: PairData, certificate: Certificate | Mapping[str, Any]) -> bool:
    """Whether the range condition holds at generic eta, as a certificate proves; otherwise raises an error.

    Parameters
    ----------
    pair : Pair
        Over an exact field.
    certificate : Certificate or its parsed JSON object
        Of kind 'generic', 'slice' or 'lattice'.

    Returns
    -------
    bool
        True for the kind 'generic', False for the others.

    Raises
    ------
    CertificateError
        If a check fails; its attribute `check` is the name of the check.

    Notes
    -----
    Let M(x) be the map (z, s) -> rho(z) x + s x from h + R to V, and m = dim h + 1. 'generic': the rank of M is d at
    eta. It is then d outside the zeros of a minor, a proper algebraic set.

    The other kinds prove that the rank is at most r < d everywhere. They have a point a and the rows W of `directions`,
    with M(a) + span W = V. Let L be the image of h + R in gl(V). The map (g, w) -> g (a + w) is a submersion at (1, 0),
    so the orbits of the points a + w fill an open set, and the rank is constant on orbits. So r bounds the rank
    everywhere if it bounds it on a + span W.

    * 'slice': the k rows of `stabilizer` are independent elements (z, s) of h + R that annihilate a and W. So the rank
      is at most r = m - k at each a + w.
    * 'lattice': W has d - r rows, and the rank is at most r at a + sum t_i w_i for all integers t_i >= 0 of sum at most
      r + 1. The minors of order r + 1 are polynomials of degree at most r + 1 in t. A polynomial of this degree that
      vanishes at these points is 0: by induction on the number of variables it vanishes for t_1 = 0, so it is t_1 times
      a polynomial of lower degree, which vanishes at the points with t_1 >= 1, a lattice of lower degree.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(3,1)/so(2,1)")
    >>> verify_range(pair, Certificate("generic", {"eta": ["1", "0", "0", "0", "0", "0"]}))
    True
    >>> verify_range(pair, Certificate("generic", {"eta": ["0", "0", "0", "0", "0", "1"]}))
    Traceback (most recent call last):
    ...
    liehom.base.errors.CertificateError: rank: [h, eta] + R eta has rank 0 of 3 in g/h
    """
    certificate = certificate.copied() if isinstance(certificate, Certificate) else Certificate.from_json(certificate)
    checked = check_pair(pair)
    check_same_field(checked.field, certificate.field)
    return _verify_range(checked, certificate)


def _verify_range(pair: CheckedPair, certificate: Certificate) -> bool:
    n, d, kind = pair.dimension, pair.codimension, certificate.kind
    _require(kind in ("generic", "slice", "lattice"), "kind", f"the kind {kind!r} is not about the range condition")
    if kind == "generic":
        rank = _images(pair, certificate.vector("eta", n)).rank()
        _require(rank == d, "rank", f"[h, eta] + R eta has rank {rank} of {d} in g/h")
        return True
    a, w = certificate.vector("point", n), certificate.matrix("directions", None, n)
    reached = pair.field.stack_rows([_images(pair, a), w @ pair.quotient], d).rank()
    _require(reached == d, "slice", f"the orbit of the point and the directions span {reached} of {d} dimensions")
    (_verify_stabilizer if kind == "slice" else _verify_lattice)(pair, certificate, a, w)
    return False


def _images(pair: CheckedPair, eta: list[Scalar]) -> ExactMatrix:
    """Rows that span rho(h) x + R x, for x = eta mod h."""
    k, d = len(pair.pivots), pair.codimension
    x = pair.field.matrix([eta], (1, pair.dimension)) @ pair.quotient
    return pair.field.stack_rows([x, (x @ _side_by_side(pair.isotropy, k, d)).reshape(k, d)] if k and d else [x], d)


def _verify_stabilizer(pair: CheckedPair, certificate: Certificate, a: list[Scalar], w: ExactMatrix) -> None:
    n, d, field = pair.dimension, pair.codimension, pair.field
    stabilizer = certificate.matrix("stabilizer", None, n + 1)
    k, bound = stabilizer.nrows, len(pair.pivots) + 1 - stabilizer.nrows
    _require(bound < d, "bound", f"the rank is bounded by {bound}, which is not below {d}")
    if not k:
        return
    _require(stabilizer.rank() == k, "stabilizer-independent", f"the {k} rows of stabilizer are linearly dependent")
    elements, scalars = stabilizer.select(columns=range(n)), stabilizer.select(columns=[n])
    _require(pair.in_h(elements), "stabilizer-in-h", "an element of stabilizer is not in h")
    acting = elements.select(columns=pair.pivots) @ pair.isotropy
    acting = acting + scalars @ field.identity(d).reshape(1, d * d)
    points = field.stack_rows([field.matrix([a], (1, n)), w], n) @ pair.quotient
    moved = points @ _side_by_side(acting, k, d)
    _require(moved.is_zero(), "stabilizer", "an element of stabilizer does not annihilate the point or a direction")


MAX_LATTICE = 20_000
"""Largest number of points of a lattice."""


def _verify_lattice(pair: CheckedPair, _: Certificate, a: list[Scalar], w: ExactMatrix) -> None:
    d, rows = pair.codimension, w.to_rows()
    r = d - len(rows)
    _require(0 <= r < d, "bound", f"{len(rows)} directions are given, expected between 1 and {d}")
    count = comb(d + 1, r + 1)
    _require(count <= MAX_LATTICE, "lattice", f"the lattice has {count} points, the limit is {MAX_LATTICE}")
    for places in combinations_with_replacement([*rows, [pair.field.zero] * pair.dimension], r + 1):
        in_time()
        rank = _images(pair, [sum(column, start=x) for x, *column in zip(a, *places, strict=True)]).rank()
        _require(rank <= r, "lattice", f"the rank is {rank} at a point of the lattice, expected at most {r}")


def _require(holds: bool, check: str, message: str) -> None:
    if not holds:
        raise CertificateError(check, message)


def _verify_trivial(pair: CheckedPair) -> None:
    """Full, because d <= 1: there is no x != 0, or Rx = V."""
    d = pair.codimension
    _require(d <= 1, "codimension", f"dim g/h = {d}; a trivial certificate needs at most 1")


def _verify_full(pair: CheckedPair, certificate: Certificate) -> None:
    """Full: elements of h act as infinitesimal similarities, transitively on one sphere at one point.

    Checks:

    * d >= 2;
    * the form F is symmetric, vanishes on h, and is positive definite on V, where it is called P;
    * the elements z_j lie in h, and K_j = rho(z_j) has P(Kx, y) + P(x, Ky) = 2c P(x, y);
    * eta, h and all [z_j, eta] span g.

    It is enough to compare F(z x, y) + F(x, z y) with 2c F(x, y) for x and y in a complement of h. For x in h all terms
    vanish, since [z, x] lies in h.

    Proof of fullness. Let m be the set of P-skew maps in rho(h) + R, a Lie algebra, since rho(h) is one and a
    bracket of skew maps is skew. K_j - c_j lies in m, and V = span{x, K_j x} for x = eta mod h gives
    V = Rx + m x, so dim m x = d - 1 (m x is orthogonal to x). The connected group M of m is in O(P); its closure
    is compact and normalizes m (a closed condition), so y -> dim m y is constant on its orbits. Hence the
    orbit of x under it has dimension at least d - 1: it is open in the sphere of P through x, and compact, so it
    is that sphere, connected as d >= 2. So dim m y = d - 1 for all y != 0 (scale y), and
    rho(h)y + Ry contains m y + Ry = V.
    """
    field, n, d = pair.field, pair.dimension, pair.codimension
    _require(d >= 2, "dimension", f"dim g/h = {d}; this certificate is for at least 2 (below: trivial)")
    form = certificate.matrix("form", n, n)
    elements = certificate.matrix("elements", None, n)
    eta = field.matrix([certificate.vector("eta", n)])
    _require(form == form.T, "form-symmetric", "the form is not symmetric")
    metric = form.select(rows=pair.free, columns=pair.free)
    vanishes = form == pair.quotient @ metric @ pair.quotient.T
    _require(vanishes, "form-kernel", "the form does not vanish on h")
    _require(_is_positive_definite(metric), "form-definite", "the form is not positive definite on g/h")
    _require(pair.in_h(elements), "elements-in-h", "an element is not in h")
    x = eta @ pair.quotient
    spanned = [x]
    for number, rho in enumerate(pair.rho(elements)):
        half = rho @ metric
        moved = half + half.T
        factor = moved[0, 0] / metric[0, 0]  # 2c
        _require(
            moved == metric.scale(factor), "conformal", f"element {number} does not preserve the form up to a factor"
        )
        spanned.append(x @ rho)
    rank = n - d + field.stack_rows(spanned, d).rank()
    message = f"h, eta and the brackets of eta with the elements span {rank} dimensions of {n}"
    _require(rank == n, "rank", message)


def _is_positive_definite(form: ExactMatrix) -> bool:
    """Whether a symmetric matrix is positive definite: all pivots of Gaussian elimination L D L^T are positive."""
    field, rows = form.field, form.to_rows()
    for i, row in enumerate(rows):
        if field.sign(row[i]) <= 0:
            return False
        inverse = 1 / row[i]
        for other in rows[i + 1 :]:
            if other[i] == 0:
                continue
            factor = other[i] * inverse
            for j in range(i + 1, len(rows)):
                other[j] = other[j] - factor * row[j]
    return True


def _verify_witness(pair: CheckedPair, certificate: Certificate) -> None:
    """Not full: a real eta outside h and a linear form phi != 0 with phi(h) = phi(eta) = phi([h, eta]) = 0.

    The coordinates of eta and phi are polynomials in theta, of lower degree than f (minpoly). Checks:

    * f is squarefree, and f(a) f(b) < 0 for the interval (a, b), a < b. If f has degree 1, a <= theta <= b is
      enough: then f = t and the interval (0, 0) or (-1, 1) say that eta and phi are over the field itself.
    * One coordinate of phi, and one coordinate of eta mod h, is coprime to f.
    * The three equations hold modulo f.

    Proof. f has a real root theta in (a, b). All equations hold there, phi(theta) != 0, and eta(theta) is not
    in h, as a polynomial coprime to f does not vanish at a root of f. phi is a nonzero linear form on V that
    vanishes on x = eta mod h != 0 and on rho(h)x. (So f may be reducible, and have several roots in (a, b):
    the equations hold at each.)
    """
    n, d, field = pair.dimension, pair.codimension, pair.field
    f = trimmed(certificate.vector("minpoly"))
    size = len(f) - 1
    _check_root(field, f, *certificate.vector("interval", 2))
    eta, phi = (certificate.polynomials(name, n, size) for name in ("eta", "phi"))
    point = pair.quotient.T @ eta  # (d; s)
    _require(_some_coprime(phi, f), "phi-nonzero", "no coordinate of phi is coprime to minpoly")
    _require(_some_coprime(point, f), "eta-outside-h", "no coordinate of eta modulo h is coprime to minpoly")
    on_quotient = phi.select(rows=pair.free)  # (d; t): values at the basis of V
    # phi(x) for x in h is (x - (x Q) e_free) phi, zero on all of h iff phi = Q phi_free
    _require(phi == pair.quotient @ on_quotient, "phi-h", "phi does not vanish on h")
    _require(_vanishes(field, [point.T @ on_quotient], f), "phi-eta", "phi(eta) is not 0 modulo minpoly")
    k = len(pair.pivots)
    if k:
        values = pair.isotropy.reshape(k * d, d) @ on_quotient  # (p, w; t)
        products = [
            point.T @ values.select(rows=range(p * d, (p + 1) * d)) for p in range(k)
        ]  # (s; t) for each element of h
        _require(_vanishes(field, products, f), "phi-bracket", "phi([h, eta]) is not 0 modulo minpoly")
    if "also" in certificate.fields:
        also = certificate.fields["also"]
        check_same_field(field, also.field)
        _verify(pair, also)


def _check_root(field: ExactField, f: list[Scalar], low: Scalar, high: Scalar) -> None:
    """Check that f is squarefree and has a real root in the interval."""
    _require(coprime(f, derivative(f)), "minpoly", "minpoly is not squarefree")
    signs = field.sign(value(f, low)), field.sign(value(f, high))
    if len(f) == 2:
        holds = field.sign(high - low) >= 0 and signs[0] * signs[1] <= 0
    else:
        holds = field.sign(high - low) > 0 and signs[0] * signs[1] < 0
    _require(holds, "interval", "minpoly does not change its sign on the interval")


def _some_coprime(rows: ExactMatrix, f: list[Scalar]) -> bool:
    polynomials = (trimmed(row) for row in rows.to_rows())
    return any(coprime(f, p) for p in polynomials if p)


def _vanishes(field: ExactField, products: list[ExactMatrix], f: list[Scalar]) -> bool:
    """Whether the polynomials sum of B[s, t] theta^(s + t) are 0 modulo f, for all matrices B (size, size)."""
    size = len(f) - 1
    rows = field.stack_rows([b.reshape(1, size * size) for b in products], size * size)
    powers = []
    for u in range(2 * size - 1):
        total = field.zeros(rows.nrows, 1)
        for s in range(max(0, u - size + 1), min(u, size - 1) + 1):
            total = total + rows.select(columns=[s * size + u - s])
        powers.append(total)
    for u in range(2 * size - 2, size - 1, -1):
        for i in range(size):
            powers[u - size + i] = powers[u - size + i] - powers[u].scale(f[i] / f[size])
    return all(total.is_zero() for total in powers[:size])


def _verify_commutant(pair: CheckedPair, certificate: Certificate) -> None:
    """Not full: a map T of V commutes with rho(h), and its eigenvalues lie on both sides of a line Re = cut.

    The rows u_j of `complement` and h form a basis of g, and T u_j = sum over i of T[i, j] u_i modulo h. Checks:

    * complement and h are a basis of g;
    * T commutes with rho(h);
    * 0 < #{eigenvalues with Re > cut} < d, counted with multiplicity, and no eigenvalue lies on the line.

    Proof. The sum W of the generalized eigenspaces of T for Re > cut is real, proper, not 0, and invariant
    under all that commutes with T: rho(h)x + Rx lies in W for x in W.
    """
    d, field = pair.codimension, pair.field
    complement = certificate.matrix("complement", d, pair.dimension)
    matrix = certificate.matrix("matrix", d, d)
    basis = complement @ pair.quotient
    _require(basis.rank() == d, "complement", "h and the rows of complement are not a basis of g")
    if d == 0:
        raise CertificateError("cut", "g/h = 0 has no proper subspace")
    acting = basis.inverse() @ matrix.T @ basis  # coordinates in the basis e_free, acting on rows
    _require(basis @ acting == matrix.T @ basis, "complement", "the rows of complement could not be inverted")
    k = len(pair.pivots)
    if k:
        before = pair.isotropy.reshape(k * d, d) @ acting  # (p, w; v)
        after = acting @ _side_by_side(pair.isotropy, k, d)  # (w; p, v)
        _require(before == _stacked(after, k, d), "commutes", "the matrix does not commute with rho(h)")
    count = count_right_of(field, characteristic_polynomial(matrix), certificate.number("cut"))
    message = f"{count} of {d} eigenvalues have real part above the cut, expected some but not all"
    _require(0 < count < d, "cut", message)


def _side_by_side(rows: ExactMatrix, k: int, d: int) -> ExactMatrix:
    """The d x d matrices side by side, columns (p, v), from k flat rows (w, v)."""
    order = [p * d + w for w in range(d) for p in range(k)]
    return rows.reshape(k * d, d).select(rows=order).reshape(d, k * d)


def _stacked(matrix: ExactMatrix, k: int, d: int) -> ExactMatrix:
    """The d x d matrices below each other, rows (p, w), from the matrices side by side, columns (p, v)."""
    return matrix.reshape(d * k, d).select(rows=[w * k + p for p in range(k) for w in range(d)])


def _verify_dominance(pair: CheckedPair, certificate: Certificate) -> None:
    """Not full: X in h has a top space W that few elements of rho(h) can leave.

    Let A be the traceless part of rho(X), W the sum of its generalized eigenspaces for Re > c, and m the number of
    eigenvalues of ad rho(X) on rho(h) with Re <= -eps. All counts are with multiplicity. Checks:

    * eps > 0, and X lies in h;
    * no eigenvalue of A has its real part in [c - eps, c];
    * W is not 0, and dim W + m < d.

    Proof. rho(h) is the sum of q (generalized eigenspaces of ad rho(X) for Re > -eps) and a complement of
    dimension m; both, and W, are real. An element of q for the eigenvalue mu sends the generalized eigenspace
    of A for lambda to that for lambda + mu. For Re lambda > c this has Re > c - eps, hence Re > c: q maps W to
    W. So for x != 0 in W, rho(h)x + Rx lies in W + (complement)x, of dimension at most dim W + m < d.
    """
    field, d = pair.field, pair.codimension
    element = field.matrix([certificate.vector("element", pair.dimension)])
    cut, eps = certificate.number("cut"), certificate.number("eps")
    _require(field.sign(eps) > 0, "eps", "eps is not positive")
    _require(pair.in_h(element), "element-in-h", "the element is not in h")
    _require(d > 0, "top", "g/h = 0 has no eigenvalues")
    rho = pair.rho(element)[0]
    spectrum = characteristic_polynomial(rho - field.identity(d).scale(rho.trace() / d))
    top = count_right_of(field, spectrum, cut)
    _require(top > 0, "top", "no eigenvalue has its real part above the cut")
    gap = count_right_of(field, spectrum, cut - eps) - top
    _require(gap == 0, "gap", f"{gap} eigenvalues have real part between cut - eps and cut")
    adjoint = _adjoint_on_image(pair, rho)
    lowering = adjoint.nrows - count_right_of(field, characteristic_polynomial(adjoint), -eps)
    message = f"the top space has dimension {top}, {lowering} directions leave it, and dim g/h = {d} is not more"
    _require(top + lowering < d, "dominance", message)


def _adjoint_on_image(pair: CheckedPair, rho: ExactMatrix) -> ExactMatrix:
    """The matrix of B -> rho(X) B - B rho(X) on rho(h), a subspace of gl(V) (rho may have a kernel).

    The entries of a map in rho(h) at certain places are its coordinates in a basis B_i of rho(h). The function verifies
    this, for as many B_i as the rank of rho(h), and that the brackets are these combinations of the B_i.
    """
    d, isotropy = pair.codimension, pair.isotropy
    basis, places = isotropy.echelon()
    r = isotropy.rank()
    spans = basis.nrows == r and isotropy == isotropy.select(columns=places) @ basis
    _require(spans, "image", "no basis of rho(h) was found")
    # B -> v B is the map first, so rho(X) B - B rho(X) has the matrix R_B R_X - R_X R_B
    left = (basis.reshape(r * d, d) @ rho).reshape(r, d * d)
    right = _stacked(rho @ _side_by_side(basis, r, d), r, d).reshape(r, d * d)
    brackets = left - right
    adjoint = brackets.select(columns=places)
    _require(brackets == adjoint @ basis, "image", "a bracket with rho(X) is not in rho(h)")
    return adjoint
