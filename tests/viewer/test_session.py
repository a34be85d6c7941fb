"""What a page does to a simulation, and that one which only watches does nothing to it."""

import json
import shutil
import socket
import threading
from contextlib import suppress

import numpy as np
import pytest

from ocean_sim import wave_field
from ocean_sim.conventions import Refused, in_words
from ocean_sim.platform.shared import packets
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.viewer import protocol as p
from ocean_sim.viewer.answers import key_table
from ocean_sim.viewer.replay import Recorded, replay_file
from ocean_sim.viewer.server import Order
from ocean_sim.viewer.session import Session, Source
from ocean_sim.viewer.watch import Watch
from ocean_sim.waves import wavenumber
from tests.processes import wait_for
from tests.viewer import page_packets

COARSE = {"runtime.threads": 1, "fluid.spacing": 2.5, "runtime.precision": "f64", "accuracy": None}

LAKE = """
duration: 2.0
basin: {length: 40.0, width: 40.0, depth: 7.5, walls: none}
fluid: {kind: linear_waves, height: 0.2, period: 4.0}
frames: {every: 0.1, spacing: 2.0}
runtime: {threads: 1, precision: f64}
"""


class Desk:
    """Somebody who watches, and may say something."""

    def __init__(self) -> None:
        self.watchers, self.fresh, self.arrived = 1, True, threading.Event()
        self.stills: list[bytes] = []
        self.frames: list[bytes] = []
        self.told: list[dict] = []
        self.waiting: list[Order] = []

    def begin(self, still):
        self.stills.append(still)

    def show(self, frame, time):
        self.frames.append(frame)

    def orders(self):
        found, self.waiting = self.waiting, []
        return found

    def tell(self, watcher, **message):
        self.told.append(json.loads(json.dumps(message)))

    def last(self, kind):
        return next(message for message in reversed(self.told) if message["type"] == kind)


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    source = Source.of("showcase", None, COARSE)
    with Session(source, Desk(), tmp_path_factory.mktemp("out"), list) as one:
        one.paused = True
        yield one


@pytest.fixture
def lake(tmp_path):
    """Waves that are there in a moment."""
    path = tmp_path / "lake.yaml"
    path.write_text(LAKE)
    with Session(Source.of(str(path)), Desk(), tmp_path / "out", list) as one:
        one.paused = True
        yield one


def ask(session, **command):
    session.server.waiting.append(Order(1, p.parse_command(json.dumps(command))))
    session.obey()


def test_physics_is_the_same_to_the_byte_with_and_without_a_watcher():
    found = []
    for watched in (False, True):
        with Simulation(load("showcase", COARSE)) as simulation:
            if watched:
                desk = Desk()
                watch = Watch(simulation, desk)
                simulation.observers.append(watch)
                watch.observe = lambda simulation, watch=watch: watch.show(0.0)  # after every step
            simulation.run(0.12)
            particles, body = simulation.fluid.particles, simulation.ships["ship"].body
            found.append(
                [particles.position.to_numpy().tobytes(), particles.id.to_numpy().tobytes(), body.position.tobytes()]
            )
    assert found[0] == found[1]
    assert len(desk.frames) > 5 and len(desk.stills) == 1


def test_a_frame_says_where_everything_is(session):
    simulation, desk = session.simulation, session.server
    session.watch.show(0.0)
    head, arrays = page_packets.unpack(desk.frames[-1])
    assert head["time"] == pytest.approx(simulation.time, abs=1e-6)
    heights = simulation.surface.elevations(session.watch.points)
    assert np.abs(arrays["height"] - heights).max() < 1e-3
    particles = simulation.fluid.particles
    there = np.empty((particles.n, 3))
    there[particles.id.to_numpy()] = particles.position.to_numpy()
    low, high = session.watch.setting.box
    assert np.abs(page_packets.opened(arrays["particles"], low, high) - there).max() < 1e-3
    assert arrays["poses"][0, :3] == pytest.approx(simulation.ships["ship"].body.position, abs=1e-5)
    still, _ = page_packets.unpack(desk.stills[-1])
    assert len(still["scalars"]) == len(arrays["scalars"]) and still["protocol"] == p.PROTOCOL_VERSION
    assert len(desk.frames[-1]) < 12_000 and still["tile"] == {
        "nx": 16,
        "nz": 16,
        "step": [2.5, 2.5],
        "first": [-18.75, -18.75],
    }


