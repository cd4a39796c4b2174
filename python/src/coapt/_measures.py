"""What a closed valve measures, as the report tells it. Definitions and sources: ``crates/coapt/src/measure``."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, TypeVar, cast, get_type_hints

__all__ = [
    "Annulus",
    "Billow",
    "ChordGroupForces",
    "Chords",
    "Coaptation",
    "LeafletMeasures",
    "Measures",
    "Orifice",
    "PapillaryForce",
    "SutureForces",
    "Tenting",
]


@dataclass(frozen=True)
class Annulus:
    """Size and shape of the closed annulus; diameters are straight distances between landmarks.

    Attributes
    ----------
    ap_mm : float
        Anteroposterior (septolateral) diameter [mm].
    commissural_mm : float
        Commissural width [mm].
    intertrigonal_mm : float
        Left to right trigone [mm].
    circumference_mm : float
        Length of the annulus curve [mm].
    area_2d_mm2 : float
        Area enclosed by its projection on the annular plane [mm²].
    area_3d_mm2 : float
        Area of the fan of triangles from its centre to its edges [mm²].
    height_mm : float
        Highest minus lowest point over the annular plane [mm], as SlicerHeart defines it.
    ahcwr : float
        Annular height to commissural width ratio [1] (Salgo 2002).
    nonplanarity_angle_deg : float
        Mid-anterior, midpoint of the commissures, mid-posterior [°]; 180 is flat.
    sphericity : float
        Anteroposterior over commissural diameter [1].
    """

    ap_mm: float
    commissural_mm: float
    intertrigonal_mm: float
    circumference_mm: float
    area_2d_mm2: float
    area_3d_mm2: float
    height_mm: float
    ahcwr: float
    nonplanarity_angle_deg: float
    sphericity: float


@dataclass(frozen=True)
class Coaptation:
    """How far the leaflets lie on each other.

    Attributes
    ----------
    area_mm2 : float
        Area of contact [mm²], half the sum over both sides.
    length_mean_mm : float
        Coaptation length, mean along the line of closure [mm] (SlicerHeart).
    length_max_mm : float
        The same, at its largest [mm].
    length_a2p2_mm : float
        The same at A2-P2 [mm]; 0 where nothing touches there. A clip's grasp and stitches count.
    closure_line_mm : float
        Length of the line of closure [mm].
    contact_depth_mm : float
        Area over the line of closure [mm].
    self_contact_area_mm2 : float
        Area of contact of leaflets with themselves [mm²]; not part of ``area_mm2``.
    """

    area_mm2: float
    length_mean_mm: float
    length_max_mm: float
    length_a2p2_mm: float
    closure_line_mm: float
    contact_depth_mm: float
    self_contact_area_mm2: float


@dataclass(frozen=True)
class Orifice:
    """What is left open: an anatomic orifice, not an effective one.

    Attributes
    ----------
    area_mm2 : float
        Anatomic regurgitant orifice area [mm²]: what open margins bound, between middle surfaces.
    count : int
        Number of holes.
    max_gap_mm : float
        How wide the widest hole gapes [mm], on the side where a margin is nearer to the other leaflet; nothing of its length.
    passage_mm2 : float or None
        The narrowest passage [mm²]: area of the smallest surface that parts atrium and ventricle, between the surfaces of the
        tissue, found without regard to margins; None where it was not asked for (samples, films) or leaflets do not hang from the
        annulus all round.
    """

    area_mm2: float
    count: int
    max_gap_mm: float
    passage_mm2: float | None = None


@dataclass(frozen=True)
class Tenting:
    """The closed leaflets below the annular surface.

    Attributes
    ----------
    height_mm : float
        Greatest depth [mm].
    area_mm2 : float
        Area in the section through mid-anterior and mid-posterior annulus [mm²].
    volume_ml : float
        Volume [mL].
    """

    height_mm: float
    area_mm2: float
    volume_ml: float


@dataclass(frozen=True)
class Billow:
    """The closed leaflets above the annular surface.

    Attributes
    ----------
    height_mm : float
        Greatest height [mm].
    volume_ml : float
        Volume [mL].
    """

    height_mm: float
    volume_ml: float


@dataclass(frozen=True)
class LeafletMeasures:
    """One leaflet.

    Attributes
    ----------
    name : str
        Name.
    area_rest_mm2 : float
        Area in the open, unloaded valve [mm²].
    area_mm2 : float
        Area as closed [mm²].
    strain_p95 : float
        95th percentile of the strain of its edges [mm/mm].
    """

    name: str
    area_rest_mm2: float
    area_mm2: float
    strain_p95: float


@dataclass(frozen=True)
class ChordGroupForces:
    """Tensions of one group of chordae.

    Attributes
    ----------
    name : str
        Name of the group.
    max_force_n : float
        Largest tension of any segment [N].
    total_force_n : float
        Sum over the segments that insert into a leaflet [N].
    """

    name: str
    max_force_n: float
    total_force_n: float


@dataclass(frozen=True)
class Chords:
    """Tensions of all chordae, the patient's own and neochordae.

    Attributes
    ----------
    max_force_n : float
        Largest tension of any segment [N].
    total_force_n : float
        Sum over the segments that insert into a leaflet [N].
    groups : tuple of ChordGroupForces
        The same per group.
    """

    max_force_n: float
    total_force_n: float
    groups: tuple[ChordGroupForces, ...]


@dataclass(frozen=True)
class SutureForces:
    """Tensions of the stitches of one repair, or of the grip of a clip.

    Attributes
    ----------
    name : str
        Name of the repair.
    max_force_n : float
        Largest tension [N].
    total_force_n : float
        Sum of the tensions [N].
    """

    name: str
    max_force_n: float
    total_force_n: float


@dataclass(frozen=True)
class PapillaryForce:
    """Force on one papillary muscle.

    Attributes
    ----------
    name : str
        Name.
    force_n : tuple of float
        Force of the chordae on its tips together [N], LPS, shape (3,).
    """

    name: str
    force_n: tuple[float, float, float]


@dataclass(frozen=True)
class Measures:
    """Everything that is measured of a closed valve.

    Attributes
    ----------
    annulus : Annulus
    coaptation : Coaptation
    orifice : Orifice
    tenting : Tenting
    billow : Billow
    leaflets : tuple of LeafletMeasures
    chords : Chords
    sutures : tuple of SutureForces
        Of each repair that sews.
    papillary : tuple of PapillaryForce
    annulus_force_n : tuple of float
        Force of the valve on the whole annulus [N], LPS, shape (3,).
    """

    annulus: Annulus
    coaptation: Coaptation
    orifice: Orifice
    tenting: Tenting
    billow: Billow
    leaflets: tuple[LeafletMeasures, ...]
    chords: Chords
    sutures: tuple[SutureForces, ...]
    papillary: tuple[PapillaryForce, ...]
    annulus_force_n: tuple[float, float, float]


Made = TypeVar("Made")


def made(kind: type[Made], told: dict[str, Any]) -> Made:
    """A dataclass from the object of a report that has its keys; other keys are an error, so that nothing is lost unnoticed."""
    hints = get_type_hints(kind)
    values = {key: _value(hints[key], value) if key in hints else value for key, value in told.items()}
    return kind(**values)


def measures(outcome: dict[str, Any]) -> Measures:
    """The measures of one closed state in a report."""
    keys = {field.name for field in fields(Measures)}
    return made(Measures, {key: outcome[key] for key in keys})


def _value(kind: Any, value: Any) -> Any:
    if isinstance(value, dict):
        return made(cast("type[Any]", kind), value)
    if isinstance(value, list):
        inner = kind.__args__[0]
        return tuple(_value(inner, item) for item in value)
    return value
