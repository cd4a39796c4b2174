"""The Texas TriValve layout: `<case>_*.csv` tables and the material cards of the Abaqus input."""

from __future__ import annotations

import math
import statistics
from pathlib import Path

from case_tables import Columns, read_chords, read_leaflets, read_points, tidy
from scene_files import Case, Tissue, bilinear_springs
from spring_fit import ExponentialLaw, fit_springs, ogden_modulus_mpa, ogden_nominal_stress_mpa
from tables import InputFault, card_numbers, material_card, read_cards

# Largest working Cauchy stress of the Texas TriValve leaflets [MPa]: the 99th percentile of the maximum
# principal stress in the published end-systolic frame (mean 0.059).
TEXAS_CAUCHY_MAX_MPA = 0.152

# Our choice, of the order of the leaflets' modulus where they are unloaded, 3 C0 = 0.003 MPa. Abaqus' shells
# have it by integration through the thickness.
TEXAS_BENDING_MODULUS_MPA = 0.01

# Our choice: in the published closed frame 99 % of the chords stretch by less than 0.8 %; the table ends well
# beyond, and goes on along its last piece.
TEXAS_CHORD_STRAIN_MAX = 0.02
TEXAS_CHORD_STRAIN_STEP = 0.0005


def texas_case(
    folder: Path, case_name: str = "healthy", springs: str | None = None, compressible: bool = False
) -> Case:
    """Texas TriValve: tables `<case>_*.csv` and the material cards of the Abaqus input.

    Leaflets are membranes of the published law; with `springs`, springs that follow it in that state of stretch.
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
        if springs:
            leaflet.tissue = texas_springs(cards_path, cards, material, springs)
        else:
            leaflet.tissue = texas_membrane(cards_path, cards, material, compressible)
    for name, group in chords.items():
        group.law, group.comment = texas_chord_law(cards_path, cards, f"{name}_Chordae")
        # Chordae and leaflets have nodes in common; how chordae fan out is meshed.
        group.insertion_radius_mm = 0.0
    # 0.5 is the slope of the input's overclosure [MPa/mm]; here it is the scale of coapt's own law [MPa].
    thickness_mm = min(leaflet.thickness_mm for leaflet in leaflets.values())
    contact = {
        "thickness_mm": contact_thickness_mm(cards, thickness_mm, points, leaflets),
        "stiffness_mpa": 0.5,
    }
    pressure_kpa = tidy(texas_pressure_mpa(cards_path, cards) * 1e3)
    kind = "springs" if springs else "membranes"
    comment = [
        f"Texas TriValve 1.1, {case_name} (a tricuspid valve). Mathur et al., Engineering with Computers",
        f"2022, doi 10.1007/s00366-022-01659-w, CC BY 4.0; changed: turned from Abaqus into {kind}",
        "and rods.",
        "Frame: as in the Abaqus input, z to the atrium; no patient frame is given, LPS is our label.",
    ]
    name = f"Texas TriValve {case_name}"
    load = ("pressure_kpa", pressure_kpa)
    return Case(name, points, leaflets, chords, load, comment=comment, contact=contact)


def shell_thickness_mm(path: Path, cards: list, material: str) -> float:
    """Thickness of the shell section with this material."""
    for card in cards:
        if (
            card.keyword == "shell section"
            and card.parameters.get("material", "").lower() == material.lower()
        ):
            return card_numbers(path, card, 1)[0]
    raise InputFault(f"{path}: no *shell section card with material {material}")


def contact_thickness_mm(cards: list, thickness_mm: float, points: dict, leaflets: dict) -> float:
    """The distance at which shells touch: their thickness, but no more than MAXRATIO of an edge (median, open)."""
    ratios = [card.parameters["maxratio"] for card in cards if "maxratio" in card.parameters]
    if not ratios:
        return thickness_mm
    faces = (face for leaflet in leaflets.values() for face in leaflet.faces)
    edges = [
        math.dist(points[a].position_mm, points[b].position_mm)
        for face in faces
        for a, b in zip(face, face[1:] + face[:1])
    ]
    return float(f"{min(thickness_mm, float(ratios[0]) * statistics.median(edges)):.2g}")


def texas_pressure_mpa(path: Path, cards: list) -> float:
    """The pressure of the last *Dsload card: `surface, P, value`."""
    for card in reversed(cards):
        if card.keyword == "dsload" and len(card.data) >= 3:
            try:
                return float(card.data[2])
            except ValueError:
                raise InputFault(f"{path}:{card.line}: *dsload: {card.data[2]!r} is not a number") from None
    raise InputFault(f"{path}: no *dsload card with a pressure")


def texas_membrane(path: Path, cards: list, material: str, compressible: bool) -> Tissue:
    """The law as published; the card holds C0, D, C1, C2."""
    card = material_card(path, cards, material, "anisotropic hyperelastic")
    c0, d, c1, c2 = card_numbers(path, card, 4)
    values = {"c0_mpa": c0, "c1_mpa": c1, "c2": c2, "wrinkling": "tension-field"}
    if compressible:
        values["compressibility_per_mpa"] = d
    values["bending_modulus_mpa"] = TEXAS_BENDING_MODULUS_MPA
    comment = [
        "The published law, W = C0/2 (I1-3) + C1/2 (exp(C2 (I1-3)^2) - 1). Bending is our choice, of the order",
        f"of the modulus where unloaded, 3 C0 = {3.0 * c0:g} MPa; Abaqus' shells have it by integration through",
        "the thickness.",
        f"The input's D = {d:.2f} 1/MPa {'stands here as it is' if compressible else 'is left out'}. With it the",
        "tissue is so compressible that its stress at the published strains bears 0.37 of the pressure (our",
        "measurement on 3939 nodes free of contact and chordae); read as incompressible, 0.77. So",
        "incompressible is what the published state agrees with.",
    ]
    return Tissue("exponential", values, comment)


def texas_springs(path: Path, cards: list, material: str, state: str) -> Tissue:
    """Springs fitted to W = C0/2 (I1-3) + C1/2 (exp(C2 (I1-3)^2) - 1); the card holds C0, D, C1, C2."""
    card = material_card(path, cards, material, "anisotropic hyperelastic")
    c0, _, c1, c2 = card_numbers(path, card, 4)
    fit = fit_springs(ExponentialLaw(c0, c1, c2), TEXAS_CAUCHY_MAX_MPA, state)
    comment = [
        "Springs fitted to W = C0/2 (I1-3) + C1/2 (exp(C2 (I1-3)^2) - 1),",
        f"C0 {c0!r} MPa, C1 {c1!r} MPa, C2 {c2!r},",
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
    return bilinear_springs(*values, comment=comment)


def texas_chord_law(path: Path, cards: list, material: str) -> tuple[dict, list[str]]:
    """The chord group's Ogden law as a table of nominal stress over strain, and how it comes about."""
    card = material_card(path, cards, material, "hyperelastic")
    numbers = card_numbers(path, card, 6)
    terms = list(zip(numbers[0::2], numbers[1::2]))
    steps = range(1, round(TEXAS_CHORD_STRAIN_MAX / TEXAS_CHORD_STRAIN_STEP) + 1)
    strain = [tidy(step * TEXAS_CHORD_STRAIN_STEP) for step in steps]
    stress_mpa = [tidy(ogden_nominal_stress_mpa(terms, 1.0 + value)) for value in strain]
    comment = [
        "Ogden law in Abaqus' form, W = sum 2 mu_i / alpha_i^2 (s1^alpha_i + s2^alpha_i + s3^alpha_i - 3),",
        "incompressible: nominal stress sum 2 mu_i / alpha_i (s^(alpha_i - 1) - s^(-alpha_i / 2 - 1)), sampled",
        f"every {100.0 * TEXAS_CHORD_STRAIN_STEP:g} % of strain; E = 3 sum mu_i = "
        f"{ogden_modulus_mpa(terms):.6g} MPa at no strain.",
        "In the published closed frame 99 % of the chords stretch by less than 0.8 %, most by much less.",
    ]
    return {"kind": "table", "strain": [0.0, *strain], "stress_mpa": [0.0, *stress_mpa]}, comment
