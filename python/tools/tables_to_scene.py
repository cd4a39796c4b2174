#!/usr/bin/env python3
"""Turns the tables of a finite-element or mass-spring valve into a coapt scene folder.

    tables_to_scene.py texas  TABLES OUT     Texas TriValve layout
    tables_to_scene.py kaiser TABLES OUT     layout of the Kaiser-McQueen-Peskin mitral generator
    tables_to_scene.py tables OUT --nodes nodes.csv --faces faces.csv [--chords chords.csv] ...

OUT gets `scene.toml`, `leaflet_<name>.vtp`, `chords_<group>.vtp` and, where the tables have closed positions,
`closed_reference.vtp` to compare a result with. Exit status: 0 written, 2 wrong usage or wrong input.
Python 3.10 or later, standard library only. See README.md beside this file.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass
from pathlib import Path

from scene_files import Case, ChordGroup, Leaflet, Point, Tissue, write_scene
from spring_fit import ExponentialLaw, fit_springs, ogden_modulus_mpa, ogden_nominal_stress_mpa
from tables import InputFault, card_numbers, material_card, read_cards, read_lines, read_table

# Largest working Cauchy stress of the Texas TriValve leaflets [MPa]: the 99th percentile of the maximum principal
# stress in the published end-systolic frame (mean 0.059).
TEXAS_CAUCHY_MAX_MPA = 0.152
# Our choice: modulus by which Kaiser's chord stiffnesses are divided to state an area.
KAISER_CHORD_MODULUS_MPA = 30.0
DYN_N = 1e-5
DYN_PER_CM2_KPA = 1e-4


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


# ---------------------------------------------------------------- tables


def tidy(value: float) -> float:
    """A converted number without the last digits' rounding noise."""
    return float(f"{value:.12g}")


def read_points(path: Path, columns: Columns) -> dict[str, Point]:
    """The node table. The annulus column is a flag: 0 or empty is no."""
    names = [columns.id, *columns.position, *columns.closed, *columns.displacement, columns.annulus, columns.tip]
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


def node_ids(row, columns: tuple[str, ...], points: dict[str, Point]) -> tuple[str, ...]:
    """The node ids in some cells; each must be in the node table."""
    for column in columns:
        if row.text(column) not in points:
            raise row.fault(column, f"node {row.text(column)!r} is not in the node table")
    return tuple(row.text(column) for column in columns)


def face_ids(row, columns: tuple[str, ...], points: dict[str, Point]) -> tuple[str, ...]:
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


# ---------------------------------------------------------------- Texas TriValve


def texas_case(folder: Path, state: str, case_name: str = "healthy") -> Case:
    """Texas TriValve: tables `<case>_*.csv` and the material cards of the Abaqus input.

    Mathur et al., Engineering with Computers 2022, doi 10.1007/s00366-022-01659-w (CC BY 4.0).
    """
    columns = Columns(closed=("x20_mm", "y20_mm", "z20_mm"))
    points = read_points(folder / f"{case_name}_nodes.csv", columns)
    leaflets = read_leaflets(folder / f"{case_name}_quads.csv", columns, points)
    chords = read_chords(folder / f"{case_name}_chords.csv", columns, points)
    cards_path = folder / f"{case_name}_materials_and_step_excerpt.txt"
    cards = read_cards(cards_path)
    for name, leaflet in leaflets.items():
        material = f"VUANISO_ISO_{name}_Leaflet"
        leaflet.thickness_mm = shell_thickness_mm(cards_path, cards, material)
        leaflet.tissue = texas_tissue(cards_path, cards, material, state)
    for name, group in chords.items():
        group.modulus_mpa, group.comment = texas_chord_modulus(cards_path, cards, f"{name}_Chordae")
    pressure_kpa = tidy(texas_pressure_mpa(cards_path, cards) * 1e3)
    comment = [
        f"Texas TriValve 1.1, {case_name} (a tricuspid valve). Mathur et al., Engineering with Computers 2022,",
        "doi 10.1007/s00366-022-01659-w, CC BY 4.0; changed: turned from Abaqus into springs and rods.",
        "Frame: as in the Abaqus input, z to the atrium; no patient frame is given, LPS is our label.",
    ]
    name = f"Texas TriValve {case_name}"
    return Case(name, points, leaflets, chords, ("pressure_kpa", pressure_kpa), comment=comment)


def shell_thickness_mm(path: Path, cards: list, material: str) -> float:
    """Thickness of the shell section with this material."""
    for card in cards:
        if card.keyword == "shell section" and card.parameters.get("material", "").lower() == material.lower():
            return card_numbers(path, card, 1)[0]
    raise InputFault(f"{path}: no *shell section card with material {material}")


def texas_pressure_mpa(path: Path, cards: list) -> float:
    """The pressure of the last *Dsload card: `surface, P, value`."""
    for card in reversed(cards):
        if card.keyword == "dsload" and len(card.data) >= 3:
            try:
                return float(card.data[2])
            except ValueError:
                raise InputFault(f"{path}:{card.line}: *dsload: {card.data[2]!r} is not a number") from None
    raise InputFault(f"{path}: no *dsload card with a pressure")


