"""Converts many robots on all cores or on a cluster, independently, and only those whose input has changed.

tasks      which robots, and where each goes
work       one robot, in whatever process
executors  where the processes are
state      what was done before
runs       all of it: outcomes as they come
summary    what came of it, for programs
index      what came of it, as a page; imported when it is written
"""

from .runs import Outcome, Status, Task, common_folder, plan, run_batch
from .summary import batch_document, check_counts, suites
from .work import ClusterUnreachable, local_executor, on_cluster

__all__ = [
    "ClusterUnreachable",
    "Outcome",
    "Status",
    "Task",
    "batch_document",
    "check_counts",
    "common_folder",
    "local_executor",
    "on_cluster",
    "plan",
    "run_batch",
    "suites",
]
