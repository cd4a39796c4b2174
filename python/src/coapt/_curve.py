"""Curves from files."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import coapt._coapt as _core
from coapt._arrays import FloatArray, read_only
from coapt._errors import Fault, fault_of


@dataclass(frozen=True, eq=False)
class FileCurve:
    """A curve that was read from a file.

    Attributes
    ----------
    points_mm : ndarray of float64, shape (n, 3)
        Points [mm], read-only; LPS where the file says its frame, else as they stand in it.
    closed : bool
        Whether the curve closes on itself.
    warnings : tuple of Fault
        What was doubted.
    """

    points_mm: FloatArray = field(repr=False)
    closed: bool
    warnings: tuple[Fault, ...]

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        read_only(self.points_mm)


def read_curve(path: str | os.PathLike[str]) -> FileCurve:
    """Reads a curve such as a ring or an annulus: Slicer markups JSON or a polyline (.vtk, .vtp).

    For ``coapt.Ring(curve_mm=curve.points_mm, closed=curve.closed)``, or for the ``annulus_mm`` of a :class:`coapt.Valve`.

    Raises
    ------
    InputError
        A file that holds no curve.
    """
    points_mm, closed, warnings = _core.read_curve(path)
    return FileCurve(points_mm, closed, tuple(fault_of(told) for told in warnings))
