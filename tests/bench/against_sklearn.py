"""Times scikit-learn on what the learning stages do; see against_sklearn.sh.

What takes scikit-learn too long to be run whole is run in part, and multiplied by how many such parts there are: hill
climbing evaluates as many subsets as the greedy definition does for the number of moves given below.
"""

import csv
import json
import sys
import time
import warnings

import numpy as np
from sklearn.ensemble import AdaBoostClassifier
from sklearn.model_selection import LeaveOneOut, cross_val_score
from sklearn.neighbors import KNeighborsClassifier, NearestNeighbors
from sklearn.tree import DecisionTreeClassifier

MOVES = 6                       # a typical climb on these features: forward, and one round that finds nothing


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))[1:]
    train = [row for row in rows if row[2] == "train"]
    return np.array([[float(value) for value in row[3:]] for row in train]), np.array([row[1] for row in train])


def least(run, times=3):
    """Processor seconds of the fastest of a few runs."""
    best = float("inf")
    for _ in range(times):
        start = time.process_time()
        run()
        best = min(best, time.process_time() - start)
    return best


def main():
    warnings.filterwarnings("ignore")
    features, labels = read(sys.argv[1])
    ours = json.loads(sys.argv[2])
    models, count = features.shape
    subset = features[:, 1:6]

    # As it is usually written.
    usual = least(lambda: cross_val_score(KNeighborsClassifier(1, algorithm="brute"), subset, labels, cv=LeaveOneOut()), 1)
    # As fast as it can be written: every model's neighbours in one call, itself among them.
    neighbours = lambda data, k: NearestNeighbors(n_neighbors=k, algorithm="brute").fit(data).kneighbors(data)
    quick = least(lambda: neighbours(subset, 2), 9)
    ranked = least(lambda: neighbours(subset, 16), 9)
    wide = least(lambda: neighbours(features[:, : count // 2], 16), 5)
    subsets = (MOVES + 1) * count
    stump = lambda rounds: AdaBoostClassifier(DecisionTreeClassifier(max_depth=1), n_estimators=rounds)
    classes = np.unique(labels)

    def boosted(rounds):
        return least(lambda: [stump(rounds).fit(features, labels == label) for label in classes], 1)

    theirs = {
        "first-k": (wide * count, f"{count} calls of kneighbors, time of one × {count}"),
        "HCBw error": (quick * subsets, f"{subsets} calls of kneighbors, time of one × {subsets}"),
        "HCBw ADR": (ranked * subsets, f"{subsets} calls of kneighbors, time of one × {subsets}"),
        "AdaBoost 20": (boosted(20), "AdaBoostClassifier of stumps, one against the rest"),
        "AdaBoost 100": (boosted(100), "AdaBoostClassifier of stumps, one against the rest"),
    }
    print(f"{models} models, {count} features, {len(classes)} classes; one thread")
    print(f"one leave-one-out evaluation by cross_val_score: {usual:.2f} s; by one call of kneighbors: {quick * 1e3:.2f} ms")
    for stage, (seconds, how) in theirs.items():
        print(f"{stage:<13} {ours[stage] * 1e3:8.2f} ms   scikit-learn {seconds:8.2f} s   "
              f"ratio {seconds / ours[stage]:7.0f}   {how}")
    total, sum_of = sum(ours.values()), sum(seconds for seconds, _ in theirs.values())
    print(f"{'together':<13} {total * 1e3:8.2f} ms   scikit-learn {sum_of:8.2f} s   ratio {sum_of / total:7.0f}")


main()
