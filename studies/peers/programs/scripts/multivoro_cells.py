"""Radical cells by Voro++ (multivoro), in the Python that has it: given.npz and JSON in, cells.npz and JSON out."""

import json
import sys

import numpy as np
from multivoro import compute_voronoi
from spent import Spent

folder = json.load(sys.stdin)["folder"]
given = np.load(f"{folder}/given.npz")
clock = Spent()
cells = compute_voronoi(
    given["centers"], limits=given["limits"], radii=given["radii"], periodic_boundaries=(False, False, False)
)
cost = clock.so_far()
owners, neighbours, lengths, corners, points, before = [], [], [], [], [], 0
for number, cell in enumerate(cells):
    vertices = [] if cell is None else np.reshape(cell.get_vertices(), (-1, 3))
    if not len(vertices):
        continue
    faces, begin = cell.get_face_vertices().tolist(), 0
    for neighbour in cell.get_neighbors().tolist():
        count = faces[begin]
        corners.append(np.array(faces[begin + 1 : begin + 1 + count]) + before)
        lengths.append(count)
        owners.append(number)
        neighbours.append(neighbour)
        begin += 1 + count
    points.append(vertices)
    before += len(vertices)
np.savez(
    f"{folder}/cells.npz",
    owner=owners,
    neighbour=neighbours,
    length=lengths,
    corner=np.concatenate(corners),
    point=np.concatenate(points),
)
print(json.dumps({"cost": cost}))
