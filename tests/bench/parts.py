"""Tables of the solver's cost by part; see parts.sh, which calls it.

Multiplications and additions (flops) and bytes of a part are counted from what the solver tells of itself: n, the
numbers in a factor f, the blocks of 8 right-hand sides that were solved, and the Lanczos processes. With m blocks in a
process, taken as equally long:

    factorisation      2 flops a multiplication; 8 f bytes written
    solves             4 f flops a right-hand side; the factor is read twice a block, 8 columns of the block with it
    orthogonalisation  4·64 n flops in single precision for each pair of a new block and an older one, whose 32 n bytes
                       are read twice, for two new blocks at a time or one; and in each step 6·64 n flops of the
                       recurrence in double precision, which count twice, and seven blocks read or written
    products           one a solve: 2·8 flops an entry of B, of which 8 are stored for a row; B's 12 bytes an entry
                       and the block read, one written

What is not counted (dense eigenproblems, orthonormal bases of blocks, assembly, ordering) is shown by time alone. The
bandwidth that a part is held against is that of arrays as large as what it goes through again and again.
"""

import argparse
import json
import statistics
import subprocess

WIDTH = 8


def run(command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def counted(told):
    """Part -> flops, bytes, and the bytes of the data that are gone through again and again."""
    n, entries, solves, processes = told["order"], told["entries"], told["solves"], max(told["processes"], 1)
    block = 8 * n * WIDTH
    blocks = solves / processes
    mass = 8 * n
    return {
        "factorisation": (
            2 * told["multiplications"] * told["factorisations"],
            8 * entries * told["factorisations"],
            8 * entries,
        ),
        "solves": (4 * entries * WIDTH * solves, (2 * 8 * entries + 4 * block) * solves, 8 * entries + block),
        "orthogonalisation": (
            4 * 64 * n * (told["pairs"] + 3 * solves),
            block * (told["passed"] + 7 * solves),
            block // 2 * blocks,
        ),
        "products": (2 * WIDTH * mass * solves, (12 * mass + 2 * block) * solves, 12 * mass + 2 * block),
    }


def attainable(machine, size):
    """Bytes per second of arrays of this size."""
    sizes = sorted((int(known), rate) for known, rate in machine["bandwidth"].items())
    return next((rate for known, rate in sizes if size <= known), sizes[-1][1])


def bound(machine, part, flops, moved, size, seconds):
    rate, bytes_per_second = flops / seconds, moved / seconds
    # A register holds twice as many numbers in single precision.
    most = machine["operations"] * (2 if part == "orthogonalisation" else 1)
    of_flops, of_bytes = rate / most, bytes_per_second / attainable(machine, size)
    by = "flops" if of_flops > of_bytes else "bandwidth"
    return (
        f"{rate / 1e9:.1f} Gflop/s ({100 * of_flops:.0f} %), {bytes_per_second / 1e9:.1f} GB/s ({100 * of_bytes:.0f} %)"
        f", nearer to {by}"
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bench")
    parser.add_argument("machine")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--counts", default="50,100,500,1000")
    parser.add_argument("--choice", default="fem")
    parser.add_argument("meshes", nargs="+")
    options = parser.parse_args()
    machine = json.loads(run([options.machine]))
    levels = ", ".join(f"{int(size) >> 20} MB {rate / 1e9:.0f} GB/s" for size, rate in machine["bandwidth"].items())
    print(f"One core: {machine['operations'] / 1e9:.0f} Gflop/s in registers; memory: {levels}.\n")
    rows, bounds = [], []
    for mesh in options.meshes:
        for count in options.counts.split(","):
            told = [
                json.loads(line)
                for line in run(
                    [options.bench, "--json", "--choice", options.choice]
                    + ["--count", count, "--rounds", str(options.rounds), mesh]
                ).splitlines()
            ]
            middle = {part: statistics.median(each["parts"][part] for each in told) for part in told[0]["parts"]}
            total = statistics.median(each["processor"] for each in told)
            last = told[-1]
            rows.append((last, total, middle))
            for part, (flops, moved, size) in counted(last).items():
                if middle[part] > 0.02 * total:
                    text = bound(machine, part, flops, moved, size, middle[part])
                    bounds.append(f"| {last['order']} | {count} | {part} | {100 * middle[part] / total:.0f} % | {text} |")
    parts = [part for part in rows[0][2] if any(middle[part] > 0.005 * total for _, total, middle in rows)]
    print("| n | eigenvalues | CPU s | " + " | ".join(f"{part} %" for part in parts) + " | factors | solves of 8 | peak MB |")
    print("|---" * (len(parts) + 6) + "|")
    for told, total, middle in rows:
        shares = " | ".join(f"{100 * middle[part] / total:.0f}" for part in parts)
        print(
            f"| {told['order']} | {told['asked']} | {total:.3f} | {shares} | {told['factorisations']} "
            f"| {told['solves']} | {told['peak'] / 1e6:.0f} |"
        )
    print("\n| n | eigenvalues | part | share | rate (of what one core can do) |\n|---|---|---|---|---|")
    print("\n".join(bounds))


main()