def texas_tissue(path: Path, cards: list, material: str, state: str) -> Tissue:
    """Springs fitted to W = C0/2 (I1-3) + C1/2 (exp(C2 (I1-3)^2) - 1); the card holds C0, D, C1, C2."""
    card = material_card(path, cards, material, "anisotropic hyperelastic")
    c0, _, c1, c2 = card_numbers(path, card, 4)
    fit = fit_springs(ExponentialLaw(c0, c1, c2), TEXAS_CAUCHY_MAX_MPA, state)
    comment = [
        f"Springs fitted to W = C0/2 (I1-3) + C1/2 (exp(C2 (I1-3)^2) - 1), C0 {c0!r} MPa, C1 {c1!r} MPa, C2 {c2!r},",
        f"incompressible, {state}, Cauchy stress 0 to {TEXAS_CAUCHY_MAX_MPA} MPa. Strain error of the fit:",
        f"rms {fit.strain_error_rms:.4f}, largest {fit.strain_error_max:.4f}.",
    ]
    springs = fit.springs
    values = [
        float(f"{value:.6g}")
        for value in (
            springs.pre_transition_modulus_mpa,
            springs.transition_strain,
            springs.post_transition_modulus_mpa,
        )
    ]
    return Tissue(*values, comment=comment)


def texas_chord_modulus(path: Path, cards: list, material: str) -> tuple[float, list[str]]:
    """Small-strain modulus of the chord group's Ogden law, and how it comes about."""
    card = material_card(path, cards, material, "hyperelastic")
    numbers = card_numbers(path, card, 6)
    terms = list(zip(numbers[0::2], numbers[1::2]))
    modulus_mpa = ogden_modulus_mpa(terms)
    secant = ogden_nominal_stress_mpa(terms, 1.004) / 0.004 / modulus_mpa - 1.0
    comment = [
        "Ogden law in Abaqus' form, W = sum 2 mu_i / alpha_i^2 (s1^alpha_i + s2^alpha_i + s3^alpha_i - 3): initial",
        f"shear modulus sum mu_i = {modulus_mpa / 3.0:.6g} MPa, incompressible, so E = 3 sum mu_i. In the published",
        f"closed frame chords stretch by 0.4 %, few more; there the law's secant modulus is {100.0 * secant:+.1f} % off E.",
    ]
    return modulus_mpa, comment


# ---------------------------------------------------------------- Kaiser-McQueen-Peskin


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
        "Mitral valve of the Kaiser-McQueen-Peskin design-based generator (BSD 3-Clause, Alexander D. Kaiser;",
        "arXiv 1902.00018). Open shape: its equilibrium at no pressure, which is not free of stress there.",
        "closed_reference.vtp: its equilibrium under pressure, without contact between the leaflets; nodes move",
        "2.2-2.6 mm on average. Expect the same belly, not the same nodes: the leaflet springs here are others.",
        "Frame: the generator's, anterior to +x in the ct cases; no patient frame is given, LPS is our label.",
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
    """Faces go to the leaflet of most of their nodes; at a tie, which happens in the commissures, of the first."""
    tissue = Tissue(
        0.3,
        0.05,
        8.0,
        comment=[
            "Springs for a mesh whose lengths were taken in the body, where the tissue is prestrained: 0.3 MPa to a",
            "strain of 0.05, 8 MPa beyond. Our choice; an excised-tissue knee of 0.25 would stretch the area by 60 %.",
            "At 100 mmHg they give 5-6 % strain; between the generator's two states its fibres stretch by 3-4 %.",
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

    The generator's tension is T = k (eta E + y0), E = length / rest - 1, above E = 0.145, which all springs pass
    when closed. That line reaches zero at E0 = -y0 / eta = 0.125, so the rod that lies on it has the rest length
    rest (1 + E0) and the stiffness EA = k eta (1 + E0). The soft toe below is left out.
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
        f"Rods on the linear branch of the generator's law: rest lengths are {1.0 + onset:g} times the table's, areas",
        f"are the stiffness EA over {KAISER_CHORD_MODULUS_MPA:g} MPa and not anatomical.",
    ]
    groups: dict[str, ChordGroup] = {}
    for tree, segment in segments:
        name = leaflet_of.get(tree, tree)
        groups.setdefault(name, ChordGroup([], KAISER_CHORD_MODULUS_MPA, comment)).segments.append(segment)
    return groups


# ---------------------------------------------------------------- any tables


def tables_case(options: argparse.Namespace) -> Case:
    """A case from tables whose columns the command line names."""
    columns = Columns(
        **{name: getattr(options, f"{name}_column") for name in Columns.__dataclass_fields__ if name != "tip_value"},
        tip_value=options.tip_value,
    )
    columns.closed = tuple(columns.closed or ())
    columns.displacement = () if options.no_displacement else columns.displacement
    points = read_points(options.nodes, columns)
    leaflets = read_leaflets(options.faces, columns, points)
    chords = read_chords(options.chords, columns, points) if options.chords else {}
    for leaflet in leaflets.values():
        leaflet.thickness_mm = options.thickness_mm
        leaflet.tissue = Tissue(*options.tissue) if options.tissue else None
    for group in chords.values():
        group.modulus_mpa = options.chord_modulus_mpa
    unit = "pressure_mmhg" if options.pressure_mmhg is not None else "pressure_kpa"
    return Case(options.name, points, leaflets, chords, (unit, getattr(options, unit)), space=options.space)


def positive(text: str) -> float:
    """A finite number above zero, for the command line."""
    value = float(text)
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"{text} must be above 0")
    return value


