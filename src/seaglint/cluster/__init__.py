"""Work units distributed over workers: this process, local processes, a Dask cluster.

Work is a ``Job`` that each worker starts once and then calls for one unit after the other. Workers write their
results to files and return a small record for each unit.
"""

from seaglint.cluster.job import Done, Failed, Job, Workers
from seaglint.cluster.local import LocalProcesses, ThisProcess

__all__ = ["Done", "Failed", "Job", "LocalProcesses", "ThisProcess", "Workers"]
