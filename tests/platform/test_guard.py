"""A platform that trusts no network: what counts as a packet, and legs that keep their limits whatever comes."""

import threading
from random import Random

import numpy as np
import pytest

from ocean_sim.files.input_file import Unreadable
from ocean_sim.platform.shared.datagrams import COMMAND_INTERVAL, Receiver, Sender, preset_geometry, read_key
from ocean_sim.platform.shared.packets import POSE_STRUCT, Packet, pack, parse_report, sign, stop_packet, unpack
from tests.platform.conftest import Receiving

HEXAPOD, HERE, THERE = preset_geometry("hexapod_a"), ("10.0.0.1", 1000), ("10.0.0.2", 1000)
KEY_RULE = b"a key that nobody else has"


def data(seq: int, pose=(0.0,) * 6, every: float = 0.01, frame: str = "flu", moment: float | None = None) -> bytes:
    return pack(Packet(seq, seq * every if moment is None else moment, frame, tuple(pose), (2.7,) * 6, 0), "ocean_sim")


def swinging(seq: int, every: float = 0.01) -> bytes:
    """Heave and roll of a ship."""
    phase = 2.0 * np.pi * 0.2 * seq * every
    return data(seq, (0.0, 0.0, 0.2 * np.sin(phase), 0.1 * np.sin(phase), 0.0, 0.0), every)


class Watched:
    """A receiver whose legs are watched: their worst speed and acceleration, and how far they come."""

    def __init__(self, **options) -> None:
        self.receiver, self.last, self.speeds = Receiver(HEXAPOD, **options), None, np.zeros((1, 6))
        self.fastest = self.hardest = 0.0
        self.shortest, self.longest = np.inf, 0.0

    def advance(self, now: float) -> None:
        lengths, speeds = self.receiver.advance(now)
        if len(lengths):
            assert np.isfinite(lengths).all()
            self.fastest = max(self.fastest, np.abs(speeds).max())
            turned = np.diff(np.vstack([self.speeds[-1:], speeds]), axis=0) / COMMAND_INTERVAL
            self.hardest, self.speeds, self.last = max(self.hardest, np.abs(turned).max()), speeds, lengths[-1]
            self.shortest, self.longest = min(self.shortest, lengths.min()), max(self.longest, lengths.max())

    def kept_its_limits(self) -> bool:
        fast = self.fastest <= HEXAPOD.leg_speed * (1.0 + 1e-9)
        hard = self.hardest <= HEXAPOD.leg_acceleration * (1.0 + 1e-6)
        return fast and hard and HEXAPOD.shortest <= self.shortest and self.longest <= HEXAPOD.longest

    def until(self, now: float, packets, source=HERE) -> None:
        """What comes before `now` [s], 100 packets a second."""
        for seq in packets:
            self.receiver.accept_datagram(swinging(seq), source, 0.01 * seq)
            self.advance(0.01 * seq)
        for moment in np.arange(self.receiver.commanded, now, 0.5):
            self.advance(moment)
        self.advance(now)


