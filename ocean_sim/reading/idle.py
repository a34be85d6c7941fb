"""Warnings of keys without effect, because another key or part is missing, zero or used instead, and of angles that may
be in radians.

Only keys whose value is not their default are examined.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ocean_sim.basin.motion import Harmonic
from ocean_sim.conventions import Motions
from ocean_sim.model import Model
from ocean_sim.parts import FluidConfig, SceneFacts, slot_of
from ocean_sim.waves import FileSpectrum, Spectrum

GRAPHICS_BACKENDS = ("cuda", "metal", "vulkan", "gpu")  # backends that no thread of the processor works for


def has_particles(mapping: Any, known: SceneFacts, *_: Any) -> bool:
    """True if the scene's water is made of particles; for IDLE_RULES. Of its arguments it reads only `known`."""
    return known.fluid.made_of_particles


def has_stops(mapping: Any, known: SceneFacts, *_: Any) -> bool:
    """True if particles of the scene's water can meet a wall, a floor, a lid or an obstacle. For IDLE_RULES, the rules
    on keys without effect; of its arguments it reads only `known`, the scene."""
    return known.fluid.made_of_particles and bool(known.tank.sides or known.tank.config.obstacles)


PI_TWELFTH = np.pi / 12.0  # [rad]
PI_TOLERANCE = 0.008  # share of it by which 3.14 differs from pi, but no 5.5 from 21

# Slots and paths of mappings, through all entries of lists; some of their keys; True if they have an effect, by the
# mapping h, the scene k, the part p and the key n; and the reason where they have none.
IDLE_RULES: list[tuple[str, str, Callable[[Any, SceneFacts, Any, str], Any], str]] = [
    (
        "scene",
        "seed",
        lambda h, k, p, *_: not (found := spectrum_seeds(p)) or h.seed in found or k.wind.is_random,
        "the scene draws nothing at random but its spectra, and each of these has a seed of its own",
    ),
    ("runtime", "threads pin", lambda h, *_: h.arch not in GRAPHICS_BACKENDS, "a graphics processor does the work"),
    ("basin.walls", "z z_min z_max", lambda h, k, *_: k.tank.dimension == 3, "a slice has no sides across z"),
    ("basin.walls", "x", lambda h, *_: None in (h.x_min, h.x_max), "x_min and x_max stand in its place"),
    ("basin.walls", "z", lambda h, *_: None in (h.z_min, h.z_max), "z_min and z_max stand in its place"),
    (
        "basin",
        "walls",
        lambda h, k, *_: h.walls == "none" or has_particles(h, k),
        "a sea in closed form passes its sides",
    ),
    ("basin", "floor lid", has_particles, "a sea in closed form has no friction and no lid"),
    ("basin", "friction restitution", has_stops, "no particle meets a side here"),
    ("basin.lid", "velocity", lambda h, *_: h.slip == "no_slip", "water slides along a lid of free_slip"),
    ("basin.motion", "about", lambda h, *_: not isinstance(h, Harmonic) or "roll" in h.axis, "the tank does not roll"),
    ("basin.obstacles.motion", "start", lambda h, k, *_: h.start < k.duration, "the run ends before"),
    ("sea.rim", "velocity", lambda h, k, *_: not k.ships, "the band lies opposite the ship"),
    ("sea fluid", "onset breaking", lambda h, *_: h.order == 3, "only a sea of order 3 is nonlinear"),
    ("fluid", "collision_distance", has_stops, "no particle meets a side here"),
    ("fluid.initial", "seed", lambda h, *_: h.disorder, "there is no disorder"),
    ("wind", "noise_every", lambda h, *_: h.is_random, "the wind has no noise"),
    ("wind wind.volumes", "targets", lambda h, k, *_: h.targets != ["ship"] or k.ships, "there is no ship"),
    ("wind.volumes", "lift_coefficient", lambda h, *_: h.wind_speed, "there is no wind_speed"),
    ("wind.volumes", "redraw_yaw_deg redraw_strength", lambda h, *_: h.velocity.any(), "it does not drift"),
    (
        "wind.volumes",
        "heading_deg",
        lambda h, *_: h.wind_speed or h.schedule or (not isinstance(h.drift, tuple) and h.drift),
        "there is neither a wind_speed nor a drift along it",
    ),
    ("wind", "pressure_gain wave_speed", lambda h, *_: h.sheltering, "without sheltering no pressure acts on waves"),
    ("wind", "u10 heading_deg", lambda h, *_: dict(h).get("schedule") is None, "the schedule stands in its place"),
    ("ship.propeller", "wake", lambda h, *_: h.zero_thrust_speed, "without a zero_thrust_speed no speed lowers thrust"),
    ("ship.propeller", "diameter", lambda h, k, p, *_: p.rudder, "there is no rudder in its slipstream"),
    ("ship.helm", "look_ahead arrival", lambda h, *_: h.route, "she holds a heading, and sails no route"),
    ("ship", "contact", lambda h, k, *_: h.contact is None or has_particles(h, k), "there are no particles to meet"),
    ("ship", "moorings", lambda h, *_: h.free, "all of her motions are held"),
    ("ship.hull", "mass centre_of_mass inertia", lambda h, k, p, n: getattr(p, n) is None, "the ship has its own"),
    (
        "ship.added_mass",
        " ".join(Motions._fields),
        lambda h, k, p, n: p.table is None or Motions._fields.index(n) not in p.table.numbers,
        "the table of radiation has it",
    ),
    ("platform.washout", "rate_limit_deg", lambda h, *_: {*h.rotation_frequency} != {None}, "no axis has a high-pass"),
    (
        "health",
        "max_speed max_density_ratio max_level_ratio max_distance max_energy_gain",
        has_particles,
        "no particles",
    ),
    ("frames render", "particles", has_particles, "there are none"),
    ("preview", "content", has_particles, "there are no particles"),
    ("gauges.pressure", "normal", lambda h, *_: h.diameter, "the gauge is a point, without a diameter"),
    ("render", "foam_cover", lambda h, *_: h.foam, "no foam is drawn"),
    ("render", "wind", lambda h, k, *_: not k.wind.still, "there is no wind"),
    ("render", "every", lambda h, *_: h.film, "there is no film"),
]


