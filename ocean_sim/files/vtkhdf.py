"""Points with cells at several moments, in one file: VTKHDF 2.2, poly data (ParaView 5.12 or newer)."""

from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files.whole_file import must_have_room

TOPOLOGIES = {"Vertices": 1, "Lines": 2, "Polygons": 3, "Strips": 0}  # corners of a cell
HELD_BACK = 1 << 24  # bytes that HDF5 may not have written yet: a chunk of each array, and where they lie
BEGINS = ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets")  # where in the arrays a moment begins


class Series:
    """A file that grows moment by moment; use it as a context manager. Raises OSError before a disk is full: HDF5 ends
    the process where it cannot write.

    Cells that are as they were in the moment before are written once.
    """

    def __init__(self, path: Path, topology: str) -> None:
        """`topology`: what the cells are, one of TOPOLOGIES."""
        import h5py

        self.path, self.topology = path, topology
        self.file = h5py.File(path, "w")
        self.root = self.file.create_group("VTKHDF")
        self.root.attrs["Version"] = np.array([2, 2])
        self.root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len("PolyData")))
        self.cells: np.ndarray | None = None
        self.times: list[float] = []
        self.parts = 0  # sets of cells written
        self.steps: dict[str, list[Any]] = {name: [] for name in BEGINS}
        self.fields: list[str] = []

    def add(self, time: float, points: np.ndarray, cells: np.ndarray, **fields: np.ndarray) -> None:
        """A moment [s]: (n, 3) points [m], cells (m, corners) as numbers of points, and values of the points."""
        taken = points.nbytes + cells.nbytes + sum(values.nbytes for values in fields.values())
        must_have_room(self.path, taken + HELD_BACK)
        before = len(self.root["Points"]) if self.times else 0
        self.steps["PointOffsets"].append(before)
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
        """A new part."""
        self.append("NumberOfPoints", np.array([points]))
        self.begins = {"CellOffsets": [0] * len(TOPOLOGIES), "ConnectivityIdOffsets": [0] * len(TOPOLOGIES)}
        for k, (name, corners) in enumerate(TOPOLOGIES.items()):
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
        """Rows after those that are there."""
        if name not in self.root:
            chunk = (max(1, min(len(values), 65536)), *values.shape[1:])
            self.root.create_dataset(name, data=values, maxshape=(None, *values.shape[1:]), chunks=chunk)
            return
        rows: Any = self.root[name]
        rows.resize(len(rows) + len(values), axis=0)
        rows[len(rows) - len(values) :] = values

    def finish(self) -> None:
        """Say where in the arrays each moment begins."""
        group = self.root.create_group("Steps")
        group.attrs["NSteps"] = len(self.times)
        group["Values"] = np.array(self.times)
        group["NumberOfParts"] = np.ones(len(self.times), dtype=int)
        for name, values in self.steps.items():
            group[name] = np.array(values)
        for name in self.fields:
            group[f"PointDataOffsets/{name}"] = np.array(self.steps["PointOffsets"])

    def __enter__(self) -> "Series":
        return self

    def __exit__(self, kind: type | None, *failure: object) -> None:
        try:
            if kind is None:
                self.finish()
        finally:
            self.file.close()
