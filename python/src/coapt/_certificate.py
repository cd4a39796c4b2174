"""How far to trust a closed valve, and how the solver came to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from coapt._arrays import IndexArray, read_only

#: Stands in every report.
NOTICE = "research use, not a medical device"

Status = Literal["converged", "iteration-limit", "stalled", "burst", "tangled-start", "interrupted"]


@dataclass(frozen=True, eq=False)
class Certificate:
    """How far a result can be trusted.

    Attributes
    ----------
    certified : bool
        Whether the result may be used: converged, stable, nothing crosses.
    residual : float
        Largest force left on a free vertex over the mean nodal pressure force or, where that is
        more, the pull of a strain of 1e-3 [1].
    stable : bool
        Whether a small push is answered by a return.
    crossings : ndarray of uint32, shape (n, 3)
        Edges (two vertices) that pass through faces (a triangle's number), by exact arithmetic. Must be empty.
    max_penetration_mm : float
        How far mid-surfaces in contact are nearer than their contact distance, at most [mm].
    max_penetration_at_mm : tuple of float or None
        Where that is [mm]; None without contact.
    discretisation_mm : float
        Bound on the distance of the visible surface from that of an infinitely fine mesh, root mean square, estimated [mm].
    """

    certified: bool
    residual: float
    stable: bool
    crossings: IndexArray
    max_penetration_mm: float
    max_penetration_at_mm: tuple[float, float, float] | None
    discretisation_mm: float

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        read_only(self.crossings)


@dataclass(frozen=True)
class Iteration:
    """One iteration of the solver.

    Attributes
    ----------
    residual : float
        Residual before the step [1].
    step_mm : float
        Longest step of a vertex [mm].
    damping : float
        Added stiffness per area [MPa/mm].
    fraction : float
        Part of the step that was taken [1].
    exact : bool
        Whether the exact tangent was used.
    faces : int
        Triangles of the mesh that it worked on: the valve's own or a coarser one's.
    """

    residual: float
    step_mm: float
    damping: float
    fraction: float
    exact: bool
    faces: int
