"""Recordings, by the reader of those who made the format."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

coapt = pytest.importorskip("coapt")
mcap_reader = pytest.importorskip("mcap.reader")
mcap_protobuf = pytest.importorskip("mcap_protobuf.decoder")

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

from test_process import INTERRUPTED, run  # noqa: E402
from vtp_reader import read_vtp  # noqa: E402


def decoded(path: Path) -> tuple[object, dict[str, list[tuple[int, object]]]]:
    """The summary of a recording and its messages by topic, every checksum compared."""
    messages: dict[str, list[tuple[int, object]]] = {}
    with path.open("rb") as file:
        factories = [mcap_protobuf.DecoderFactory()]
        reader = mcap_reader.make_reader(file, validate_crcs=True, decoder_factories=factories)
        summary = reader.get_summary()
        for _, channel, message in reader.iter_messages():
            if channel.message_encoding == "json":
                messages.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
        for _, channel, message, update in reader.iter_decoded_messages(
            topics=[channel.topic for channel in summary.channels.values() if channel.message_encoding == "protobuf"]
        ):
            messages.setdefault(channel.topic, []).append((message.log_time, update))
    return summary, messages


def entity(update, name):
    return next(entity for entity in update.entities if entity.id == name)


def points(list_of_points) -> np.ndarray:
    return np.array([[point.x, point.y, point.z] for point in list_of_points])


def test_the_official_reader_finds_what_was_filmed(tmp_path):
    done = coapt.closure(coapt.generate("dilated", faces=300), coapt.Ring.physio_like(30))
    done.record(tmp_path / "closing.mcap", frames=7)
    done.write(tmp_path / "out")
    summary, messages = decoded(tmp_path / "closing.mcap")

    kinds = {channel.topic: (channel.message_encoding, summary.schemas[channel.schema_id]) for channel in summary.channels.values()}
    for stage in ("before", "after"):
        assert kinds[f"/{stage}/valve"][0] == kinds[f"/{stage}/supports"][0] == "protobuf"
        assert kinds[f"/{stage}/valve"][1].name == "foxglove.SceneUpdate"
        assert kinds[f"/{stage}/figures"][0] == "json"
        assert kinds[f"/{stage}/figures"][1].encoding == "jsonschema"
    assert len(kinds) == 6
    assert summary.statistics.attachment_count == 2
    assert {index.compression for index in summary.chunk_indexes} == {"lz4"}

    for stage, closed in (("before", done.before), ("after", done.after)):
        frames = messages[f"/{stage}/valve"]
        assert len(frames) == len(messages[f"/{stage}/figures"]) == 7
        # Two seconds, evenly.
        assert [time for time, _ in frames] == [2_000_000_000 * number // 6 for number in range(7)]
        last = frames[-1][1]
        leaflets = entity(last, "leaflets").triangles[0]
        filmed = points(leaflets.points)
        surface = read_vtp(tmp_path / "out" / stage / "closed.vtp")
        assert filmed.tobytes() == np.ascontiguousarray(surface.points).tobytes()
        assert np.array_equal(np.reshape(leaflets.indices, (-1, 3)), closed.triangles)
        assert len(leaflets.colors) == len(filmed)
        ends, segments = closed.chords
        assert points(entity(last, "chordae").lines[0].points).tobytes() == ends[segments].reshape(-1, 3).tobytes()
        touching = points(sphere.pose.position for sphere in entity(last, "contact").spheres)
        assert touching.tobytes() == filmed[closed.in_contact].tobytes()
        _, figures = messages[f"/{stage}/figures"][-1]
        assert figures["coaptation_area_mm2"] == closed.coaptation.area_mm2
        assert figures["orifice_area_mm2"] == closed.orifice.area_mm2
        assert figures["residual"] == closed.certificate.residual
        pressures = [figures["pressure_mmhg"] for _, figures in messages[f"/{stage}/figures"]]
        assert pressures[0] == 0 and pressures == sorted(pressures) and abs(pressures[-1] - 100) < 1e-9
        assert len(messages[f"/{stage}/supports"]) == 1
    assert len(entity(messages["/after/supports"][0][1], "ring").lines) == 1
    assert len(entity(messages["/before/supports"][0][1], "ring").lines) == 0


def test_a_film_of_two_seconds_at_sixty_a_second_is_small(tmp_path):
    """120 frames of 650 triangles: 5 MB was asked for, 2.2 MB it is, of which 1.1 MB are coordinates of the leaflets."""
    coapt.generate("healthy", faces=650).close().record(tmp_path / "closing.mcap", frames=120)
    assert (tmp_path / "closing.mcap").stat().st_size < 3e6


def test_program_and_package_record_the_same_bytes(program, tmp_path):
    scene = tmp_path / "scene"
    subprocess.run([program, "generate", "flail", "--set", "faces=160", "--out", scene], check=True, capture_output=True)
    plan = tmp_path / "plan.toml"
    plan.write_text('schema_version = 1\n[[repair]]\nkind = "clip"\nsite = "A2P2"\nsize = "long"\n')
    record = ["--record", tmp_path / "program.mcap", "--frames", "5"]
    done = subprocess.run([program, "closure", scene, "--plan", plan, *record], check=False, capture_output=True)
    assert done.returncode in (0, 3), done.stderr
    valve = coapt.load(scene)
    coapt.closure(valve, coapt.Clip(site="A2P2", size="long")).record(tmp_path / "package.mcap", frames=5)
    assert (tmp_path / "program.mcap").read_bytes() == (tmp_path / "package.mcap").read_bytes()
    layouts = [(tmp_path / f"{door}.layout.json").read_bytes() for door in ("program", "package")]
    assert layouts[0] == layouts[1]


def test_a_repaired_valve_recorded_alone_is_made_again_by_the_program(program, tmp_path):
    valve = coapt.generate("dilated", faces=160).with_repair(coapt.Ring.physio_like(30))
    valve.close().record(tmp_path / "alone.mcap", frames=4)
    coapt.closure(valve, coapt.Clip(site="A2P2")).record(tmp_path / "more.mcap", frames=4)
    for name in ("alone", "more"):
        done = subprocess.run([program, "replay", tmp_path / f"{name}.mcap"], check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith("agrees: ")


def test_program_and_package_replay_alike(program, tmp_path):
    path, cut = tmp_path / "closing.mcap", tmp_path / "cut.mcap"
    coapt.generate("healthy", faces=160).close().record(path, frames=4)
    stored = path.read_bytes()
    cut.write_bytes(stored[: len(stored) // 2])
    for recording in (path, cut):
        done = subprocess.run([program, "replay", recording], check=True, capture_output=True, text=True)
        replayed = coapt.replay(recording)
        assert replayed.agrees and replayed.text() == done.stdout and list(replayed.doubts) == done.stderr.splitlines()
    whole = coapt.replay(path)
    assert (whole.frames, whole.different, whole.first, whole.farthest_mm, whole.doubts) == (4, 0, None, 0.0, ())
    with pytest.raises(coapt.InputError, match="nowhere"):
        coapt.replay("nowhere.mcap")


@pytest.mark.parametrize("frames", [1, 0, -3, 10_001])
def test_wrong_numbers_of_frames_are_told(tmp_path, frames):
    closed = coapt.generate("healthy", faces=160).close()
    with pytest.raises(ValueError, match=f"frames is {frames}; expected a number from 2 to 10000"):
        closed.record(tmp_path / "closing.mcap", frames=frames)
    with pytest.raises(OSError, match="nowhere"):
        closed.record(tmp_path / "nowhere" / "closing.mcap", frames=2)
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_stops_a_film_at_once_and_writes_nothing(tmp_path):
    path = tmp_path / "closing.mcap"
    made = "closed = coapt.generate('barlow', faces=1300).close()"
    work = f"closed.record({str(path)!r}, frames=2000)"
    assert float(run(INTERRUPTED.format(made=made, work=work))) < 0.2 + 0.3
    assert list(tmp_path.iterdir()) == []
