"""Shares a sweep of parameters among the workers of HyperQueue, and merges the tables.

pip install hyperqueue; python examples/sweep_hyperqueue.py path/to/gingerbread
On a cluster, connect to its server by `Client()` in place of the local one: the workers need the program and a common folder.
"""

import subprocess
import sys
from pathlib import Path

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig

PROGRAM = str(Path(sys.argv[1] if len(sys.argv) > 1 else "target/release/gingerbread").resolve())
SHARDS = 8
SWEEP = ["sweep", "gingerbread_pulled", "--seconds", "1", "--threads", "1", "--progress", "0"]
SWEEP += ["--vary", "model=c,v,n,s", "--vary", "young=1e3,3e3,1e4,3e4,1e5", "--vary", "poisson=0.1,0.2,0.3,0.4,0.45"]

folder = Path("sweep")
folder.mkdir(exist_ok=True)
tables = [str(folder.resolve() / f"{own}.csv") for own in range(1, SHARDS + 1)]

with LocalCluster() as cluster:
    for _ in range(2):
        cluster.start_worker(WorkerConfig(cores=1))
    client = cluster.client()
    job = Job()
    for own, table in enumerate(tables, start=1):
        job.program([PROGRAM, *SWEEP, "--shard", f"{own}/{SHARDS}", "--csv", table])
    client.wait_for_jobs([client.submit(job)])

subprocess.run([PROGRAM, "merge", *tables, "--csv", str(folder / "all.csv")], check=True)
