"""The classes of repairs, tissues and settings are what the schemas say; the library takes them."""

from __future__ import annotations

import copy
import pickle
import sys
from pathlib import Path

import pytest

coapt = pytest.importorskip("coapt")

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python" / "tools"))

import plain_data  # noqa: E402


def test_nobody_has_edited_what_is_written():
    for name, text in plain_data.modules().items():
        assert (plain_data.PACKAGE / name).read_text(encoding="utf-8") == text, (
            f"{name} is not what the schemas say; run python python/tools/plain_data.py"
        )


ONE_OF_EACH = [
    coapt.Ring.physio_like(30),
    coapt.Clip(site="A2P2"),
    coapt.Alfieri(site="A2P2"),
    coapt.Neochord(leaflet="posterior", site="A2P2"),
    coapt.CutChord(group="strut"),
    coapt.TransferChord(near_mm=(0.0, -5.0, -10.0), leaflet="anterior", site="A2P2"),
    coapt.Rupture(region="P2"),
    coapt.RelocatePapillary(muscle="posteromedial", by_mm=(0.0, 0.0, 2.0)),
    coapt.CloseCleft(position=0.35, depth_mm=1.0),
    coapt.Resect(leaflet="posterior", shape="triangular", site="A2P2", cut_chords=True),
    coapt.Augment(leaflet="posterior", site="A2P2"),
]


def test_there_is_one_of_each():
    import typing

    assert {type(repair) for repair in ONE_OF_EACH} == set(typing.get_args(coapt.Repair))


@pytest.mark.parametrize("repair", ONE_OF_EACH, ids=lambda repair: type(repair).__name__)
def test_every_repair_is_carried_out_or_refused_in_words(repair):
    valve = coapt.generate("healthy", faces=300)
    try:
        repaired = valve.with_repair(repair)
    except coapt.InputError as error:
        assert error.faults[0].place.startswith("repair[0]")
        assert isinstance(repair, coapt.CloseCleft), error
        return
    assert repaired.repairs[0]["kind"] == repair.to_dict()["kind"]
    assert repaired.close().status == "converged"


@pytest.mark.parametrize("again", [copy.copy, lambda it: pickle.loads(pickle.dumps(it)), lambda it: it.replace()])
def test_copies_are_repairs_too(again):
    valve, ring = coapt.generate("healthy", faces=160), coapt.Ring.physio_like(30)
    assert valve.with_repair(again(ring)).repairs == valve.with_repair(ring).repairs


def test_a_list_that_changes_changes_no_repair():
    """A repair is read when it is made: what it tells of itself afterwards must be that."""
    groups = ["strut"]
    torn = coapt.Rupture(region="P2", groups=groups)
    groups.append("marginal")
    assert torn.groups == ("strut",)
    with pytest.raises(coapt.InputError, match="expected a list"):
        coapt.Rupture(region="P2", groups="strut")


def test_what_is_left_out_is_as_in_plans():
    (told,) = coapt.generate("healthy", faces=160).with_repair(coapt.Alfieri(site="A2P2")).repairs
    assert told == {"kind": "alfieri", "site": "A2P2", "length_mm": 8.0, "bite_mm": 2.0}


def test_data_is_frozen_comparable_and_replaced():
    ring = coapt.Ring.physio_like(30)
    assert ring == coapt.Ring(family="physio-like", size_mm=30) and hash(ring) == hash(coapt.Ring.physio_like(30))
    assert ring.replace(size_mm=32).size_mm == 32
    with pytest.raises(coapt.InputError):
        ring.replace(size_mm="32")
    with pytest.raises(TypeError):
        coapt.Ring(size=30)
