"""Conformance suite: checks for algebras, representations, pairs, certificates, actions and steps.

The checks test axioms on random elements with other code than the code that constructs the objects. They also test that
writing and reading, and a change of basis, lose nothing. A failure raises `ConformanceError`, whose attribute `check`
names the check that failed. The caller may pass a random generator with a seed. Users run the checks on their own
objects, see docs/extending.md; the tests of the library run them on the catalogue.
"""

from liehom.testing.steps import check_order as check_order
from liehom.testing.steps import check_space as check_space
from liehom.testing.structures import check_certificate as check_certificate
from liehom.testing.structures import check_lie_algebra as check_lie_algebra
from liehom.testing.structures import check_pair as check_pair
from liehom.testing.structures import check_representation as check_representation
from liehom.testing.structures import random_unimodular as random_unimodular
