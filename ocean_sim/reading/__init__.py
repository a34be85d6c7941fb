"""Reading of a scene, from a user's text to a checked SceneConfig; here the keys of a scene outside its parts."""

from ocean_sim.model import Model, quantity


class Heading(Model):
    """Title, seed, duration and resolution of a scene."""

    title: str = ""
    """The experiment in one line."""
    seed: int = quantity("1", 0, ge=0, lt=2**31)
    """Seed of every random number of the run."""
    duration: float = quantity("s", 10.0, gt=0.0)
    """Simulated time."""
    resolution: float = quantity("1", 1.0, gt=0.0)
    """A factor on every spacing: 2 is twice as coarse."""
