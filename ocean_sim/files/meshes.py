"""Writers of mesh files for other programs: PLY, glTF and VTKHDF.

PLY, binary (Turk 1994, the Stanford triangle format): meshes or points, with fields of the points as properties of
their own names; readers ignore those that they do not know. glTF 2.0, binary (Khronos 2021): moving meshes, with nodes
that are rotated and translated, and surfaces that change shape by one morph target per moment; y is up, in metres and
seconds, as the format prescribes. VTKHDF 2.2, poly data (ParaView 5.12 or newer): points with cells at several moments.
"""

import json
import struct
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files.atomic_file import atomic_write, require_disk_space, write_file

PLY_TYPES = {"<f4": "float", "<i4": "int", "|u1": "uchar"}
AXIS_NAMES = "xyz"
FLOAT_TYPE, INDEX_TYPE = 5126, 5125  # component types of glTF
ACCESSOR_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
CELL_CORNERS = {"Vertices": 1, "Lines": 2, "Polygons": 3, "Strips": 0}  # corners of a cell
HDF5_UNWRITTEN_BYTES = 1 << 24  # bytes that HDF5 may not have written yet: a chunk of each array, and where they lie
# Numbers by which a moment is found in the arrays.
OFFSET_NAMES = ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets")


def save_ply(path: Path, points: np.ndarray, faces: np.ndarray | None, fields: dict[str, np.ndarray]) -> Path:
    """Write points (n, 3) [m], triangles `faces` (m, 3) if any, fields of points, (n,) or (n, 3), as PLY; returns path.
    `Normals` become nx, ny, nz; `RGB` (or else grey `foam`) 8-bit colours; other vectors name_x, name_y, name_z."""
    columns: dict[str, np.ndarray] = dict(zip(AXIS_NAMES, points.T))
    if "Normals" in fields:
        columns |= {f"n{axis}": values for axis, values in zip(AXIS_NAMES, fields["Normals"].T)}
    colours = fields.get("RGB")
    if colours is None and "foam" in fields:
        colours = np.repeat((255.0 * np.clip(fields["foam"], 0.0, 1.0))[:, None], 3, axis=1)
    if colours is not None:
        columns |= dict(zip(("red", "green", "blue"), colours.astype(np.uint8).T))
    for name, values in fields.items():
        if name not in ("Normals", "RGB"):
            columns |= {name: values} if values.ndim == 1 else {f"{name}_{a}": v for a, v in zip(AXIS_NAMES, values.T)}
    rows = np.empty(len(points), [(name, ply_type(values)) for name, values in columns.items()])
    for name, values in columns.items():
        rows[name] = values
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property {PLY_TYPES[ply_type(values)]} {name}" for name, values in columns.items()]
    corners = np.empty(0 if faces is None else len(faces), [("count", "|u1"), ("corners", "<i4", 3)])
    if faces is not None:
        head += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
        corners["count"], corners["corners"] = 3, faces
    write_file(path, "\n".join([*head, "end_header", ""]).encode("ascii") + rows.tobytes() + corners.tobytes())
    return path


def ply_type(values: np.ndarray) -> str:
    """NumPy type code of an array in a PLY file: 8-bit or 32-bit integers, or 32-bit floats."""
    if values.dtype == np.uint8:
        return "|u1"
    return "<i4" if values.dtype.kind in "iu" else "<f4"


