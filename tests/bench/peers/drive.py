"""Runs this program and its peers in turns and prints tables; see peers.sh, which calls it."""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
OURS = "this program"
# (nev, ncv) of a slice that SLEPc is tried with; the fastest counts that is accurate enough.
SLICES = [(30, 60), (40, 100), (20, 40), (40, 80)]


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, action="append", help="eigenvalues; may be given more than once")
    parser.add_argument("--choice", action="append", choices=["fem", "cot"])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds from which on a method is slow")
    parser.add_argument("--slow-rounds", type=int, default=1, help="how often a slow method is run")
    parser.add_argument("--skip", action="append", default=[], help="a method to leave out")
    parser.add_argument("--accuracy", type=float, default=1e-10, help="what a peer's settings must reach")
    parser.add_argument("--tolerance", type=float, default=1e-8, help="what SciPy, LaPy and Krylov-Schur are given")
    parser.add_argument("--raw", help="a file to which each run is added as a line of JSON")
    parser.add_argument("meshes", nargs="+")
    return parser.parse_args()


def environment(name):
    value = os.environ.get(name)
    return json.loads(value) if value else None


class Peers:
    """What peers.sh found: programs, and interpreters with their variables."""

    def __init__(self):
        self.spectrum, self.matrices = os.environ["PEERS_SPECTRUM"], os.environ["PEERS_MATRICES"]
        self.spectra = os.environ.get("PEERS_SPECTRA")
        self.lapy = "PEERS_LAPY" in os.environ
        # Name -> interpreter and the variables it needs.
        self.slepc = environment("PEERS_SLEPC") or {}


