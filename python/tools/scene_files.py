"""A case and the scene folder that it becomes: `scene.toml`, a `.vtp` per leaflet and per chord group.

Numbers are written with all their digits, in an order that depends on the case alone. The `.vtp` files are
ASCII VTK XML PolyData with the patient frame in a field-data string array `SPACE`, as 3D Slicer has it.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from tables import InputFault

Vector = tuple[float, float, float]


@dataclass
class Point:
    """A node of the case; positions in mm."""

    position_mm: Vector
    closed_mm: Vector | None = None
    displacement_mm: Vector = (0.0, 0.0, 0.0)
    annulus: bool = False
    tip: bool = False


@dataclass
class Tissue:
    """A tissue law of the scene by its name, its constants by their keys, and where they come from."""

    law: str
    values: dict[str, float]
    comment: list[str] = field(default_factory=list)


def bilinear_springs(
    pre_mpa: float, knee: float, post_mpa: float, comment: list[str] | None = None
) -> Tissue:
    """The scene's `bilinear-springs`: modulus, transition strain, modulus beyond."""
    values = {
        "pre_transition_modulus_mpa": pre_mpa,
        "transition_strain": knee,
        "post_transition_modulus_mpa": post_mpa,
    }
    return Tissue("bilinear-springs", values, comment or [])


@dataclass
class Leaflet:
    """Faces of 3 or 4 node ids, and the tissue."""

    faces: list[tuple[str, ...]]
    thickness_mm: float = 1.0
    tissue: Tissue | None = None


@dataclass
class ChordGroup:
    """Segments as (node id, node id, rest length [mm], area [mm2]), and what they are made of.

    `law` is a chord law of the scene, its kind and constants by their keys; without it rods of `modulus_mpa`.
    """

    segments: list[tuple[str, str, float, float]]
    modulus_mpa: float = 30.0
    comment: list[str] = field(default_factory=list)
    law: dict[str, str | float | list[float]] | None = None
    insertion_radius_mm: float | None = None


@dataclass
class Case:
    """Everything that a scene folder says.

    `pressure` is a key of the scene's `[load]` with its value, `contact` holds the keys of `[contact]`.
    """

    name: str
    points: dict[str, Point]
    leaflets: dict[str, Leaflet]
    chords: dict[str, ChordGroup]
    pressure: tuple[str, float]
    space: str = "LPS"
    muscle_distance_mm: float = 5.0
    comment: list[str] = field(default_factory=list)
    contact: dict[str, float] = field(default_factory=dict)


def write_scene(case: Case, folder: Path, force: bool = False) -> list[Path]:
    """Writes the scene folder and returns the files written. A folder with something in it needs `force`."""
    orient_to_atrium(case)
    files = scene_texts(case)
    try:
        if folder.exists() and not folder.is_dir():
            raise InputFault(f"{folder}: is a file; expected a folder to write to")
        if folder.is_dir() and any(folder.iterdir()) and not force:
            raise InputFault(f"{folder}: is not empty; give another folder, or --force to overwrite")
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise InputFault(f"{folder}: {error.strerror or error}") from None
    return [folder / name for name in files]


def scene_texts(case: Case) -> dict[str, str]:
    """The files of the scene folder as text, by file name."""
    texts = {"scene.toml": scene_toml(case)}
    for name, leaflet in case.leaflets.items():
        texts[leaflet_file(name)] = leaflet_vtp(case, leaflet)
    for name, group in case.chords.items():
        texts[chord_file(name)] = chord_vtp(case, group)
    if all(case.points[id].closed_mm for leaflet in case.leaflets.values() for id in leaflet_ids(leaflet)):
        texts["closed_reference.vtp"] = closed_vtp(case)
    return texts


# ---------------------------------------------------------------- geometry


def leaflet_ids(leaflet: Leaflet) -> list[str]:
    """The node ids of a leaflet in order of first use."""
    return list(dict.fromkeys(id for face in leaflet.faces for id in face))


