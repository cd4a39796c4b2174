"""How far apart two surfaces lie."""

from __future__ import annotations

import os
from typing import TypeAlias, Union, cast, final

import coapt._coapt as _core
from coapt._arrays import FloatArray, GivenIndices
from coapt._closed import Closed
from coapt._given import wrong_type
from coapt._plain import Vector
from coapt._result import Result

#: A closed valve; a surface file, or a folder of results; points (float64, shape (n, 3)) with triangles (shape (m, 3)).
Surface: TypeAlias = Union[Closed, str, "os.PathLike[str]", tuple[FloatArray, GivenIndices]]


@final
class Comparison(Result[_core.Comparison]):
    """The distance between two surfaces, under every published definition. Made by :func:`coapt.compare`."""

    __slots__ = ()
    _MADE_BY = "comparing surfaces: coapt.compare()"

    @classmethod
    def _of_bytes(cls, stored: bytes) -> Comparison:
        return cls._of(_core.Comparison.from_stored(stored))

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
    result, reference : Closed, path, or two arrays
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
    TypeError
        What is no surface, such as an open valve.
    """
    given = native_surface("result", result), native_surface("reference", reference)
    direction = None if atrial_direction is None else tuple(float(part) for part in atrial_direction)
    return Comparison._of(
        _core.compare(given[0], given[1], cast("tuple[float, float, float] | None", direction), thickness_mm)
    )


def native_surface(name: str, given: Surface) -> _core._Surface:
    """A surface as the native half takes it.

    Raises
    ------
    TypeError
        What is none.
    """
    if isinstance(given, Closed):
        return given._native
    if isinstance(given, (str, os.PathLike)) or (isinstance(given, tuple) and len(given) == 2):
        return given
    expected = "a coapt.Closed, such as valve.close(), the path of a surface, or a tuple of points [mm] and triangles"
    raise wrong_type(name, given, expected)