def test_a_tank_has_a_wavemaker_an_absorbing_zone_and_a_body_without_a_helm():
    """Its significant height is that of the water beside the box, which stands 0.3 m deep in still water."""
    with Simulation(load("gallery/box_in_wave_tank", COARSE | {"fluid.spacing": 0.15})) as simulation:
        desk = Desk()
        Watch(simulation, desk).show(0.0)
    still, _ = page_packets.unpack(desk.stills[-1])
    assert still["tank"] and still["plates"] == 1 and np.shape(still["zones"]) == (1, 2, 3)
    assert not still["ships"][0]["steered"]
    _, arrays = page_packets.unpack(desk.frames[-1])
    names = [scalar["name"] for scalar in still["scalars"]]
    assert arrays["scalars"][names.index("height")] < 0.05


def test_particles_are_boxed_in_the_kernel_as_the_protocol_boxes_them(session):
    particles = session.simulation.fluid.particles
    low, high = np.array([-5.0, -8.0, -30.0]), np.array([20.0, 2.0, 20.0])  # so that some lie outside
    rows = particles.in_box(*p.box_scale(low, high), p.FULL_SCALE, 1)
    places, speed = rows[:, :3].astype(np.int16), rows[:, 3]
    order = particles.id.to_numpy()
    positions, velocities = (np.empty((particles.n, 3)) for _ in range(2))
    positions[order], velocities[order] = particles.position.to_numpy(), particles.velocity.to_numpy()
    assert np.array_equal(places, p.box_positions(positions, low, high))
    assert speed == pytest.approx(np.linalg.norm(velocities, axis=1), abs=1e-12)
    assert np.array_equal(particles.in_box(*p.box_scale(low, high), p.FULL_SCALE, 3), rows[::3])


def test_play_step_and_pause(session):
    simulation = session.simulation
    before = simulation.steps
    session.advance(0.02)
    assert simulation.steps == before
    ask(session, do="step")
    session.advance(0.02)
    assert simulation.steps == before + 1 and session.paused
    ask(session, do="play")
    session.advance(0.02)
    ask(session, do="pause")
    assert simulation.steps > before + 1


def test_a_page_that_opens_late_is_told_where_the_ship_was(session):
    """For her wake; also while nobody watches."""
    session.server.watchers = 0
    for _ in range(3):
        session.simulation.run(session.simulation.time + 0.3)
    session.server.watchers, session.server.fresh = 1, True
    session.watch.show(0.0)
    session.server.fresh = False
    head, arrays = page_packets.unpack(session.server.frames[-1])
    times, poses = arrays["trail"][:, 0], arrays["trail"][:, 1:]
    assert (np.diff(times) >= 0.25 - 1e-5).all() and head["time"] - 0.3 <= times[-1] <= head["time"] + 1e-5
    assert poses.shape == (len(times), 7) and poses[-1, :3] == pytest.approx(arrays["poses"][0, :3], abs=1.0)
    assert np.linalg.norm(poses[:, 3:], axis=1) == pytest.approx(np.ones(len(times)), abs=1e-5)


def test_frames_go_on_while_no_page_is_open_but_rarely(lake, monkeypatch):
    """For the last minute of a page that opens late."""
    clock, desk = [lake.watch.last], lake.server
    monkeypatch.setattr("ocean_sim.viewer.watch.perf_counter", lambda: clock[0])

    def frames_of_ten_seconds():
        before = len(desk.frames)
        for _ in range(1000):
            clock[0] += 0.01
            lake.watch.observe(lake.simulation)
        return len(desk.frames) - before

    desk.fresh = False
    assert 150 < frames_of_ten_seconds() <= 200
    desk.watchers = 0
    assert 30 < frames_of_ten_seconds() <= 40


