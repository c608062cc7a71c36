"""The domain manager by itself, against all pairs: who needs whom for destinations and sources of several arrays,
in one to three dimensions, with every kind of side and partitioner; no ghost that none can need; ghosts' values and
images; bytes sent against bytes foretold (tests/mpi/domain.c), on 1 to 7 ranks."""
import os
import subprocess
import sys

from launch import ENVIRONMENT, MPIRUN, need

need()
program = os.path.join(os.environ["top_builddir"], "tests", "mpi", "domain")
missed = 0
for seed, ranks in enumerate((1, 2, 3, 5, 7)):
    done = subprocess.run([*MPIRUN, "-n", str(ranks), program, str(1000 * seed + 7)], capture_output=True, text=True,
                          env=ENVIRONMENT, timeout=120)
    if done.returncode or "ok" not in done.stdout:
        missed += 1
        print(f"MISS {ranks} ranks, seed {1000 * seed + 7}: {done.stdout[-500:]} {done.stderr[-2000:]}")
sys.exit(1 if missed else 0)
