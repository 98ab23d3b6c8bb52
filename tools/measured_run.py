"""Runs `anatomesh mesh` and `anatomesh check` on one image and gathers what they measured."""
import json
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import threading
import time
import typing


class Run(typing.NamedTuple):
    """What became of a command."""
    status: int  # negative: the signal that ended it
    wall_s: float
    cpu_s: float
    memory_mb: float  # at its peak
    timed_out: bool


def run_limited(arguments, log, timeout_s=None, memory_gib=None):
    """Runs a command, its output appended to the file `log`; kills it after `timeout_s`, and lets it have no more
    address space than `memory_gib`."""
    def limit_memory():
        resource.setrlimit(resource.RLIMIT_AS, (int(memory_gib * 2**30),) * 2)

    begin = time.monotonic()
    with open(log, "ab") as stream:
        process = subprocess.Popen([str(a) for a in arguments], stdout=stream, stderr=stream,
                                   preexec_fn=limit_memory if memory_gib else None)
        killer = threading.Timer(timeout_s or threading.TIMEOUT_MAX, process.kill)
        killer.daemon = True
        killer.start()
        _, status, usage = os.wait4(process.pid, 0)
        killer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    wall_s = time.monotonic() - begin
    timed_out = process.returncode == -signal.SIGKILL and timeout_s is not None and wall_s >= timeout_s
    return Run(process.returncode, wall_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, timed_out)


def run(arguments, log):
    """(exit status, seconds, peak memory in MB) of a command; its output goes to the file `log`."""
    done = run_limited(arguments, log)
    return done.status, done.wall_s, done.memory_mb


def measure(program, image, options, folder):
    """Meshes an image into the folder and checks the mesh. Returns a dictionary; `check` and `report` are missing
    when meshing failed."""
    name = pathlib.Path(image).name.split(".")[0]
    mesh, report, check = (pathlib.Path(folder, name + end) for end in (".vtu", ".report.json", ".check.json"))
    log = pathlib.Path(folder, name + ".log")
    for old in (mesh, report, check, log):
        old.unlink(missing_ok=True)
    result = {"name": name, "mesh": mesh, "log": log}
    result["mesh_status"], result["seconds"], result["memory_mb"] = run(
        [program, "mesh", image, "-o", mesh, *options], log)
    if result["mesh_status"] != 0:
        return result
    result["check_status"], _, _ = run([program, "check", mesh, "--image", image, "--json", check, "--quiet"], log)
    if check.exists():
        result["check"] = json.loads(check.read_text(encoding="utf-8"))
    return result


def stage_seconds(program, image, options, stages):
    """Seconds that `mesh` spent in all stages but those named."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder, "report.json")
        subprocess.run([program, "mesh", image, "-o", pathlib.Path(folder, "mesh.vtu"), "--report", report, "--quiet",
                        *options], check=True)
        times = json.loads(report.read_text(encoding="utf-8"))["times"]
    return sum(t["seconds"] for t in times if t["stage"] not in stages)
