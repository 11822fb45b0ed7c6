"""Independent evaluation of first-k, HCBw, AdaBoost and retrieval (Tables 1 to 5), with NumPy and nothing else.

    python3 tests/independent/evaluate.py FEATURES.csv [DISTANCE ...] > expected.json

FEATURES.csv: model,class,role,f1,f2,... with role train or query. Classes count in the order of their first appearance.
DISTANCE: l2, l1, chi2, wesd1.5, wesd2 (all by default). Indices of features and values of k count from 1, models and classes from 0.

Written from the definitions, whole matrices at a time, and without a look at how the program does it: plain sorts for
every k and every candidate. Models with nothing relevant to find are left out of mean ADR; the empty selection has
epsilon = 1 and mean ADR = 0.
"""

import csv
import json
import math
import sys

import numpy as np

LEAST_ERROR = 1e-10     # bounds the error of a weak classifier from below, for its weight
TIE = 1e-12             # weighted errors this close are equal


def term(distance, a, b):
    """The terms of one feature between all a (rows) and all b (columns)."""
    difference = a[:, None] - b[None, :]
    if distance == "l2":
        return difference ** 2
    if distance == "l1":
        return np.abs(difference)
    if distance.startswith("wesd"):
        product = np.abs(a[:, None] * b[None, :])
        ratio = np.divide(np.abs(difference), product, out=np.zeros_like(difference), where=product != 0)
        return ratio * (ratio if distance == "wesd2" else np.sqrt(ratio))
    total = np.abs(a)[:, None] + np.abs(b)[None, :]
    return np.divide(difference ** 2, total, out=np.zeros_like(difference), where=total != 0)


