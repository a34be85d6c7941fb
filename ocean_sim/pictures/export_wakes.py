"""What pictures make of the water around ships, for files of it: their wakes, and the waves of their own."""

from pathlib import Path

import numpy as np

from ocean_sim.pictures.camera import Vessel
from ocean_sim.pictures.frame_files import Log, ships_in
from ocean_sim.pictures.wake import Kelvin, Wake, standing


class Wakes:
    """Of all ships of a run, at the points of its frames."""

    def __init__(self, files: list[Path], grid: dict[str, np.ndarray]) -> None:
        """`files`: all frames of the run."""
        sizes = {key: np.ptp(grid[f"{key}_vertices"].astype(float), axis=0) for key in ships_in(grid, "_vertices")}
        tracks = Log(files).tracks if sizes else {}
        self.x, self.z = grid["x"], grid["z"]
        self.vessels = [
            (Vessel(float(size[2]), np.zeros(3), tracks[key]), float(size[0]))
            for key, size in sizes.items()
            if key in tracks
        ]
        self.alone = "sea_amplitude" in grid and "sea_answers" not in grid  # the water of the run knows of no ship

    def white(self, time: float, origin: np.ndarray) -> np.ndarray:
        """(nx, nz) share of foam behind ships at a time [s], around an origin x, z [m]."""
        found = np.zeros((len(self.x), len(self.z)))
        for vessel, beam in self.vessels:
            found = np.maximum(found, Wake(vessel, beam, self.x, self.z).share(time, origin))
        return found

    def raised(self, time: float, origin: np.ndarray, answer: np.ndarray | None) -> np.ndarray:
        """(nx, nz) by how much pictures show the water higher than the run has it [m]; `answer`: what it answers to
        its ships [m]."""
        x, z = self.x + origin[0], self.z + origin[1]
        more = np.zeros((len(x), len(z)))
        if answer is not None:
            shown = answer.astype(float)
            for vessel, beam in self.vessels:
                shown = standing(shown, vessel, beam, x, z, time)
            more += shown - answer
        if self.alone:
            places = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
            for vessel, beam in self.vessels:
                more += Kelvin(vessel, beam).height(time, places).reshape(more.shape)
        return more
