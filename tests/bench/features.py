"""Writes the features of a JSON report as the table that against_sklearn.sh and learning.rs read.

    tui report DATA --format json --spectra --out report.json
    python3 tests/bench/features.py report.json > features.csv
"""

import csv
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "independent"))
import report  # noqa: E402


def main():
    with open(sys.argv[1]) as file:
        found = json.load(file)
    models = {model["name"]: model for model in found["models"]}
    spectra = [spectrum for spectrum in found["spectra"] if spectrum["name"] in models]
    kmax = int(found["parameters"]["kmax"])
    values = np.array([spectrum["eigenvalues"][:kmax] for spectrum in spectra])
    chosen = [models[spectrum["name"]] for spectrum in spectra]
    measure = np.array([float(model["measure"]) for model in chosen])
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["model", "class", "role"] + [f"f{k + 1}" for k in range(kmax)])
    for model, row in zip(chosen, report.features(found["parameters"]["normalisation"], values, measure)):
        table.writerow([model["name"], model["class"], model["role"]] + [repr(float(value)) for value in row])


if __name__ == "__main__":
    main()
