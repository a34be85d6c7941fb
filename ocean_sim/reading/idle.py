"""Keys that are given and change nothing, because another key or part is missing, zero, or stands in their place.

A key counts as given where its value is not its default. Each rule names keys below their part, `[]` standing for every
entry of a list or mapping, when they have an effect, and the reason where they have none.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

from ocean_sim.basin.tank_motion import Harmonic
from ocean_sim.conventions import Motions
from ocean_sim.model import Model
from ocean_sim.parts import FluidConfig, Preflight, slot_of
from ocean_sim.waves import Spectrum

MOTIONS, REPLACED = Motions._fields, ("mass", "centre_of_mass", "inertia")
GRAPHICS = ("cuda", "metal", "vulkan", "gpu")  # backends that no thread of the processor works for


class Rule(NamedTuple):
    """When some keys have an effect."""

    keys: str
    has_effect: Callable[[Any, Preflight, Any], Any]  # of the mapping that holds the key, the scene, and the part
    reason: str


def particles(mapping: Any, known: Preflight, part: Any) -> bool:
    """True if the water is made of particles."""
    return known.fluid.made_of_particles


def has_stops(mapping: Any, known: Preflight, part: Any) -> bool:
    """True if particles can meet a wall, a floor, a lid or an obstacle."""
    return known.fluid.made_of_particles and bool(known.tank.sides or known.tank.config.obstacles)


def is_none(key: str, mapping: Any, known: Preflight, part: Any) -> bool:
    """True if the part leaves a key open."""
    return getattr(part, key) is None


def untabled(motion: str, mapping: Any, known: Preflight, part: Any) -> bool:
    """True if a ship has no table of radiation that gives a motion."""
    return part.table is None or MOTIONS.index(motion) not in part.table.numbers


SAME = "the scene draws nothing at random but its spectra, and each of these has a seed of its own"
RULES = {
    "scene": [
        Rule("seed", lambda h, k, p: not (seeds := spectrum_seeds(p)) or h.seed in seeds or k.wind.is_random, SAME)
    ],
    "runtime": [Rule("threads pin", lambda h, k, p: h.arch not in GRAPHICS, "a graphics processor does the work")],
    "basin": [
        Rule("walls.z walls.z_min walls.z_max", lambda h, k, p: k.tank.dimension == 3, "a slice has no sides across z"),
        Rule("walls.x", lambda h, k, p: h.x_min is None or h.x_max is None, "x_min and x_max stand in its place"),
        Rule("walls.z", lambda h, k, p: h.z_min is None or h.z_max is None, "z_min and z_max stand in its place"),
        Rule("walls", lambda h, k, p: h.walls == "none" or particles(h, k, p), "a sea in closed form passes its sides"),
        Rule("floor lid", particles, "a sea in closed form has no friction and no lid"),
        Rule("friction restitution", has_stops, "no particle meets a side here"),
        Rule("lid.velocity", lambda h, k, p: h.slip == "no_slip", "water slides along a lid of free_slip"),
        Rule("motion.about", lambda h, k, p: not isinstance(h, Harmonic) or "roll" in h.axis, "the tank does not roll"),
        Rule("obstacles[].motion.start", lambda h, k, p: h.start < k.duration, "the run ends before"),
    ],
    "sea": [
        Rule("rim.velocity", lambda h, k, p: not k.ships, "the band lies opposite the ship"),
        Rule("onset breaking", lambda h, k, p: h.order == 3, "only a sea of order 3 is nonlinear"),
    ],
    "fluid": [
        Rule("collision_distance", has_stops, "no particle meets a side here"),
        Rule("onset breaking", lambda h, k, p: h.order == 3, "only a sea of order 3 is nonlinear"),
        Rule("initial.seed", lambda h, k, p: h.disorder, "there is no disorder"),
    ],
    "wind": [
        Rule("noise_every", lambda h, k, p: h.is_random, "the wind has no noise"),
        Rule("targets volumes[].targets", lambda h, k, p: h.targets != ["ship"] or k.ships, "there is no ship"),
        Rule("volumes[].lift_coefficient", lambda h, k, p: h.wind_speed, "there is no wind_speed"),
        Rule(
            "volumes[].redraw_yaw_deg volumes[].redraw_strength", lambda h, k, p: h.velocity.any(), "it does not drift"
        ),
        Rule(
            "volumes[].heading_deg",
            lambda h, k, p: h.wind_speed or h.schedule or (not isinstance(h.drift, tuple) and h.drift),
            "there is neither a wind_speed nor a drift along it",
        ),
        Rule("pressure_gain wave_speed", lambda h, k, p: h.sheltering, "without sheltering no pressure acts on waves"),
        Rule("u10 heading_deg", lambda h, k, p: h.schedule is None, "the schedule stands in its place"),
    ],
    "ship": [
        Rule(
            "propeller.wake", lambda h, k, p: h.zero_thrust_speed, "without a zero_thrust_speed no speed lowers thrust"
        ),
        Rule("propeller.diameter", lambda h, k, p: p.rudder, "there is no rudder in its slipstream"),
        Rule("helm.look_ahead helm.arrival", lambda h, k, p: h.route, "she holds a heading, and sails no route"),
        Rule("contact", lambda h, k, p: h.contact is None or particles(h, k, p), "there are no particles to meet"),
        Rule("moorings", lambda h, k, p: h.free, "all of her motions are held"),
        *(Rule(f"hull.{key}", partial(is_none, key), f"the ship's own {key} replaces it") for key in REPLACED),
        *(
            Rule(f"added_mass.{motion}", partial(untabled, motion), "the table of radiation has it")
            for motion in MOTIONS
        ),
    ],
    "platform": [
        Rule(
            "washout.rate_limit_deg",
            lambda h, k, p: any(frequency is not None for frequency in h.rotation_frequency),
            "no axis has a high-pass",
        )
    ],
    "health": [
        Rule("max_speed max_density_ratio max_level_ratio max_distance max_energy_gain", particles, "no particles")
    ],
    "frames": [Rule("particles", particles, "there are none")],
    "preview": [Rule("content", particles, "there are no particles")],
    "gauges": [Rule("pressure[].normal", lambda h, k, p: h.diameter, "the gauge is a point, without a diameter")],
    "render": [
        Rule("particles", particles, "there are none"),
        Rule("foam_cover", lambda h, k, p: h.foam, "no foam is drawn"),
        Rule("wind", lambda h, k, p: not k.wind.still, "there is no wind"),
        Rule("every", lambda h, k, p: h.film, "there is no film"),
    ],
}


def spectrum_seeds(model: Any) -> set[int]:
    """Seeds of all spectra inside a model."""
    if isinstance(model, Mapping | list | tuple):
        entries = model.values() if isinstance(model, Mapping) else model
        return set().union(*(spectrum_seeds(one) for one in entries))
    if not isinstance(model, Model):
        return set()
    own = {model.seed} if isinstance(model, Spectrum) else set()
    return own.union(*(spectrum_seeds(getattr(model, name)) for name in type(model).model_fields))


def mappings(value: Any, steps: list[str], place: str) -> Iterator[tuple[str, Model]]:
    """The models at the end of a path, each with its place."""
    if not steps:
        if isinstance(value, Model):
            yield place, value
        return
    name, each = steps[0].removesuffix("[]"), steps[0].endswith("[]")
    if not isinstance(value, Model) or name not in type(value).model_fields:
        return
    inner = getattr(value, name)
    entries = (inner.items() if isinstance(inner, Mapping) else enumerate(inner or ())) if each else [("", inner)]
    for key, entry in entries:
        yield from mappings(entry, steps[1:], f"{place}.{name}.{key}" if each else f"{place}.{name}")


def idle_keys(scene: Model, parts: Mapping[str, Any], known: Preflight) -> Iterator[str]:
    """A sentence for each key of a scene and its parts that is given and changes nothing."""
    for place, part in {"scene": scene, **parts}.items():
        rules = RULES.get(slot_of(place), [])
        if isinstance(part, FluidConfig):
            unread = f"water of kind {part.kind} does not read it"
            rules = [*rules, *(Rule(key, lambda h, k, p: False, unread) for key in part.unheeded)]
        for keys, has_effect, reason in rules:
            for path in keys.split():
                *above, name = path.split(".")
                for where, mapping in mappings(part, above, place):
                    field = type(mapping).model_fields.get(name)
                    default = None if field is None else field.get_default(call_default_factory=True)
                    if field is not None and getattr(mapping, name) != default and not has_effect(mapping, known, part):
                        yield f"{where}.{name}".removeprefix("scene.") + f" has no effect: {reason}"
