"""Binary glTF 2.0 (Khronos 2021) of meshes that move: nodes that are turned and put, and surfaces that change shape by
morph targets, one a moment. Y is up, metres and seconds, as the format has it."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files.whole_file import whole

FLOAT, INDEX = 5126, 5125  # component types
SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


class Glb:
    """Parts are added, then it is saved."""

    def __init__(self, times: np.ndarray) -> None:
        """`times`: of the moments [s]."""
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
        """The number under which an array (n,) or (n, components) is found."""
        values = np.ascontiguousarray(values)
        self.data += b"\0" * (-len(self.data) % 4)
        views, accessors = self.tree["bufferViews"], self.tree["accessors"]
        views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        self.data += values.tobytes()
        kind = INDEX if values.dtype == np.uint32 else FLOAT
        shape = SHAPES[1 if values.ndim == 1 else values.shape[1]]
        found = {"bufferView": len(views) - 1, "componentType": kind, "count": len(values), "type": shape}
        if bounds:
            found |= {
                "min": np.atleast_1d(values.min(axis=0)).tolist(),
                "max": np.atleast_1d(values.max(axis=0)).tolist(),
            }
        accessors.append(found)
        return len(accessors) - 1

    def mesh(
        self, name: str, points: np.ndarray, faces: np.ndarray, colour: np.ndarray, moved: np.ndarray | None = None
    ) -> int:
        """A node with points (n, 3) [m], triangles, and linear RGB of all or of each point (n, 3); `moved`: the points
        at every moment (k, n, 3). Returns its number."""
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

    def in_turn(self, nodes: dict[int, int], moments: int) -> None:
        """Shows each of these nodes, by the number of a moment, only then: a node of scale zero is not drawn (glTF 2.0,
        3.5.2)."""
        for k, node in nodes.items():
            seen = np.zeros((moments, 3), np.float32)
            seen[k] = 1.0
            self.tree["nodes"][node]["scale"] = [float(k == 0)] * 3  # to who knows no time, the first
            self.animate(node, "scale", seen, "STEP")

    def animate(self, node: int, path: str, values: np.ndarray, between: str = "LINEAR") -> None:
        """Values at every moment: `translation` (k, 3) [m], `rotation` (k, 4) quaternions x, y, z, w, `scale` (k, 3),
        or `weights`; `between` moments as the format calls it."""
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
        size = 12 + 8 + len(words) + 8 + len(self.data)
        with whole(path) as draft, draft.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, size))
            file.write(struct.pack("<I4s", len(words), b"JSON") + words)
            file.write(struct.pack("<I4s", len(self.data), b"BIN\0") + bytes(self.data))
