"""Hulls from mesh files: read, judged, turned into the hull's axes, and filled by columns."""

import logging
import warnings
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ocean_sim.files.input_file import Unreadable, content, shown

MILLIMETRES = 1.0e3  # units: a hull longer than a kilometre is taken to be drawn in millimetres
AXES = {"x": 0, "y": 1, "z": 2}


class Source(Protocol):
    """A mesh file, and how to read it; what is None is guessed."""

    @property
    def file(self) -> str: ...
    @property
    def scale(self) -> float | None:
        """Metres per unit."""
        ...

    @property
    def up(self) -> str | None:
        """The file's axis that points up."""
        ...

    @property
    def bow(self) -> str | None:
        """The file's axis that points to the bow, with its sign."""
        ...


class BadMesh(ValueError):
    """A mesh that is no hull; `problems` are sentences: what is wrong and where."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


@dataclass(frozen=True)
class Guess:
    """How a mesh was read: metres per unit, the file's axis that is up, and that of the bow with its sign."""

    scale: float
    up: int
    bow: int
    sense: float

    def sentence(self) -> str:
        sign = "" if self.sense > 0 else "-"
        return f"read with {self.scale:g} m per unit, {'xyz'[self.up]} up and the bow along {sign}{'xyz'[self.bow]}"


def closed_mesh(shape: Source) -> Any:
    """The mesh of a shape in the hull's axes, keel at y = 0, amidships at z = 0; raises BadMesh."""
    mesh = read(Path(shape.file))
    problems = flaws(mesh)
    if problems:
        raise BadMesh([f"{shown(shape.file)}: {problem}" for problem in problems])
    if mesh.volume < 0.0:
        mesh.invert()
    guess = guessed(mesh, shape)
    if guess.up == guess.bow:
        raise BadMesh([f"{shown(shape.file)}: up and bow are the same axis, {'xyz'[guess.up]}"])
    up, bow = np.eye(3)[guess.up], guess.sense * np.eye(3)[guess.bow]
    turn = np.stack([np.cross(up, bow), up, bow])  # rows: port, up, bow in the file's axes
    mesh.vertices = guess.scale * mesh.vertices @ turn.T
    lower, upper = mesh.bounds
    mesh.vertices -= [(lower[0] + upper[0]) / 2, lower[1], (lower[2] + upper[2]) / 2]
    return mesh


def read(path: Path) -> Any:
    """The mesh in a file; raises BadMesh."""
    import trimesh

    kind = path.suffix.lower().removeprefix(".")
    if kind not in ("stl", "obj", "ply"):
        raise BadMesh([f"{shown(path)}: a hull is an STL, OBJ or PLY file"])
    try:
        data = content(path)
    except Unreadable as error:
        raise BadMesh([str(error)]) from None
    logging.getLogger("trimesh").addHandler(logging.NullHandler())  # what is wrong is told here
    try:  # from its bytes: materials that an OBJ names are not looked for
        with warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            mesh = trimesh.load(BytesIO(data), file_type=kind, force="mesh")
    except Exception as error:
        raise BadMesh([f"{shown(path)}: cannot be read as a mesh ({first_line(error)})"]) from None
    if len(getattr(mesh, "faces", ())) == 0:
        raise BadMesh([f"{shown(path)}: holds no triangles"])
    if np.shape(mesh.vertices)[1:] != (3,):
        raise BadMesh([f"{shown(path)}: cannot be read as a mesh (its vertices do not have three coordinates)"])
    mesh.merge_vertices()
    return mesh


def first_line(error: Exception) -> str:
    """The first line of an error's message, cut short."""
    line = next(iter(str(error).strip().splitlines()), "") or type(error).__name__
    return line if len(line) <= 100 else f"{line[:97]}..."