def test_the_first_step_waits_for_a_page(lake):
    lake.paused, lake.server.watchers = False, 0
    lake.advance(0.1)
    assert lake.simulation.steps == 0
    lake.server.watchers = 1
    lake.advance(0.1)
    lake.server.watchers, steps = 0, lake.simulation.steps
    lake.advance(0.1)
    assert 0 < steps < lake.simulation.steps  # it goes on without one


def test_a_scene_stops_at_its_duration_and_play_goes_on(lake):
    ask(lake, do="play")
    for _ in range(1000):
        lake.advance(0.1)
        if lake.paused:
            break
    assert lake.simulation.time == pytest.approx(2.0, abs=0.05) and lake.server.last("panel")["paused"]
    assert "ends at 2 s" in lake.server.last("said")["text"]
    ask(lake, do="play")
    lake.advance(0.1)
    assert not lake.paused and lake.simulation.time > 2.05


def test_waves_in_closed_form_change_while_they_run(lake):
    """Height, period and heading; the height at the origin, where the phases go on, does not jump."""
    fluid = lake.simulation.fluid
    while lake.simulation.time < 1.0:
        lake.step()
    origin = np.zeros((1, 2))
    before, frames = fluid.elevations(origin)[0], len(lake.server.frames)
    ask(lake, do="slide", key="wave heading [deg]", value=90.0)
    ask(lake, do="slide", key="wave period [s]", value=2.0)
    assert len(lake.server.frames) == frames + 2  # also while it is paused
    assert fluid.elevations(origin)[0] == pytest.approx(before, abs=1e-9)
    ask(lake, do="slide", key="wave height [m]", value=0.4)
    assert fluid.elevations(origin)[0] == pytest.approx(2.0 * before, abs=1e-9)
    sea = fluid.plane_waves
    assert (sea.heading_deg, sea.period) == (pytest.approx(90.0), pytest.approx(2.0))
    ((amplitude, x, z, omega, _),) = lake.server.last("panel")["sea"]["waves"]
    assert amplitude == pytest.approx(0.2) and z == pytest.approx(0.0, abs=1e-9) and omega == pytest.approx(np.pi)
    assert x == pytest.approx(wavenumber(np.pi, 7.5), rel=1e-6)


def test_a_slider_reaches_the_running_simulation_and_the_newest_counts(session):
    label = next(s["label"] for s in session.server.last("panel")["sliders"] if "stiffness" in s["label"])
    now = session.simulation.fluid.stiffness
    for factor in (3.0, 2.0, 1.5):
        session.server.waiting.append(Order(1, p.Slide(do="slide", key=label, value=factor * now)))
    built = len(session.server.stills)
    session.obey()
    assert session.simulation.fluid.stiffness == pytest.approx(1.5 * now) and len(session.server.stills) == built
    ask(session, do="slide", key="no such thing", value=1.0)
    assert "no slider" in session.server.last("said")["text"]


def test_a_person_steers_and_a_route_is_sailed(session):
    ship = session.simulation.ships["ship"]
    ask(session, do="steer", ship="ship", throttle=0.5, rudder=9.0 / 10.0)
    assert session.persons["ship"].throttle == 0.5 and session.persons["ship"].rudder < 0.9  # held at its limit
    x, _, z = ship.body.position
    ask(session, do="route", ship="ship", points=[[x, z + 1.0], [x + 40.0, z]], speed=2.5)
    assert session.server.last("panel")["ships"][0]["route"] == [[x, z + 1.0], [x + 40.0, z]]
    pilot = session.pilots["ship"]
    assert pilot.config.speed == 2.5 and pilot.near == np.ptp(ship.drawn()[0][:, 2])  # her length
    throttle, rudder = pilot.order(ship.actuators.time + 0.1, ship.body)
    session.follow_routes()
    assert session.server.last("panel")["ships"][0]["route"] == [[x + 40.0, z]]  # she is at the first
    assert throttle > 0.0 and rudder != 0.0
    ask(session, do="steer", ship="ship", throttle=0.2, rudder=0.0)
    assert session.server.last("panel")["ships"][0]["route"] == [] and session.persons["ship"].throttle == 0.2
    ask(session, do="steer", ship="ghost", throttle=0.0, rudder=0.0)
    assert "no ship" in session.server.last("said")["text"]


