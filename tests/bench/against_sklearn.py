"""Times scikit-learn and mlxtend on what the learning stages do; see against_sklearn.sh.

What takes them too long to be run whole is run in part, and multiplied by how many such parts there are: hill climbing
evaluates as many subsets as the greedy definition does for the number of moves given below.
"""

import csv
import json
import sys
import time
import warnings

import numpy as np
from mlxtend.feature_selection import SequentialFeatureSelector
from sklearn.ensemble import AdaBoostClassifier
from sklearn.model_selection import LeaveOneOut, cross_val_score
from sklearn.neighbors import KNeighborsClassifier, NearestNeighbors
from sklearn.tree import DecisionTreeClassifier

MOVES = 6                       # a typical climb on these features: forward, and one round that finds nothing
SOME = 6                        # features that mlxtend is given to choose from where it is timed


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


def neighbours(data, k):
    """Every model's neighbours in one call, itself among them."""
    return NearestNeighbors(n_neighbors=k, algorithm="brute").fit(data).kneighbors(data)


class Quick:
    """Leave-one-out accuracy, or mean ADR, of a subset by one call of kneighbors, as an estimator and its score."""

    def __init__(self, labels, ranked):
        self.labels, self.ranked = labels, ranked
        self.relevant = np.array([np.sum(labels == label) - 1 for label in labels])

    def score(self, data):
        count = self.relevant.max() + 1 if self.ranked else 2
        _, found = neighbours(data, count)
        own = np.arange(len(data))[:, None]
        # Without the model itself, which need not be found first where models are equal.
        order = np.argsort(found == own, axis=1, kind="stable")
        right = self.labels[np.take_along_axis(found, order, 1)[:, :-1]] == self.labels[:, None]
        if not self.ranked:
            return right[:, 0].mean()
        retrieved = np.cumsum(right, axis=1) / np.arange(1, right.shape[1] + 1)
        within = np.arange(right.shape[1]) < self.relevant[:, None]
        return np.mean((retrieved * within).sum(1)[self.relevant > 0] / self.relevant[self.relevant > 0])


def sequential(features, labels, quick, floating):
    """Processor seconds of mlxtend for one subset, and how many it evaluated, choosing among a few features.

    The scorer is as quick as it can be: what is left is mlxtend's own."""
    evaluated = [0]

    def scorer(_, data, __):
        evaluated[0] += 1
        return quick.score(data)

    selector = SequentialFeatureSelector(
        KNeighborsClassifier(1), k_features=(1, SOME - 1), forward=True, floating=floating, scoring=scorer, cv=0)
    start = time.process_time()
    selector.fit(features[:, 1 : SOME + 1], labels)
    return (time.process_time() - start) / evaluated[0], evaluated[0]


def main():
    warnings.filterwarnings("ignore")
    features, labels = read(sys.argv[1])
    ours = json.loads(sys.argv[2])
    models, count = features.shape
    subset = features[:, 1:6]
    subsets = (MOVES + 1) * count
    classes = np.unique(labels)

    # As it is usually written, and as fast as it can be written.
    usual = least(lambda: cross_val_score(KNeighborsClassifier(1, algorithm="brute"), subset, labels, cv=LeaveOneOut()), 1)
    error, adr = Quick(labels, ranked=False), Quick(labels, ranked=True)
    quick, ranked = least(lambda: error.score(subset), 9), least(lambda: adr.score(subset), 9)
    wide = least(lambda: adr.score(features[:, : count // 2]), 5)
    stump = lambda rounds: AdaBoostClassifier(DecisionTreeClassifier(max_depth=1), n_estimators=rounds)

    def boosted(rounds):
        return least(lambda: [stump(rounds).fit(features, labels == label) for label in classes], 1)

    theirs = [
        ("first-k", "scikit-learn", wide * count, f"{count} calls of kneighbors, time of one × {count}"),
        ("HCBw error", "scikit-learn", quick * subsets, f"{subsets} calls of kneighbors, time of one × {subsets}"),
        ("HCBw ADR", "scikit-learn", ranked * subsets, f"{subsets} calls of kneighbors, time of one × {subsets}"),
    ]
    for stage, judge in (("HCBw error", error), ("HCBw ADR", adr)):
        for name, floating in (("forward", False), ("floating", True)):
            each, evaluated = sequential(features, labels, judge, floating)
            how = f"{name} over {SOME} features ({evaluated} subsets), time of one subset × {subsets}"
            theirs.append((stage, "mlxtend", each * subsets, how))
        usually = f"{subsets} × leave-one-out by cross_val_score, as mlxtend does it with cv=LeaveOneOut()"
        theirs += [(stage, "mlxtend", usual * subsets, usually)] if judge is error else []
    theirs += [
        ("AdaBoost 20", "scikit-learn", boosted(20), "AdaBoostClassifier of stumps, one against the rest"),
        ("AdaBoost 100", "scikit-learn", boosted(100), "AdaBoostClassifier of stumps, one against the rest"),
    ]
    print(f"{models} models, {count} features, {len(classes)} classes; processor seconds on one thread")
    print(f"one leave-one-out evaluation by cross_val_score: {usual:.2f} s; by one call of kneighbors: {quick * 1e3:.2f} ms")
    for stage, who, seconds, how in theirs:
        print(f"{stage:<13} {ours[stage] * 1e3:8.2f} ms   {who:<12} {seconds:8.2f} s   "
              f"ratio {seconds / ours[stage]:7.0f}   {how}")
    total, sum_of = sum(ours.values()), sum(seconds for _, who, seconds, _ in theirs if who == "scikit-learn")
    print(f"{'together':<13} {total * 1e3:8.2f} ms   {'scikit-learn':<12} {sum_of:8.2f} s   ratio {sum_of / total:7.0f}")


main()