def test_what_is_not_a_number_does_not_count():
    """It used to leave a pose that is not a number for ever, after 0.1 s of silence."""
    watched = Watched()
    watched.until(4.0, range(400))
    for spot in range(8, POSE_STRUCT.size, 8):
        broken = bytearray(swinging(400))
        broken[spot : spot + 8] = np.array([[np.nan], [np.inf]][spot % 16 // 8]).tobytes()
        if spot >= 16:
            with pytest.raises(ValueError, match="not a number"):
                unpack(bytes(broken))
            assert watched.receiver.accept_datagram(bytes(broken), HERE, 4.0) is None
    assert watched.receiver.strange == 13
    for seq in range(420, 900):
        watched.receiver.accept_datagram(swinging(seq), HERE, 0.01 * seq)
        watched.advance(0.01 * seq)
    assert np.isfinite(watched.receiver.pose(9.0)).all() and watched.kept_its_limits()
    assert watched.receiver.pose(8.99)[2] == pytest.approx(0.2 * np.sin(0.4 * np.pi * 8.98), abs=2e-3)


@pytest.mark.parametrize("leap", [(0.0, 0.0, 5.0, 0.0, 0.0, 0.0), (0.3, 0.0, 0.0, 0.0, 0.0, 0.0)])
def test_a_leap_is_not_followed(leap):
    """5 m in 10 ms, which no leg reaches, and 0.3 m, which it does not reach so soon."""
    watched, alone = Watched(), Watched()
    for seq in range(1000):
        for each in (watched, alone):
            each.receiver.accept_datagram(swinging(seq), HERE, 0.01 * seq)
        if seq % 10 == 5:
            watched.receiver.accept_datagram(data(seq + 1, leap), HERE, 0.01 * seq + 0.001)
        for each in (watched, alone):
            each.advance(0.01 * seq)
    assert watched.receiver.implausible == 100 and watched.receiver.came == alone.receiver.came == 1000
    np.testing.assert_array_equal(watched.last, alone.last)
    assert watched.kept_its_limits()


def test_a_clock_that_runs_ahead_gives_no_leave_to_leap():
    watched = Watched()
    watched.until(4.0, range(400))
    assert watched.receiver.accept_datagram(data(400, (0.3, 0, 0, 0, 0, 0), moment=100.0), HERE, 4.0) is None
    assert watched.receiver.implausible == 1


def test_a_stream_comes_from_one_source_until_the_platform_is_home():
    watched = Watched(home=1.0, ramp=1.0)
    watched.until(4.0, range(400))
    assert watched.receiver.accept_datagram(swinging(401), THERE, 4.0) is None and watched.receiver.foreign == 1
    assert watched.receiver.accept_datagram(swinging(401), THERE, 5.0) is None and watched.receiver.foreign == 2
    watched.until(6.5, ())
    np.testing.assert_allclose(watched.last, watched.receiver.hexapod.neutral_legs, atol=1e-9)
    assert watched.receiver.accept_datagram(swinging(0), THERE, 6.5) is not None


def test_in_silence_it_brakes_then_goes_home_and_returns_within_its_limits():
    watched = Watched(home=1.0, ramp=2.0)
    watched.until(3.3, range(321))
    held = watched.receiver.pose(3.3)
    watched.until(4.1, ())
    np.testing.assert_array_equal(watched.receiver.pose(4.1), held)
    assert np.abs(held).max() > 0.05 and np.abs(watched.speeds[-1]).max() < 1e-9
    watched.until(6.6, ())
    np.testing.assert_allclose(watched.last, watched.receiver.hexapod.neutral_legs, atol=1e-9)
    for seq in range(700, 1200):
        watched.receiver.accept_datagram(swinging(seq), HERE, 0.01 * seq)
        watched.advance(0.01 * seq)
    assert watched.receiver.stalls == 1 and watched.kept_its_limits()
    assert watched.receiver.pose(11.99)[2] == pytest.approx(0.2 * np.sin(0.4 * np.pi * 11.98), abs=2e-3)


def test_a_key_keeps_strangers_and_yesterdays_packets_out(tmp_path):
    watched, other = Watched(key=KEY_RULE), b"another key of some length"
    assert watched.receiver.accept_datagram(swinging(0), HERE, 0.0) is None
    assert watched.receiver.accept_datagram(sign(swinging(0), other, 5), HERE, 0.0) is None
    heard = [sign(swinging(seq), KEY_RULE, 5) for seq in range(100)]
    for seq, each in enumerate(heard):
        assert watched.receiver.accept_datagram(each, HERE, 0.01 * seq) is not None
    for bit in range(0, 8 * len(heard[0]), 37):
        broken = bytearray(sign(swinging(100), KEY_RULE, 5))
        broken[bit // 8] ^= 1 << bit % 8
        assert watched.receiver.accept_datagram(bytes(broken), HERE, 1.0) is None
    assert all(watched.receiver.accept_datagram(each, HERE, 60.0) is None for each in heard)  # played again, in silence
    assert watched.receiver.accept_datagram(sign(swinging(0), KEY_RULE, 4), HERE, 60.0) is None
    assert watched.receiver.accept_datagram(sign(swinging(0), KEY_RULE, 6), HERE, 60.0) is not None
    (tmp_path / "key").write_bytes(KEY_RULE + b"\n")
    (tmp_path / "short").write_bytes(b"short")
    assert read_key(str(tmp_path / "key")) == KEY_RULE
    with pytest.raises(Unreadable, match="a key has 16 to 4096 bytes"):
        read_key(str(tmp_path / "short"))
    with pytest.raises(ValueError, match="no place for a signature"):
        Sender("udp://127.0.0.1:9", "openmotionsim", KEY_RULE)


def test_frames_are_understood():
    """Up is -z in NED: what was asked for is what the legs do."""
    one, other = Receiver(HEXAPOD), Receiver(HEXAPOD)
    one.accept_datagram(data(0, (0.1, 0.2, 0.3, 0.01, 0.02, 0.03)), HERE, 0.0)
    other.accept_datagram(data(0, (0.1, -0.2, -0.3, 0.01, -0.02, -0.03), frame="ned"), HERE, 0.0)
    np.testing.assert_allclose(other.pose(9.0), one.pose(9.0), atol=1e-12)


def test_garbage_does_not_outlive_patience():
    """A stream that ends, and garbage that goes on: the receiver says so after its patience."""
    receiving, over = Receiving(patience=1.5, key=KEY_RULE), threading.Event()
    sender = Sender(receiving.url, key=KEY_RULE)

    def shout() -> None:
        while not over.wait(0.01):
            sender.socket.sendto(b"garbage", sender.address)

    noise = threading.Thread(target=shout)
    noise.start()
    for seq in range(20):
        sender.send(unpack(swinging(seq)))
    receiving.thread.join(30.0)
    alive, seen = receiving.thread.is_alive(), receiving.platform
    over.set()
    noise.join()
    sender.close()
    assert not alive and seen.came == 20 and seen.strange > 10


@pytest.mark.parametrize("count", [5_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("key", [b"", KEY_RULE])
def test_no_packet_moves_the_legs_beyond_their_limits(count, key):
    """Noise, turned bits, leaps, lies about time and order, silences and strangers around a sound stream."""
    dice, numbers = Random(7), np.random.default_rng(7)
    watched, now, seq = Watched(key=key, home=0.5, ramp=0.5), 0.0, 0
    for _ in range(count):
        now += dice.choice([0.0005, 0.001, 0.002]) if dice.random() < 0.9995 else dice.uniform(0.1, 3.0)
        way, source = dice.random(), HERE if dice.random() < 0.95 else THERE
        if way < 0.3:
            seq = max(seq + 1, int(now / 0.01))
            sent = swinging(seq)
        elif way < 0.4:
            sent = dice.randbytes(dice.choice([0, 20, 119, 120, 121, 160, 1500]))
        elif way < 0.6:
            bits = bytearray(swinging(seq + 1))
            for _ in range(dice.randint(1, 3)):
                bits[dice.randrange(len(bits))] ^= 1 << dice.randrange(8)
            sent = bytes(bits)
        else:
            pose = numbers.normal(size=6) * dice.choice([1e-3, 0.01, 0.1, 1.0, 1e300])
            moment = dice.choice([seq * 0.01, now, dice.uniform(-1e3, 1e6), 1e308])
            sent = data((seq + dice.choice([-50, 0, 1, 2, 2**31])) % 2**32, pose, moment=moment)
        if key and dice.random() < 0.9:  # so that most get past the signature
            sent = sign(sent, key, dice.choice([1, 1, 1, int(now)]))
        watched.receiver.accept_datagram(sent, source, now)
        watched.advance(now)
    assert watched.kept_its_limits() and watched.receiver.came > 0.001 * count
    told = (watched.receiver.strange, watched.receiver.foreign, watched.receiver.implausible)
    print(f"{count} packets: {watched.receiver.came} counted; strange, from elsewhere, implausible: {told}")


@pytest.mark.parametrize("key", [b"", KEY_RULE])
def test_a_stop_brakes_within_the_limits_and_is_latched(key):
    watched = Watched(key=key)
    told = (lambda raw: sign(raw, key, 1)) if key else (lambda raw: raw)

    def moving(first, last):
        for seq in range(first, last):
            watched.receiver.accept_datagram(told(swinging(seq)), HERE, 0.01 * seq)
            watched.advance(0.01 * seq)

    moving(0, 520)
    speed = np.abs(watched.speeds[-1]).max()
    if key:
        assert (
            watched.receiver.accept_datagram(stop_packet(), THERE, 5.2) is None and watched.receiver.glide is None
        )  # not signed
    watched.receiver.accept_datagram(stop_packet(key, 2), THERE, 5.2)
    moving(521, 620)  # the stream goes on, the platform does not
    at_rest = watched.last
    moving(620, 700)
    assert speed > 0.1 and np.abs(watched.last - at_rest).max() < 1e-4 and watched.kept_its_limits()
    assert parse_report(watched.receiver.report()).stopped
