"""What is done to a valve, with the keys of plans.

Written by python/tools/plain_data.py from the schemas under assets/schema.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias, Union

from coapt._plain import Curve, RepairData, Vector

__all__ = [
    "Alfieri",
    "Augment",
    "Clip",
    "CloseCleft",
    "CutChord",
    "Neochord",
    "RelocatePapillary",
    "Repair",
    "Resect",
    "Ring",
    "Rupture",
    "TransferChord",
]


@dataclass(frozen=True, kw_only=True, slots=True)
class Ring(RepairData):
    """Annuloplasty: the annulus is drawn onto a ring.

    Parameters
    ----------
    ap_mm : float, optional
        Inner anteroposterior diameter [mm], instead of the family's share of the size.
    attachment : Literal["arc-length", "nearest-point", "sutures"], optional
        How annulus points find their place on the ring. Default: "arc-length".
    closed : bool, optional
        Whether the curve closes on itself; a family knows.
    curve_mm : Curve, optional
        Ring curve as a polyline [mm], shape ``[point]``.
    family : Literal["classic-like", "physio-like", "saddle", "reduced-ap", "posterior-band"], optional
        Parametric family; needs ``size_mm``. A generic shape, not any maker's geometry.
    flexible : bool, optional
        The ring is a thread in the annulus rather than a frame: it takes the annulus' length, not
        its shape.
    placed : bool, optional
        Use the curve where it stands instead of fitting it to the annulus' landmarks. Default:
        false.
    saddle_height_mm : float, optional
        How far the ring's anterior middle stands above its widest line, toward the atrium [mm],
        instead of the family's share of the size. The posterior middle stands up in the family's
        proportion to it, in a planar family's by 0.3, as in ``saddle``.
    size_mm : float, optional
        Inner transverse diameter [mm], for a family.
    sutures : int, optional
        How many sutures there are, for ``attachment = "sutures"``; absent: 12, of the 10 to 14 that
        are usual.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "ring")
    _LISTS: ClassVar[tuple[str, ...]] = ("curve_mm",)
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {"curve_mm": (None, 3)}

    ap_mm: float | None = None
    attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None
    closed: bool | None = None
    curve_mm: Curve | None = None
    family: Literal["classic-like", "physio-like", "saddle", "reduced-ap", "posterior-band"] | None = None
    flexible: bool | None = None
    placed: bool | None = None
    saddle_height_mm: float | None = None
    size_mm: float | None = None
    sutures: int | None = None

    @classmethod
    def classic_like(
        cls,
        size_mm: float,
        *,
        ap_mm: float | None = None,
        saddle_height_mm: float | None = None,
        attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None,
        sutures: int | None = None,
        flexible: bool | None = None,
    ) -> Ring:
        """Open, rigid, planar. ``size_mm`` is the inner transverse diameter [mm]."""
        return cls(
            family="classic-like",
            size_mm=size_mm,
            ap_mm=ap_mm,
            saddle_height_mm=saddle_height_mm,
            attachment=attachment,
            sutures=sutures,
            flexible=flexible,
        )

    @classmethod
    def physio_like(
        cls,
        size_mm: float,
        *,
        ap_mm: float | None = None,
        saddle_height_mm: float | None = None,
        attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None,
        sutures: int | None = None,
        flexible: bool | None = None,
    ) -> Ring:
        """Closed, mild anterior saddle. ``size_mm`` is the inner transverse diameter [mm]."""
        return cls(
            family="physio-like",
            size_mm=size_mm,
            ap_mm=ap_mm,
            saddle_height_mm=saddle_height_mm,
            attachment=attachment,
            sutures=sutures,
            flexible=flexible,
        )

    @classmethod
    def saddle(
        cls,
        size_mm: float,
        *,
        ap_mm: float | None = None,
        saddle_height_mm: float | None = None,
        attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None,
        sutures: int | None = None,
        flexible: bool | None = None,
    ) -> Ring:
        """Closed, pronounced saddle. ``size_mm`` is the inner transverse diameter [mm]."""
        return cls(
            family="saddle",
            size_mm=size_mm,
            ap_mm=ap_mm,
            saddle_height_mm=saddle_height_mm,
            attachment=attachment,
            sutures=sutures,
            flexible=flexible,
        )

    @classmethod
    def reduced_ap(
        cls,
        size_mm: float,
        *,
        ap_mm: float | None = None,
        saddle_height_mm: float | None = None,
        attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None,
        sutures: int | None = None,
        flexible: bool | None = None,
    ) -> Ring:
        """Closed, reduced anteroposterior diameter. ``size_mm`` is the inner transverse diameter [mm]."""
        return cls(
            family="reduced-ap",
            size_mm=size_mm,
            ap_mm=ap_mm,
            saddle_height_mm=saddle_height_mm,
            attachment=attachment,
            sutures=sutures,
            flexible=flexible,
        )

    @classmethod
    def posterior_band(
        cls,
        size_mm: float,
        *,
        ap_mm: float | None = None,
        saddle_height_mm: float | None = None,
        attachment: Literal["arc-length", "nearest-point", "sutures"] | None = None,
        sutures: int | None = None,
        flexible: bool | None = None,
    ) -> Ring:
        """Open band along the posterior annulus. ``size_mm`` is the inner transverse diameter [mm]."""
        return cls(
            family="posterior-band",
            size_mm=size_mm,
            ap_mm=ap_mm,
            saddle_height_mm=saddle_height_mm,
            attachment=attachment,
            sutures=sutures,
            flexible=flexible,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Clip(RepairData):
    """Edge-to-edge repair with a clip, which grips both leaflets between its arms.

    Parameters
    ----------
    angle_deg : float, optional
        How far the arms lean from the perpendicular of the margin toward the posteromedial
        commissure [°], on both leaflets. Default: 0.0.
    grasp_anterior_mm : float, optional
        How much of the anterior leaflet is gripped, from its margin [mm]; absent: 3 less than the
        arms, 6 or 9.
    grasp_posterior_mm : float, optional
        How much of the posterior leaflet is gripped, from its margin [mm]; absent: 3 less than the
        arms, 6 or 9.
    model : Literal["springs", "rigid"], optional
        How the grip is modelled. Default: "springs".
    position : float, optional
        Where along the line of closure, as share of the margin's arc length from the anterolateral
        commissure [1]; instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the line of closure, by name.
    size : Literal["short", "short-wide", "long", "long-wide"], optional
        How large it is. Default: "short".
    stiffness_n_per_mm : float, optional
        Stiffness of each tie between two gripped places [N/mm]; absent: 9.81 for springs, 50 for
        ``rigid``.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "clip")

    angle_deg: float | None = None
    grasp_anterior_mm: float | None = None
    grasp_posterior_mm: float | None = None
    model: Literal["springs", "rigid"] | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None
    size: Literal["short", "short-wide", "long", "long-wide"] | None = None
    stiffness_n_per_mm: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Alfieri(RepairData):
    """Edge-to-edge repair with stitches (Alfieri): a stretch of both margins is sewn together.

    Parameters
    ----------
    bite_mm : float, optional
        How far from the margin the stitches go through the leaflets [mm]. 2 is our choice: what a
        thread holds in. Default: 2.0.
    length_mm : float, optional
        Length of the stretch [mm]. 5 to 10 is usual; 8 is our choice. Default: 8.0.
    position : float, optional
        Where along the line of closure, as share of the margin's arc length from the anterolateral
        commissure [1]; instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the line of closure, by name.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "alfieri")

    bite_mm: float | None = None
    length_mm: float | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Neochord(RepairData):
    """Artificial chordae from a papillary tip to a leaflet.

    Parameters
    ----------
    leaflet : str
        Name of the leaflet that they are sewn to.
    axial_stiffness_n : float, optional
        Force over strain of each strand [N]. 90, our choice: the middle of the 30 to 150 N that are
        quoted for threads of 0.25 to 0.31 mm; one of 20 mm gives 0.1 mm under half a newton,
        anywhere in that range less than a mesh shows. Default: 90.0.
    depth_mm : float, optional
        Instead of a length, how far below the plane of the closed annulus the margin is to end
        [mm]; a geometric estimate. 5 where neither is given: 4 to 6 is usual.
    inset_mm : float, optional
        How far from the margin they are sewn [mm]. Default: 0.0.
    length_mm : float, optional
        Unloaded length from the tip to the leaflet [mm]. Must be there beside ``point_mm``, where
        none is estimated.
    muscle : str, optional
        Name of the papillary muscle; absent: that of the nearest tip.
    point_mm : Vector, optional
        The place on the leaflet itself [mm], in the open valve; instead of ``site`` or
        ``position``.
    position : float, optional
        Where along the margin, as share of its arc length from the anterolateral commissure [1];
        instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the margin, by name.
    spread_mm : float, optional
        Distance along the margin between the outermost strands [mm]. 4 is our choice, about the
        distance of native marginal chordae. Strands to a point of their own all go there. Default:
        4.0.
    strands : int, optional
        How many strands. 2: a thread makes a loop. Default: 2.
    tip : int, optional
        Number of the muscle's tip, from 0; absent: the nearest.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "neochord")
    _LISTS: ClassVar[tuple[str, ...]] = ("point_mm",)
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {"point_mm": (3,)}

    leaflet: str
    axial_stiffness_n: float | None = None
    depth_mm: float | None = None
    inset_mm: float | None = None
    length_mm: float | None = None
    muscle: str | None = None
    point_mm: Vector | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None
    spread_mm: float | None = None
    strands: int | None = None
    tip: int | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class CutChord(RepairData):
    """Chordae are cut, as those that tether a leaflet.

    Parameters
    ----------
    count : int, optional
        How many, the nearest first; absent: one.
    group : str, optional
        Name of the group it belongs to; absent: any.
    near_mm : Vector, optional
        A place near their insertions [mm], in the open valve; absent: all of the group.
    part : Literal["chord", "branch"], optional
        What is cut. Default: "chord".

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "cut-chord")
    _LISTS: ClassVar[tuple[str, ...]] = ("near_mm",)
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {"near_mm": (3,)}

    count: int | None = None
    group: str | None = None
    near_mm: Vector | None = None
    part: Literal["chord", "branch"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class TransferChord(RepairData):
    """A chord is set to another place of a leaflet or to another papillary tip.

    Parameters
    ----------
    near_mm : Vector
        A place near the insertion of the chord that is meant [mm], in the open valve.
    group : str, optional
        Name of the group it belongs to; absent: any.
    inset_mm : float, optional
        How far from the margin it is sewn [mm]. Default: 0.0.
    leaflet : str, optional
        Name of the leaflet that it is sewn to; absent: it stays where it inserts.
    muscle : str, optional
        Name of the papillary muscle that it is set to; absent: it stays where it comes from.
    point_mm : Vector, optional
        The new place on the leaflet itself [mm], in the open valve; instead of ``site`` or
        ``position``.
    position : float, optional
        Where along the margin, as share of its arc length from the anterolateral commissure [1];
        instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the margin, by name.
    tip : int, optional
        Number of the muscle's tip, from 0; absent: the nearest.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "transfer-chord")
    _LISTS: ClassVar[tuple[str, ...]] = ("near_mm", "point_mm",)
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {"near_mm": (3,), "point_mm": (3,)}

    near_mm: Vector
    group: str | None = None
    inset_mm: float | None = None
    leaflet: str | None = None
    muscle: str | None = None
    point_mm: Vector | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None
    tip: int | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Rupture(RepairData):
    """Chordae tear; no repair, but what one is for.

    Parameters
    ----------
    region : Literal["A1", "A2", "A3", "P1", "P2", "P3"]
        The segment.
    count : int, optional
        How many, instead of a fraction.
    fraction : float, optional
        How many of the segment's chordae [1], rounded to whole chordae but at least one; absent:
        all.
    groups : Sequence[str], optional
        Names of the groups that tear. Default: ["marginal"].

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "rupture")
    _LISTS: ClassVar[tuple[str, ...]] = ("groups",)

    region: Literal["A1", "A2", "A3", "P1", "P2", "P3"]
    count: int | None = None
    fraction: float | None = None
    groups: Sequence[str] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class RelocatePapillary(RepairData):
    """A papillary muscle is drawn elsewhere.

    Parameters
    ----------
    muscle : str
        Name of the muscle.
    by_mm : Vector, optional
        By how much its tips move [mm].
    distance_mm : float, optional
        How far toward that place [mm]; 5 to 15 is usual.
    toward : Literal["mid-anterior", "mid-posterior", "commissure-anterolateral", "commissure-posteromedial", "trigone-left", "trigone-right"], optional
        Instead of a vector, the place of the closed annulus toward which they are drawn.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "relocate-papillary")
    _LISTS: ClassVar[tuple[str, ...]] = ("by_mm",)
    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {"by_mm": (3,)}

    muscle: str
    by_mm: Vector | None = None
    distance_mm: float | None = None
    toward: Literal["mid-anterior", "mid-posterior", "commissure-anterolateral", "commissure-posteromedial", "trigone-left", "trigone-right"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class CloseCleft(RepairData):
    """An indentation of the posterior margin is sewn up.

    Parameters
    ----------
    position : float
        Where the indentation is, as share of the posterior margin's arc length from the
        anterolateral commissure [1]; its bottom is sought within 4 mm of there.
    depth_mm : float
        How far stitches go along its edges, from the bottom [mm].

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "close-cleft")

    position: float
    depth_mm: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Resect(RepairData):
    """A piece of a leaflet is cut out, and the edges of the gap are sewn together.

    Parameters
    ----------
    leaflet : str
        Name of the leaflet.
    shape : Literal["triangular", "quadrangular"]
        What is cut out.
    cut_chords : bool, optional
        Whether chordae that insert in the piece are cut with it; else they forbid the resection.
        Default: false.
    height_fraction : float, optional
        How much of the leaflet's height a triangle takes [1]; absent: two thirds, as is usual.
    position : float, optional
        Where along the margin, as share of its arc length from the anterolateral commissure [1];
        instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the margin the middle of the piece is, by name.
    strip_mm : float, optional
        How much a quadrangle leaves at the annulus [mm]; absent: 3, our choice: what holds the
        stitches of the plication.
    width_mm : float, optional
        Width of the piece at the margin [mm]; absent: 10 for a triangle, 15 for a quadrangle.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "resect")

    leaflet: str
    shape: Literal["triangular", "quadrangular"]
    cut_chords: bool | None = None
    height_fraction: float | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None
    strip_mm: float | None = None
    width_mm: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Augment(RepairData):
    """A patch is set into a leaflet, which makes it higher.

    Parameters
    ----------
    leaflet : str
        Name of the leaflet.
    fraction : float, optional
        Part of the leaflet's height that lies between annulus and patch [1]; absent: a quarter, our
        choice.
    length_mm : float, optional
        Length of the patch along the leaflet, measured on the margin [mm]; from its middle to its
        ends its width fades to nothing. 30 is our choice: the middle segment and half of its
        neighbours. Default: 30.0.
    position : float, optional
        Where along the margin, as share of its arc length from the anterolateral commissure [1];
        instead of ``site``.
    site : Literal["A1P1", "A2P2", "A3P3"], optional
        Where along the margin the middle of the patch is, by name.
    width_mm : float, optional
        Width of the patch, from the annulus toward the margin, in its middle [mm]: 8 to 15 is
        usual, 10 our choice. Default: 10.0.

    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "augment")

    leaflet: str
    fraction: float | None = None
    length_mm: float | None = None
    position: float | None = None
    site: Literal["A1P1", "A2P2", "A3P3"] | None = None
    width_mm: float | None = None


#: One surgical deed.
Repair: TypeAlias = Union[Ring, Clip, Alfieri, Neochord, CutChord, TransferChord, Rupture, RelocatePapillary, CloseCleft, Resect, Augment]
