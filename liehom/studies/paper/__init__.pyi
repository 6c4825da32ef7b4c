from liehom.studies.paper.efficiency import figure6 as figure6, figure7 as figure7
from liehom.studies.paper.energy_errors import figure3 as figure3, figure4 as figure4, figure5 as figure5
from liehom.studies.paper.figures import NAMES as NAMES, reproduce as reproduce
from liehom.studies.paper.reproduction import (
    FORMATS as FORMATS,
    Check as Check,
    Reproduction as Reproduction,
    stored as stored,
)
from liehom.studies.paper.table import Table as Table
from liehom.studies.paper.trajectories import figure1 as figure1, figure2 as figure2, separatrix as separatrix