def mean(vectors: list[Vector]) -> Vector:
    """The mean of some vectors."""
    return tuple(math.fsum(axis) / len(vectors) for axis in zip(*vectors))


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def subtract(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def orient_to_atrium(case: Case) -> None:
    """Turns whole leaflets round whose faces run clockwise along the annulus, seen from the atrium.

    The atrium is where the annulus lies as seen from the leaflets' nodes. Summed face normals would not do:
    those of an open valve that hangs like a tube nearly cancel.
    """
    ids = list(dict.fromkeys(id for leaflet in case.leaflets.values() for id in leaflet_ids(leaflet)))
    ring = [case.points[id].position_mm for id in ids if case.points[id].annulus]
    if not ring:
        raise InputFault(f"{case.name}: no node of any leaflet is on the annulus; check the annulus column")
    centre = mean(ring)
    to_atrium = subtract(centre, mean([case.points[id].position_mm for id in ids]))
    for leaflet in case.leaflets.values():
        turning = 0.0
        for face in leaflet.faces:
            for a, b in zip(face, face[1:] + face[:1]):
                if case.points[a].annulus and case.points[b].annulus:
                    start = case.points[a].position_mm
                    along = subtract(case.points[b].position_mm, start)
                    turning += dot(cross(subtract(start, centre), along), to_atrium)
        if turning < 0.0:
            leaflet.faces = [tuple(reversed(face)) for face in leaflet.faces]


def muscles(case: Case) -> list[list[Point]]:
    """Papillary tips in groups: tips nearer than `muscle_distance_mm` to one of the group belong to it.

    Tips at the same place that move alike are one.
    """
    tips: dict[tuple, Point] = {}
    for point in case.points.values():
        if point.tip:
            tips.setdefault((point.position_mm, point.displacement_mm), point)
    groups: list[list[Point]] = []
    for tip in tips.values():
        near = [
            group
            for group in groups
            if any(math.dist(tip.position_mm, other.position_mm) < case.muscle_distance_mm for other in group)
        ]
        merged = [point for group in near for point in group] + [tip]
        at = groups.index(near[0]) if near else len(groups)
        groups = [group for group in groups if not any(group is other for other in near)]
        groups.insert(at, merged)
    return groups


# ---------------------------------------------------------------- scene.toml


def toml_string(text: str) -> str:
    """A TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    escaped = "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped)
    return f'"{escaped}"'


def toml_vectors(vectors: list[Vector]) -> str:
    """A TOML array of points, one a line."""
    return "[\n" + "".join(f"  [{', '.join(map(repr, vector))}],\n" for vector in vectors) + "]"


def toml_value(value: str | float | list[float]) -> str:
    """A word, a number or a list of numbers in TOML."""
    if isinstance(value, str):
        return toml_string(value)
    return f"[{', '.join(map(repr, value))}]" if isinstance(value, list) else repr(value)


def toml_lines(values: dict) -> list[str]:
    """Keys with their values."""
    return [f"{key} = {toml_value(value)}" for key, value in values.items()]


def comment_lines(lines: list[str]) -> list[str]:
    """Words as TOML comments."""
    return [f"# {line}".rstrip() for text in lines for line in text.splitlines()]


def scene_toml(case: Case) -> str:
    """The scene file."""
    lines = comment_lines(case.comment) + ["schema_version = 1"]
    lines += [f"name = {toml_string(case.name)}", f"space = {toml_string(case.space)}", ""]
    lines += ["[annulus]", 'marker_array = "annulus"', 'displacement_array = "annulus_displacement_mm"', ""]
    lines += ["[load]", f"{case.pressure[0]} = {case.pressure[1]!r}", ""]
    if case.contact:
        lines += ["[contact]", *toml_lines(case.contact), ""]
    lines += comment_lines(["The tables number shared nodes once, so ends that meet coincide exactly."])
    lines += ["[weld]", "tolerance_mm = 1e-6", "insertion_tolerance_mm = 1e-6", ""]
    for name, leaflet in case.leaflets.items():
        lines += ["[[leaflets]]", f"name = {toml_string(name)}"]
        lines += [f"mesh_file = {toml_string(leaflet_file(name))}"]
        lines += [f"thickness_mm = {leaflet.thickness_mm!r}", ""]
        if leaflet.tissue:
            lines += comment_lines(leaflet.tissue.comment) + ["[leaflets.tissue]"]
            lines += toml_lines({"law": leaflet.tissue.law, **leaflet.tissue.values}) + [""]
    for number, group in enumerate(muscles(case), start=1):
        lines += ["[[papillary]]", f'name = "papillary_{number}"']
        lines += [f"tips_mm = {toml_vectors([tip.position_mm for tip in group])}"]
        if any(any(tip.displacement_mm) for tip in group):
            lines += [f"displacements_mm = {toml_vectors([tip.displacement_mm for tip in group])}"]
        lines += [""]
    for name, chords in case.chords.items():
        lines += comment_lines(chords.comment) + ["[[chordae]]", f"name = {toml_string(name)}"]
        lines += [f"mesh_file = {toml_string(chord_file(name))}"] + chord_lines(chords) + [""]
    return "\n".join(lines)


def chord_lines(chords: ChordGroup) -> list[str]:
    """What the chordae of a group are made of and how they insert."""
    values = {} if chords.law else {"modulus_mpa": chords.modulus_mpa}
    if chords.insertion_radius_mm is not None:
        values["insertion_radius_mm"] = chords.insertion_radius_mm
    law = ["[chordae.law]", *toml_lines(chords.law)] if chords.law else []
    return toml_lines(values) + law


# ---------------------------------------------------------------- VTK files


def file_word(name: str) -> str:
    """A name as part of a file name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name)