class Side:
    """Models asked against the training models: themselves (each left out of its own ranking) or the queries."""

    def __init__(self, asked, asked_labels, train, labels):
        self.asked, self.train, self.labels, self.truth = asked, train, labels, asked_labels
        self.itself = asked is train
        self.relevant = (asked_labels[:, None] == labels[None, :]).sum(1) - (1 if self.itself else 0)
        self.deepest = max(int(self.relevant.max(initial=0)), 1)
        # ADR = 1/Q sum r_i/i, in integers over a common multiple of all Q * i.
        sizes = sorted({int(q) for q in self.relevant if q > 0})
        self.multiple = math.lcm(*[q * i for q in sizes for i in range(1, q + 1)])
        self.parts = np.array([[self.multiple // (int(q) * i) if i <= q else 0 for i in range(1, self.deepest + 1)]
                               for q in self.relevant], dtype=object)
        if self.multiple < 2 ** 40:
            self.parts = self.parts.astype(np.int64)
        self.counted = int((self.relevant > 0).sum())

    def terms(self, distance, feature):
        return term(distance, self.asked[:, feature], self.train[:, feature])

    def judge(self, sums):
        """Number of wrong decisions, and the sum of ADR in units of 1/multiple."""
        sums = sums.copy()
        if self.itself:
            np.fill_diagonal(sums, np.inf)
        order = np.argsort(sums, axis=1, kind="stable")[:, :self.deepest]
        hit = self.labels[order] == self.truth[:, None]
        retrieved = np.cumsum(hit, axis=1)
        return int((~hit[:, 0]).sum()), int((retrieved * self.parts).sum())

    def wrong(self, sums):
        """Number of wrong decisions alone."""
        sums = sums.copy()
        if self.itself:
            np.fill_diagonal(sums, np.inf)
        return int((self.labels[sums.argmin(axis=1)] != self.truth).sum())

    def figures(self, judged):
        wrong, recall = judged
        return wrong / len(self.truth), recall / (self.multiple * self.counted) if self.counted else 0.0


def first_k(side, distance):
    sums = np.zeros((len(side.asked), len(side.train)))
    curves = []
    for feature in range(side.train.shape[1]):
        sums = sums + side.terms(distance, feature)
        curves.append(side.figures(side.judge(sums)))
    return [error for error, _ in curves], [adr for _, adr in curves]


def total(side, distance, selection):
    return sum((side.terms(distance, feature) for feature in selection), np.zeros((len(side.asked), len(side.train))))


def climb(side, distance, cost):
    """Selection (from 0) and moves (feature, added, cost), every cost being an integer until it is shown."""
    count = side.train.shape[1]
    terms = np.stack([side.terms(distance, feature) for feature in range(count)])
    if cost == "error":
        loss, scale = side.wrong, len(side.truth)
    else:
        scale = side.multiple * side.counted
        loss = lambda sums: scale - side.judge(sums)[1]
    selected, current, moves = [], scale, []
    moved = True
    while moved:
        moved = False
        while True:
            base = total(side, distance, selected)
            losses = {j: loss(base + terms[j]) for j in range(count) if j not in selected}
            best = min(losses, key=lambda j: (losses[j], j), default=None)
            if best is None or losses[best] >= current:
                break
            selected, current, moved = selected + [best], losses[best], True
            moves.append((best + 1, True, current / scale))
        while len(selected) > 1:
            losses = {j: loss(total(side, distance, [i for i in selected if i != j])) for j in selected}
            best = min(losses, key=lambda j: (losses[j], j))
            if losses[best] >= current:
                break
            selected, current, moved = [i for i in selected if i != best], losses[best], True
            moves.append((best + 1, False, current / scale))
    return selected, moves


def boost(train, labels, positive, rounds):
    """The rounds for one class: (index, error, alpha, ties)."""
    members = train[labels == positive]
    if len(members) == 0:
        return []
    y = np.where(labels == positive, 1, -1)
    threshold = np.abs(members[:, None, :] - members[None, :, :]).max((0, 1))
    farthest = np.abs(train[:, None, :] - members[None, :, :]).max(1)
    h = np.where(farthest <= threshold, 1, -1)
    w = np.where(y > 0, 0.5 / max((y > 0).sum(), 1), 0.5 / max((y < 0).sum(), 1))
    taken = []
    for _ in range(rounds):
        errors = (w[:, None] * (h != y[:, None])).sum(0)
        if errors.min() >= 0.5 - TIE:
            break
        ties = np.flatnonzero(errors <= errors.min() + TIE)
        k = ties[0]
        bounded = max(errors[k], LEAST_ERROR)
        alpha = 0.5 * np.log((1 - bounded) / bounded)
        w = w * np.exp(-alpha * h[:, k] * y)
        w = w / w.sum()
        taken.append((int(k) + 1, float(errors[k]), float(alpha), [int(i) + 1 for i in ties]))
    return taken


def score(rows, train, labels, positive, taken):
    members = train[labels == positive]
    s = np.zeros(len(rows))
    if len(members) == 0:
        return s - np.inf
    for index, _, alpha, _ in taken:
        values = members[:, index - 1]
        threshold = np.abs(values[:, None] - values[None, :]).max()
        s += alpha * np.where(np.abs(rows[:, index - 1][:, None] - values[None, :]).max(1) <= threshold, 1, -1)
    return s


def mean_adr(side, retrieve):
    """Mean ADR of the lists of models that retrieve(asked) finds, which may be shorter than what is relevant."""
    adrs = []
    for asked in np.flatnonzero(side.relevant > 0):
        found = np.array(retrieve(asked), dtype=int)[:side.relevant[asked]]
        hits = np.zeros(side.relevant[asked])
        hits[:len(found)] = side.labels[found] == side.truth[asked]
        adrs.append((np.cumsum(hits) / np.arange(1, len(hits) + 1)).mean())
    return float(np.mean(adrs)) if adrs else 0.0


def ranking(side, distance, selection):
    sums = total(side, distance, selection)
    order = [list(row) for row in np.argsort(sums, axis=1, kind="stable")]
    return [[m for m in row if m != asked] if side.itself else row for asked, row in enumerate(order)]


def retrieval(side, distance, first_k, hill, scores):
    """Mean ADR of every classification before every retrieval: {"gate pick kept": mean ADR}.

    first_k and hill hold the selections (from 0) for epsilon and for mean ADR; scores has S for each class (-inf where
    it has no training model) and each model asked.
    """
    by_first, by_hill = ([ranking(side, distance, selection) for selection in pair] for pair in (first_k, hill))
    known = [c for c in range(len(scores)) if (side.labels == c).any()]
    # The class of the nearest model first; of equal S the lower class.
    nearest = lambda order: [list(dict.fromkeys(int(side.labels[m]) for m in row)) for row in order]
    gates = {
        "SC": [sorted(known, key=lambda c: (-scores[c][asked], c)) for asked in range(len(side.truth))],
        "first-k": nearest(by_first[0]),
        "HCBw": nearest(by_hill[0]),
    }
    found = {}
    for pick, (_, order) in [("first-k", by_first), ("HCBw", by_hill)]:
        found[f"– {pick} 0"] = mean_adr(side, lambda asked: order[asked])
        for gate, classes in gates.items():
            for kept in [5, 10, 15]:
                found[f"{gate} {pick} {kept}"] = mean_adr(
                    side, lambda asked: [m for m in order[asked] if side.labels[m] in classes[asked][:kept]])
    return found


def main():
    with open(sys.argv[1], newline="") as file:
        records = list(csv.reader(file))[1:]
    names = list(dict.fromkeys(record[1] for record in records))
    features = np.array([[float(value) for value in record[3:]] for record in records])
    every = np.array([names.index(record[1]) for record in records])
    is_train = np.array([record[2] == "train" for record in records])
    train, labels, query, query_labels = features[is_train], every[is_train], features[~is_train], every[~is_train]
    sides = [Side(train, labels, train, labels)]
    if len(query):
        sides.append(Side(query, query_labels, train, labels))

    rounds = 20
    classes = [boost(train, labels, c, rounds) for c in range(len(names))]
    scores = [np.stack([score(side.asked, train, labels, c, taken) for c, taken in enumerate(classes)])
              for side in sides]

    report = {}
    for distance in sys.argv[2:] or ["l2", "l1", "chi2", "wesd1.5", "wesd2"]:
        curves = [first_k(side, distance) for side in sides]
        best_error = int(np.argmin(curves[0][0])) + 1
        best_adr = int(np.argmax(curves[0][1])) + 1
        entry = {"error": [c[0] for c in curves], "adr": [c[1] for c in curves],
                 "best_error": best_error, "best_adr": best_adr}
        hill = []
        for cost in ["error", "adr"]:
            selected, moves = climb(sides[0], distance, cost)
            hill.append(selected)
            figures = [side.figures(side.judge(total(side, distance, selected))) for side in sides]
            entry["climb_" + cost] = {"selected": sorted(j + 1 for j in selected), "steps": moves,
                                      "error": [f[0] for f in figures], "adr": [f[1] for f in figures]}
        entry["retrieval"] = [retrieval(side, distance, (range(best_error), range(best_adr)), hill, s)
                              for side, s in zip(sides, scores)]
        report[distance] = entry

    decided = [np.argmax(s, axis=0) for s in scores]
    known = [taken for c, taken in enumerate(classes) if (labels == c).any()]
    report["boost"] = {
        "rounds": classes,
        "decided": [int(c) for d in decided for c in d],
        "error": [float((d != truth).mean()) for d, truth in zip(decided, [labels, query_labels])],
        "mean_chosen": float(np.mean([len({r[0] for r in taken}) for taken in known])),
        "mean_ties": float(np.mean([len({i for r in taken for i in r[3]}) for taken in known])),
    }
    json.dump(report, sys.stdout, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
