"""Runge-Kutta coefficients as exact data, with proofs of their order by rooted trees.

`Tableau` proves the order that is claimed for it. `tableau` finds the classical methods by name, and `collocation`
computes a method from its nodes. `liehom.integrators.methods` uses them; see docs/theory/correctors.md.
"""

from liehom.integrators.tableaux.collocation import collocation as collocation
from liehom.integrators.tableaux.collocation import gauss as gauss
from liehom.integrators.tableaux.collocation import radau as radau
from liehom.integrators.tableaux.order_conditions import Violation as Violation
from liehom.integrators.tableaux.rooted_trees import RootedTree as RootedTree
from liehom.integrators.tableaux.rooted_trees import elementary_weight as elementary_weight
from liehom.integrators.tableaux.rooted_trees import rooted_trees as rooted_trees
from liehom.integrators.tableaux.tableau import Tableau as Tableau
from liehom.integrators.tableaux.tableaux import tableau as tableau
from liehom.integrators.tableaux.tableaux import tableau_names as tableau_names
