"""Runs `anatomesh mesh` and `anatomesh check` on one image and gathers what they measured."""
import json
import os
import pathlib
import subprocess
import tempfile
import time


def run(arguments, log):
    """(exit status, seconds, peak memory in MB) of a command; its output goes to the file `log`."""
    begin = time.monotonic()
    with open(log, "ab") as stream:
        process = subprocess.Popen([str(a) for a in arguments], stdout=stream, stderr=stream)
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, time.monotonic() - begin, usage.ru_maxrss / 1024


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
