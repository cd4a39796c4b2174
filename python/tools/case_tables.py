"""Nodes, faces and chords of a case from tables whose column names are given."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from scene_files import ChordGroup, Leaflet, Point
from tables import Row, read_table


@dataclass
class Columns:
    """What the columns are called. The defaults are the Texas tables' names."""

    id: str = "id"
    position: tuple[str, ...] = ("x0_mm", "y0_mm", "z0_mm")
    closed: tuple[str, ...] = ()
    displacement: tuple[str, ...] = ("dx_mm", "dy_mm", "dz_mm")
    annulus: str = "annulus"
    tip: str = "bc"
    tip_value: str = "papillary"
    face: tuple[str, ...] = ("a", "b", "c", "d")
    leaflet: str = "leaflet"
    chord: tuple[str, ...] = ("a", "b")
    group: str = "group"
    area: str = "area_mm2"
    rest: str = "rest_mm"


def read_points(path: Path, columns: Columns) -> dict[str, Point]:
    """The node table. The annulus column is a flag: 0 or empty is no."""
    names = [
        columns.id,
        *columns.position,
        *columns.closed,
        *columns.displacement,
        columns.annulus,
        columns.tip,
    ]
    points: dict[str, Point] = {}
    for row in read_table(path, names):
        id = row.text(columns.id)
        if id in points:
            raise row.fault(columns.id, f"node {id} is listed twice")
        points[id] = Point(
            position_mm=row.vector(list(columns.position)),
            closed_mm=row.vector(list(columns.closed)) if columns.closed else None,
            displacement_mm=row.vector_or_zero(list(columns.displacement)) or (0.0, 0.0, 0.0),
            annulus=row.text(columns.annulus) not in ("", "0"),
            tip=row.text(columns.tip) == columns.tip_value,
        )
    return points


def node_ids(row: Row, columns: tuple[str, ...], points: dict[str, Point]) -> tuple[str, ...]:
    """The node ids in some cells; each must be in the node table."""
    for column in columns:
        if row.text(column) not in points:
            raise row.fault(column, f"node {row.text(column)!r} is not in the node table")
    return tuple(row.text(column) for column in columns)


def face_ids(row: Row, columns: tuple[str, ...], points: dict[str, Point]) -> tuple[str, ...]:
    """A face without repeated corners: in four columns, a triangle has one corner twice."""
    ids = tuple(dict.fromkeys(node_ids(row, columns, points)))
    if len(ids) < 3:
        raise row.fault(columns[-1], f"a face needs 3 different nodes, found {len(ids)}")
    return ids


def read_leaflets(path: Path, columns: Columns, points: dict[str, Point]) -> dict[str, Leaflet]:
    """The face table, split by the leaflet column."""
    leaflets: dict[str, Leaflet] = {}
    for row in read_table(path, [*columns.face, columns.leaflet]):
        name = row.text(columns.leaflet)
        if not name:
            raise row.fault(columns.leaflet, "empty; expected the name of a leaflet")
        leaflets.setdefault(name, Leaflet([])).faces.append(face_ids(row, columns.face, points))
    return leaflets


def read_chords(path: Path, columns: Columns, points: dict[str, Point]) -> dict[str, ChordGroup]:
    """The chord table, split by the group column."""
    groups: dict[str, ChordGroup] = {}
    for row in read_table(path, [*columns.chord, columns.group, columns.area, columns.rest]):
        a, b = node_ids(row, columns.chord, points)
        if a == b:
            raise row.fault(columns.chord[1], f"both ends are node {a}")
        name = row.text(columns.group)
        if not name:
            raise row.fault(columns.group, "empty; expected the name of a chord group")
        segment = (a, b, row.positive(columns.rest), row.positive(columns.area))
        groups.setdefault(name, ChordGroup([])).segments.append(segment)
    return groups


def tidy(value: float) -> float:
    """A converted number without the last digits' rounding noise."""
    return float(f"{value:.12g}")