class Glb:
    """Writer of a binary glTF file of meshes that move: add meshes and animations, then call `save`."""

    def __init__(self, times: np.ndarray) -> None:
        """`times`: moments (k,) [s] for which all animations give values."""
        self.data = bytearray()
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "ocean-sim"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
            "animations": [{"name": "run", "channels": [], "samplers": []}],
        }
        self.times = self.accessor(np.asarray(times, np.float32), bounds=True)

    def accessor(self, values: np.ndarray, bounds: bool = False) -> int:
        """Store an array (n,) or (n, components), with minimum and maximum if `bounds`; returns its glTF accessor."""
        values = np.ascontiguousarray(values)
        self.data += b"\0" * (-len(self.data) % 4)
        views, accessors = self.tree["bufferViews"], self.tree["accessors"]
        views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        self.data += values.tobytes()
        kind = INDEX_TYPE if values.dtype == np.uint32 else FLOAT_TYPE
        shape = ACCESSOR_TYPES[1 if values.ndim == 1 else values.shape[1]]
        found = {"bufferView": len(views) - 1, "componentType": kind, "count": len(values), "type": shape}
        if bounds:
            ends = {"min": values.min(axis=0), "max": values.max(axis=0)}
            found |= {name: np.atleast_1d(end).tolist() for name, end in ends.items()}
        accessors.append(found)
        return len(accessors) - 1

    def mesh(
        self, name: str, points: np.ndarray, faces: np.ndarray, colour: np.ndarray, moved: np.ndarray | None = None
    ) -> int:
        """Add a mesh of points (n, 3) [m] and triangles `faces` (m, 3), of linear RGB `colour` (3,) or (n, 3); returns
        the index of its node. `moved` (k, n, 3): the points at each of the k moments, if they change."""
        traits = {"POSITION": self.accessor(points.astype(np.float32), bounds=True)}
        base = [1.0, 1.0, 1.0, 1.0]
        if colour.ndim == 2:
            traits["COLOR_0"] = self.accessor(colour.astype(np.float32))
        else:
            base = [*colour.tolist(), 1.0]
        part: dict[str, Any] = {"attributes": traits, "indices": self.accessor(faces.astype(np.uint32).ravel())}
        surface = {"baseColorFactor": base, "metallicFactor": 0.0, "roughnessFactor": 0.4}
        self.tree["materials"].append({"name": name, "pbrMetallicRoughness": surface, "doubleSided": True})
        part["material"] = len(self.tree["materials"]) - 1
        mesh: dict[str, Any] = {"name": name, "primitives": [part]}
        if moved is not None:
            ways = (moved - points).astype(np.float32)
            part["targets"] = [{"POSITION": self.accessor(way, bounds=True)} for way in ways]
            mesh["weights"] = [0.0] * len(ways)
        self.tree["meshes"].append(mesh)
        self.tree["nodes"].append({"name": name, "mesh": len(self.tree["meshes"]) - 1})
        self.tree["scenes"][0]["nodes"].append(len(self.tree["nodes"]) - 1)
        if moved is not None:
            self.animate(len(self.tree["nodes"]) - 1, "weights", np.eye(len(moved), dtype=np.float32).ravel())
        return len(self.tree["nodes"]) - 1

    def show_at_moments(self, nodes: dict[int, int], moments: int) -> None:
        """Show each node at one moment only; `nodes`: index of the node, by index of the moment; `moments`: their
        number. At other moments its scale is zero, which hides it (glTF 2.0, section 3.5.2)."""
        for k, node in nodes.items():
            seen = np.zeros((moments, 3), np.float32)
            seen[k] = 1.0
            self.tree["nodes"][node]["scale"] = [float(k == 0)] * 3  # to who knows no time, the first
            self.animate(node, "scale", seen, "STEP")

    def animate(self, node: int, path: str, values: np.ndarray, between: str = "LINEAR") -> None:
        """Animate the property `path` of a node over the k moments: `translation` (k, 3) [m], `rotation` (k, 4),
        quaternions x, y, z, w, `scale` (k, 3) or `weights`. `between`: glTF's name of the interpolation."""
        run = self.tree["animations"][0]
        sampler = {"input": self.times, "output": self.accessor(values.astype(np.float32)), "interpolation": between}
        run["samplers"].append(sampler)
        run["channels"].append({"sampler": len(run["samplers"]) - 1, "target": {"node": node, "path": path}})

    def save(self, path: Path) -> None:
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        if not self.tree["animations"][0]["channels"]:
            del self.tree["animations"]
        words = json.dumps(self.tree, separators=(",", ":")).encode()
        words += b" " * (-len(words) % 4)
        with atomic_write(path) as draft, draft.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(words) + 8 + len(self.data)))
            file.write(struct.pack("<I4s", len(words), b"JSON") + words)
            file.write(struct.pack("<I4s", len(self.data), b"BIN\0") + bytes(self.data))


