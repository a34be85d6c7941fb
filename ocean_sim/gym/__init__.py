"""Boats for robots and learning: `boats` moves many at once, `environments` has them for Gymnasium (extra `gym`),
`unit` as a functional mock-up unit (extra `fmi`). `OceanEnv` and `OceanVectorEnv` are found here, too."""

from typing import Any

__all__ = ["OceanEnv", "OceanVectorEnv"]


def __getattr__(name: str) -> Any:
    """Import the environments, and with them Gymnasium, when one is first used; AttributeError for any other name."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from ocean_sim.gym import environments

    return vars(environments)[name]
