"""Springs that follow a biaxial test."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, cast

import coapt._coapt as _core
from coapt._measures import made
from coapt._plain import Json
from coapt._tissue import AnisotropicSprings, BilinearSprings


@dataclass(frozen=True)
class TissueFit:
    """Springs fitted to a biaxial table. Made by :func:`coapt.fit_tissue`.

    Attributes
    ----------
    tissue : BilinearSprings or AnisotropicSprings
        For the ``tissue`` of a :class:`Leaflet`, to six digits.
    rms_error_mpa : float
        Root mean square of the error of the nominal stress, both directions together [MPa].
    worst_error_mpa : float
        Its largest [MPa].
    rms_stress_mpa : float
        Root mean square of the nominal stress itself [MPa].
    working_range_mpa : tuple of float
        Cauchy stress from and to [MPa], shape (2,): what was followed.
    points : int
        Points of the table in it.
    """

    tissue: BilinearSprings | AnisotropicSprings
    rms_error_mpa: float
    worst_error_mpa: float
    rms_stress_mpa: float
    working_range_mpa: tuple[float, float]
    points: int
    _json: str = field(repr=False)
    _text: str = field(repr=False)

    def text(self) -> str:
        """The block of a scene, with what was fitted and how well as comments: as ``coapt fit-tissue`` prints it."""
        return self._text

    def to_dict(self) -> dict[str, Json]:
        """The fit as ``coapt fit-tissue --format json`` prints it."""
        return cast("dict[str, Json]", json.loads(self._json))


def fit_tissue(
    curve: str | os.PathLike[str],
    *,
    anisotropic: bool = False,
    up_to_kpa: float = _core.FIT_UP_TO_KPA,
    thickness_mm: float | None = None,
) -> TissueFit:
    """Fits the springs of leaflets to a table of a biaxial test: ``coapt fit-tissue``.

    Parameters
    ----------
    curve : path
        A table with the columns ``stretch_circ``, ``stretch_rad`` and, for both directions, ``cauchy_stress_circ_kpa`` (or
        ``_mpa``), ``nominal_stress_circ_kpa`` (or ``_mpa``) or ``tension_circ_n_per_m`` (or ``_n_per_mm``).
    anisotropic : bool
        Springs with a direction instead of isotropic ones, which follow the gain of area.
    up_to_kpa : float
        Largest Cauchy stress that is followed [kPa]: that at which closed leaflets work, some 50 to 150.
    thickness_mm : float, optional
        Thickness of the tissue [mm], for a table of tensions.

    Raises
    ------
    InputError
        A table that cannot be read, or whose curve no springs follow.
    """
    as_json, text, tissue = _core.fit_tissue(curve, anisotropic, up_to_kpa, thickness_mm)
    fit: dict[str, Any] = json.loads(as_json)["fit"]
    return TissueFit(
        _springs(json.loads(tissue)),
        fit["rms_error_mpa"],
        fit["worst_error_mpa"],
        fit["rms_stress_mpa"],
        (fit["working_range_mpa"][0], fit["working_range_mpa"][1]),
        fit["points"],
        as_json,
        text,
    )


def _springs(keys: dict[str, Any]) -> BilinearSprings | AnisotropicSprings:
    if keys.pop("law") == "bilinear-springs":
        return made(BilinearSprings, keys)
    return made(AnisotropicSprings, keys)
