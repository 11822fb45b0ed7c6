"""Checks every figure of a JSON report against an evaluation from its spectra, with NumPy alone.

    tui report DATA --format json --spectra --out report.json
    python3 tests/independent/report.py report.json

Features are made of the report's eigenvalues by the definition of its normalisation; then evaluate.py computes the
curves, hill climbing and AdaBoost. Every epsilon, every selection and every move must be the same, every ADR to 1e-12.
For reports with the paper's way of selecting (weights none, search strict, weak range, stop fixed).
"""

import json
import sys

import numpy as np

import evaluate

TOLERANCE = 1e-12


def features(name, values, measure):
    k = np.arange(1, values.shape[1] + 1)
    if name == "none":
        return values
    if name == "area":
        return values * measure[:, None]
    if name == "max":
        return values / values[:, -1:]
    if name == "weyl":
        return values * measure[:, None] / (4 * np.pi * k)
    return np.where(values > 0, np.log(np.where(values > 0, values, 1) * measure[:, None]), 0)


def same(what, ours, theirs):
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    if ours.shape != theirs.shape or (ours != theirs).any():
        sys.exit(f"{what}: the program says {ours}, the definition {theirs}")


def near(what, ours, theirs):
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    if ours.shape != theirs.shape or not (np.abs(ours - theirs) <= TOLERANCE).all():
        sys.exit(f"{what}: the program says {ours}, the definition {theirs}")


def main():
    with open(sys.argv[1]) as file:
        report = json.load(file)
    said = report["parameters"]
    for parameter, paper in [("weights", "none"), ("search", "strict"), ("weak", "range"), ("stop", "fixed")]:
        if said.get(parameter, paper) != paper:
            sys.exit(f"this check knows {parameter} = {paper} alone")
    spectra = {entry["name"]: entry["eigenvalues"] for entry in report["spectra"]}
    models = [model for model in report["models"] if model["state"] == "ready"]
    names = [entry["name"] for entry in report["classes"]]
    values = np.array([spectra[model["name"]][:said["kmax"]] for model in models])
    every = features(said["normalisation"], values, np.array([model["measure"] for model in models]))
    labels = np.array([names.index(model["class"]) for model in models])
    in_train = np.array([model["role"] == "train" for model in models])
    # The very array of the training models: what is asked against itself leaves itself out.
    train, known = every[in_train], labels[in_train]
    sides = {"train": evaluate.Side(train, known, train, known)}
    if not in_train.all():
        sides["query"] = evaluate.Side(every[~in_train], labels[~in_train], train, known)
    distance, selections = said["distance"], report["selections"]

    for name, side in sides.items():
        error, adr = evaluate.first_k(side, distance)
        same(f"first-k error, {name}", report["curves"]["error"][name], error)
        near(f"first-k ADR, {name}", report["curves"]["adr"][name], adr)
    for cost in ["error", "adr"]:
        ours = selections["hill_climbing"][cost]
        selected, moves = evaluate.climb(sides["train"], distance, cost)
        same(f"hill climbing for {cost}", ours["selected"], sorted(j + 1 for j in selected))
        same("its moves", [(step["index"], step["added"]) for step in ours["steps"]], [move[:2] for move in moves])
        near("its costs", [step["cost"] for step in ours["steps"]], [move[2] for move in moves])
        for name, side in sides.items():
            error, adr = side.figures(side.judge(evaluate.total(side, distance, selected)))
            same(f"error after hill climbing for {cost}, {name}", ours["error"][name], error)
            near(f"ADR after hill climbing for {cost}, {name}", ours["adr"][name], adr)
    classes = [evaluate.boost(train, known, c, said["T"]) for c in range(len(names))]
    for entry in selections["adaboost"]["classes"]:
        taken = classes[names.index(entry["class"])]
        same(f"AdaBoost's rounds for {entry['class']}", [r["index"] for r in entry["rounds"]], [r[0] for r in taken])
        for ours, theirs in zip(entry["rounds"], taken):
            same(f"ties for {entry['class']}", ours["ties"], theirs[3])
            near(f"weighted error for {entry['class']}", ours["error"], theirs[1])
    for name, side in sides.items():
        scores = [evaluate.score(side.asked, train, known, c, taken) for c, taken in enumerate(classes)]
        wrong = np.argmax(np.stack(scores), axis=0) != side.truth
        same(f"error of AdaBoost, {name}", selections["adaboost"]["error"][name], wrong.mean())
    print(f"{len(models)} models, {every.shape[1]} eigenvalues: every epsilon, selection and move is the same, every ADR "
          f"to {TOLERANCE}")


if __name__ == "__main__":
    main()
