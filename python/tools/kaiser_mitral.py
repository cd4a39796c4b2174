"""The layout of the Kaiser-McQueen-Peskin mitral valves: nodes.csv, quads.csv, springs.csv, law.txt."""

from __future__ import annotations

import math
from pathlib import Path

from case_tables import Columns, face_ids, node_ids, read_points, tidy
from scene_files import Case, ChordGroup, Leaflet, Point, Tissue
from tables import InputFault, read_lines, read_table

# Our choice: modulus by which Kaiser's chord stiffnesses are divided to state an area.
KAISER_CHORD_MODULUS_MPA = 30.0
DYN_N = 1e-5
DYN_PER_CM2_KPA = 1e-4


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
    for name in ("eta", "y0", "p_closed_dyn_cm2"):
        if not math.isfinite(law.get(name, math.nan)):
            raise InputFault(f"{path}: no line '{name} <number>'")
    if law["eta"] <= 0.0 or law["y0"] > 0.0:
        raise InputFault(f"{path}: eta {law['eta']!r} must be above 0 and y0 {law['y0']!r} not above 0")
    return law


def kaiser_leaflets(path: Path, points: dict[str, Point], names: dict[str, str]) -> dict[str, Leaflet]:
    """Faces go to the leaflet of most of their nodes; at a tie, as in the commissures, of the first."""
    tissue = Tissue(
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
    """Chord springs as rods, in groups by the leaflet that their tree inserts in.

    The generator's tension is T = k (eta E + y0), E = length / rest - 1, above E = 0.145, which all springs
    pass when closed. That line reaches zero at E0 = -y0 / eta = 0.125, so the rod that lies on it has the
    rest length rest (1 + E0) and the stiffness EA = k eta (1 + E0). The soft toe below is left out.
    """
    onset = -law["y0"] / law["eta"]
    rows = read_table(path, ["i", "j", "kind", "rest_mm", "k_dyn"])
    rows = [row for row in rows if row.text("kind") in ("chord", "chord_leaf")]
    segments, leaflet_of = [], {}
    for row in rows:
        a, b = node_ids(row, ("i", "j"), points)
        if row.text("kind") == "chord_leaf":
            leaflet_of.setdefault(names[b], names[a])
        stiffness_n = row.positive("k_dyn") * law["eta"] * (1.0 + onset) * DYN_N
        rest_mm = row.positive("rest_mm") * (1.0 + onset)
        segments.append((names[b], (a, b, rest_mm, stiffness_n / KAISER_CHORD_MODULUS_MPA)))
    comment = [
        f"Rods on the linear branch of the generator's law: rest lengths are {1.0 + onset:g} times the",
        f"table's, areas are the stiffness EA over {KAISER_CHORD_MODULUS_MPA:g} MPa and not anatomical.",
    ]
    groups: dict[str, ChordGroup] = {}
    for tree, segment in segments:
        name = leaflet_of.get(tree, tree)
        groups.setdefault(name, ChordGroup([], KAISER_CHORD_MODULUS_MPA, comment)).segments.append(segment)
    return groups