def test_a_wrong_scene_is_told_at_its_lines_and_the_other_goes_on(session):
    text = session.source.text.replace("depth: 7.5", "depth: -1.0").replace("wind: wide", "wind: wid")
    steps = session.simulation.steps
    for do, notices in (("check", 0), ("apply", 1)):  # while a text is written nothing pops up over the page
        said = len(session.server.told)
        ask(session, do=do, text=text)
        assert [message.get("bad") for message in session.server.told[said:]].count(True) == notices
        problems = session.server.last("problems")["problems"]
        assert [row["line"] for row in problems] == [5, 7] and "did you mean 'wide'" in problems[1]["message"]
    assert session.simulation.steps == steps
    ask(session, do="check", text=session.source.text)
    assert session.server.last("problems")["problems"] == []


LARGE = [
    {"do": "apply", "text": LAKE.replace("period: 4.0", "period: 4.5")},
    {"do": "change", "key": "seed", "value": "9"},
    {"do": "open", "name": "showcase"},
    {"do": "record"},
]


@pytest.mark.parametrize("order", LARGE, ids=[order["do"] for order in LARGE])
def test_a_scene_that_is_too_large_is_told_in_a_sentence_and_the_other_goes_on(lake, monkeypatch, order):
    playing, before, sliders = lake.simulation, lake.source, lake.sliders
    lake.step()
    monkeypatch.setattr("ocean_sim.machine.available_memory", lambda: 100_000_000)
    ask(lake, **order)
    said = lake.server.last("said")
    assert said["bad"] and "GB of memory, and 0.1 GB are left" in said["text"] and "\n" not in said["text"]
    lake.step()
    assert lake.simulation is playing and playing.steps == 2 and len(lake.server.stills) == 1
    assert lake.source is before and lake.sliders is sliders and lake.claim is None


@pytest.mark.parametrize("failure", [MemoryError(), OSError(28, "No space left on device"), ValueError("a reason")])
@pytest.mark.parametrize("order", [{"do": "change", "key": "seed", "value": "11"}, {"do": "reset"}, {"do": "record"}])
def test_what_cannot_be_built_is_told_and_the_other_begins_again(lake, monkeypatch, order, failure):
    seed, build, built = lake.config.seed, Simulation.build, []

    def fails_once(simulation, *given):
        built.append(simulation)
        if len(built) == 1:
            raise failure
        build(simulation, *given)

    monkeypatch.setattr(Simulation, "build", fails_once)
    ask(lake, **order)
    said = lake.server.last("said")
    assert said["bad"] and said["text"] == in_words(failure)
    assert lake.config.seed == seed and lake.simulation.steps == 0 and lake.claim is None
    lake.step()
    assert lake.simulation.steps == 1 and lake.simulation is built[1]


def test_a_record_that_cannot_be_written_ends_and_the_scene_begins_again(lake):
    ask(lake, do="record")
    folder = lake.claim.folder
    shutil.rmtree(folder)
    folder.write_text("a file where a folder was")
    lake.speed = 0.0
    for _ in range(10):
        lake.advance(0.05)
    assert (
        lake.claim is None and "the record ends" in lake.server.last("said")["text"] and lake.server.last("said")["bad"]
    )
    lake.step()
    assert lake.simulation.steps == 1