def tables_options(parser: argparse.ArgumentParser) -> None:
    """The options of the `tables` form."""
    defaults = Columns()
    parser.add_argument("out", type=Path, help="scene folder to write")
    parser.add_argument("--nodes", type=Path, required=True, help="CSV of nodes")
    parser.add_argument("--faces", type=Path, required=True, help="CSV of triangles or quads")
    parser.add_argument("--chords", type=Path, help="CSV of chord segments")
    parser.add_argument("--name", default="valve", help="name of the case")
    parser.add_argument("--space", choices=("LPS", "RAS"), default="LPS", help="patient frame of the positions")
    pressure = parser.add_mutually_exclusive_group(required=True)
    pressure.add_argument("--pressure-mmhg", type=positive)
    pressure.add_argument("--pressure-kpa", type=positive)
    parser.add_argument("--thickness-mm", type=positive, default=1.0)
    parser.add_argument(
        "--tissue",
        type=positive,
        nargs=3,
        metavar=("PRE_MPA", "KNEE", "POST_MPA"),
        help="bilinear springs: modulus, transition strain, modulus; left out: coapt's defaults",
    )
    parser.add_argument("--chord-modulus-mpa", type=positive, default=30.0)
    parser.add_argument("--no-displacement", action="store_true", help="the node table has no displacements")
    for name, default in vars(defaults).items():
        if name == "tip_value":
            parser.add_argument("--tip-value", default=default, help="what the tip column says of a papillary tip")
            continue
        several = isinstance(default, tuple)
        count = ("+" if name == "face" else 2 if name == "chord" else 3) if several else None
        shown = " ".join(default) if several else default
        parser.add_argument(
            f"--{name}-column{'s' if several else ''}",
            dest=f"{name}_column",
            nargs=count,
            default=default,
            metavar="COLUMN",
            help=f"default: {shown or 'none'}",
        )


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], epilog="See README.md beside this file.", allow_abbrev=False
    )
    forms = top.add_subparsers(dest="form", required=True)
    for form, words in (("texas", "Texas TriValve layout"), ("kaiser", "Kaiser-McQueen-Peskin layout")):
        sub = forms.add_parser(form, help=words, allow_abbrev=False)
        sub.add_argument("folder", type=Path, help="folder with the tables")
        sub.add_argument("out", type=Path, help="scene folder to write")
        if form == "texas":
            sub.add_argument("--case", default="healthy", help="prefix of the file names")
            sub.add_argument(
                "--fit-state",
                choices=("equibiaxial", "uniaxial"),
                default="equibiaxial",
                help="stretch in which the leaflet springs follow the published law",
            )
    tables_options(forms.add_parser("tables", help="any tables, columns named here", allow_abbrev=False))
    for sub in forms.choices.values():
        sub.add_argument("--muscle-distance-mm", type=positive, default=5.0, help="tips nearer are one muscle")
        sub.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    return top


def report(case: Case, files: list[Path]) -> str:
    """What was written, for stdout."""
    lines = [f"{file}" for file in files]
    for name, leaflet in case.leaflets.items():
        tissue = leaflet.tissue
        lines.append(f"leaflet {name}: {len(leaflet.faces)} faces, thickness {leaflet.thickness_mm:g} mm")
        if tissue:
            lines.append(
                f"  springs {tissue.pre_transition_modulus_mpa:g} MPa to strain {tissue.transition_strain:g}, "
                f"then {tissue.post_transition_modulus_mpa:g} MPa"
            )
            lines += [f"  {line}" for line in tissue.comment]
    for name, group in case.chords.items():
        lines.append(f"chords {name}: {len(group.segments)} segments, modulus {group.modulus_mpa:g} MPa")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Reads the command line, writes the folder, says what it wrote."""
    options = parser().parse_args(arguments)
    try:
        if options.form == "texas":
            case = texas_case(options.folder, options.fit_state, options.case)
        elif options.form == "kaiser":
            case = kaiser_case(options.folder)
        else:
            case = tables_case(options)
        case.muscle_distance_mm = options.muscle_distance_mm
        print(report(case, write_scene(case, options.out, options.force)))
    except InputFault as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
