"""What a valve is made of: leaflets, chordae, papillary muscles, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

from coapt._arrays import FloatArray, GivenIndices
from coapt._plain import PlainData, Value
from coapt._tissue import ChordLaw, Tissue


@dataclass(frozen=True, eq=False)
class Leaflet:
    """One leaflet: its open shape, which is also its unloaded shape, and its tissue.

    Parameters
    ----------
    name : str
        Name in reports; ``anterior`` and ``posterior`` also orient the landmarks.
    points_mm : ndarray of float64, shape (n, 3)
        Points of the open, unloaded surface [mm], C-contiguous.
    triangles : ndarray of int32, int64, uint32 or uint64, shape (m, 3)
        Triangles as point numbers from 0, C-contiguous.
    annulus_points : ndarray of such integers, shape (k,), optional
        Points on the annulus. Left out of all leaflets: found geometrically, or by ``annulus_mm`` of the valve.
    annulus_displacement_mm : ndarray of float64, shape (n, 3), optional
        Prescribed motion of annulus points from the open to the closed phase [mm]; other rows are ignored.
    thickness_mm : float, optional
        Tissue thickness [mm]. Default: 1.
    tissue : Tissue, optional
        The stress-strain law. Default: ``BilinearSprings()``.
    """

    name: str
    points_mm: FloatArray = field(repr=False)
    triangles: GivenIndices = field(repr=False)
    annulus_points: GivenIndices | None = field(default=None, repr=False)
    annulus_displacement_mm: FloatArray | None = field(default=None, repr=False)
    thickness_mm: float | None = None
    tissue: Tissue | None = None


@dataclass(frozen=True, eq=False)
class ChordGroup:
    """Chordae of one kind: tension-only rods. A chord may branch and may be a polyline of several segments.

    Parameters
    ----------
    name : str
        Name in reports, for example ``marginal``.
    points_mm : ndarray of float64, shape (n, 3)
        Points in the open phase [mm]. An end is welded to the papillary tip, leaflet point or chord end that it lies on.
    segments : ndarray of int32, int64, uint32 or uint64, shape (m, 2)
        Segments as point numbers from 0.
    rest_length_mm : ndarray of float64, shape (m,), optional
        Unloaded length of each segment [mm]. Default: its length in the open phase.
    area_mm2 : ndarray of float64, shape (m,), optional
        Cross-section of each segment [mm²]. Default: from ``diameter_mm``.
    diameter_mm : float, optional
        Rod diameter [mm]. Default: 1.
    modulus_mpa : float, optional
        Young's modulus of a linear law [MPa], instead of ``law``. Default: 30.
    law : ChordLaw, optional
        The stress-strain law, instead of ``modulus_mpa``.
    rest_length_scale : float, optional
        Factor on all rest lengths [1]. Default: 1.
    insertion_radius_mm : float, optional
        Leaflet tissue this near an insertion shares the chord's pull [mm]. Default: 1.5.
    """

    name: str
    points_mm: FloatArray = field(repr=False)
    segments: GivenIndices = field(repr=False)
    rest_length_mm: FloatArray | None = field(default=None, repr=False)
    area_mm2: FloatArray | None = field(default=None, repr=False)
    diameter_mm: float | None = None
    modulus_mpa: float | None = None
    law: ChordLaw | None = None
    rest_length_scale: float | None = None
    insertion_radius_mm: float | None = None


@dataclass(frozen=True, eq=False)
class PapillaryMuscle:
    """A papillary muscle: one or several tips.

    Parameters
    ----------
    name : str
        Name in reports, for example ``anterolateral``.
    tips_mm : ndarray of float64, shape (n, 3)
        Tips in the open phase [mm].
    displacements_mm : ndarray of float64, shape (n, 3), optional
        Prescribed motion of each tip to the closed phase [mm]. Default: the tips stay.
    """

    name: str
    tips_mm: FloatArray = field(repr=False)
    displacements_mm: FloatArray | None = field(default=None, repr=False)


#: Keys of a chord group in a scene, beside its mesh.
CHORD_KEYS = (
    "name",
    "diameter_mm",
    "modulus_mpa",
    "law",
    "rest_length_scale",
    "insertion_radius_mm",
)


def keys_of(part: object, *keys: str) -> dict[str, Value]:
    """Some attributes as keys of a scene."""
    made: dict[str, Value] = {}
    for key in keys:
        value = getattr(part, key)
        if value is not None:
            made[key] = value.to_dict() if isinstance(value, PlainData) else value
    return made