def test_a_key_builds_anew_and_what_a_person_set_is_kept(session):
    label = next(s.label for s in session.sliders if "strength" in s.label)
    ask(session, do="slide", key=label, value=2.0)
    ask(session, do="change", key="seed", value="8")
    assert session.simulation.steps == 0 and session.config.seed == 8
    assert next(s.value for s in session.sliders if s.label == label) == 2.0
    ask(session, do="change", key="fluid.spacing", value="-3.0")
    assert session.config.fluid.spacing == 2.5
    assert "not greater than 0" in session.server.last("problems")["problems"][0]["message"]


def test_what_is_saved_is_the_scene_that_is_played(session):
    ask(session, do="save", name="mine")
    saved = load(session.out / "mine.yaml")
    assert saved.fluid == session.config.fluid and saved.wind == session.config.wind
    ask(session, do="save", name="mine")
    assert "such a file already" in session.server.last("said")["text"]


def test_every_key_has_its_unit_and_range():
    found = {row["key"]: row for row in key_table(load("showcase"))}
    spacing = found["fluid.spacing"]
    assert (spacing["unit"], spacing["range"]) == ("m", "> 0") and spacing["meaning"]
    assert found["seed"]["range"] == ">= 0, < 2147483648"
    assert {"seed", "duration", "basin.depth", "runtime.threads", "time_step.courant_number"} <= set(found)
    assert found["runtime.precision"]["choices"] == ("f32", "f64") and found["wind.frame"]["value"] is None
    assert not any(key.endswith("kind") for key in found)


def test_keys_of_several_ships_are_those_of_their_kind():
    found = {row["key"]: row for row in key_table(load("gallery/two_ships"))}
    assert found["ships.moored.heading_deg"]["unit"] == "deg" and found["ships.tug.heading_deg"]["meaning"]


@pytest.mark.slow
def test_a_record_is_a_run_folder_that_replays(session, tmp_path):
    ask(session, do="change", key="duration", value="0.6")
    ask(session, do="record")
    session.speed = 0.0
    folder = session.claim.folder
    ask(session, do="steer", ship="ship", throttle=1.0, rudder=0.1)
    while session.claim is not None:
        session.advance(0.05)
    run = Recorded(folder)
    head, arrays = page_packets.unpack(run.stream())
    heights = page_packets.summed(arrays["height"]).astype(float) * head["arrays"][0]["high"] / p.FULL_SCALE
    with np.load(run.files[-1]) as frame:
        assert np.abs(heights[-1].reshape(16, 16) - frame["elevation"]).max() < 1e-3
    assert "throttle 1" in (folder / "touched.txt").read_text()
    page = replay_file([folder, folder], tmp_path / "both.html")
    assert page.stat().st_size < 4e6


def test_what_is_no_run_is_refused(tmp_path):
    with pytest.raises(Refused, match="not a run folder"):
        Recorded(tmp_path)


RIG = """
duration: 60.0
basin: {length: 400.0, width: 400.0, depth: 50.0, walls: none}
fluid: {kind: linear_waves, height: 0.5, period: 6.0, heading_deg: 150.0}
ship: {kind: dynamic, hull: yacht, cells_per_draught: 3.0}
platform: {kind: hexapod, geometry: hexapod_a, washout: ship}
"""


def rig(tmp_path, more=""):
    path = tmp_path / "rig.yaml"
    path.write_text(RIG + more)
    return Source.of(str(path), None, {"runtime.threads": 1, "runtime.precision": "f64"})