def inner_models(value: Any, path: str = "", place: str = "") -> Iterator[tuple[str, str, Model]]:
    """Yield (path, place, model) for `value` and each model inside it, such as (.wind.volumes, .wind.volumes.0, model):
    `path` leaves out list indices and mapping keys, `place` has them."""
    if isinstance(value, Model):
        yield path, place, value
        for name in type(value).model_fields:
            yield from inner_models(getattr(value, name), f"{path}.{name}", f"{place}.{name}")
    elif isinstance(value, Mapping | list | tuple):
        for key, entry in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from inner_models(entry, path, f"{place}.{key}")


def like_radians(mapping: Model) -> Iterator[str]:
    """Yield a warning for each angle in degrees that looks like radians: a multiple of pi/12 to three digits."""
    for key in [key for key in type(mapping).model_fields if key.endswith("_deg") and getattr(mapping, key)]:
        turns = np.abs(getattr(mapping, key)) / PI_TWELFTH
        if ((turns > 0.5) & (turns < 24.5) & (np.abs(turns - np.rint(turns)) < PI_TOLERANCE)).any():
            meant = np.degrees(getattr(mapping, key)).round(1).tolist()
            yield f"{key} is {getattr(mapping, key)} degrees; if it is in radians, write {meant}"


def spectrum_seeds(scene: Model) -> set[int]:
    """Seeds of all wave spectra in a scene."""
    return {model.seed for _, _, model in inner_models(scene) if isinstance(model, Spectrum | FileSpectrum)}


def idle_keys(parts: Mapping[str, Any], known: SceneFacts) -> Iterator[str]:
    """Yield a warning for each key of the models in `parts`, by name, that has no effect or may be in radians."""
    for root, part in parts.items():
        rules = IDLE_RULES
        if isinstance(part, FluidConfig):
            unread = f"water of kind {part.kind} does not read it"
            rules = [*IDLE_RULES, ("fluid", " ".join(part.unheeded), lambda h, *_: False, unread)]
        for path, place, mapping in inner_models(part, slot_of(root), root):
            if root != "scene":  # which has all parts
                yield from (f"{place}.{sentence}" for sentence in like_radians(mapping))
            fields = type(mapping).model_fields
            for where, keys, has_effect, reason in rules:
                for key in keys.split() if path in where.split() else ():
                    if key in fields and getattr(mapping, key) != fields[key].get_default(call_default_factory=True):
                        if not has_effect(mapping, known, part, key):
                            yield f"{place}.{key}".removeprefix("scene.") + f" has no effect: {reason}"
