"""Studies: many runs of scenes or of validation cases, and their results taken together."""

from ocean_sim.parts import config_of, kinds


def reads_key(scheme: str, key: str) -> bool:
    """True if a scheme (a kind) reads the setting `key`, such as `fluid.spacing`, which then can change results."""
    slot, _, name = key.partition(".")
    return scheme not in kinds(slot) or name not in config_of(slot, scheme).unheeded
