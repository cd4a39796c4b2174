"""Closed valves: where they came to rest, and what they measure."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Literal, cast, final

import coapt._coapt as _core
from coapt._arrays import FloatArray, IndexArray
from coapt._certificate import Certificate, Iteration, Status
from coapt._measures import (
    Annulus,
    Billow,
    Chords,
    Coaptation,
    LeafletMeasures,
    Measures,
    Orifice,
    PapillaryForce,
    SutureForces,
    Tenting,
    measures,
)
from coapt._plain import Json
from coapt._valve import Valve

if TYPE_CHECKING:
    import matplotlib.figure
    import numpy as np
    import pandas
    import pyvista
    from numpy.typing import NDArray

    from coapt._live import Live
    from coapt._slicer import ModelNode

#: What a picture may be coloured by.
Colour = Literal["gap", "strain", "displacement", "leaflet"]


@final
class Closed:
    """A closed valve. It never changes. Made by :meth:`coapt.Valve.close`.

    Research use, not a medical device: what is not ``certified`` is no prediction, and what is, is one of a model.
    """

    __slots__ = ("_native", "_report")
    _native: _core.Closed
    _report: dict[str, Any] | None

    def __init__(self) -> None:
        raise TypeError("a Closed is made by closing a valve: Valve.close()")

    @classmethod
    def _of(cls, made: _core.Closed) -> Closed:
        closed = cls.__new__(cls)
        object.__setattr__(closed, "_native", made)
        object.__setattr__(closed, "_report", None)
        return closed

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a result does not change; cannot set {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a result does not change; cannot delete {name!r}")

    def __reduce__(self) -> tuple[object, tuple[bytes]]:
        return closed_of_bytes, (self._native.stored(),)

    def __repr__(self) -> str:
        trust = "certified" if self.certified else f"NOT certified ({self.status})"
        return f"<coapt.Closed {self.valve.name!r}: {trust}, orifice {self.orifice.area_mm2:.1f} mm²>"

    def _repr_html_(self) -> str:
        from coapt._html import page

        return page(str(self.valve.name), [("", self)], self._native.rows(None))

    def text(self) -> str:
        """The report as ``coapt closure`` prints it: certificate, table, warnings, notice."""
        return self._native.text(None)

    @property
    def valve(self) -> Valve:
        """The valve that was closed, with its repairs."""
        return Valve._of(self._native.valve)

    @property
    def status(self) -> Status:
        """Why the solver stopped. Not converging is a status, not an error."""
        return cast(Status, self._native.status)

    @property
    def certified(self) -> bool:
        """Whether the result may be used: converged, stable, nothing crosses."""
        return self._native.certified

    @property
    def certificate(self) -> Certificate:
        """How far the result can be trusted."""
        return Certificate(self.certified, *self._native.certificate())

    @property
    def history(self) -> tuple[Iteration, ...]:
        """What happened, iteration by iteration."""
        return tuple(Iteration(*parts) for parts in self._native.history())

    @property
    def wall_ms(self) -> float:
        """Wall-clock time of the closure [ms]; after an edit of a :class:`Live`, of the edit."""
        return self._native.wall_ms

    @property
    def positions_mm(self) -> FloatArray:
        """Closed positions of all vertices [mm], LPS, shape (n, 3), read-only; the order is that of ``valve.points_mm``."""
        return self._native.positions_mm

    @property
    def triangles(self) -> IndexArray:
        """Triangles of all leaflets, shape (m, 3), read-only; normals to the atrium."""
        return self.valve.triangles

    @property
    def reactions_n(self) -> FloatArray:
        """Force of the valve on its support at each vertex [N], zero at free ones, shape (n, 3), read-only."""
        return self._native.reactions_n

    @property
    def gap_mm(self) -> FloatArray:
        """Distance of each leaflet vertex to the opposite leaflet [mm], shape (leaflet vertices,), read-only."""
        return self._native.at_points()[0]

    @property
    def in_contact(self) -> NDArray[np.bool_]:
        """Whether tissue touches tissue at each leaflet vertex, shape (leaflet vertices,), read-only."""
        return self._native.at_points()[1]

    @property
    def strain(self) -> FloatArray:
        """Mean strain of the edges at each leaflet vertex [mm/mm], shape (leaflet vertices,), read-only."""
        return self._native.at_points()[2]

    @property
    def chords(self) -> tuple[FloatArray, IndexArray]:
        """Ends of the chord segments [mm], shape (n, 3), and the segments, shape (m, 2); read-only."""
        return self._native.chords()

    @property
    def chord_forces_n(self) -> FloatArray:
        """Tension of each chord segment [N], shape (m,), read-only."""
        return self._native.chord_forces_n()

    @property
    def measures(self) -> Measures:
        """Everything that is measured. Computed when first asked for."""
        return measures(self._told()["before"])

    @property
    def annulus(self) -> Annulus:
        """Size and shape of the annulus."""
        return self.measures.annulus

    @property
    def coaptation(self) -> Coaptation:
        """How far the leaflets lie on each other."""
        return self.measures.coaptation

    @property
    def orifice(self) -> Orifice:
        """What is left open."""
        return self.measures.orifice

    @property
    def tenting(self) -> Tenting:
        """The closed leaflets below the annular surface."""
        return self.measures.tenting

    @property
    def billow(self) -> Billow:
        """The closed leaflets above the annular surface."""
        return self.measures.billow

    @property
    def leaflets(self) -> tuple[LeafletMeasures, ...]:
        """Areas and strains of each leaflet."""
        return self.measures.leaflets

    @property
    def chord_tensions(self) -> Chords:
        """Chordal tensions, of all and of each group."""
        return self.measures.chords

    @property
    def sutures(self) -> tuple[SutureForces, ...]:
        """Tensions of what holds the leaflets together."""
        return self.measures.sutures

    @property
    def papillary(self) -> tuple[PapillaryForce, ...]:
        """Forces on the papillary muscles."""
        return self.measures.papillary

    @property
    def annulus_force_n(self) -> tuple[float, float, float]:
        """Force of the valve on the whole annulus [N], LPS."""
        return self.measures.annulus_force_n

    def to_dict(self) -> dict[str, Json]:
        """The report as ``report.json`` holds it; units are in the names. This closure stands under ``before``, with the repairs
        that its valve has: it knows of no other. Before and after a repair: ``coapt.closure(valve, repair)``."""
        return cast("dict[str, Json]", json.loads(self._native.report_json(None)))

    def to_dataframe(self) -> pandas.DataFrame:
        """The table of the report: title, measure, unit, value; needs pandas."""
        from coapt._tables import of_rows

        return of_rows(self._native.rows(None), ["value"])

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what ``coapt closure --out`` writes: ``report.json``, ``open.vtp``, ``closed.vtp``, chordae.

        Raises
        ------
        OSError
            What the file system says.
        """
        self._native.write(folder, None)

    def record(self, path: str | os.PathLike[str], *, frames: int = _core.FILM_FRAMES) -> None:
        """Writes how this valve closes as an MCAP file, to be played in Foxglove or Lichtblick: what ``coapt closure --record`` writes.

        The film is quasi-static: a row of balances under pressures from none to all of it, annulus and papillary tips where they
        are in systole. It is found by unloading this result, which is its last frame, bit for bit. A frame that is no balance is
        grey and says so. ``coapt replay`` makes the film again and compares it; a valve closed live or from a ``start`` of its own comes
        out the same only if the open valve comes to rest there too.

        Parameters
        ----------
        path : path
            The file, ``closing.mcap`` say; beside it comes ``closing.layout.json``, to be imported in the viewer.
        frames : int, optional
            How many, from 2 to 10,000. Default: 60, which takes some ten times as long as the closure.

        Raises
        ------
        ValueError
            Another number of frames.
        OSError
            What the file system says.
        KeyboardInterrupt
            Within 0.2 s of Ctrl-C; nothing is written then.
        """
        self._native.record(path, checked_frames(frames), None)

    def picture(self, path: str | os.PathLike[str], *, colour: Colour = "gap") -> None:
        """Writes a PNG file with the valve from the atrium and from the side, without a display or Matplotlib: what
        ``coapt closure --picture`` draws.

        Parameters
        ----------
        path : path
            The file, ``closed.png`` say; an old one is replaced, and stays where the new one cannot be written.
        colour : {"gap", "strain", "displacement", "leaflet"}
            What it is coloured by: distance to the other leaflet, mean strain of the edges at a point, way from the open valve, or
            which leaflet it is.

        Raises
        ------
        ValueError
            Another colour.
        InputError
            A name that does not end in ``.png``.
        OSError
            What the file system says; an annulus without a plane, which cannot be drawn.
        """
        self._native.picture(path, colour, None)

    def report(self, path: str | os.PathLike[str], *, recording: str | os.PathLike[str] | None = None) -> None:
        """Writes one HTML page of this closed valve, to be opened in any browser without a network: what ``coapt report`` makes of
        the folder that :meth:`write` writes.

        The valve before and after a repair stands on one page where both were closed by :func:`coapt.closure`.

        Parameters
        ----------
        path : path
            The page, ``page.html`` say; an old one is replaced, and stays where the new one cannot be written.
        recording : path, optional
            The film of this closure, which :meth:`record` wrote, to be played on the page.

        Raises
        ------
        InputError
            A recording that cannot be read, or is of another closure; an annulus without a plane, which cannot be drawn.
        OSError
            What the file system says.
        """
        self._native.report(path, recording, None)

    def interactive(self) -> Live:
        """To be edited as by a slider: see :class:`coapt.Live`."""
        from coapt._live import Live

        return Live(self)

    def to_pyvista(self) -> pyvista.PolyData:
        """The closed leaflets with what is known at every point, as in ``closed.vtp``; needs PyVista."""
        from coapt._pyvista import closed_leaflets

        return closed_leaflets(self)

    def chords_to_pyvista(self) -> pyvista.PolyData:
        """The chordae with ``force_n`` of each segment; needs PyVista."""
        from coapt._pyvista import closed_chords

        return closed_chords(self)

    def to_slicer(self) -> tuple[ModelNode, ModelNode | None]:
        """Puts the closed valve into the scene of 3D Slicer, with its displays; needs to run in Slicer.

        Points and the vectors ``displacement_mm`` are turned to RAS, the frame of Slicer's scene, by the signs of x and y; everything
        else in coapt is LPS. Each call makes new nodes.

        Returns
        -------
        leaflets : vtkMRMLModelNode
            With the arrays of :meth:`to_pyvista`, coloured by ``gap_mm``.
        chordae : vtkMRMLModelNode or None
            Segments with ``group`` and ``force_n``, coloured by the latter; None where there are none.

        Raises
        ------
        ImportError
            Outside Slicer.
        """
        from coapt._slicer import closed_valve

        return closed_valve(self)

    def plot(
        self, *, color_by: Literal["gap_mm", "contact", "strain", "leaflet"] = "gap_mm"
    ) -> matplotlib.figure.Figure:
        """A picture from the atrium and one from the front; needs Matplotlib."""
        from coapt._pictures import picture

        return picture(self, color_by)

    def _told(self) -> dict[str, Any]:
        if self._report is None:
            object.__setattr__(self, "_report", json.loads(self._native.report_json(None)))
        return cast("dict[str, Any]", self._report)


def checked_frames(frames: int) -> int:
    """A number of frames that a film may have."""
    if not 2 <= frames <= _core.FILM_FRAME_LIMIT:
        raise ValueError(f"frames is {frames}; expected a number from 2 to {_core.FILM_FRAME_LIMIT}")
    return frames


def closed_of_bytes(stored: bytes) -> Closed:
    """A pickled result."""
    return Closed._of(_core.Closed.from_stored(stored))


def __getattr__(name: str) -> object:
    """Pickles name a module, and those of versions that had it here name this one."""
    if name == "Closure":
        from coapt._closure import Closure

        return Closure
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
