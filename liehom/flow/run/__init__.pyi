from liehom.flow.run.records import ConservationReport as ConservationReport, Report as Report
from liehom.flow.run.solution import DenseSolution as DenseSolution, Solution as Solution
