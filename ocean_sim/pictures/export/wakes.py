"""Water around ships as pictures show it, for exported files: wakes, the ships' own waves, and foam along hulls."""

from pathlib import Path

import numpy as np

from ocean_sim.basin.points import grid_points, middles_of
from ocean_sim.pictures.frame_files import Frame, FrameLog, ship_keys
from ocean_sim.pictures.stage.camera import Vessel
from ocean_sim.pictures.water.sea_state import is_open_sea, run_scene
from ocean_sim.pictures.water.wake import Kelvin, Wake, limited_answer
from ocean_sim.pictures.water.waterline import Hull, WettedHull


class RunWakes:
    """Wakes of all ships of a run at sea, at the points of the heights in its frames; without effect for a tank."""

    def __init__(self, files: list[Path], grid: dict[str, np.ndarray]) -> None:
        keys = ship_keys(grid, "_vertices")
        drawn = keys and not (first := Frame(files[0])).folds
        at_sea = drawn and is_open_sea(run_scene(files[0].parents[1]), first, float(grid["depth"]))
        tracks = FrameLog(files).tracks if at_sea else {}
        self.grid, self.x, self.z = grid, grid["x"], grid["z"]
        self.hulls = {key: Hull(grid, key) for key in keys if key in tracks}
        self.vessels = {key: Vessel(hull.length, np.zeros(3), tracks[key]) for key, hull in self.hulls.items()}
        self.answers = "sea_answers" in grid  # the water of the run knows of its ships

    def shown(self, frame: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Heights (nx, nz) [m] of a frame and shares of foam on its foam's grid, both with those of the ships added."""
        height, white = frame["elevation"].astype(float), frame["foam"].astype(float)
        if not self.vessels:
            return height, white
        time, origin = float(frame["time"]), frame.get("origin", np.zeros(2)).astype(float)
        points = grid_points(self.x + origin[0], self.z + origin[1])
        height += self.behind(time, points, frame.get("answer"))
        if not self.answers:
            for ship in self.wetted_hull(frame, height, origin):
                height += ship.raised(points).reshape(height.shape)
        x, z = (middles_of(*self.sides(k), white.shape[k]) for k in range(2))
        for key, vessel in self.vessels.items():
            white = np.maximum(white, Wake(vessel, self.hulls[key].beam, x, z).share(time, origin))
        for ship in self.wetted_hull(frame, height, origin):
            low, high = (ends - origin for ends in ship.around())
            near = np.ix_((x > low[0]) & (x < high[0]), (z > low[1]) & (z < high[1]))
            along = ship.white(grid_points(x[near[0].ravel()] + origin[0], z[near[1].ravel()] + origin[1]))
            white[near] = np.maximum(white[near], along.reshape(white[near].shape))
        return height, white

    def sides(self, k: int) -> tuple[float, float]:
        """Lower and upper limit [m] of the basin along x (k = 0) or z (k = 1)."""
        return float(self.grid["lower"][2 * k]), float(self.grid["upper"][2 * k])

    def places(self, at: np.ndarray, origin: np.ndarray) -> np.ndarray:
        """Positions (2, n) of points x, z (n, 2) [m] in the basin around an origin, 0 to 1 from side to side."""
        low, high = np.transpose([self.sides(k) for k in range(2)])
        return ((at - origin - low) / (high - low)).T

    def wetted_hull(self, frame: dict[str, np.ndarray], height: np.ndarray, origin: np.ndarray) -> list[WettedHull]:
        """Hulls of a frame that touch the water, whose heights (nx, nz) [m] lie around an origin x, z [m]."""
        time = float(frame["time"])
        ships = [
            hull.wetted_hull(
                frame[f"{key}_position"],
                frame[f"{key}_turn"],
                self.vessels[key].speed(time),
                lambda at: read_cells(height, self.places(at, origin)),
            )
            for key, hull in self.hulls.items()
        ]
        return [ship for ship in ships if ship.wet]

    def behind(self, time: float, points: np.ndarray, answer: np.ndarray | None) -> np.ndarray:
        """Ship waves (nx, nz) [m] but bow waves at x, z (nx nz, 2) [m]; `answer`: what the run's water has [m]."""
        shape = len(self.x), len(self.z)
        more = np.zeros(shape)
        if answer is not None:
            x, z = points[:: shape[1], 0], points[: shape[1], 1]
            shown = answer.astype(float)
            for key, vessel in self.vessels.items():
                shown = limited_answer(shown, vessel, self.hulls[key].beam, x, z, time)
            more += shown - answer
        if "sea_amplitude" in self.grid and not self.answers:
            for key, vessel in self.vessels.items():
                more += Kelvin(vessel, self.hulls[key].beam).height(time, points).reshape(shape)
        return more


def read_cells(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (n, ...) of a grid (nx, nz, ...) at positions (2, n), 0 to 1 across it, interpolated between cells."""
    from scipy.ndimage import map_coordinates

    cells = at * np.array(values.shape[:2])[:, None] - 0.5
    channels = np.moveaxis(values.reshape(*values.shape[:2], -1), -1, 0).astype(float)
    found = [map_coordinates(channel, cells, order=1, mode="nearest") for channel in channels]
    return np.stack(found, axis=-1).reshape(at.shape[1], *values.shape[2:])
