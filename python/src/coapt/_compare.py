"""How far apart two surfaces lie."""

from __future__ import annotations

import json
import os
from typing import TypeAlias, Union, cast, final

import coapt._coapt as _core
from coapt._arrays import FloatArray, GivenIndices
from coapt._closed import Closed
from coapt._plain import Json, Vector

#: A closed valve; a surface file, or a folder of results; points (float64, shape (n, 3)) with triangles (shape (m, 3)).
Surface: TypeAlias = Union[Closed, str, "os.PathLike[str]", tuple[FloatArray, GivenIndices]]


@final
class Comparison:
    """The distance between two surfaces, under every published definition. Made by :func:`coapt.compare`."""

    __slots__ = ("_native",)
    _native: _core.Comparison

    def __init__(self) -> None:
        raise TypeError("a Comparison is made by comparing surfaces: coapt.compare()")

    @classmethod
    def _of(cls, made: _core.Comparison) -> Comparison:
        comparison = cls.__new__(cls)
        object.__setattr__(comparison, "_native", made)
        return comparison

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a result does not change; cannot set {name!r}")

    def __repr__(self) -> str:
        return f"<coapt.Comparison of {len(self.distance_mm)} points>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self.text())}</pre>"

    @property
    def distance_mm(self) -> FloatArray:
        """Distance of each point of the result to the reference where both stand as given [mm], shape (n,), read-only."""
        return self._native.distances()[0]

    @property
    def aligned_distance_mm(self) -> FloatArray:
        """The same after rigid alignment [mm], shape (n,), read-only."""
        return self._native.distances()[1]

    def text(self) -> str:
        """The table as ``coapt compare`` prints it."""
        return self._native.text()

    def to_dict(self) -> dict[str, Json]:
        """The report as ``comparison.json`` holds it; units are in the names."""
        return cast("dict[str, Json]", json.loads(self._native.report_json()))

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what ``coapt compare --out`` writes: ``comparison.json`` and ``error.vtp``.

        Raises
        ------
        OSError
            What the file system says.
        """
        self._native.write(folder)


def compare(
    result: Surface,
    reference: Surface,
    *,
    atrial_direction: Vector | None = None,
    thickness_mm: float | None = None,
) -> Comparison:
    """Measures how far a result lies from a reference, both in one frame, in mm.

    Parameters
    ----------
    result, reference : Closed, path, or (points, triangles)
        Closed valves; surface files (.vtp, .vtk, .ply, .stl, .obj) or folders that ``coapt closure --out`` wrote; arrays of
        points [mm], float64, shape (n, 3), with triangles, shape (m, 3).
    atrial_direction : sequence of 3 numbers, optional
        Towards the atrium, in LPS, of any length. Default: from the annulus of each surface.
    thickness_mm : float, optional
        Distance of mid-surfaces in contact [mm]. Default: 1.

    Raises
    ------
    InputError
        Surfaces that cannot be compared.
    """
    given = [it._native if isinstance(it, Closed) else it for it in (result, reference)]
    direction = None if atrial_direction is None else tuple(float(part) for part in atrial_direction)
    return Comparison._of(
        _core.compare(given[0], given[1], cast("tuple[float, float, float] | None", direction), thickness_mm)
    )
