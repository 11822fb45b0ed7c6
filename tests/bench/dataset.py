"""Times `tui spectrum` on a whole data set; see dataset.sh, which calls it."""

import argparse
import json
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

ENDINGS = {".off", ".obj", ".ply", ".stl"}


def named(folder):
    """The meshes of a data set: those of its .cla files, or all."""
    meshes = {mesh.stem: mesh for mesh in sorted(folder.rglob("*")) if mesh.suffix in ENDINGS}
    names = []
    for listing in folder.glob("*.cla"):
        lines = listing.read_text().split("\n")[2:]
        names += [line.strip() for line in lines if line.strip() and len(line.split()) == 1]
    if not names:
        return list(meshes.values())
    return [meshes[key] for key in (name if name in meshes else "m" + name for name in names) if key in meshes]


def certified(spectrum):
    """True when the inertia counts cover all eigenvalues that are given: as many lie below the last shifts."""
    last = {count["part"]: count["below"] for count in spectrum["certificate"]}
    return 0 < len(spectrum["eigenvalues"]) <= sum(last.values())


def solve(program, meshes, count, threads, folder):
    cache, out = Path(folder) / f"cache-{threads}", Path(folder) / f"{threads}.json"
    command = [program, "spectrum", "--count", str(count), "--threads", str(threads), "--cache", cache, "--out", out]
    start = time.monotonic()
    child = subprocess.Popen([*command, *meshes], stderr=subprocess.PIPE, text=True)
    peak = 0
    # The most memory is asked for while it lives: what rusage tells includes this interpreter.
    while child.poll() is None:
        try:
            status = Path(f"/proc/{child.pid}/status").read_text()
            peak = max([peak] + [int(line.split()[1]) * 1024 for line in status.split("\n") if line.startswith("VmHWM")])
        except FileNotFoundError:
            pass
        time.sleep(0.02)
    wall = time.monotonic() - start
    complaints = child.stderr.read().strip()
    return wall, peak, json.loads(out.read_text())["spectra"], child.returncode, complaints


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--threads", default="1 2 4")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--models", type=int)
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    meshes = named(options.folder)
    if options.models:
        step = max(len(meshes) // options.models, 1)
        meshes = meshes[::step][: options.models]
    print(f"{len(meshes)} models, {options.count} eigenvalues, load {os.getloadavg()[0]:.1f}\n")
    print("| threads | wall s | CPU s | models a second | efficiency by wall | by CPU | processors had | peak MB | certified |")
    print("|---|---|---|---|---|---|---|---|---|")
    alone = None
    with tempfile.TemporaryDirectory() as folder:
        for threads in map(int, options.threads.split()):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            wall, peak, spectra, code, complaints = solve(options.program, meshes, options.count, threads, folder)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            alone = alone or (wall * threads, spent)
            proved = sum(map(certified, spectra))
            print(
                f"| {threads} | {wall:.1f} | {spent:.1f} | {len(meshes) / wall:.2f} | {alone[0] / wall / threads:.2f} "
                f"| {alone[1] / spent:.2f} | {spent / wall:.2f} | {peak / 1e6:.0f} | {proved} of {len(meshes)} |",
                flush=True,
            )
            if code != 0:
                print(f"\nexit code {code}: {complaints}\n")


main()
