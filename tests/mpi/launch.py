"""What the tests of runs on several ranks share: mpirun, never for longer than a bound, and one rank that is another
than the rest."""
import os
import shlex
import signal
import stat
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.environ["top_srcdir"], "tests"))
from scenes import SPH, Scenes, Snapshot, changed, example  # noqa: E402, F401

BOUND = 30  # seconds that any end may take
MPIRUN = shlex.split(os.environ.get("MPIRUN") or "")
# Many ranks on few cores, as root too; of Open MPI's memory nobody is to answer for what it keeps.
ENVIRONMENT = {
    **os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMP_WAIT_POLICY": "passive",
    "ASAN_OPTIONS": ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "detect_leaks=0",
                                          "verify_asan_link_order=0"]))}
os.environ["ASAN_OPTIONS"] = ENVIRONMENT["ASAN_OPTIONS"]  # also where others start mpirun


def need():
    """Skips the test without mpirun or MPI."""
    info = subprocess.run([SPH, "info", "--build"], capture_output=True, text=True).stdout
    if not MPIRUN or not any(line.startswith("MPI ") and "not built in" not in line for line in info.splitlines()):
        print("no mpirun, or built without MPI")
        sys.exit(77)


def wrapper(folder, name, text):
    """A script that goes before the program on every rank; it ends with exec "$@" by itself."""
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(f'#!/bin/sh\nrank=$OMPI_COMM_WORLD_RANK\n{text}\nexec "$@"\n')
    os.chmod(path, stat.S_IRWXU)
    return path


class Job:
    """An mpirun under way, with all that it starts in a session of its own."""

    def __init__(self, ranks, *words, options=(), before=(), env=None):
        self.begin = time.monotonic()
        self.process = subprocess.Popen([*before, *MPIRUN, *options, "-n", str(ranks), *words],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env={**ENVIRONMENT, **(env or {})}, start_new_session=True)

    def ranks(self):
        """Process ids of the program, by rank: of this job's descendants those that MPI has given one."""
        found = {}
        for pid in descendants(self.process.pid):
            try:
                with open(f"/proc/{pid}/environ", "rb") as file:
                    words = dict(word.split(b"=", 1) for word in file.read().split(b"\0") if b"=" in word)
                program = os.path.basename(os.readlink(f"/proc/{pid}/exe"))
            except OSError:
                continue
            rank = words.get(b"OMPI_COMM_WORLD_RANK")
            if rank is not None and program in ("sph", "lt-sph"):
                found[int(rank)] = pid
        return found

    def end(self, seconds=120):
        """Waits; a job that does not end is killed and has the code None."""
        try:
            self.stdout, self.stderr = self.process.communicate(timeout=seconds)
            self.returncode = self.process.returncode
        except subprocess.TimeoutExpired:
            everything = [self.process.pid, *descendants(self.process.pid)]
            for pid in everything:
                try:
                    os.kill(pid, signal.SIGKILL)
                except OSError:
                    pass
            self.stdout, self.stderr = self.process.communicate()
            self.returncode = None
        self.seconds = time.monotonic() - self.begin
        self.said = [line for line in self.stderr.splitlines() if line.startswith("sph")]
        return self


def descendants(pid):
    children = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                with open(f"/proc/{name}/stat") as file:
                    parent = int(file.read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            children.setdefault(parent, []).append(int(name))
    found, todo = [], [pid]
    while todo:
        more = children.get(todo.pop(), [])
        found += more
        todo += more
    return found


def running(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def gone(ranks, until):
    """Waits for their ends; those that are left."""
    while any(running(pid) for pid in ranks.values()) and time.monotonic() < until:
        time.sleep(0.01)
    return [pid for pid in ranks.values() if running(pid)]
