"""The panel without a browser: what its sliders ask for, and what comes back."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anywidget", reason="the panel needs anywidget")

import coapt  # noqa: E402
from coapt._panel import NOTHING, RANGES, Asked, Panel, answered, repairs  # noqa: E402


@pytest.fixture(scope="module")
def closed() -> coapt.Closed:
    return coapt.generate("dilated", faces=160).close()


def asked(**changes: object) -> Asked:
    return {**NOTHING, **changes}  # type: ignore[typeddict-item]


def test_untouched_sliders_do_nothing(closed: coapt.Closed) -> None:
    assert repairs(NOTHING) == []
    answer = answered(closed, NOTHING)
    assert answer["faults"] == [] and answer["certified"] is True and answer["ring"] is None
    shown = np.frombuffer(answer["positions"], dtype=np.float32).reshape(-1, 3)  # type: ignore[call-overload]
    # Single precision: a hundred thousandth of a millimetre at 100 mm.
    assert np.abs(shown - closed.positions_mm[: len(shown)]).max() < 1e-5
    assert all(row["before"] == row["after"] for row in answer["rows"])  # type: ignore[attr-defined]


def test_sliders_are_repairs() -> None:
    everything = asked(
        ring_family="physio-like",
        ring_size_mm=32,
        ring_ap_share="0.60",
        clip_site="A2P2",
        neochord_leaflet="posterior",
        neochord_length_mm=20,
    )
    assert repairs(everything) == [
        coapt.Ring(family="physio-like", size_mm=32, ap_mm=0.6 * 32),
        coapt.Clip(site="A2P2"),
        coapt.Neochord(leaflet="posterior", position=0.5, length_mm=20),
    ]
    assert repairs(asked(clip_site="position", clip_position=0.25)) == [coapt.Clip(position=0.25)]


def test_a_ring_is_the_ring_of_the_package(closed: coapt.Closed) -> None:
    panel = Panel(closed)
    panel.asked = dict(asked(id=7, ring_family="physio-like", ring_size_mm=30))
    assert panel.answer["id"] == 7 and panel.answer["ring"] is not None
    alone = closed.valve.with_repair(coapt.Ring.physio_like(30)).close()
    shown = np.frombuffer(panel.answer["positions"], dtype=np.float32).reshape(-1, 3)
    assert np.array_equal(shown, alone.positions_mm[: len(shown)].astype(np.float32))
    assert np.array_equal(panel.closed.positions_mm, alone.positions_mm)
    areas = [row for row in panel.answer["rows"] if row["name"] == "contact area"]
    assert areas[0]["after"] == alone.coaptation.area_mm2 and areas[0]["before"] == closed.coaptation.area_mm2


def test_what_cannot_be_done_is_told_and_the_old_shape_stays(closed: coapt.Closed) -> None:
    answer = answered(closed, asked(id=3, neochord_leaflet="septal"))
    assert answer["id"] == 3 and "faces" not in answer
    assert any("septal" in fault for fault in answer["faults"])  # type: ignore[attr-defined]


def test_every_slider_begins_within_its_range() -> None:
    for name, reach in RANGES.items():
        assert reach["low"] <= reach["start"] <= reach["high"], name
        assert NOTHING[name] == reach["start"]  # type: ignore[literal-required]


def test_what_is_left_out_of_a_question_is_untouched(closed: coapt.Closed) -> None:
    """As a person asks by hand: the sliders that are named, and no others."""
    panel = Panel(closed)
    panel.asked = {"ring_family": "physio-like"}
    assert panel.repairs == [coapt.Ring(family="physio-like", size_mm=RANGES["ring_size_mm"]["start"])]
    assert panel.answer["faults"] == [] and panel.answer["ring"] is not None
    panel.asked = {}
    assert panel.repairs == [] and np.array_equal(panel.closed.positions_mm, closed.positions_mm)


def test_a_slider_that_is_not_there_is_told(closed: coapt.Closed) -> None:
    panel = Panel(closed)
    panel.asked = {"id": 4, "ring_famly": "physio-like", "clip": "A2P2"}
    assert panel.answer["id"] == 4 and "faces" not in panel.answer
    with pytest.raises(coapt.InputError) as caught:
        panel.repairs  # noqa: B018
    assert [fault.found for fault in caught.value.faults] == ["has the unknown key `clip`", "has the unknown key `ring_famly`"]
    assert panel.answer["faults"] == [str(fault) for fault in caught.value.faults]
