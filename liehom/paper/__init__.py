"""Reproduction of section 4 of the paper: each figure as tables, with claims that are checked, and plots.

`figures` finds a figure by its name; `trajectories` (Figures 1 and 2), `energy_errors` (3 to 5), `efficiency` (6 and 7)
and `separatrices` compute them. They use `printed_data` (the numbers of the paper), `kernels` (the 13 updates on
coordinates), `samples` (random bodies), `orders`, `costs`, `table`, `plots` and `reproduction` (claims, captions,
files). The command ``liehom reproduce`` calls them; docs/reproduction.md discusses the results.
"""

from liehom.paper.efficiency import figure6 as figure6
from liehom.paper.efficiency import figure7 as figure7
from liehom.paper.energy_errors import figure3 as figure3
from liehom.paper.energy_errors import figure4 as figure4
from liehom.paper.energy_errors import figure5 as figure5
from liehom.paper.figures import NAMES as NAMES
from liehom.paper.figures import reproduce as reproduce
from liehom.paper.reproduction import FORMATS as FORMATS
from liehom.paper.reproduction import Check as Check
from liehom.paper.reproduction import Reproduction as Reproduction
from liehom.paper.reproduction import stored as stored
from liehom.paper.separatrices import separatrix as separatrix
from liehom.paper.table import Table as Table
from liehom.paper.trajectories import figure1 as figure1
from liehom.paper.trajectories import figure2 as figure2