class Series(AbstractContextManager["Series"]):
    """Writer of a VTKHDF file of points, cells and fields at successive moments; cells that do not change are stored
    once. A context manager. `add` raises OSError before the disk is full, since HDF5 would end the process."""

    def __init__(self, path: Path, topology: str) -> None:
        """`path`: the file to create; `topology`: kind of the cells, a key of CELL_CORNERS."""
        import h5py

        self.path, self.topology = path, topology
        self.file = h5py.File(path, "w")
        self.root = self.file.create_group("VTKHDF")
        self.root.attrs["Version"] = np.array([2, 2])
        self.root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len("PolyData")))
        self.cells: np.ndarray | None = None
        self.times: list[float] = []
        self.parts = 0  # sets of cells written
        self.steps: dict[str, list[Any]] = {name: [] for name in OFFSET_NAMES}
        self.fields: list[str] = []

    def add(self, time: float, points: np.ndarray, cells: np.ndarray, **fields: np.ndarray) -> None:
        """Append a moment, `time` [s]: points (n, 3) [m], cells (m, corners) of point indices, fields (n, ...)."""
        taken = points.nbytes + cells.nbytes + sum(values.nbytes for values in fields.values())
        require_disk_space(self.path, taken + HDF5_UNWRITTEN_BYTES)
        self.steps["PointOffsets"].append(len(self.root["Points"]) if self.times else 0)
        self.append("Points", points.astype(np.float32))
        for name, values in fields.items():
            self.append(f"PointData/{name}", values)
        self.fields = list(fields)
        if self.cells is None or not np.array_equal(self.cells, cells) or self.held != len(points):
            self.write_cells(cells, len(points))
        self.times.append(time)
        self.steps["PartOffsets"].append(self.parts - 1)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            self.steps[name].append(self.begins[name])

    def write_cells(self, cells: np.ndarray, points: int) -> None:
        """Append cells (m, corners), indices into `points` points, as a VTK part that later moments can share."""
        self.append("NumberOfPoints", np.array([points]))
        self.begins = {"CellOffsets": [0] * len(CELL_CORNERS), "ConnectivityIdOffsets": [0] * len(CELL_CORNERS)}
        for k, (name, corners) in enumerate(CELL_CORNERS.items()):
            own = cells if name == self.topology else np.empty((0, corners), dtype=np.int64)
            if self.parts:
                self.begins["CellOffsets"][k] = int(np.sum(self.root[name]["NumberOfCells"]))
                self.begins["ConnectivityIdOffsets"][k] = len(self.root[name]["Connectivity"])
            self.append(f"{name}/NumberOfCells", np.array([len(own)]))
            self.append(f"{name}/NumberOfConnectivityIds", np.array([own.size]))
            self.append(f"{name}/Offsets", corners * np.arange(len(own) + 1))
            self.append(f"{name}/Connectivity", own.ravel().astype(np.int64))
        self.cells, self.held, self.parts = cells, points, self.parts + 1

    def append(self, name: str, values: np.ndarray) -> None:
        """Append `values` (m, ...) to the HDF5 data set `name` as new rows; the data set is created if missing."""
        if name not in self.root:
            chunk = (max(1, min(len(values), 65536)), *values.shape[1:])
            self.root.create_dataset(name, data=values, maxshape=(None, *values.shape[1:]), chunks=chunk)
            return
        rows: Any = self.root[name]
        rows.resize(len(rows) + len(values), axis=0)
        rows[len(rows) - len(values) :] = values

    def finish(self) -> None:
        """Write the group `Steps` of VTKHDF: times [s], and the row at which the arrays of each moment begin."""
        group = self.root.create_group("Steps")
        group.attrs["NSteps"] = len(self.times)
        group["Values"] = np.array(self.times)
        group["NumberOfParts"] = np.ones(len(self.times), dtype=int)
        for name, values in self.steps.items():
            group[name] = np.array(values)
        for name in self.fields:
            group[f"PointDataOffsets/{name}"] = np.array(self.steps["PointOffsets"])

    def __exit__(self, kind: type | None, *failure: object) -> None:
        """Complete the file with `finish` unless the block failed, and close it."""
        try:
            if kind is None:
                self.finish()
        finally:
            self.file.close()
