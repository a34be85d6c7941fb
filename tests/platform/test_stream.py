import socket
import threading
import time

import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim.observers import stream
from ocean_sim.platform import Commands, Cue
from ocean_sim.platform.shared import datagrams, packets
from ocean_sim.platform.shared.datagrams import Sender, SmoothPose, parse_address, receive_stream
from ocean_sim.platform.shared.packets import Packet, pack, unpack
from tests.platform.conftest import Listener, Receiving, free_port, until


def packet(seq, height=0.0, every=0.01):
    return Packet(seq, seq * every, "flu", (0.0, 0.0, height, 0.1, 0.2, 0.3), (2.7,) * 6, 0)


def test_packets_are_what_their_description_says():
    sent = Packet(7, 1.25, "ned", (1.0, 2.0, -3.0, 0.1, 0.2, 0.3), (2.1, 2.2, 2.3, 2.4, 2.5, 2.6), 9)
    data = pack(sent, "ocean_sim")
    assert len(data) == 120 and data[:8] == b"OSPF\x01\x00\x01\x00" and data[8:16] == b"\x07\0\0\0\x09\0\0\0"
    assert unpack(data) == sent
    theirs = np.frombuffer(pack(sent, "openmotionsim"), "<f4")
    np.testing.assert_allclose(theirs, [1.25, *np.degrees([0.3, 0.2, 0.1]), 3.0], rtol=1e-6)  # down is -z in NED
    for wrong in (data[:-1], b"XXXX" + data[4:], data[:4] + b"\x02\0" + data[6:]):
        with pytest.raises(ValueError):
            unpack(wrong)


def test_an_address_is_this_machine_unless_another_is_named():
    assert (
        parse_address("udp://:5005")
        == parse_address("udp://127.0.0.1:5005")
        == parse_address("127.0.0.1:5005")
        == ("127.0.0.1", 5005)
    )
    assert parse_address("udp://platform.local:99") == ("platform.local", 99)
    for wrong in (
        "tcp://127.0.0.1:5",
        "udp://127.0.0.1",
        "udp://127.0.0.1:no",
        "udp://127.0.0.1:99999",
        "",
        "udp://:0",
    ):
        with pytest.raises(ValueError, match="is not like udp://"):
            parse_address(wrong)


def test_a_host_that_nobody_knows_is_told_in_a_sentence():
    from ocean_sim.__main__ import describe_error

    with pytest.raises(OSError) as error:
        Sender("udp://nowhere.invalid:5")
    code, sentence, _ = describe_error(error.value)
    assert code == 1 and sentence.endswith(": udp://nowhere.invalid:5") and "should not happen" not in sentence


class Clock:
    """A time that goes on only when it is looked at or waited for."""

    now = 0.0

    def perf_counter(self):
        self.now += 1e-5
        return self.now

    def sleep(self, seconds):
        self.now += seconds

    def select(self, *sockets_and_seconds):
        self.sleep(sockets_and_seconds[-1])
        return [], [], []

    def time_ns(self):
        return 0


def test_a_stream_on_loopback_loses_nothing_and_keeps_its_pace():
    """100 packets a second, for a short while; the deviation is reported, and depends on who else uses the machine."""
    listener = Listener(150)
    sender = Sender(listener.url)
    for k in range(150):
        sender.send(packet(k))
    sender.close()
    assert [packet.seq for packet in listener.packets()] == list(range(150))
    jitter = sender.jitter()
    assert jitter.packets == 150 and jitter.interval > 0.0099
    assert np.median(np.diff(sender.sent)) == pytest.approx(0.01, rel=0.5)  # whoever else uses the machine
    assert "150 packets, every" in str(jitter)


def test_the_receiver_tells_what_came_and_counts():
    """The one that `python -m ocean_sim.platform.shared.datagrams` runs."""
    arrivals = []
    receiving = Receiving(arrivals.append, hold=30.0)
    sender = Sender(receiving.url)
    sender.socket.sendto(pack(packet(0), "openmotionsim"), sender.address)
    for k in (0, 1, 4, 3):
        sender.send(packet(k, every=0.0))
    sender.close()
    until(lambda: len(arrivals) == 4)
    seen = receiving.ended()
    assert (seen.came, seen.lost, seen.reordered, seen.strange, len(arrivals)) == (4, 2, 1, 1, 4)


