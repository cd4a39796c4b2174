"""The layout of the Kaiser-McQueen-Peskin mitral valves: nodes.csv, quads.csv, springs.csv, law.txt."""

from __future__ import annotations

import math
from pathlib import Path

from case_tables import Columns, face_ids, node_ids, read_points, tidy
from scene_files import Case, ChordGroup, Leaflet, Point, bilinear_springs
from tables import InputFault, read_lines, read_table

DYN_PER_CM2_KPA = 1e-4
DYN_PER_CM2_MPA = 1e-7
CM2_MM2 = 100.0


def kaiser_case(folder: Path) -> Case:
    """Kaiser-McQueen-Peskin generated valve: nodes.csv, quads.csv, springs.csv, law.txt; arXiv 1902.00018."""
    columns = Columns(
        position=("xo_mm", "yo_mm", "zo_mm"),
        closed=("xc_mm", "yc_mm", "zc_mm"),
        displacement=(),
        annulus="fixed",
        tip="kind",
    )
    nodes_path = folder / "nodes.csv"
    points = read_points(nodes_path, columns)
    rows = {row.text("id"): row for row in read_table(nodes_path, ["id", "kind", "leaflet", "fixed"])}
    for id, point in points.items():
        # Annulus and papillary tips are both fixed; only leaflet nodes are annulus.
        point.annulus = point.annulus and rows[id].text("kind") == "leaflet"
    names = {id: row.text("leaflet") for id, row in rows.items()}
    law = kaiser_law(folder / "law.txt")
    comment = [
        "Mitral valve of the Kaiser-McQueen-Peskin generator (BSD 3-Clause, Alexander D. Kaiser; arXiv",
        "1902.00018). Open shape: its equilibrium at no pressure, which is not free of stress there.",
        "closed_reference.vtp: its equilibrium under pressure, without contact between the leaflets; nodes",
        "move 2.2-2.6 mm on average. Expect the same belly, not the same nodes: the leaflet springs differ.",
        "Frame: the generator's, anterior to +x in the ct cases; no patient frame is given; LPS is ours.",
    ]
    return Case(
        f"Kaiser mitral {folder.resolve().name}",
        points,
        kaiser_leaflets(folder / "quads.csv", points, names),
        kaiser_chords(folder / "springs.csv", points, names, law),
        ("pressure_kpa", tidy(abs(law["p_closed_dyn_cm2"]) * DYN_PER_CM2_KPA)),
        comment=comment,
    )


def kaiser_law(path: Path) -> dict[str, float]:
    """The lines `name value` of law.txt."""
    law = {}
    for text in read_lines(path):
        words = text.split()
        if len(words) == 2:
            try:
                law[words[0]] = float(words[1])
            except ValueError:
                continue
    for name in ("a", "b", "full_recruitment", "eta", "y0", "p_closed_dyn_cm2"):
        if not math.isfinite(law.get(name, math.nan)):
            raise InputFault(f"{path}: no line '{name} <number>'")
    for name in ("a", "b", "full_recruitment", "eta"):
        if law[name] <= 0.0:
            raise InputFault(f"{path}: {name} {law[name]!r} must be above 0")
    recruited = law["full_recruitment"]
    curve, line = law["a"] * math.expm1(law["b"] * recruited), law["eta"] * recruited + law["y0"]
    # The published numbers meet to 1e-6; coapt's line starts where the curve ends, wherever `y0` puts it.
    if not abs(line - curve) <= 1e-3 * curve:
        raise InputFault(f"{path}: the branches give {curve:g} and {line:g} at full recruitment; expected one value")
    return law


def kaiser_leaflets(path: Path, points: dict[str, Point], names: dict[str, str]) -> dict[str, Leaflet]:
    """Faces go to the leaflet of most of their nodes; at a tie, as in the commissures, of the first."""
    tissue = bilinear_springs(
        0.3,
        0.05,
        8.0,
        comment=[
            "Springs for a mesh whose lengths were taken in the body, where the tissue is prestrained:",
            "0.3 MPa to a strain of 0.05, 8 MPa beyond. Our choice; a knee of 0.25, as for excised tissue,",
            "would stretch the area by 60 %. At 100 mmHg these give 5-6 % strain; from the relaxed to the",
            "pressurised state the generator's own fibres stretch by 2.6 % around and 4 % along the leaflets",
            "(medians, ct_64).",
        ],
    )
    leaflets: dict[str, Leaflet] = {}
    for row in read_table(path, ["a", "b", "c", "d"]):
        ids = face_ids(row, ("a", "b", "c", "d"), points)
        owners = [names[id] for id in ids]
        owner = max(dict.fromkeys(owners), key=owners.count)
        leaflets.setdefault(owner, Leaflet([], 1.0, tissue)).faces.append(ids)
    return leaflets


def kaiser_chords(path: Path, points: dict, names: dict[str, str], law: dict) -> dict[str, ChordGroup]:
    """Chord springs under the generator's own law, in groups by the leaflet that their tree inserts in.

    The generator's tension at E = length / rest - 1 is k a (exp(b E) - 1) up to the strain of full recruitment
    and k (eta E + y0) from there on, zero where slack: a stress law over the cross-section k, in cm2. Where
    the branches meet they differ by 1e-6 of their value; coapt's line starts where its curve ends.
    """
    collagen = {
        "kind": "collagen",
        "scale_mpa": tidy(law["a"] * DYN_PER_CM2_MPA),
        "exponent": law["b"],
        "full_recruitment_strain": law["full_recruitment"],
        "modulus_mpa": tidy(law["eta"] * DYN_PER_CM2_MPA),
    }
    rows = read_table(path, ["i", "j", "kind", "rest_mm", "k_dyn"])
    rows = [row for row in rows if row.text("kind") in ("chord", "chord_leaf")]
    segments, leaflet_of = [], {}
    for row in rows:
        a, b = node_ids(row, ("i", "j"), points)
        if row.text("kind") == "chord_leaf":
            leaflet_of.setdefault(names[b], names[a])
        area_mm2 = tidy(row.positive("k_dyn") * CM2_MM2)
        segments.append((names[b], (a, b, row.positive("rest_mm"), area_mm2)))
    comment = ["The generator's law, rest lengths and cross-sections."]
    groups: dict[str, ChordGroup] = {}
    for tree, segment in segments:
        name = leaflet_of.get(tree, tree)
        # Chordae and leaflets have nodes in common.
        group = ChordGroup([], comment=comment, law=collagen, insertion_radius_mm=0.0)
        groups.setdefault(name, group).segments.append(segment)
    return groups
