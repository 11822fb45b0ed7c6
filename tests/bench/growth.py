"""Tables of how time and memory grow; see growth.sh, which calls it."""

import json
import math
import os
import statistics
import sys
from pathlib import Path

runs = {}
for line in sys.stdin:
    told = json.loads(line)
    runs.setdefault(Path(told["mesh"]).stem, {}).setdefault(told["order"], []).append(told)
print(f"load {os.getloadavg()[0]:.1f}\n")
print("| shape | n | eigenvalues | CPU s | exponent | peak MB | factor MB | ordering s |")
print("|---|---|---|---|---|---|---|---|")
for shape, sizes in runs.items():
    before = None
    for n, told in sorted(sizes.items()):
        seconds = statistics.median(each["processor"] for each in told)
        ordering = statistics.median(each["parts"]["ordering"] for each in told)
        exponent = f"{math.log(seconds / before[1]) / math.log(n / before[0]):.2f}" if before else "–"
        last = told[-1]
        print(
            f"| {shape} | {n} | {last['asked']} | {seconds:.3f} | {exponent} | {last['peak'] / 1e6:.0f} "
            f"| {8 * last['entries'] / 1e6:.0f} | {ordering:.3f} |"
        )
        before = (n, seconds)
    (first, few), (last, many) = min(sizes.items()), max(sizes.items())
    if first < last:
        ratio = statistics.median(each["processor"] for each in many) / statistics.median(
            each["processor"] for each in few
        )
        print(f"| {shape} | {first} to {last} | | | {math.log(ratio) / math.log(last / first):.2f} | | | |")