def test_the_receiver_waits_for_a_first_packet_and_says_what_is_wrong(capsys):
    url, arrivals = f"udp://127.0.0.1:{free_port()}", []
    thread = threading.Thread(target=receive_stream, args=(url, 0.2, arrivals.append))
    thread.start()
    time.sleep(1.0)  # longer than its patience
    sender = Sender(url)
    sender.send(packet(0))
    sender.close()
    thread.join()
    assert [seen.seq for seen in arrivals] == [0]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        for wrong in ("tcp://there", f"udp://127.0.0.1:{other.getsockname()[1]}"):
            for words in ([wrong], ["stop", wrong]) if wrong.startswith("tcp") else ([wrong],):
                assert datagrams.main(words) == 2
                said = capsys.readouterr().err
                assert said.count("\n") == 1 and wrong in said


@pytest.mark.parametrize("words", [["stop"], ["udp://127.0.0.1:5005", "key", "more"], ["stop", "a", "b", "c"]])
def test_too_few_or_too_many_words_get_the_usage(words, capsys):
    assert datagrams.main(words) == 2 and "stop udp://127.0.0.1:5005 [KEYFILE]" in capsys.readouterr().err
    assert datagrams.main(["--help"]) == 0 and "stops that platform" in capsys.readouterr().out


