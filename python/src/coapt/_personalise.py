"""Chord lengths fitted to a closed image."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast, final

import coapt._coapt as _core
from coapt._closed import Closed
from coapt._compare import Surface, native_surface
from coapt._given import A_VALVE, of_type
from coapt._measures import made
from coapt._optional import needed
from coapt._plain import Json
from coapt._progress import Progress
from coapt._result import Frozen
from coapt._valve import Valve

if TYPE_CHECKING:
    import pandas

FitStatus = Literal["fitted", "at-bound", "iteration-limit", "not-converged", "interrupted"]


@dataclass(frozen=True)
class ChordScale:
    """The factor of one group of chordae.

    Attributes
    ----------
    name : str
        Name of the group.
    scale : float
        Fitted rest length over the valve's own [1].
    interval_95 : tuple of float
        Within these the scatter of the surface's points explains the misfit, with 95 % probability [1], shape (2,). What the
        model gets wrong, or an annulus in the wrong place, comes on top.
    identified : bool
        Whether the interval is narrower than a tenth: else the surface does not decide this factor.
    """

    name: str
    scale: float
    interval_95: tuple[float, float]
    identified: bool


@dataclass(frozen=True)
class TargetDistance:
    """From the points of the surface to the nearest place of a closed valve.

    Attributes
    ----------
    points : int
        Points.
    rms_mm : float
        Root mean square [mm].
    mean_mm : float
        Mean, without sign [mm].
    mean_signed_mm : float
        Mean with sign, positive where the surface lies on the atrial side of the valve [mm].
    p95_mm : float
        Not exceeded by 95 % of the points [mm].
    max_mm : float
        Largest [mm].
    """

    points: int
    rms_mm: float
    mean_mm: float
    mean_signed_mm: float
    p95_mm: float
    max_mm: float


@final
class FitResult(Frozen[_core.Fit]):
    """Chord lengths fitted to a closed surface. Made by :func:`coapt.personalise`.

    The fitted error is of the shape that the chordae were fitted to: it says how well the model can be made to look like it, not
    how well it predicts. Research use, not a medical device.
    """

    __slots__ = ("_report",)
    _report: dict[str, Any]
    _MADE_BY = "fitting chordae: coapt.personalise()"

    @classmethod
    def _of(cls, made: _core.Fit) -> FitResult:
        result = super()._of(made)
        object.__setattr__(result, "_report", json.loads(made.report_json()))
        return result

    @classmethod
    def _of_bytes(cls, stored: bytes) -> FitResult:
        return cls._of(_core.Fit.from_stored(stored))

    def __repr__(self) -> str:
        factors = ", ".join(f"{group.name} {group.scale:.3f}" for group in self.groups)
        return f"<coapt.FitResult {self.status}: {factors}>"

    @property
    def status(self) -> FitStatus:
        """How the fit ended: ``at-bound`` where a factor lies at an end of its range of 0.7 to 1.5, so that a better one may lie
        beyond; ``iteration-limit`` where the search was still moving; ``not-converged`` where there is no result."""
        return cast(FitStatus, self._report["status"])

    @property
    def certified(self) -> bool:
        """Whether the fitted valve may be used: ``fitted``, and its closure certified."""
        return self._native.certified

    @property
    def groups(self) -> tuple[ChordScale, ...]:
        """The factor of each group of chordae; all one without a result."""
        return tuple(made(ChordScale, told) for told in self._report["chord_groups"])

    @property
    def valve(self) -> Valve | None:
        """The valve with the fitted lengths; None without a result."""
        valve = self._native.valve
        return None if valve is None else Valve._of(valve)

    @property
    def before(self) -> Closed | None:
        """The valve as given, closed; None where that did not converge."""
        closed = self._native.untuned
        return None if closed is None else Closed._of(closed)

    @property
    def after(self) -> Closed | None:
        """The valve with the fitted lengths, closed; None without a result."""
        closed = self._native.tuned
        return None if closed is None else Closed._of(closed)

    @property
    def distance_before(self) -> TargetDistance | None:
        """From all points of the surface to ``before``."""
        return self._distance("untuned", "all_points")

    @property
    def distance_after(self) -> TargetDistance | None:
        """From all points of the surface to ``after``."""
        return self._distance("tuned", "all_points")

    @property
    def visible_distance_before(self) -> TargetDistance | None:
        """From the points whose nearest place on ``before`` is visible from the atrium."""
        return self._distance("untuned", "visible_points")

    @property
    def visible_distance_after(self) -> TargetDistance | None:
        """From the points whose nearest place on ``after`` is visible from the atrium."""
        return self._distance("tuned", "visible_points")

    def _distance(self, state: str, points: str) -> TargetDistance | None:
        told = self._report[state]
        return None if told is None else made(TargetDistance, told[points])

    def text(self) -> str:
        """The fit as ``coapt personalise`` prints it: factors with their intervals, distances before and after, notice."""
        return self._native.text()

    def to_dict(self) -> dict[str, Json]:
        """The fit with the keys of ``personalise.json``; units are in the names."""
        return cast("dict[str, Json]", json.loads(self._native.report_json()))

    def to_dataframe(self) -> pandas.DataFrame:
        """A row per group of chordae: name, scale, the ends of its interval, whether it is identified; needs pandas."""
        with needed("pandas", "to_dataframe()"):
            import pandas

        rows = [(it.name, it.scale, *it.interval_95, it.identified) for it in self.groups]
        columns = ["group", "scale", "interval_95_low", "interval_95_high", "identified"]
        table: pandas.DataFrame = pandas.DataFrame(rows, columns=columns)
        return table


def personalise(
    valve: Valve,
    closed_surface: Surface,
    *,
    per_group: bool = False,
    progress: Progress | None = None,
) -> FitResult:
    """Fits the lengths of the chordae so that the valve closes to an imaged shape, as ``coapt personalise``.

    Parameters
    ----------
    valve : Valve
        The patient's valve before any repair. Its annulus and papillary tips must move, on closing, to where the image has
        them: see ``annulus_displacement_mm`` of :class:`Leaflet`.
    closed_surface : Closed, path, or two arrays
        The closed leaflets' mid-surface, in mm and in the frame of the valve; what was seen of them is enough. A surface file
        (.vtp, .vtk, .ply, .stl, .obj), or arrays as of :func:`coapt.compare`.
    per_group : bool
        One factor for each group of chordae instead of one for all.
    progress : callable, optional
        Called in this thread, some times in a second, with how many closures are done and of how many that are known of: the search
        decides as it goes, so that these become more.

    Raises
    ------
    InputError
        A valve with repairs or without chordae; a surface that is none, or far from the valve.
    TypeError
        What is no valve; what is no surface, such as an open valve.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    Exception
        What ``progress`` raises; the work ends then.
    """
    native = of_type(Valve, "valve", valve, A_VALVE)._native
    given = native_surface("closed_surface", closed_surface)
    return FitResult._of(_core.personalise(native, given, per_group, progress))