def flaws(mesh: Any) -> list[str]:
    """Why a mesh bounds no volume: sentences with positions in the file's own units."""
    found = []
    if not np.isfinite(mesh.vertices).all():
        return ["some vertices are not numbers"]
    edges, count = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    for wrong, what in ((count == 1, "a hole"), (count > 2, "a seam of more than two faces")):
        if wrong.any():
            position = mesh.vertices[edges[wrong]].reshape(-1, 3).mean(axis=0)
            found.append(f"not watertight: {np.count_nonzero(wrong)} edges bound {what}, around {spot(position)}")
    if not found and not mesh.is_winding_consistent:
        found.append("its faces do not all turn the same way, so inside and outside cannot be distinguished")
    if not found and abs(mesh.volume) <= 1e-9 * float(np.prod(mesh.extents)):
        found.append("it holds no volume")
    return found


def spot(position: np.ndarray) -> str:
    """A position as a message shows it."""
    return "(" + ", ".join(f"{x:.4g}" for x in position) + ")"


def guessed(mesh: Any, shape: Source) -> Guess:
    """Unit, up and bow where the shape does not give them: the longest axis is the ship's, and of the other two the one
    that the mesh mirrors itself in is athwart."""
    extents = np.asarray(mesh.extents)
    scale = shape.scale or (1.0 / MILLIMETRES if extents.max() > MILLIMETRES else 1.0)
    given_up = AXES[shape.up] if shape.up else None
    if shape.bow:
        bow, sense = AXES[shape.bow[-1]], -1.0 if shape.bow[0] == "-" else 1.0
    else:
        order = [axis for axis in np.argsort(-extents) if axis != given_up]
        bow, sense = int(order[0]), 1.0
    if given_up is not None:
        return Guess(scale, given_up, bow, sense)
    others = [axis for axis in range(3) if axis != bow]
    lopsided = [abs(mesh.center_mass[a] - mesh.bounds[:, a].mean()) / extents[a] for a in others]
    if abs(lopsided[0] - lopsided[1]) > 1e-3:
        return Guess(scale, others[int(np.argmax(lopsided))], bow, sense)
    return Guess(scale, 2 if bow != 2 else 1, bow, sense)  # as most files have it


def column_shares(mesh: Any, x: np.ndarray, z: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(len(x), len(edges) - 1, len(z)): the share of each interval between `edges` along y that lies inside, on
    columns at x and z [m]: between the first and second crossing, the third and fourth, and so on."""
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    position, height = [], []
    for p, q, r in zip(a, b, c):
        i0, i1 = np.searchsorted(x, [min(p[0], q[0], r[0]), max(p[0], q[0], r[0])])
        k0, k1 = np.searchsorted(z, [min(p[2], q[2], r[2]), max(p[2], q[2], r[2])])
        if i0 == i1 or k0 == k1:
            continue
        u, v = q - p, r - p
        area = u[0] * v[2] - u[2] * v[0]
        if area == 0.0:
            continue
        dx, dz = (x[i0:i1] - p[0])[:, None], (z[k0:k1] - p[2])[None, :]
        s, t = (dx * v[2] - dz * v[0]) / area, (u[0] * dz - u[2] * dx) / area
        hit = np.argwhere((s >= 0.0) & (t >= 0.0) & (s + t <= 1.0))
        if len(hit):
            position.append((hit[:, 0] + i0) * len(z) + hit[:, 1] + k0)
            height.append(p[1] + s[tuple(hit.T)] * u[1] + t[tuple(hit.T)] * v[1])
    shares = np.zeros((len(x) * len(z), len(edges) - 1))
    if position:
        column, y = np.concatenate(position), np.concatenate(height)
        order = np.lexsort((y, column))
        column, y = column[order], y[order]
        starts = np.flatnonzero(np.r_[True, column[1:] != column[:-1]])
        for first, last in zip(starts, np.r_[starts[1:], len(column)]):
            for low, high in zip(y[first:last:2], y[first + 1 : last : 2]):
                inside = np.clip(edges, low, high)
                shares[column[first]] += np.diff(inside) / np.diff(edges)
    return shares.reshape(len(x), len(z), -1).transpose(0, 2, 1)
