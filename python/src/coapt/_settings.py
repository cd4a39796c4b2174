"""How leaflets touch, where landmarks are and how equilibria are sought, with the keys of scenes.

Written by python/tools/plain_data.py from the schemas under assets/schema.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from coapt._plain import PlainData, Vector

__all__ = [
    "Contact",
    "Landmarks",
    "Settings",
    "Weld",
]


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact(PlainData):
    """How leaflets touch: a penalty that grows without bound as the mid-surfaces approach each other.

    Parameters
    ----------
    stiffness_mpa : float, optional
        Scale of the contact pressure [MPa]; see ``contact`` for the law. 0: leaflets pass through
        each other, as in models without contact. Default: 0.5.
    thickness_mm : float, optional
        Mid-surface distance at which contact begins [mm]. Default: 1.0.
    """

    stiffness_mpa: float | None = None
    thickness_mm: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Landmarks(PlainData):
    """Named points on the annulus [mm].

    Parameters
    ----------
    commissure_anterolateral_mm : Vector, optional
        Anterolateral commissure.
    commissure_posteromedial_mm : Vector, optional
        Posteromedial commissure.
    mid_anterior_mm : Vector, optional
        Middle of the anterior annulus (A2 hinge).
    mid_posterior_mm : Vector, optional
        Middle of the posterior annulus (P2 hinge).
    trigone_left_mm : Vector, optional
        Left (anterolateral side) fibrous trigone.
    trigone_right_mm : Vector, optional
        Right (posteromedial side) fibrous trigone.
    """
    _LISTS: ClassVar[tuple[str, ...]] = ("commissure_anterolateral_mm", "commissure_posteromedial_mm", "mid_anterior_mm", "mid_posterior_mm", "trigone_left_mm", "trigone_right_mm",)

    commissure_anterolateral_mm: Vector | None = None
    commissure_posteromedial_mm: Vector | None = None
    mid_anterior_mm: Vector | None = None
    mid_posterior_mm: Vector | None = None
    trigone_left_mm: Vector | None = None
    trigone_right_mm: Vector | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings(PlainData):
    """How the equilibrium is sought.

    Parameters
    ----------
    coarse_to_fine : bool, optional
        Whether an open valve is closed on coarser meshes first. The result is the same but for what
        several stable shapes allow; without it large meshes take far longer. Default: true.
    face_limit : int, optional
        Valves of more triangles are refused, with an estimate of what closing them would cost.
        Default: 250000.
    iteration_limit : int, optional
        Give up after so many solver iterations on one mesh, begun anew or not, and say so. Default:
        4000.
    residual_tolerance : float, optional
        Largest force left on a free vertex, over the mean nodal pressure force or, where that is
        more, the pull of a strain of 1e-3 [1]. Default: 1e-06.
    step_scale : float, optional
        Longest step of the solver over its own choice [1]; for studies of how far the result
        depends on the road. Default: 1.0.
    """

    coarse_to_fine: bool | None = None
    face_limit: int | None = None
    iteration_limit: int | None = None
    residual_tolerance: float | None = None
    step_scale: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Weld(PlainData):
    """How near points must be to count as one.

    Parameters
    ----------
    insertion_tolerance_mm : float, optional
        A chord end within this distance of a leaflet inserts at its nearest point [mm]. Default:
        1.0.
    tolerance_mm : float, optional
        Leaflet points, branch nodes and papillary tips within this distance are one [mm]. Default:
        0.01.
    """

    insertion_tolerance_mm: float | None = None
    tolerance_mm: float | None = None
