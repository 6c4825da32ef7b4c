"""Three jobs of a geometer who studies homogeneous spaces: `python tests/journeys/geometer.py`."""

import numpy as np

import liehom as lh


def wolf_space() -> tuple[str, int, list[str], bool]:
    """G2/SO(4) and S^3 x S^3 = SU(2)^3/SU(2): number of Einstein metrics, their scalar curvatures, a float check."""
    wolf = lh.pair("g2/so(4)")
    symmetric = f"{wolf.is_symmetric()}, {len(wolf.invariant_metrics().einstein())} metric"
    su2 = lh.su(2)
    g = lh.direct_sum(su2, su2, su2)
    diagonal = g.subalgebra(np.tile(np.eye(3, dtype=int), 3).tolist())
    space = lh.Pair(g, diagonal)
    found = space.invariant_metrics().einstein()
    normalized = [str(m.metric.scalar() / m.metric.einstein_constant()) for m in found]
    metric = found[0].metric
    ricci, matrix = np.asarray(metric.ricci(), dtype=float), np.asarray(metric.matrix(), dtype=float)
    constant = float(metric.einstein_constant())
    return symmetric, len({m.kind for m in found}), sorted(set(normalized)), bool(np.allclose(ricci, constant * matrix))


def nilmanifold() -> tuple[str, list[str], tuple[int, ...]]:
    """A solvable algebra from its own brackets: its name; Ricci curvature and cohomology of the Heisenberg group."""
    mine = lh.LieAlgebra({(0, 3): {0: 1, 1: 1}, (1, 3): {1: 1}, (2, 3): {2: -2}})
    group = lh.Pair(lh.heisenberg(1), [])
    ricci = [str(x) for x in np.diag(group.invariant_metrics()(np.eye(3, dtype=int)).ricci())]
    return mine.identify().name, ricci, group.invariant_cohomology()


def special_lagrangians() -> tuple[bool, str, str, str]:
    """SU(3)/SO(3): whether it is symmetric, its Einstein constant, holonomy and fullness."""
    space = lh.pair("su(3)/so(3)")
    metric = space.invariant_metrics()([1])
    return (
        space.is_symmetric(),
        str(metric.einstein_constant()),
        lh.structure_name(metric.holonomy()),
        str(lh.decide_fullness(space)),
    )


JOBS = (wolf_space, nilmanifold, special_lagrangians)

if __name__ == "__main__":
    for job in JOBS:
        print(f"{job.__name__}: {job()}")
