"""The ready-made winds and waters carry the numbers of the thesis's listings, and say what they will do."""

import pytest

from ocean_sim import basin
from ocean_sim.parts import SceneFacts, config_of, named
from ocean_sim.reading.scene import load

PRINTED = {
    "CreateEmFluid": {
        "kernelRadiusMultiplier": 2.0,
        "restParticlesPerMeter": 0.8,
        "motionLimitMultiplier": 2,
        "packetSizeMultiplier": 16,
        "collisionDistanceMultiplier": 0.2,
        "stiffness": 20.0,
        "viscosity": 40.0,
        "restDensity": 1000.0,
        "restitutionForStaticShapes": 0.162,
        "dynamicFrictionForStaticShapes": 0.146,
        "restitutionForDynamicShapes": 0.5,
        "dynamicFrictionForDynamicShapes": 0.5,
        "simulationMethod": "NX_F_SPH",
        "maxParticles": None,
        "collisionResponseCoefficient": 0.5,
    },
    "createEllipAForceField": {
        "linearKernelDesc.constant": [-12.125, 20.0, 7.0],
        "linearKernelDesc.noise": [2, 2, 2],
        "fieldDesc.rigidBodyType": "NX_FF_TYPE_GRAVITATIONAL",
        "fieldDesc.softBodyType": "NX_FF_TYPE_NO_INTERACTION",
        "fieldDesc.fluidType": "NX_FF_TYPE_GRAVITATIONAL",
        "box.dimensions": [0.5, 15, 18],
        "box.pose.M": [20, 40],
    },
    "createSimForceField2": {"linearKernelDesc.noise": [30, 30, 30], "box.dimensions": [20, 3, 20]},
    "CreateCloth": {
        "globalPose.t": [0, 6.0, 0],
        "thickness": 1.5,
        "bendingStiffness": 0.01,
        "stretchingStiffness": 0.01,
        "dampingCoefficient": 0.001,
        "density": 50,
        "fromFluidResponseCoefficient": 1.0,
        "toFluidResponseCoefficient": 0.0,
    },
    "GenerateShip": {"BodyDesc.angularDamping": 0.4, "BodyDesc.linearDamping": 0.2, "GenerateShipSidePts height": 5.0},
}


@pytest.fixture(scope="module")
def listings(preset_data):
    return preset_data("thesis", "listings")


def at(data, key):
    """The value at a dotted key of nested mappings and lists."""
    for step in key.split("."):
        data = data[int(step)] if isinstance(data, list) else data[step]
    return data


@pytest.mark.parametrize("listing", PRINTED)
def test_no_printed_number_is_dropped(listings, listing):
    kept = {row["name"]: row["printed"] for row in listings[listing]["parameters"]}
    assert PRINTED[listing].items() <= kept.items()
    assert len(kept) == len(listings[listing]["parameters"])


@pytest.mark.parametrize("listing", PRINTED)
def test_our_keys_hold_our_values(listings, listing):
    config = load(listings[listing]["scene"], listings[listing].get("set"))
    resolved = config.resolved()
    if config.preflight.surface is not None:
        resolved["surface"] = config.preflight.surface.model_dump()  # with what it leaves to the water
    for row in listings[listing]["parameters"]:
        assert row.keys() == {"name", "printed", "our_key", "our_value", "unit", "why"}
        assert row["why"], row["name"]
        if row["our_key"] is not None:
            assert at(resolved, row["our_key"]) == row["our_value"], row["name"]
        else:
            assert row["our_value"] is None, row["name"]


def test_presets_have_the_numbers_of_the_listing(preset_data):
    narrow, noise = (preset_data("wind", name)["volumes"][0] for name in ("narrow", "noise_only"))
    assert narrow["acceleration"] == [-12.125, 20.0, 7.0] and narrow["noise"] == [2.0, 2.0, 2.0]
    assert narrow["include"][0]["half_size"] == [0.5, 15.0, 18.0] and narrow["redraw_yaw_deg"] == [20.0, 40.0]
    assert noise["noise"] == [30.0, 30.0, 30.0] and noise["include"][0]["half_size"] == [20.0, 3.0, 20.0]
    assert "acceleration" not in noise


def test_waters_have_the_numbers_of_the_listing(preset_data):
    place = basin.Config(length=40.0, width=40.0, depth=7.5).build()
    listing = config_of("fluid", "mueller").model_validate(preset_data("fluid", "thesis_listing"))
    assert (listing.stiffness, listing.kinematic_viscosity, listing.support_ratio) == (20.0, 40.0, 2.0)
    assert (listing.motion_limit, listing.collision_distance) == (2.0, 0.2)
    assert listing.lattice(place).n == 6144 and listing.spacing == 1.0 / 0.8
    sea = config_of("fluid", "mueller").model_validate(preset_data("fluid", "thesis_6000"))
    assert sea.lattice(place).n == 6144 and sea.compression == 0.008 and sea.stiffness is None


@pytest.fixture
def scene(preset_data):
    fluid = config_of("fluid", "mueller").model_validate(preset_data("fluid", "thesis_6000"))
    return SceneFacts({"fluid": fluid}, basin.Config(length=40.0, width=40.0, depth=7.5).build(), 4, 10.0)


def warned(preset_data, scene, name, **keys):
    data = preset_data("wind", name)
    if keys:
        data["volumes"][0].update(keys)
    return " ".join(config_of("wind", data["kind"]).model_validate(data).warnings(scene))


@pytest.mark.parametrize("name", named("wind"))
def test_every_preset_says_that_it_is_stylised(preset_data, scene, name):
    assert "stylised force field, not a physical stress" in warned(preset_data, scene, name)


def test_warnings_give_the_velocity_change_of_a_passage(preset_data, scene):
    assert "170000 times" in warned(preset_data, scene, "narrow")
    assert "one passage changes the velocity by 1.7 m/s (1 along, 1.4 up)" in warned(preset_data, scene, "narrow")
    assert "one passage changes the velocity by 2.1 m/s (1.2 along, 1.7 up)" in warned(preset_data, scene, "wide")
    assert "throws the water" not in warned(preset_data, scene, "narrow") + warned(preset_data, scene, "wide")
    assert "does not drift" in warned(preset_data, scene, "vortex")


@pytest.mark.parametrize("name, change", [("calm", "0.17"), ("breeze", "1.1"), ("gale", "2.7"), ("squall", "2.6")])
def test_our_own_winds_state_their_velocity_change_and_throw_nothing_out(preset_data, scene, name, change):
    said = warned(preset_data, scene, name)
    assert f"one passage changes the velocity by {change} m/s" in said and "throws the water" not in said


def test_the_front_of_the_squall_passes_a_basin_of_40_m_once(preset_data):
    place = basin.Config(length=40.0, width=40.0, depth=7.5).build()
    squall = config_of("wind", "gusts").model_validate(preset_data("wind", "squall"))
    front = squall.volumes[0].passages(place, 7, 0)
    assert front.lasts == pytest.approx(7.83, abs=0.01) and squall.volumes[0].end == 7.9


def test_a_field_that_throws_the_water_out_is_called_that(preset_data, scene):
    """The listing's strength in the wide box, which the first trial found to be no sea."""
    said = warned(preset_data, scene, "wide", acceleration=[-12.125, 20.0, 7.0])
    assert "throws the water 19.4 m high, above the depth of 7.5 m" in said


def test_a_real_wind_is_no_force_field(scene):
    config = config_of("wind", "gusts").model_validate(
        {"volumes": [{"include": [{"kind": "sphere", "radius": 100.0}], "wind_speed": 10.0}]}
    )
    assert not list(config.warnings(scene))
