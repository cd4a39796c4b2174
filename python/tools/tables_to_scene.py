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
from pathlib import Path

from case_tables import Columns, read_chords, read_leaflets, read_points
from kaiser_mitral import kaiser_case
from scene_files import Case, bilinear_springs, write_scene
from tables import InputFault
from texas_trivalve import texas_case


def tables_case(options: argparse.Namespace) -> Case:
    """A case from tables whose columns the command line names."""
    columns = Columns(
        **{
            name: getattr(options, f"{name}_column")
            for name in Columns.__dataclass_fields__
            if name != "tip_value"
        },
        tip_value=options.tip_value,
    )
    columns.closed = tuple(columns.closed or ())
    columns.displacement = () if options.no_displacement else columns.displacement
    points = read_points(options.nodes, columns)
    leaflets = read_leaflets(options.faces, columns, points)
    chords = read_chords(options.chords, columns, points) if options.chords else {}
    for leaflet in leaflets.values():
        leaflet.thickness_mm = options.thickness_mm
        leaflet.tissue = bilinear_springs(*options.tissue) if options.tissue else None
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
    parser.add_argument(
        "--space", choices=("LPS", "RAS"), default="LPS", help="patient frame of the positions"
    )
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
            parser.add_argument(
                "--tip-value", default=default, help="what the tip column says of a papillary tip"
            )
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
            law = sub.add_mutually_exclusive_group()
            law.add_argument(
                "--springs",
                choices=("equibiaxial", "uniaxial"),
                help="leaflets as springs that follow the published law in this stretch, not as membranes",
            )
            law.add_argument(
                "--compressible",
                action="store_true",
                help="leaflets with the D of the input as it stands; left out: incompressible",
            )
    tables_options(forms.add_parser("tables", help="any tables, columns named here", allow_abbrev=False))
    for sub in forms.choices.values():
        sub.add_argument(
            "--muscle-distance-mm", type=positive, default=5.0, help="tips nearer are one muscle"
        )
        sub.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    return top


def report(case: Case, files: list[Path]) -> str:
    """What was written, for stdout."""
    lines = [f"{file}" for file in files]
    for name, leaflet in case.leaflets.items():
        tissue = leaflet.tissue
        lines.append(f"leaflet {name}: {len(leaflet.faces)} faces, thickness {leaflet.thickness_mm:g} mm")
        if tissue:
            said = {key: value if isinstance(value, str) else f"{value:g}" for key, value in tissue.values.items()}
            constants = ", ".join(f"{key} {value}" for key, value in said.items())
            lines.append(f"  {tissue.law}: {constants}")
            lines += [f"  {line}" for line in tissue.comment]
    for name, group in case.chords.items():
        law = f"law {group.law['kind']}" if group.law else f"modulus {group.modulus_mpa:g} MPa"
        lines.append(f"chords {name}: {len(group.segments)} segments, {law}")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Reads the command line, writes the folder, says what it wrote."""
    options = parser().parse_args(arguments)
    try:
        if options.form == "texas":
            case = texas_case(options.folder, options.case, options.springs, options.compressible)
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
