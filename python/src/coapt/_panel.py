"""A panel with sliders for notebooks: needs anywidget, which is imported when a panel is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypedDict, cast, get_args

import anywidget
import numpy as np
import traitlets

from coapt._certificate import NOTICE
from coapt._closed import Closed
from coapt._errors import Fault, InputError
from coapt._repairs import Clip, Neochord, Repair, Ring
from coapt._tables import Row

RingFamily: TypeAlias = Literal["classic-like", "physio-like", "saddle", "reduced-ap", "posterior-band"]
Site: TypeAlias = Literal["A1P1", "A2P2", "A3P3"]

#: Rows of a report that a panel shows, by title and name: what changes while one moves sliders.
ROWS = (
    ("Competence", None),
    ("Coaptation", None),
    ("Tenting and billow", "tenting height"),
    ("Chordae", "all: largest tension"),
    ("Annulus", "anteroposterior diameter"),
    ("Annulus", "commissural width"),
)


class Asked(TypedDict):
    """What the sliders say. An empty word: no such repair, or the ring family's own share."""

    id: int
    ring_family: str
    ring_size_mm: float
    ring_ap_share: str
    clip_site: str
    clip_position: float
    neochord_leaflet: str
    neochord_position: float
    neochord_length_mm: float


class Range(TypedDict):
    """Where a slider goes. All are our choice, wide enough for adult valves; what a valve does not take is told."""

    low: float
    high: float
    step: float
    start: float
    unit: str


RANGES: dict[str, Range] = {
    "ring_size_mm": {"low": 20, "high": 44, "step": 0.5, "start": 30, "unit": "mm"},
    "clip_position": {"low": 0.05, "high": 0.95, "step": 0.01, "start": 0.5, "unit": ""},
    "neochord_position": {"low": 0.05, "high": 0.95, "step": 0.01, "start": 0.5, "unit": ""},
    "neochord_length_mm": {"low": 10, "high": 40, "step": 0.5, "start": 25, "unit": "mm"},
}

#: What the sliders say before anybody has moved one.
NOTHING: Asked = {
    "id": 0,
    "ring_family": "",
    "ring_size_mm": RANGES["ring_size_mm"]["start"],
    "ring_ap_share": "",
    "clip_site": "",
    "clip_position": RANGES["clip_position"]["start"],
    "neochord_leaflet": "",
    "neochord_position": RANGES["neochord_position"]["start"],
    "neochord_length_mm": RANGES["neochord_length_mm"]["start"],
}


def whole(given: Mapping[str, Any]) -> Asked:
    """What the sliders say, with what is left out as before anybody has moved one.

    Raises
    ------
    InputError
        A key that no slider has.
    """
    unknown = sorted(str(key) for key in given if key not in NOTHING)
    if unknown:
        expected = ", ".join(key for key in NOTHING if key != "id")
        raise InputError(Fault("panel.asked", f"has the unknown key `{key}`; expected some of {expected}") for key in unknown)
    return cast(Asked, {**NOTHING, **given})


def repairs(asked: Asked) -> list[Repair]:
    """The repairs that the sliders ask for.

    Raises
    ------
    InputError
        A value that a repair does not take.
    """
    wanted: list[Repair] = []
    if asked["ring_family"]:
        size_mm = asked["ring_size_mm"]
        share = asked["ring_ap_share"]
        family = cast(RingFamily, asked["ring_family"])
        wanted.append(Ring(family=family, size_mm=size_mm, ap_mm=float(share) * size_mm if share else None))
    if asked["clip_site"] == "position":
        wanted.append(Clip(position=asked["clip_position"]))
    elif asked["clip_site"]:
        wanted.append(Clip(site=cast(Site, asked["clip_site"])))
    if asked["neochord_leaflet"]:
        neochord = Neochord(
            leaflet=asked["neochord_leaflet"],
            position=asked["neochord_position"],
            length_mm=asked["neochord_length_mm"],
        )
        wanted.append(neochord)
    return wanted


def answered(before: Closed, given: Mapping[str, Any]) -> dict[str, object]:
    """The valve closed as asked for, as the panel draws it; where that cannot be carried out, why: the old shape then stays."""
    number = given.get("id", NOTHING["id"])
    try:
        wanted = repairs(whole(given))
        closed = before.valve.with_repair(*wanted).close() if wanted else before
    except InputError as error:
        return {"id": number, "faults": [str(fault) for fault in error.faults]}
    return {"id": number, "faults": [], **drawn(before, closed)}


