"""Compares the re-mesher with pymeshlab's isotropic re-meshing and pyacvd.

    python tests/bench/remesh_peers.py OURS MESH…      (needs numpy, scipy, pymeshlab, pyacvd, pyvista)

OURS is a folder of results by the bench `remesh --out OURS MESH…`; N is taken from each of them, and the CPU seconds
from its output where that was kept as OURS/table.txt. Every result is measured here, by the same code: least angles,
variation of edge lengths, Hausdorff distance by sampled points (nearest sampled point of the other, so an upper
bound), change of area, topology. CPU seconds of the others are of this process.
"""

import pathlib
import sys
import time

import numpy as np
import pyacvd
import pymeshlab
import pyvista
from scipy.spatial import cKDTree


def load(path):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    return meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()


def edges(faces):
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)


def surface_area(vertices, faces):
    corners = vertices[faces]
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


def samples(vertices, faces, count):
    corners = vertices[faces]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    random = np.random.default_rng(1)
    which = random.choice(len(faces), count, p=areas / areas.sum())
    u, w = random.random((2, count))
    over = u + w > 1
    u[over], w[over] = 1 - u[over], 1 - w[over]
    a, b, c = corners[which].transpose(1, 0, 2)
    return np.concatenate([a + (b - a) * u[:, None] + (c - a) * w[:, None], vertices[np.unique(faces)]])


def measure(original, result):
    vertices, faces = result
    corners = vertices[faces]
    sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    a, b, c = sides.T
    cosines = [(y * y + z * z - x * x) / np.maximum(2 * y * z, 1e-300) for x, y, z in [(a, b, c), (b, c, a), (c, a, b)]]
    least = np.degrees(np.arccos(np.clip(np.max(cosines, axis=0), -1, 1)))
    pairs, uses = edges(faces)
    lengths = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    euler = len(np.unique(faces)) - len(pairs) + len(faces)
    before = len(np.unique(original[1])) - len(edges(original[1])[0]) + len(original[1])
    one, two = samples(*original, 400_000), samples(vertices, faces, 400_000)
    far = max(cKDTree(two).query(one)[0].max(), cKDTree(one).query(two)[0].max())
    area = surface_area(vertices, faces) / surface_area(*original) - 1
    diagonal = np.linalg.norm(np.ptp(original[0], axis=0))
    kept = "yes" if euler == before and (uses == 2).all() else "NO"
    return len(np.unique(faces)), np.percentile(least, 1), least.min(), lengths.std() / lengths.mean(), far / diagonal * 100, area * 100, kept


def by_pymeshlab(original, count):
    vertices, faces = original
    area = surface_area(vertices, faces)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
    length = (area / (np.sqrt(0.75) * count)) ** 0.5
    meshes.meshing_isotropic_explicit_remeshing(iterations=10, targetlen=pymeshlab.PureValue(length))
    return meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()


def by_pyacvd(original, count):
    vertices, faces = original
    surface = pyvista.PolyData.from_regular_faces(vertices, faces)
    clustering = pyacvd.Clustering(surface)
    # Its manual: as many subdivisions as make some ten vertices of one.
    while len(clustering.mesh.points) < 10 * count:
        clustering.subdivide(1)
    clustering.cluster(count)
    result = clustering.create_mesh()
    return np.asarray(result.points, float), result.regular_faces


def main():
    ours = pathlib.Path(sys.argv[1])
    table = ours / "table.txt"
    rows = [line.split() for line in table.read_text().splitlines()] if table.exists() else []
    own = {row[0]: f"{float(row[12]):.3f}" for row in rows if len(row) > 12 and row[4] in ("yes", "NO")}
    print("| mesh | by | CPU s | vertices | 1st percentile of least angle | least | cv of edges | Hausdorff % | area % | topology kept |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for mesh in map(pathlib.Path, sys.argv[2:]):
        original = load(mesh)
        result = load(ours / f"{mesh.stem}.obj")
        count = len(result[0])
        for name, remesh in [("ours", None), ("pymeshlab", by_pymeshlab), ("pyacvd", by_pyacvd)]:
            start = time.process_time()
            made = result if remesh is None else remesh(original, count)
            seconds = own.get(mesh.stem, "") if remesh is None else f"{time.process_time() - start:.2f}"
            n, angle, least, cv, far, area, kept = measure(original, made)
            print(f"| {mesh.stem} | {name} | {seconds} | {n} | {angle:.1f} | {least:.1f} | {cv:.3f} | {far:.2f} | {area:+.2f} | {kept} |", flush=True)


main()
