"""Times `tui spectrum` against SciPy; see against_scipy.sh."""

import json
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse.linalg as sla

sys.path.insert(0, str(Path(__file__).parents[1] / "reference"))
from spectrum import matrices, read_off  # noqa: E402


def ours(program, mesh, count):
    """Processor seconds of the whole process (start, reading, assembly, solve, certificate), and its eigenvalues."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [program, "spectrum", mesh, "--count", str(count), "--no-cache", "--format", "json"]
    out = subprocess.run(command, check=True, capture_output=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, np.array(json.loads(out)["spectra"][0]["eigenvalues"])


def scipy(stiffness, mass, count):
    """Processor seconds of eigsh alone, as a user calls it: shift-invert, defaults, eigenvalues only."""
    scale = mass.sum()
    start = time.process_time()
    values = sla.eigsh(stiffness, k=count, M=mass / scale, sigma=-0.01, return_eigenvectors=False)
    return time.process_time() - start, np.sort(values) / scale


def main():
    program, mesh, count, rounds = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    stiffness, mass = matrices(*read_off(mesh))
    pairs = []
    for _ in range(rounds):
        (mine, a), (theirs, b) = ours(program, mesh, count), scipy(stiffness, mass, count)
        pairs.append((mine, theirs))
        print(f"tui {mine:.3f} s   eigsh {theirs:.3f} s   ratio {theirs / mine:.1f}", flush=True)
    difference = np.max(np.abs(a[1:] - b[1:]) / b[1:])
    ratio = statistics.median(theirs / mine for mine, theirs in pairs)
    print(f"n = {stiffness.shape[0]}, {count} eigenvalues: median ratio {ratio:.1f}, ", end="")
    print(f"largest relative difference {difference:.1e}")


main()
