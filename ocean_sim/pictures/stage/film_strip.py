"""A row of small pictures of a film, so that its motion shows where nothing moves: on paper, in a page."""

import numpy as np

from ocean_sim.pictures.stage import antialiasing

MOST, SHRUNK = 8, 4  # pictures in the row, and pixels of a picture along a side of one of its
GAP = 3  # pixels between them


class Moments:
    """Collects pictures evenly from a film of unknown length; holds at most twice as many as it shows."""

    def __init__(self) -> None:
        self.kept: list[np.ndarray] = []
        self.seen, self.every = 0, 1  # pictures of the film, and how many of them for each that is kept

    def see(self, image: np.ndarray) -> None:
        """The next picture (height, width, 3) of the film."""
        if self.seen % self.every == 0:
            if len(self.kept) == 2 * MOST:
                self.kept, self.every = self.kept[::2], 2 * self.every
            if self.seen % self.every == 0:
                self.kept.append(antialiasing.mean(image, SHRUNK))
        self.seen += 1

    def row(self) -> np.ndarray:
        """(height, width, 3) pictures from the beginning to the end, side by side."""
        chosen = np.unique(np.round(np.linspace(0, len(self.kept) - 1, min(MOST, len(self.kept)))).astype(int))
        pictures = [self.kept[k] for k in chosen]
        between = np.full((pictures[0].shape[0], GAP, 3), 255, np.uint8)
        return np.concatenate([part for picture in pictures for part in (picture, between)][:-1], axis=1)
