"""Water that folds over, in a tank of glass: clear, with air where it is stirred.

Things behind clear water are seen bent and dimmed by the way of light through it. Two pictures come first: one of
everything but the water, one of the distances of its back faces. The shader takes the difference of both faces as the
thickness, absorbs and scatters along it (Beer and Lambert), and mirrors the sky. Water hidden by other water, as a pool
below a jet, is drawn first, behind the back faces of the nearer one.

Its mesh is smoothed by a low-pass filter: waves along it shorter than some dozen of its edges are removed, as the
terraces that layers of particles leave on slopes; longer ones stay (Taubin, Zhang & Golub 1996, ECCV '96: Chebyshev
polynomials of the graph's Laplacian).
"""

import sys
from typing import Any

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.water import water_glsl, water_shading
from ocean_sim.pictures.water.foam import read_cells
from ocean_sim.surface import Mesh

# Angle acos(1 - k) of the eigenvalue k where a wave is halved; and how sharply the filter falls
PASS_BAND, FILTER_DEGREE = 0.30, 32
SIDE_TOLERANCE = 1.0e-4  # of the length of the box: what is nearer to one of its sides lies on it
SPREAD_STEPS = 16  # edges from its rim to which what lies flat on a side goes with the rim
MAX_SMOOTHING = 0.4  # [spacings] by which a folded surface is smoothed
WATER_TRAITS = "nrm", "air", "was"  # normal; share of air; where its water was born
ABSORPTION = np.array([3.0, 0.85, 0.60])  # of light, in a way as long as the tank is deep
# Light that comes back from water so thick that nothing shines through
SCATTERED_LIGHT = np.array([0.016, 0.135, 0.170])
SHINE_VARIANCE = 0.004  # variance of slopes that widen the sun's highlight
RELIEF_FACTOR = 1.6  # by which slopes are steeper than they are in the light of a map
GRAIN_LENGTH = 0.5  # of foam: how many of its metres on a sea a spacing of the particles is in a tank
HEIGHT_SKEW = (0.7, 0.4)  # of the height at which water was born, in the two coordinates of its grain
# Colour of water full of bubbles; its light from all sides, and the sun's
FOAM_COLOUR, FOAM_LIGHTS = np.array([0.80, 0.83, 0.84]), (0.62, 0.38)


def smooth_mesh(mesh: Mesh, lower: tuple[float, ...], upper: tuple[float, ...], most: float) -> Mesh:
    """Smoothed copy of a mesh. No vertex moves more than `most` [m], so that drops and thin sheets stay; then all
    vertices move along their normals by a thin layer that restores the volume.

    Where the surface meets a side of the box from `lower` to `upper` [m], it is smoothed as if mirrored in that side,
    so its rim slides along the side. Triangles flat on a side get vertices and normals of their own, for a sharp edge.
    Measure volumes on the original mesh."""
    n, corners = len(mesh.vertices), mesh.triangles
    if n == 0:
        return mesh
    x = mesh.vertices.astype(float)
    sides = points_on_sides(x, lower, upper)
    on = np.any(sides, axis=0)
    lies = np.all(sides[:, corners], axis=2)  # (2, m, 3) whether a triangle lies on the lower, on the upper side
    flat = lies.any(axis=(0, 2))
    curved = corners[~flat]
    adjacent = neighbour_weights(curved, on)
    degree = np.asarray(adjacent.sum(axis=1))[:, None]
    inner = degree == 0.0  # of a side
    held, degree = on | inner, np.maximum(degree, 1.0)
    x = level_rim(x, adjacent, held)
    weights = low_pass_weights(PASS_BAND, FILTER_DEGREE)
    before, now = x, np.where(held, x, adjacent @ x / degree)
    found = weights[0] * before + weights[1] * now
    for weight in weights[2:]:
        before, now = now, 2.0 * np.where(held, now, adjacent @ now / degree) - before
        found += weight * now
    way = found - x
    way *= np.minimum(1.0, most / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1.0e-30))
    before, after = (Mesh(each, corners, mesh.normals).vertex_areas for each in (x, x + way))
    swept = (way * (before + after)).sum() / 6.0  # [m3]; a layer of this volume is taken off again
    out = np.where(held, 0.0, Mesh(x + way, curved, mesh.normals).vertex_areas)
    areas = np.linalg.norm(out, axis=1, keepdims=True)
    x += way - out / np.maximum(areas, 1.0e-30) * swept * 3.0 / max(float(areas.sum()), 1.0e-30)
    if flat.any():
        beside = neighbour_weights(corners[flat], np.zeros_like(on))
        x = mesh.vertices + spread_ways(x - mesh.vertices, beside, on | ~inner)
    normals = np.where(on, 0.0, Mesh(x, curved, mesh.normals).vertex_areas)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.maximum(lengths, 1.0e-30), mesh.normals)
    smooth = Mesh(x.astype(mesh.vertices.dtype), corners, normals.astype(mesh.normals.dtype))
    return split_edges(smooth, flat, lies[1].astype(int) - lies[0]) if flat.any() else smooth