def test_who_steers_in_the_page_rides_on_the_platform(tmp_path):
    """A scene that names `stream` sends its poses while a person has the helm; else nothing is sent, and the page alone
    shows the platform."""
    came = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        listening.settimeout(0.5)

        def listen():
            with suppress(OSError):
                while True:
                    with suppress(TimeoutError):
                        came.append(packets.unpack(listening.recv(2048)))

        threading.Thread(target=listen, daemon=True).start()
        more = f"stream: {{to: 'udp://127.0.0.1:{listening.getsockname()[1]}'}}\n"
        with Session(rig(tmp_path, more), Desk(), tmp_path, list) as one:
            ask(one, do="steer", ship="ship", throttle=1.0, rudder=0.3)
            while one.simulation.time < 0.5:
                one.step()
            assert one.simulation.ships["ship"].orders[1] > 0.0
            assert {"stream", "platform_log"} <= parts_of(one)
        wait_for("the pose at rest", lambda: came and came[-1].time > 1.0 and not any(came[-1].pose))
    assert came[0].seq == 0 and len(came[0].legs) == 6 and any(any(each.pose) for each in came)
    assert not any(came[-1].pose)  # it ends at neutral
    with Session(rig(tmp_path), Desk(), tmp_path, list) as one:
        while one.simulation.time < 0.5:
            one.step()
        assert "stream" not in parts_of(one) and one.watch.commands[:6].any()


def parts_of(session):
    """The kinds of observer that play along."""
    return {type(each).__module__.rpartition(".")[2] for each in session.simulation.observers}


def test_the_water_is_asked_over_the_socket_with_the_verbs_of_a_wave_field(tmp_path):
    """For any time where it is the sum of its waves; the answers are those of the formulae."""
    source = rig(tmp_path)
    field = wave_field(load(tmp_path / "rig.yaml", source.overrides))
    with Session(source, Desk(), tmp_path, list) as one:

        def told(**asked):
            ask(one, do="waves", **asked)
            return one.server.last("waves")

        found = told(verb="elevation", id=7, points=[[0.0, 0.0], [10.0, -4.0]], time=30.0)
        assert found["id"] == 7 and found["time"] == 30.0
        np.testing.assert_allclose(found["values"], field.elevation([[0.0, 0.0], [10.0, -4.0]], 30.0), atol=1e-6)
        normal = told(verb="normal", points=[[10.0, -4.0]], time=30.0)["values"]
        np.testing.assert_allclose(normal, field.normal([[10.0, -4.0]], 30.0), atol=1e-6)
        moved = told(verb="velocity", points=[[10.0, -1.0, -4.0]], time=30.0)["values"]
        np.testing.assert_allclose(moved, field.velocity([[10.0, -1.0, -4.0]], 30.0), atol=1e-6)
        square = np.array(told(verb="field", cells=16, side=80.0, time=30.0)["values"])
        np.testing.assert_allclose(square, field.field(16, 80.0, 30.0), atol=1e-6)
        assert "at points of x, y, z" in told(verb="velocity", points=[[0.0, 0.0]])["error"]
        assert not one.persons  # it needs no helm and changes nothing


def test_particles_answer_for_now(session):
    ask(session, do="waves", verb="elevation", points=[[0.0, 0.0], [1e6, 0.0]])
    heights = session.server.last("waves")["values"]
    assert abs(heights[0]) < 2.0 and session.server.last("waves")["time"] == session.simulation.time
    ask(session, do="waves", verb="normal", points=[[0.0, 0.0]])
    assert np.linalg.norm(session.server.last("waves")["values"][0]) == pytest.approx(1.0, abs=1e-5)
    for more in ({"time": 3.0, "points": [[0.0, 0.0]], "verb": "elevation"}, {"verb": "field"}):
        ask(session, do="waves", **more)
        assert "plane waves" in session.server.last("waves")["error"]


def test_a_platform_stands_in_neutral_before_its_first_row(tmp_path):
    """And not folded up on its base, with legs of no length."""
    with Session(rig(tmp_path), Desk(), tmp_path, list) as one:
        commands = one.watch.commands
        assert not commands[:6].any() and commands[6:].min() > 0.1  # [m]
        np.testing.assert_allclose(commands[6:], one.simulation.scene.platform.build(0.02).neutral_legs, rtol=1e-6)
