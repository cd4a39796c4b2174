"""The Texas TriValve layout: `<case>_*.csv` tables and the material cards of the Abaqus input."""

from __future__ import annotations

from pathlib import Path

from case_tables import Columns, read_chords, read_leaflets, read_points, tidy
from scene_files import Case, Tissue
from spring_fit import ExponentialLaw, fit_springs, ogden_modulus_mpa, ogden_nominal_stress_mpa
from tables import InputFault, card_numbers, material_card, read_cards

# Largest working Cauchy stress of the Texas TriValve leaflets [MPa]: the 99th percentile of the maximum
# principal stress in the published end-systolic frame (mean 0.059).
TEXAS_CAUCHY_MAX_MPA = 0.152


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
        f"Texas TriValve 1.1, {case_name} (a tricuspid valve). Mathur et al., Engineering with Computers",
        "2022, doi 10.1007/s00366-022-01659-w, CC BY 4.0; changed: turned from Abaqus into springs and rods.",
        "Frame: as in the Abaqus input, z to the atrium; no patient frame is given, LPS is our label.",
    ]
    name = f"Texas TriValve {case_name}"
    return Case(name, points, leaflets, chords, ("pressure_kpa", pressure_kpa), comment=comment)


def shell_thickness_mm(path: Path, cards: list, material: str) -> float:
    """Thickness of the shell section with this material."""
    for card in cards:
        if (
            card.keyword == "shell section"
            and card.parameters.get("material", "").lower() == material.lower()
        ):
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
    return Tissue(*values, comment=comment)


def texas_chord_modulus(path: Path, cards: list, material: str) -> tuple[float, list[str]]:
    """Small-strain modulus of the chord group's Ogden law, and how it comes about."""
    card = material_card(path, cards, material, "hyperelastic")
    numbers = card_numbers(path, card, 6)
    terms = list(zip(numbers[0::2], numbers[1::2]))
    modulus_mpa = ogden_modulus_mpa(terms)
    secant = ogden_nominal_stress_mpa(terms, 1.004) / 0.004 / modulus_mpa - 1.0
    comment = [
        "Ogden law in Abaqus' form, W = sum 2 mu_i / alpha_i^2 (s1^alpha_i + s2^alpha_i + s3^alpha_i - 3):",
        f"initial shear modulus sum mu_i = {modulus_mpa / 3.0:.6g} MPa, incompressible, so E = 3 sum mu_i.",
        "In the published closed frame 99 % of the chords stretch by less than 0.8 %, most by much less;",
        f"at 0.4 % the law's secant modulus is {100.0 * secant:+.1f} % off E.",
    ]
    return modulus_mpa, comment
