"""The matrices of one mesh, as every method gets them.

`problem.py EXPORT STEM` reads what the bench `matrices` wrote, assembles the same matrices once more from the mesh in it
(tests/reference/spectrum.py), checks that both are equal, and writes STEM.npz for the methods in Python and STEM.bin for
those in C++. B is divided by its sum 1'B1, so that eigenvalues times area are found and one shift suits every mesh.
"""

import json
import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp

sys.path.insert(0, str(Path(__file__).parents[2] / "reference"))
from spectrum import matrices  # noqa: E402


def read(path):
    """Both triangles of L and B (CSR on one pattern), and the mesh."""
    raw = Path(path).read_bytes()
    vertices, triangles, n, entries = (int(size) for size in np.frombuffer(raw, "<u8", 4))
    at = 32

    def take(count, kind):
        nonlocal at
        at += 8 * count
        return np.frombuffer(raw, kind, count, at - 8 * count)

    points = take(3 * vertices, "<f8").reshape(-1, 3)
    corners = take(3 * triangles, "<u8").astype(int).reshape(-1, 3)
    kept = take(n, "<u8").astype(int)
    rows, columns = take(entries, "<u8").astype(int), take(entries, "<u8").astype(int)
    stiffness, mass = take(entries, "<f8"), take(entries, "<f8")
    assert at == len(raw), path
    off = rows != columns

    def both(values):
        mirrored = (np.r_[values, values[off]], (np.r_[rows, columns[off]], np.r_[columns, rows[off]]))
        matrix = sp.csr_matrix(mirrored, shape=(n, n))
        matrix.sort_indices()
        return matrix

    return points, corners, kept, both(stiffness), both(mass)


def difference(a, b):
    """The largest difference of two matrices, against the largest entry."""
    return abs(a - b).max() / abs(b).max()


def main():
    export, stem = sys.argv[1:]
    points, corners, kept, stiffness, mass = read(export)
    unit = (mass != sp.identity(len(kept))).nnz == 0
    if not unit and mass.nnz == len(kept):
        sys.exit("only consistent mass is compared")
    own_stiffness, own_mass = (matrix.tocsr()[kept][:, kept] for matrix in matrices(points, corners))
    apart = [difference(stiffness, own_stiffness), 0.0 if unit else difference(mass, own_mass)]
    scale = mass.sum()
    # The pattern of L without the entries of B = 1 that are not on the diagonal.
    np.savez(
        stem + ".npz",
        n=len(kept),
        indptr=stiffness.indptr.astype("i4"),
        indices=stiffness.indices.astype("i4"),
        stiffness=stiffness.data,
        mass=mass.data / scale,
        unit=unit,
    )
    with open(stem + ".bin", "wb") as out:
        np.array([len(kept), stiffness.nnz, int(unit)], "<i8").tofile(out)
        stiffness.indptr.astype("<i4").tofile(out)
        stiffness.indices.astype("<i4").tofile(out)
        stiffness.data.astype("<f8").tofile(out)
        (mass.data / scale).astype("<f8").tofile(out)
    print(json.dumps({"n": len(kept), "scale": scale, "apart": max(apart)}))


main()