class Problem:
    """One mesh, operator and number of eigenvalues."""

    def __init__(self, peers, options, folder, mesh, choice, count):
        self.peers, self.options, self.folder = peers, options, folder
        self.mesh, self.choice, self.count = mesh, choice, count
        self.name = f"{Path(mesh).stem}"
        self.stem = str(folder / f"{self.name}-{choice}")
        export = self.stem + ".export"
        subprocess.run([peers.matrices, choice, mesh, export], check=True)
        told = subprocess.run(
            [sys.executable, HERE / "problem.py", export, self.stem], check=True, capture_output=True, text=True
        )
        os.remove(export)
        facts = json.loads(told.stdout)
        self.n, self.scale = facts["n"], facts["scale"]
        if facts["apart"] > 1e-9:
            # Slivers are mended before the solve; then the peers get the mended matrices.
            say(f"{self.name}: the matrices differ from plain ones by {facts['apart']:.0e} (a mended mesh)")
        more = self.ours(count + 30)["values"]
        self.zeros = int((more == 0.0).sum())
        # SLEPc needs an interval: it ends in the first clear gap after the last eigenvalue asked for.
        gaps = np.diff(more[count - 1 :]) / more[count:]
        first = int(np.argmax(gaps > 1e-5))
        self.end = float(more[count - 1 + first] + more[count + first]) / 2
        self.inside = count + first
        self.reference = self.refer()

    def ours(self, count):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [self.peers.spectrum, "--json", "--choice", self.choice, "--count", str(count), self.mesh]
        out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = json.loads(out)
        whole = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        values = np.array(run["eigenvalues"]) * self.scale
        return {"processor": run["processor"], "whole": whole, "before": 0, "peak": run["peak"], "values": values}

    def python(self, interpreter, method, settings, variables=None, count=None):
        with tempfile.NamedTemporaryFile(suffix=".npy", dir=self.folder) as out:
            command = [interpreter, HERE / "solve.py", method, self.stem + ".npz", str(count or self.count)]
            command += [json.dumps({"seed": 1} | settings), out.name]
            done = subprocess.run(command, capture_output=True, text=True, env=os.environ | (variables or {}))
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip()[-2000:] or f"ended with {done.returncode}")
            return json.loads(done.stdout.splitlines()[-1]) | {"values": np.load(out.name)}

    def spectra(self, settings):
        with tempfile.NamedTemporaryFile(dir=self.folder) as out:
            command = [self.peers.spectra, self.stem + ".bin", str(self.count), str(settings["basis"])]
            command += [str(settings["tol"]), out.name]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            return json.loads(done.stdout) | {"values": np.sort(np.fromfile(out.name))}

    def slice(self, installation, settings):
        interpreter, variables = self.peers.slepc[installation]
        return self.python(interpreter, "slicing", {"end": self.end} | settings, variables)

    def refer(self):
        """Eigenvalues to full precision: SciPy with tolerance 0 from another shift and in a larger basis than in the
        rounds; for large meshes SLEPc's slicing with a tight tolerance."""
        if self.n <= 20_000 or not self.peers.slepc:
            return self.python(sys.executable, "scipy", {"tol": 0, "shift": -1.0, "more": 50})["values"]
        # MUMPS pivots; PETSc's factors of indefinite matrices do not, and lose digits on large ones.
        settings = {"package": "mumps", "ordering": 7, "nev": 40, "ncv": 100, "tol": 1e-13}
        return self.slice(list(self.peers.slepc)[-1], settings)["values"]

    def accuracy(self, values):
        """The largest relative difference; infinite when the number of values is wrong."""
        if len(values) < self.count:
            return float("inf")
        found, wanted = values[self.zeros : self.count], self.reference[self.zeros : self.count]
        return float(np.max(abs(found - wanted) / wanted))

    def methods(self):
        """Name -> a function that runs it once."""
        tolerance = self.options.tolerance
        plain = {"tol": tolerance}
        yield OURS, "", lambda: self.ours(self.count)
        yield "SciPy eigsh (SuperLU)", "", lambda: self.python(sys.executable, "scipy", plain)
        if self.peers.lapy:
            yield "LaPy + CHOLMOD", "", lambda: self.python(sys.executable, "lapy", plain)
        if self.peers.spectra:
            settings = {"basis": 2 * self.count, "tol": tolerance}
            yield "Spectra (Eigen LDLT)", "", lambda: self.spectra(settings)
        for installation, (interpreter, variables) in self.peers.slepc.items():
            packages = [("MUMPS", {"package": "mumps", "ordering": 7})]
            if installation == next(iter(self.peers.slepc)):
                yield (
                    "SLEPc Krylov-Schur",
                    "",
                    lambda a=(interpreter, variables): self.python(
                        a[0], "krylov", plain | {"package": "petsc", "ordering": "amd"}, a[1]
                    ),
                )
                packages.append(("PETSc Cholesky", {"package": "petsc", "ordering": "amd"}))
            for package, factor in packages:
                name = f"SLEPc slicing + {package}" + (f" ({installation})" if len(self.peers.slepc) > 1 else "")
                if skipped(self.options, name):
                    continue
                best = self.tune(name, installation, factor)
                if best:
                    note = f"slices of nev {best['nev']}, ncv {best['ncv']}, tol {best['tol']:.0e}"
                    yield name, note, lambda i=installation, s=best: self.slice(i, s)

    def tune(self, name, installation, factor):
        """The fastest settings of SLEPc's slicing that are accurate enough; else the most accurate."""
        tried = []
        for nev, ncv in SLICES:
            if nev > max(self.count, 20):
                continue
            for tolerance in (1e-8, 1e-10):
                settings = factor | {"nev": nev, "ncv": ncv, "tol": tolerance}
                try:
                    run = self.slice(installation, settings)
                except RuntimeError as error:
                    say(f"{name} with {settings}: {str(error).splitlines()[-1]}")
                    break
                accuracy = self.accuracy(run["values"])
                self.record(name, "tuning", settings, run, accuracy)
                if len(run["values"]) != self.inside:
                    say(f"{name} with {settings}: {len(run['values'])} of {self.inside} eigenvalues")
                tried.append((accuracy > self.options.accuracy, run["processor"], accuracy, settings))
                # A tighter tolerance that did not help once will not with other slices.
                if accuracy <= self.options.accuracy or (len(tried) > 1 and accuracy > 0.5 * tried[-2][2]):
                    break
            if tried and tried[0][1] > self.options.limit:
                break
        if not tried:
            return None
        good = [entry for entry in tried if not entry[0]]
        return min(good, key=lambda entry: entry[1])[3] if good else min(tried, key=lambda entry: entry[2])[3]

    def record(self, method, kind, settings, run, accuracy):
        if not self.options.raw:
            return
        line = {key: value for key, value in run.items() if key != "values"}
        line |= {"mesh": self.name, "n": self.n, "choice": self.choice, "count": self.count, "method": method}
        line |= {"kind": kind, "settings": settings, "accuracy": accuracy, "load": os.getloadavg()[0]}
        with open(self.options.raw, "a") as out:
            print(json.dumps(line), file=out)

    def enough(self, runs):
        """True when a slow method has run often enough."""
        return len(runs) >= self.options.slow_rounds and runs[0]["processor"] > self.options.limit

    def run(self):
        """All methods in turns; prints the table and returns by method how many times longer it takes."""
        methods = [method for method in self.methods() if not skipped(self.options, method[0])]
        runs = {name: [] for name, _, _ in methods}
        for _ in range(self.options.rounds):
            for name, note, once in methods:
                if runs[name] is None or self.enough(runs[name]):
                    continue
                try:
                    run = once()
                except (RuntimeError, subprocess.CalledProcessError) as error:
                    say(f"{self.name} {name} failed: {str(error).splitlines()[-1]}")
                    runs[name] = None
                    continue
                run["accuracy"] = self.accuracy(run["values"])
                self.record(name, "round", note, run, run["accuracy"])
                runs[name].append(run)
        print(f"\n**{self.name}**, n = {self.n}, {self.choice}, {self.count} eigenvalues\n")
        print("| method | CPU s | times ours | accuracy | peak MB (before the solve) | runs |")
        print("|---|---|---|---|---|---|")
        ours = statistics.median(run["processor"] for run in runs[OURS])
        ratios = {}
        for name, note, _ in methods:
            if not runs[name]:
                continue
            middle = statistics.median(run["processor"] for run in runs[name])
            ratios[name] = middle / ours
            accuracy = max(run["accuracy"] for run in runs[name])
            peak, before = (max(run[key] for run in runs[name]) / 1e6 for key in ("peak", "before"))
            memory = f"{peak:.0f}" + (f" ({before:.0f})" if before else "")
            label = name + (f": {note}" if note else "")
            ratio = "1" if name == OURS else f"{ratios[name]:.1f}"
            print(f"| {label} | {middle:.3f} | {ratio} | {accuracy:.0e} | {memory} | {len(runs[name])} |", flush=True)
        return ratios


