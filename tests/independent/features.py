"""Writes features.csv: the seeded sample on which the Rust code is compared with evaluate.py.

    python3 tests/independent/features.py > tests/independent/features.csv

Spectra-like rows (ascending trend bent by class, pose and noise) with everything that makes ties and corner cases: a
first feature that is 0 everywhere, coarsely rounded features, repeated features, features that are negative, two equal
models, classes of unequal size, one with a single training model and one with queries only.
"""

import numpy as np

CLASSES = {"ant": (9, 3), "bear": (8, 3), "chair": (8, 2), "dish": (7, 2), "eagle": (6, 2), "fish": (6, 2),
           "glass": (5, 2), "horse": (3, 1), "iron": (1, 1), "jar": (0, 2)}
COLUMNS = 40


def main():
    rng = np.random.default_rng(20070612)
    k = np.arange(COLUMNS)
    print(",".join(["model", "class", "role"] + [f"f{i + 1}" for i in k]))
    number = 0
    for name, (train, query) in CLASSES.items():
        bend = rng.uniform(-0.25, 0.25)
        wave = rng.normal(0, 1.1, (4, 1))
        speed = rng.uniform(0.05, 0.9, (4, 1))
        first = None
        for model in range(train + query):
            pose = rng.normal(0, 0.12)
            row = k + (wave * np.sin(speed * k + pose * 4)).sum(0) + (bend + pose) * k + rng.normal(0, 0.8, COLUMNS)
            row[0] = 0
            row[5] = np.round(row[5] / 2) * 2     # coarse: many equal distances
            row[11] = np.round(row[11] / 4) * 4
            row[17] = row[8]                      # a repeated feature
            row[23] = np.sign(row[23] - 24)       # two or three values
            row[30] = row[30] - 30                # both signs, for chi2
            row = np.round(row, 3)
            first = row if first is None else first
            if name == "bear" and model == 4:
                row = first                       # the same shape twice
            role = "train" if model < train else "query"
            number += 1
            print(",".join([f"m{number}", name, role] + [f"{value:g}" for value in row]))


if __name__ == "__main__":
    main()