def test_an_unknown_host_and_a_key_that_is_not_there_are_said(capsys):
    assert datagrams.main(["stop", "udp://nowhere.invalid:5"]) == 2
    assert datagrams.main(["stop", "udp://127.0.0.1:5", "no.key"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2 and "udp://nowhere.invalid:5" in said[0] and said[1] == "no.key: there is no such file"


def test_a_stream_that_begins_anew_is_followed():
    """After a silence it is no late packet of the one before; without one it is."""
    smooth = SmoothPose(hold=0.1, ramp=1.0)
    for k in range(100, 110):
        smooth.accept(packet(k, 0.3), 0.01 * k)
    smooth.accept(packet(5, 0.1), 1.095)
    assert smooth.reordered == 1 and smooth.last.seq == 109
    for k in range(300):
        smooth.accept(packet(k, 0.1), 2.0 + 0.01 * k)
    assert (smooth.reordered, smooth.lost, smooth.stalls) == (1, 0, 1)
    assert smooth.pose(2.0)[2] == pytest.approx(0.3) and smooth.pose(4.99)[2] == pytest.approx(0.1)


def test_a_sender_that_is_late_does_not_burst(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(datagrams, "time", clock)
    monkeypatch.setattr(datagrams, "select", clock.select)
    sender = Sender(f"udp://127.0.0.1:{free_port()}")
    for k in range(5):
        sender.send(packet(k))
        if k == 1:
            clock.sleep(0.1)
    sender.close()
    assert sender.jitter().longest > 0.09 and np.diff(sender.sent)[2:].min() > 0.005


def test_a_receiver_lies_on_the_line_between_packets():
    smooth = SmoothPose(ramp=0.0001)
    smooth.accept(packet(0, 0.0), 10.00)
    smooth.accept(packet(1, 1.0), 10.01)
    assert smooth.pose(10.015)[2] == pytest.approx(0.5) and smooth.pose(10.02)[2] == pytest.approx(1.0)
    smooth.accept(packet(4, 2.0), 10.02)
    smooth.accept(packet(3, 9.0), 10.03)
    assert (smooth.lost, smooth.reordered) == (2, 1) and smooth.pose(10.03)[2] == pytest.approx(2.0)


def test_on_a_stall_the_pose_holds_and_then_ramps():
    smooth, poses = SmoothPose(hold=0.1, ramp=1.0), []
    for k in range(2500):  # at 1 ms; packets every 10 ms, none from 1.0 to 1.5 s
        now = k * 0.001
        if k % 10 == 0 and not 1000 < k < 1500:
            smooth.accept(packet(k // 10, 0.1 if k <= 1000 else 0.5), now)
        poses.append(smooth.pose(now)[2])
    height = np.array(poses)
    assert smooth.stalls == 1 and np.ptp(height[1011:1500]) < 1e-12
    assert np.abs(np.diff(height)).max() < 0.002 and np.abs(np.diff(height, n=2)).max() < 2e-4
    assert height[-1] == pytest.approx(0.5, abs=1e-3) and height[1750] < 0.2


def test_a_run_streams_what_its_platform_does(tmp_path, capsys):
    from types import SimpleNamespace

    from ocean_sim.basin import Config as BasinConfig
    from ocean_sim.observers import motion
    from ocean_sim.parts import SceneFacts
    from ocean_sim.platform.hexapod import Config

    listener = Listener(130)
    tank = BasinConfig(length=9.0, width=9.0, depth=2.0).build()
    preflight = SceneFacts({"motion": motion.Config(every=0.01)}, tank, 4, 1.0)
    simulation = SimpleNamespace(scene=SimpleNamespace(platform=Config(ramp=1.0), preflight=preflight))
    observer = stream.Config(to=listener.url, frame="ned").build(tmp_path, simulation)
    pose, still = np.array([[0.1, 0.2, 0.3, 0.01, 0.02, 0.03]]), np.zeros((1, 3))
    cue = Cue(pose, np.zeros(1, dtype=int), still, still)
    for k in range(30):
        row = np.array([k * 0.01]), np.array([k]), pose, np.full((1, 6), 2.7), np.zeros((1, 6)), still, still
        observer.take_commands(Commands(*row, np.ones(1, dtype=int), cue))
    observer.close()
    seen = listener.packets()
    assert [packet.seq for packet in seen] == list(range(130)) and not any(seen[-1].pose) and seen[0].limited == 1
    np.testing.assert_allclose(seen[0].pose, [0.1, -0.2, -0.3, 0.01, -0.02, -0.03])
    assert "130 packets" in capsys.readouterr().err
    with pytest.raises(ValidationError, match="is not like udp://"):
        stream.Config(to="somewhere")


def test_the_formats_are_the_ones_offered():
    assert set(packets.FORMAT_NAMES) == set(stream.Config.model_fields["packets"].annotation.__args__)


def test_layouts_for_motion_software_are_what_their_description_says():
    sent = Packet(7, 1.25, "ship", (0.2, -0.3, 0.1, 0.1, 0.2, 0.3), (2.1,) * 6, 9)  # x is to port, z forward
    data = pack(sent, "floats")
    assert len(data) == 36 and np.frombuffer(data, "<u4")[8] == 9
    six = [100.0, 200.0, -300.0, *np.degrees([0.1, 0.2, 0.3])]
    np.testing.assert_allclose(np.frombuffer(data, "<f4")[:8], [1.25, 7.0, *six], rtol=1e-6)
    assert pack(sent, "text") == b"1.250,100.000,200.000,-300.000,5.730,11.459,17.189\n"


def test_a_platform_reports_where_its_legs_are_and_how_long_the_way_was():
    receiving = Receiving()
    sender, every = Sender(receiving.url), 0.04
    for seq in range(20):
        sender.send(packet(seq, every=every)._replace(pose=(0.0,) * 6))
    until(lambda: sender.listen() or (sender.readings and sender.readings[-1][1].seq == 19))
    found = receiving.ended()
    latency = sender.latency()
    sender.close()
    assert latency is not None and latency.packets > 15 and 0.0 < latency.median <= latency.most <= latency.longest
    assert latency.median < 0.5 * every  # a report counts when it comes, not when the next packet goes out
    np.testing.assert_allclose(sender.readings[-1][1].legs, 2.706, atol=1e-3)
    assert found.came == 20 and not sender.readings[-1][1].stopped and sender.stop_report() == ""


def test_who_sends_to_a_platform_that_is_stopped_hears_of_it(capsys):
    receiving = Receiving()
    url, sender = receiving.url, Sender(receiving.url)
    for seq in range(40):
        sender.send(packet(seq)._replace(pose=(0.0,) * 6))
        if seq == 20:
            assert datagrams.main(["stop", url]) == 0 and url in capsys.readouterr().out
    until(lambda: sender.listen() or (sender.readings and sender.readings[-1][1].stopped))
    receiving.ended()
    sender.close()
    states = [found.stopped for _, found in sender.readings]
    assert states == sorted(states) and states[0] is False and states[-1] is True
    after = next(came for came, found in sender.readings if found.stopped) - sender.sent[0]
    assert after > 0.19 and sender.stop_report() == f"the platform was stopped, {after:.2f} s after the first packet"
    assert sender.readings[-1][1].seq <= 21  # the last that counted
