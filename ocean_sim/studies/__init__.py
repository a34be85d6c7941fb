"""Studies: many runs of scenes or of validation cases, and what they say together."""

WITHOUT_EFFECT = {"dfsph": ("fluid.compression",)}  # by scheme: keys that change no number of its runs


def heeds(scheme: str, key: str) -> bool:
    """Whether a setting of this key can change what a scheme computes."""
    return key not in WITHOUT_EFFECT.get(scheme, ())
