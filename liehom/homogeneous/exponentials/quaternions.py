"""Unit quaternions (w, x, y, z), scalar part first, and the rotation matrices that they denote.

q v q^-1 = R(q) v,   R(q) = R(-q),   R(p q) = R(p) R(q)
"""

from __future__ import annotations

from typing import Any

from liehom.series.arrays import namespace
from liehom.typing import Values


def quaternion_to_matrix(q: Values) -> Values:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), which are divided by their norms.

    Examples
    --------
    >>> import numpy as np
    >>> quaternion_to_matrix(np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])).round(12).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    xp = namespace(q)
    w, x, y, z = (q[..., i] for i in range(4))
    s = 2 / (w * w + x * x + y * y + z * z)
    rows = [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]
    made: Values = xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)
    return made


def matrix_to_quaternion(matrix: Values) -> Values:
    """Unit quaternions (..., 4) of rotation matrices (..., 3, 3), of the sign for which the largest entry is positive.

    Notes
    -----
    4 q q^T is linear in the matrix; the row of its largest diagonal entry is divided by its norm, so that no digits
    are lost at any angle.

    Examples
    --------
    >>> import numpy as np
    >>> matrix_to_quaternion(np.diag([1.0, -1.0, -1.0])).tolist()
    [0.0, 1.0, 0.0, 0.0]
    """
    xp = namespace(matrix)
    r: Any = matrix
    (a, b, c), (d, e, f), (g, h, i) = ([r[..., k, j] for j in range(3)] for k in range(3))
    rows = [
        [1 + a + e + i, h - f, c - g, d - b],
        [h - f, 1 + a - e - i, b + d, c + g],
        [c - g, b + d, 1 - a + e - i, f + h],
        [d - b, c + g, f + h, 1 - a - e + i],
    ]
    outer = xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)
    largest = xp.argmax(xp.stack([rows[k][k] for k in range(4)], axis=-1), axis=-1)
    row = xp.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    made: Values = row / xp.sqrt(xp.sum(row * row, axis=-1, keepdims=True))
    return made


def quaternion_product(p: Values, q: Values) -> Values:
    """Products p q of quaternions (..., 4).

    Examples
    --------
    >>> import numpy as np
    >>> i, j = np.eye(4)[1], np.eye(4)[2]
    >>> quaternion_product(i, j).tolist()
    [0.0, 0.0, 0.0, 1.0]
    """
    xp = namespace(p, q)
    a, b, c, d = (p[..., k] for k in range(4))
    w, x, y, z = (q[..., k] for k in range(4))
    parts = [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
    made: Values = xp.stack(parts, axis=-1)
    return made
