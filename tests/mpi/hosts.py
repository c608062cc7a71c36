"""Ranks on several hosts: network namespaces, each with an address and a host name of its own, joined by a bridge. What
ranks say to each other crosses the wire, as it would between machines, and a strict run has the bits of a run on one
rank; what one host's rank meets ends the run on all. Skipped where namespaces cannot be made (not as root)."""
import atexit
import os
import shutil
import signal
import subprocess
import sys
import time

from launch import BOUND, SPH, Job, Scenes, Snapshot, changed, example, gone, need, wrapper

need()
scenes = Scenes()
expect = scenes.expect
SCRATCH = scenes.scratch.name
NAME = f"sph{os.getpid()}"
IP = shutil.which("ip") or shutil.which("ip", path="/usr/sbin:/sbin")
HOSTS = [f"{NAME}h{k}" for k in range(3)]


def address(k):
    return f"10.213.77.{k + 1}"


# -- The hosts ---------------------------------------------------------------------------------------------------


def ip(*words):
    done = subprocess.run([IP, *words], capture_output=True, text=True)
    if done.returncode:
        raise OSError(f"ip {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def clean():
    """A namespace takes its end of a wire with it, and the hub the bridge."""
    for name in (*HOSTS, NAME):
        subprocess.run([IP, "netns", "del", name], capture_output=True)


def build():
    ip("netns", "add", NAME)
    ip("-n", NAME, "link", "add", "hub", "type", "bridge")
    ip("-n", NAME, "link", "set", "hub", "up")
    for k, host in enumerate(HOSTS):
        ip("netns", "add", host)
        ip("-n", host, "link", "add", "eth0", "type", "veth", "peer", "name", f"port{k}", "netns", NAME)
        ip("-n", NAME, "link", "set", f"port{k}", "master", "hub", "up")
        ip("-n", host, "address", "add", f"{address(k)}/24", "dev", "eth0")
        ip("-n", host, "link", "set", "lo", "up")
        ip("-n", host, "link", "set", "eth0", "up")


def inside(k):
    """In front of a command: on this host."""
    return [IP, "netns", "exec", HOSTS[k], "unshare", "-u", "sh", "-c", f'hostname host{k} && exec "$@"', "sh"]


def skip(why):
    print(f"no network namespaces: {why}")
    sys.exit(77)


if not IP or not shutil.which("unshare"):
    skip("no ip, or no unshare")
if os.geteuid() != 0:
    skip("not root")
atexit.register(clean)
for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
    signal.signal(number, lambda *_: sys.exit(1))
try:
    build()
    subprocess.run([*inside(2), "true"], check=True, capture_output=True)
except (OSError, subprocess.CalledProcessError) as error:
    # Root in a container may not, or not enter one; where one may, a command that fails is a fault of this test.
    tries = [subprocess.run([IP, *words, f"{HOSTS[0]}-try", *more], capture_output=True, text=True) for words, more in (
        (("netns", "add"), ()), (("netns", "exec"), ("true",)), (("netns", "del"), ()))]
    if any(one.returncode for one in tries):
        skip("; ".join(one.stderr.strip() for one in tries if one.returncode))
    raise error

# The launcher's way to another host.
AGENT = os.path.join(SCRATCH, "agent.sh")
with open(AGENT, "w") as file:
    file.write("#!/bin/sh\nwhere=$1\nshift\ncase $where in\n")
    for k in range(len(HOSTS)):
        here = " ".join(f"'{word}'" for word in inside(k)[:-2])
        file.write(f"{address(k)}) exec {here} 'hostname host{k} && '\"$*\" ;;\n")
    file.write("esac\necho \"$where is no host\" >&2\nexit 1\n")
os.chmod(AGENT, 0o700)


def sent():
    """Bytes that each host has sent."""
    command = ("cat", "/sys/class/net/eth0/statistics/tx_bytes")
    return [int(subprocess.check_output([IP, "netns", "exec", host, *command])) for host in HOSTS]


def job(hosts, *words, each=1):
    """One on each of the first hosts, or more; the launcher stands on the first."""
    where = ",".join(f"{address(k)}:{each}" for k in range(hosts))
    options = ["--mca", "plm_rsh_agent", AGENT, "--mca", "btl", "self,vader,tcp", "--mca", "btl_tcp_if_include", "eth0",
               "--mca", "oob_tcp_if_include", "eth0", "-H", where]
    return Job(hosts * each, *words, options=options, before=inside(0))


# -- The same bits -----------------------------------------------------------------------------------------------

noh = example("noh-1d.json")
square = changed(noh, dimensions=2, domain={"min": [0, 0], "max": [1, 1], "sides": {"x": ["mirror", "open"],
                                                                                    "y": "periodic"}})
square["particles"]["fluid"]["fill"] = {"lattice": "square", "spacing": 0.025}
square["particles"]["fluid"]["fields"]["v"] = [-1, 0]
square["time"]["end"] = 0.1
for scene in (noh, square):
    scene["output"]["picture"] = False
square.pop("compare"), square.pop("probes")


def same(a, b):
    return a.time == b.time and a.column.keys() == b.column.keys() and all(
        a[name].tobytes() == b[name].tobytes() for name in a.column)


for title, scene in (("line", noh), ("square", square)):
    alone = scenes.good(scene, "--strict")
    for hosts, each in ((2, 1), (3, 1), (2, 2)):
        what = f"{title}, {hosts} hosts, {each} ranks on each"
        out = os.path.join(SCRATCH, f"{title}{hosts}{each}")
        before = sent()
        run = job(hosts, SPH, scenes.write(scene), "--out", out, "--threads", "1", "--quiet", "--strict", each=each).end(60)
        crossed = [now - then for now, then in zip(sent(), before)]
        print(f"{what}: exit code {run.returncode}, {run.seconds:.1f} s, bytes over the wire: {crossed}")
        expect(what, run.returncode == 0, run.stderr)
        if run.returncode == 0:
            last = Snapshot(os.path.join(out, os.path.basename(alone.snapshots()[-1])))
            expect(f"{what}: the same bits", same(last, alone.last()))
            expect(f"{what}: over the wire", min(crossed[:hosts]) > 100000, crossed)

# -- Failures ----------------------------------------------------------------------------------------------------

own = wrapper(SCRATCH, "own.sh", f"cd {SCRATCH}; [ $rank != 1 ] || cd elsewhere")
os.mkdir(os.path.join(SCRATCH, "elsewhere"))
scenes.write(noh)
run = job(2, own, SPH, "./scene.json", "--out", os.path.join(SCRATCH, "none"), "--quiet")
run.end(BOUND)
expect("a host without the scene", run.returncode == 2 and len(run.said) == 1 and "rank 1: " in run.said[0], run.stderr)

out = os.path.join(SCRATCH, "killed")
endless = changed(square, time={"end": 1000, "dt_max": 1e-5})
run = job(2, SPH, scenes.write(endless), "--out", out, "--threads", "1", "--quiet")
ranks = {}
while len(ranks) < 2 or not os.path.exists(os.path.join(out, "snapshot_0000.vtkhdf")):
    ranks = run.ranks()
    if run.process.poll() is not None or time.monotonic() > run.begin + BOUND:
        break
    time.sleep(0.05)
expect("a rank on another host is found", 1 in ranks, ranks)
if 1 in ranks:
    os.kill(ranks[1], signal.SIGKILL)
    run.begin = time.monotonic()
    run.end(BOUND)
    print(f"a rank killed on another host: exit code {run.returncode}, {run.seconds:.1f} s")
    expect("a rank killed on another host: all end", run.returncode not in (0, None) and run.seconds < BOUND, run.stderr)
    left = gone(ranks, run.begin + BOUND)
    expect("a rank killed on another host: none is left", not left, left)
else:
    run.end(1)

scenes.end()
