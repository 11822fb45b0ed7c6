"""Reference eigenvalues of linear finite elements, by SciPy alone.

    python spectrum.py COUNT MESH.off...  > spectrum.txt

Assembles the stiffness and the consistent mass matrix of each mesh from its vertex positions, and finds the COUNT
smallest eigenvalues with shift-invert ARPACK to full precision. One line per mesh: its name, its number of vertices,
then the eigenvalues.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla


def read_off(path):
    words = Path(path).read_text().split()
    assert words[0] == "OFF", path
    vertices, faces = int(words[1]), int(words[2])
    points = np.array(words[4 : 4 + 3 * vertices], float).reshape(-1, 3)
    triangles = np.array(words[4 + 3 * vertices : 4 + 3 * vertices + 4 * faces], int).reshape(-1, 4)
    assert (triangles[:, 0] == 3).all(), path
    return points, triangles[:, 1:]


def matrices(points, triangles):
    """Stiffness and mass from the gradients of the hat functions."""
    n = len(points)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    edges = np.stack([c - b, a - c, b - a], axis=1)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    local_stiffness = np.einsum("fik,fjk->fij", edges, edges) / (4 * area)[:, None, None]
    local_mass = area[:, None, None] * (np.ones((3, 3)) + np.eye(3)) / 12
    rows = np.repeat(triangles, 3, axis=1).ravel()
    columns = np.tile(triangles, 3).ravel()

    def assemble(local):
        return sp.csc_matrix((local.ravel(), (rows, columns)), shape=(n, n))

    return assemble(local_stiffness), assemble(local_mass)


def eigenvalues(stiffness, mass, count):
    scale = mass.sum()
    values = sla.eigsh(
        stiffness, k=count, M=mass / scale, sigma=-1.0, tol=0, ncv=2 * count + 50, return_eigenvectors=False
    )
    return np.sort(values) / scale


def main():
    count = int(sys.argv[1])
    for path in sys.argv[2:]:
        points, triangles = read_off(path)
        values = eigenvalues(*matrices(points, triangles), count)
        print(Path(path).stem, len(points), " ".join(f"{value:.13e}" for value in values), flush=True)


if __name__ == "__main__":
    main()