def drawn(before: Closed, closed: Closed) -> dict[str, object]:
    """A closed valve as bytes and words."""
    valve = closed.valve
    count = valve.leaflet_vertex_count
    chord_points_mm, chord_ends = closed.chords
    native = before._native.rows(closed._native)
    has_ring = any(repair["kind"] == "ring" for repair in valve.repairs)
    # The annulus as it is sewn to the ring, closed; an open ring or a band holds a part of it.
    annulus = np.append(valve.annulus, valve.annulus[:1])
    return {
        "faces": _bytes(closed.triangles, np.uint32),
        "face_leaflet": _bytes(valve.triangle_leaflet, np.uint32),
        "positions": _bytes(closed.positions_mm[:count], np.float32),
        "gap_mm": _bytes(closed.gap_mm, np.float32),
        "strain": _bytes(closed.strain, np.float32),
        "chord_points": _bytes(chord_points_mm, np.float32),
        "chord_ends": _bytes(chord_ends, np.uint32),
        "chord_forces_n": _bytes(closed.chord_forces_n, np.float32),
        "ring": _bytes(closed.positions_mm[annulus], np.float32) if has_ring else None,
        "rows": [_row(row) for row in native if (row[0], None) in ROWS or (row[0], row[1]) in ROWS],
        "certified": closed.certified,
        "verdict": _verdict(closed),
    }


def _bytes(values: np.ndarray[Any, Any], dtype: type[np.float32] | type[np.uint32]) -> bytes:
    return np.ascontiguousarray(values, dtype=dtype).tobytes()


def _row(row: Row) -> dict[str, object]:
    _, name, unit, digits, before, after = row
    return {"name": name, "unit": unit, "digits": digits, "before": before, "after": after}


def _verdict(closed: Closed) -> str:
    if closed.certified:
        return f"certified: converged, stable, no surfaces cross; {closed.wall_ms:.0f} ms"
    return f"NOT CERTIFIED ({closed.status}): figures of such a shape are no prediction"


class Panel(anywidget.AnyWidget):
    """A valve that is closed anew as sliders move: ring family and size, clip, neochordae.

    Made by :func:`coapt.panel`. ``closed`` is the valve as it is shown, ``repairs`` what was done to it.
    """

    _esm = Path(__file__).with_name("_panel.js")
    ring_families = traitlets.List(list(get_args(RingFamily))).tag(sync=True)
    ranges = traitlets.Dict(RANGES).tag(sync=True)
    notice = traitlets.Unicode(NOTICE).tag(sync=True)
    leaflets = traitlets.List(traitlets.Unicode()).tag(sync=True)
    frame = traitlets.Dict().tag(sync=True)
    reach_mm = traitlets.Float().tag(sync=True)
    asked = traitlets.Dict(dict(NOTHING)).tag(sync=True)
    answer = traitlets.Dict().tag(sync=True)

    def __init__(self, before: Closed) -> None:
        report = before.to_dict()
        frame = cast("dict[str, list[float]]", report["frame"])
        valve = before.valve
        points_mm = np.vstack([valve.points_mm[: valve.leaflet_vertex_count], before.positions_mm[: valve.leaflet_vertex_count]])
        reach_mm = float(np.linalg.norm(points_mm - np.array(frame["centre_mm"]), axis=1).max())
        self.before = before
        super().__init__(
            leaflets=[leaflet.name for leaflet in before.leaflets],
            frame=frame,
            reach_mm=reach_mm,
            answer=answered(before, NOTHING),
        )
        self.observe(self._follow, "asked")

    @property
    def repairs(self) -> list[Repair]:
        """What the sliders ask for; of keys that ``asked`` leaves out, what untouched sliders do: nothing.

        Raises
        ------
        InputError
            A key that no slider has; a value that a repair does not take.
        """
        return repairs(whole(self.asked))

    @property
    def closed(self) -> Closed:
        """The valve closed as the sliders ask for.

        Raises
        ------
        InputError
            Why that cannot be carried out.
        """
        wanted = self.repairs
        return self.before.valve.with_repair(*wanted).close() if wanted else self.before

    def _follow(self, change: Any) -> None:
        self.answer = answered(self.before, change["new"])
