"""Binary PLY (Turk 1994, the Stanford triangle format) of meshes and of points, with what is known at each point as
properties of their own names: readers take those that they know."""

from pathlib import Path

import numpy as np

from ocean_sim.files.whole_file import whole

NAMES = {"<f4": "float", "<i4": "int", "|u1": "uchar"}  # of types
AXES = "xyz"


def save(path: Path, points: np.ndarray, faces: np.ndarray | None, fields: dict[str, np.ndarray]) -> Path:
    """Points (n, 3) and triangles, with fields (n,) or (n, 3) of the points: `Normals` as nx, ny, nz; `RGB` as red,
    green and blue of 8 bits, where there is none `foam` as grey, too; any other by its name, of three numbers as name_x
    and so on."""
    columns: dict[str, np.ndarray] = dict(zip(AXES, points.T))
    if "Normals" in fields:
        columns |= {f"n{axis}": values for axis, values in zip(AXES, fields["Normals"].T)}
    colours = fields.get("RGB")
    if colours is None and "foam" in fields:
        colours = np.repeat((255.0 * np.clip(fields["foam"], 0.0, 1.0))[:, None], 3, axis=1)
    if colours is not None:
        columns |= dict(zip(("red", "green", "blue"), colours.astype(np.uint8).T))
    for name, values in fields.items():
        if name not in ("Normals", "RGB"):
            columns |= {name: values} if values.ndim == 1 else {f"{name}_{a}": v for a, v in zip(AXES, values.T)}
    rows = np.empty(len(points), [(name, stored(values)) for name, values in columns.items()])
    for name, values in columns.items():
        rows[name] = values
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property {NAMES[stored(values)]} {name}" for name, values in columns.items()]
    corners = np.empty(0 if faces is None else len(faces), [("count", "|u1"), ("corners", "<i4", 3)])
    if faces is not None:
        head += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
        corners["count"], corners["corners"] = 3, faces
    with whole(path) as draft:
        draft.write_bytes("\n".join([*head, "end_header", ""]).encode("ascii") + rows.tobytes() + corners.tobytes())
    return path


def stored(values: np.ndarray) -> str:
    """The type by which values are written."""
    if values.dtype == np.uint8:
        return "|u1"
    return "<i4" if values.dtype.kind in "iu" else "<f4"