def leaflet_file(name: str) -> str:
    """The file of a leaflet."""
    return f"leaflet_{file_word(name)}.vtp"


def chord_file(name: str) -> str:
    """The file of a chord group."""
    return f"chords_{file_word(name)}.vtp"


def leaflet_vtp(case: Case, leaflet: Leaflet) -> str:
    """A leaflet, open, with its annulus nodes and their prescribed motion."""
    ids = leaflet_ids(leaflet)
    number = {id: index for index, id in enumerate(ids)}
    points = [case.points[id] for id in ids]
    on = [int(point.annulus) for point in points]
    moves = [point.displacement_mm if point.annulus else (0.0, 0.0, 0.0) for point in points]
    return polydata(
        case.space,
        [point.position_mm for point in points],
        polys=[[number[id] for id in face] for face in leaflet.faces],
        point_arrays=[data_array("annulus", on), data_array("annulus_displacement_mm", moves)],
    )


def chord_vtp(case: Case, group: ChordGroup) -> str:
    """A chord group: one line cell per segment."""
    ids = list(dict.fromkeys(id for segment in group.segments for id in segment[:2]))
    number = {id: index for index, id in enumerate(ids)}
    return polydata(
        case.space,
        [case.points[id].position_mm for id in ids],
        lines=[[number[a], number[b]] for a, b, _, _ in group.segments],
        cell_arrays=[
            data_array("rest_length_mm", [segment[2] for segment in group.segments]),
            data_array("area_mm2", [segment[3] for segment in group.segments]),
        ],
    )


def closed_vtp(case: Case) -> str:
    """All leaflets where the tables say they end up; cell array `leaflet` counts as the scene does."""
    ids = list(dict.fromkeys(id for leaflet in case.leaflets.values() for id in leaflet_ids(leaflet)))
    number = {id: index for index, id in enumerate(ids)}
    faces = [[number[id] for id in face] for leaflet in case.leaflets.values() for face in leaflet.faces]
    which = [index for index, leaflet in enumerate(case.leaflets.values()) for _ in leaflet.faces]
    return polydata(
        case.space,
        [case.points[id].closed_mm for id in ids],
        polys=faces,
        point_arrays=[data_array("annulus", [int(case.points[id].annulus) for id in ids])],
        cell_arrays=[data_array("leaflet", which)],
    )


def data_array(name: str, values: list) -> str:
    """One ASCII DataArray: Int64, Float64 or Float64 with 3 components, from what the values are."""
    if values and isinstance(values[0], tuple):
        kind, width, rows = "Float64", ' NumberOfComponents="3"', (" ".join(map(repr, row)) for row in values)
    else:
        kind = "Int64" if all(isinstance(value, int) for value in values) else "Float64"
        width, rows = "", map(repr, values)
    body = "\n".join(rows)
    return f'<DataArray type="{kind}" Name="{name}"{width} format="ascii">\n{body}\n</DataArray>\n'


def polydata(
    space: str,
    points: list[Vector],
    polys: list[list[int]] = (),
    lines: list[list[int]] = (),
    point_arrays: list[str] = (),
    cell_arrays: list[str] = (),
) -> str:
    """A VTK XML PolyData file."""
    frame = " ".join(str(ord(letter)) for letter in space) + " 0"
    parts = [
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">\n',
        "<PolyData>\n",
        f'<FieldData>\n<Array type="String" Name="SPACE" NumberOfTuples="1" format="ascii">{frame}</Array>\n',
        "</FieldData>\n",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="{len(lines)}" ',
        f'NumberOfStrips="0" NumberOfPolys="{len(polys)}">\n',
        f"<PointData>\n{''.join(point_arrays)}</PointData>\n<CellData>\n{''.join(cell_arrays)}</CellData>\n",
        f"<Points>\n{data_array('Points', points)}</Points>\n",
    ]
    for name, cells in (("Lines", lines), ("Polys", polys)):
        ends, offsets = 0, []
        for cell in cells:
            ends += len(cell)
            offsets.append(ends)
        connectivity = [number for cell in cells for number in cell]
        arrays = data_array("connectivity", connectivity) + data_array("offsets", offsets)
        parts.append(f"<{name}>\n{arrays}</{name}>\n")
    return "".join(parts) + "</Piece>\n</PolyData>\n</VTKFile>\n"