def summarise(ratios):
    """Over all meshes: method by operator and number of eigenvalues, the median ratio and its range."""
    columns = list(ratios)
    methods = list(dict.fromkeys(name for column in columns for each in ratios[column] for name in each))
    print("\n**Times ours**, median over the meshes (least to most)\n")
    print("| method | " + " | ".join(f"{choice}, {count}" for choice, count in columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for name in methods:
        cells = []
        for column in columns:
            found = sorted(each[name] for each in ratios[column] if name in each)
            cells.append(f"{statistics.median(found):.1f} ({found[0]:.1f} to {found[-1]:.1f})" if found else "")
        print(f"| {name} | " + " | ".join(cells) + " |")


def skipped(options, name):
    return any(word.lower() in name.lower() for word in options.skip)


def say(text):
    print(text, file=sys.stderr, flush=True)


def main():
    options, peers = parse(), Peers()
    ratios = {}
    with tempfile.TemporaryDirectory(dir=os.environ.get("PEERS_SCRATCH")) as folder:
        for count in options.count or [500]:
            for choice in options.choice or ["fem"]:
                for mesh in options.meshes:
                    problem = Problem(peers, options, Path(folder), mesh, choice, count)
                    ratios.setdefault((choice, count), []).append(problem.run())
                    for file in Path(folder).iterdir():
                        file.unlink()
    summarise(ratios)


main()