def neighbour_weights(corners: np.ndarray, on: np.ndarray) -> Any:
    """Sparse matrix (n, n) of weights of a vertex's neighbours in triangles `corners`: 1, doubled for each side of the
    box that holds the vertex (`on` (n, 3)) but not the neighbour, whose mirror image then counts, too."""
    from scipy.sparse import coo_array

    n = len(on)
    i, j = np.concatenate([corners[:, [a, b]].T for a, b in ((0, 1), (1, 0), (1, 2), (2, 1), (0, 2), (2, 0))], axis=1)
    found = coo_array((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr().tocoo()
    weights = np.prod(np.where(on[found.row] & ~on[found.col], 2.0, 1.0), axis=1)
    return coo_array((weights, (found.row, found.col)), shape=(n, n)).tocsr()


def level_rim(x: np.ndarray, adjacent: Any, held: np.ndarray) -> np.ndarray:
    """Vertices (n, 3) [m], those on a side of the tank's box moved to the mean of their neighbours off it, but not
    where `held` (n, 3). `adjacent`: `neighbour_weights`. Marching cubes end half a cell inside, with a step."""
    beyond = adjacent > 1.0
    many = np.asarray(beyond.sum(axis=1))[:, None]
    return np.where(held | (many == 0), x, beyond @ x / np.maximum(many, 1))


def spread_ways(way: np.ndarray, adjacent: Any, held: np.ndarray) -> np.ndarray:
    """Displacements `way` (n, 3) [m] of vertices, spread over SPREAD_STEPS edges to neighbours that are not `held` (n,
    3). So the inside of a flat side follows its rim, and no triangle folds over. `adjacent`: `neighbour_weights`."""
    degree = np.maximum(np.asarray(adjacent.sum(axis=1)), 1.0)[:, None]
    for _ in range(SPREAD_STEPS):
        way = np.where(held, way, adjacent @ way / degree)
    return way


def split_edges(mesh: Mesh, flat: np.ndarray, facing: np.ndarray) -> Mesh:
    """Copy of a mesh whose `flat` triangles (m,) get vertices of their own, with normals `facing` (m, 3) along axes."""
    kinds, number = np.unique(facing[flat], axis=0, return_inverse=True)
    n, corners = len(mesh.vertices), mesh.triangles.copy()
    own, found = np.unique(number.reshape(-1, 1) * n + corners[flat], return_inverse=True)
    corners[flat] = n + found.reshape(-1, 3)
    normals = (kinds / np.linalg.norm(kinds, axis=1, keepdims=True))[own // n].astype(mesh.normals.dtype)
    vertices = np.concatenate([mesh.vertices, mesh.vertices[own % n]])
    return Mesh(vertices, corners, np.concatenate([mesh.normals, normals]))


def points_on_sides(x: np.ndarray, lower: tuple[float, ...], upper: tuple[float, ...]) -> np.ndarray:
    """Masks (2, n, 3) of points (n, 3) [m] on the lower and on the upper side of a box, for each axis."""
    low, up, near = np.array(lower), np.array(upper), SIDE_TOLERANCE * (upper[0] - lower[0])
    return np.stack([x <= low + near, x >= up - near])


def low_pass_weights(edge: float, degree: int) -> np.ndarray:
    """Weights (degree + 1,) of Chebyshev polynomials T_n(cos t) that add up to a low-pass filter: 1 at t = 0, 1/2 at t
    = `edge`, 0 beyond. They are the Fourier series of a step under von Hann's window."""
    n = np.arange(1, degree + 1)
    window = 0.5 + 0.5 * np.cos(np.pi * n / (degree + 1.0))
    weights = np.concatenate([[edge / np.pi], 2.0 * np.sin(n * edge) / (np.pi * n) * window])
    return weights / weights.sum()


class Shell(Content):
    """Water in a glass tank, drawn as a clear, smooth closed surface."""

    def __init__(self, stage: Stage, grid: Any, upper: np.ndarray, white: bool) -> None:
        """`stage`: camera, plotter; `grid`: arrays in grid.npz; `upper`: top corner [m]; `white`: True to draw foam."""
        depth = self.depth = float(grid["depth"])
        self.stage, self.white, self.sides = stage, white, (grid["lower"][[0, 2]], grid["upper"][[0, 2]])
        self.lower, self.spacing = tuple(grid["lower"]), float(grid["spacing"])
        self.upper = upper[0], np.inf, upper[2]  # no lid in which crests would lie flat
        over = sky.clear_sky_image()
        self.behind = water_glsl.make_texture(np.zeros((2, 2, 3), np.uint8))
        self.far, self.farther = (water_glsl.make_texture(np.zeros((2, 2, 4), np.uint8)) for _ in range(2))
        textures = water_glsl.sky_textures(over)
        seen = textures | {"scene": self.behind, "back": self.farther, "before": self.far}
        own = sys.modules[__name__]
        functions = water_glsl.WATER_FUNCTIONS + water_glsl.shader("tank_functions", own)
        program = water_glsl.shader("tank", own, sky, water_shading)
        plain = water_glsl.neutral_uniforms(0) | water_glsl.sky_uniforms(over)
        self.water = water_glsl.Shaded(stage.pyvista.PolyData(), program, functions, seen, WATER_TRAITS)
        measured = water_glsl.own_textures(textures | {"before": self.far})
        distances = water_glsl.shader("tank_distance")
        self.backs = water_glsl.Shaded(self.water.mesh, distances, functions, measured, WATER_TRAITS)
        self.backs.actor.GetProperty().FrontfaceCullingOn()
        half, parallel = stage.camera.parallel_height, stage.camera.parallel_height is not None
        pixel = 2.0 * (half or float(np.tan(np.radians(stage.camera.angle) / 2.0))) / (stage.samples * stage.size[1])
        for part in (self.water, self.backs):
            shown = {"exposure": water_shading.TANK_EXPOSURE, "depth": depth, "onMap": float(stage.camera.from_above)}
            shown |= {"spacing": self.spacing, "pixel": pixel, "behindOthers": 0.0, "parallel": float(parallel)}
            space = {"ahead": stage.camera.forward, "boxLow": np.array(self.lower), "boxHigh": upper}
            part.set(**plain | shown | space | {"view": np.eye(4), "screen": np.ones(3), "reach": 1.0})
        stage.plotter.add_actor(self.water.actor, reset_camera=False, render=False)
        self.measure = stage.new_plotter(stage.plotter.window_size)  # the picture of distances
        self.measure.set_background("black")
        self.measure.add_actor(self.backs.actor, reset_camera=False, render=False)

    def surface(self, frame: Frame) -> tuple[Mesh, np.ndarray, np.ndarray]:
        """Smoothed surface mesh of a frame, and at its vertices, as vectors for the shader (n, 3), the share of air
        (column 0; the others are 0) and the positions [m] that their water had in the first frame."""
        assert frame.mesh is not None
        skin = smooth_mesh(Mesh(*frame.mesh), self.lower, self.upper, MAX_SMOOTHING * self.spacing)
        if not self.white or frame.left is None or frame.carried is None or not len(skin.vertices):
            return skin, np.zeros_like(skin.vertices), skin.vertices
        at = ((skin.vertices[:, [0, 2]] - self.sides[0]) / (self.sides[1] - self.sides[0])).T
        free = ~points_on_sides(skin.vertices, self.lower, self.upper).any(axis=(0, 2))  # glass shows no air
        air = np.outer(read_cells(frame.left, at) * free, [1.0, 0.0, 0.0])
        return skin, air, skin.vertices - np.insert(read_cells(frame.carried, at), 1, 0.0, axis=1)

    def show(self, frame: Frame) -> None:
        """Take the water's mesh from a frame; draw two pictures for its shader: distances of its back, background."""
        mesh, state, birth = self.surface(frame)
        traits = dict(zip(WATER_TRAITS, (mesh.normals, state, birth), strict=True))
        self.water.mesh.DeepCopy(self.stage.mesh(mesh.vertices, mesh.triangles, **traits))
        eye, plotter = self.stage.camera.eye, self.stage.plotter
        self.reach = 1.01 * float(np.linalg.norm(mesh.vertices - eye, axis=1).max())
        camera = plotter.camera
        view = water_glsl.projection(camera, self.stage.size[0] / self.stage.size[1])
        space = {"eyeW": eye, "ahead": self.stage.camera.forward, "screen": np.array([*plotter.window_size, 1.0])}
        for part in (self.water, self.backs):
            part.set(**space, reach=self.reach, view=view, behindOthers=0.0)
        self.measure.camera.DeepCopy(camera)
        nearest = self.distances()
        water_glsl.fill_image(self.far.GetInput(), nearest)
        self.backs.set(behindOthers=1.0)
        water_glsl.fill_image(self.farther.GetInput(), self.distances())
        self.water.actor.VisibilityOff()
        self.capture_background()
        self.water.actor.VisibilityOn()
        self.water.set(behindOthers=1.0)
        self.capture_background()
        self.water.set(behindOthers=0.0)
        water_glsl.fill_image(self.farther.GetInput(), nearest)

    def distances(self) -> np.ndarray:
        """Render distances from the eye to the water surfaces that face away from it, over the shader's `reach` [m], as
        8-bit RGBA (height, width, 4), lowest row first: red in steps of 1/255, green the rest of a step."""
        self.measure.render()
        return self.measure.screenshot(None, return_img=True, transparent_background=True)[::-1]

    def capture_background(self) -> None:
        """Render the present picture without overlays, and use it as the background seen through the water; its fourth
        channel: distances along the camera's axis, over `reach`."""
        for mark in self.stage.over:
            mark.VisibilityOff()
        self.stage.plotter.render()
        image = self.stage.plotter.screenshot(None, return_img=True)
        away = -self.stage.plotter.get_image_depth(fill_value=-np.inf, reset_camera_clipping_range=False) / self.reach
        image = np.dstack([image, (255.0 * np.minimum(away, 1.0)).astype(np.uint8)])
        water_glsl.fill_image(self.behind.GetInput(), image[::-1])
        for mark in self.stage.over:
            mark.VisibilityOn()
