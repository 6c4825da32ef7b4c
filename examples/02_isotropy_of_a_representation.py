"""From matrices to the isotropy subalgebra and the orbit of a point."""

import liehom as lh

# Two rotations generate so(3): the missing bracket is appended as a third basis element.
about_x = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
about_y = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
rho = lh.Representation.from_matrices([about_x, about_y])
print(rho, "appended:", rho.appended)
assert rho.algebra.dimension == 3
assert rho.appended == ((0, 1),)

# At a point of the sphere the isotropy subalgebra is a line, the orbit has dimension 2.
point = [1, 2, 2]
isotropy = rho.isotropy(point)
print("isotropy at", point, "is spanned by", isotropy.rows())
assert isotropy.dimension == 1
assert rho.orbit_dimension(point) == 2

# The origin is fixed by everything.
assert rho.isotropy([0, 0, 0]).dimension == 3

# The pair (algebra, isotropy) is the sphere as a homogeneous space.
assert lh.decide_fullness(rho.pair(point)).full

# The same group acts on symmetric matrices by conjugation; the orbit of diag(1, 2, 3) has trivial isotropy.
sym3 = lh.sym_conjugation(3)
assert sym3.isotropy([1, 0, 0, 2, 0, 3]).dimension == 0
assert sym3.isotropy([1, 0, 0, 1, 0, 2]).dimension == 1
