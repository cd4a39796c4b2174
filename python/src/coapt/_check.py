"""What is wrong with a scene, or doubted, before anything is closed."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, cast

import coapt._coapt as _core
from coapt._errors import Fault
from coapt._measures import made
from coapt._plain import Json
from coapt._valve import Valve


@dataclass(frozen=True)
class SpringQuality:
    """How well the edge springs of a leaflet stand for the sheet of tissue that they are meant for, from the shape of its triangles.

    Attributes
    ----------
    leaflet : str
        Name of the leaflet.
    softening : float
        How much too soft the springs are, mean over the leaflet and all kinds of strain [1].
    stiffness_error : float
        How far the stiffness is off in the kind of strain that the mesh renders worst, mean over the leaflet [1].
    worst_error : float
        How far it is off at ``worst_vertex`` [1].
    worst_vertex : int
        Where the stiffness is most off.
    """

    leaflet: str
    softening: float
    stiffness_error: float
    worst_error: float
    worst_vertex: int


@dataclass(frozen=True)
class CheckResult:
    """What was found of a scene. Made by :func:`coapt.check`.

    Attributes
    ----------
    scene : str
        What was checked, as it was given; the name of a valve.
    faults : tuple of Fault
        Everything: what stops it, what was repaired, guessed or doubted.
    vertices, triangles, chord_segments : int or None
        Size of the valve; None where it could not be built.
    springs : tuple of SpringQuality
        Of each leaflet made of springs.
    """

    scene: str
    faults: tuple[Fault, ...]
    vertices: int | None
    triangles: int | None
    chord_segments: int | None
    springs: tuple[SpringQuality, ...]
    _json: str = field(repr=False)
    _text: str = field(repr=False)

    @property
    def ready(self) -> bool:
        """Whether the valve can be closed: nothing that was found is an error."""
        return not self.errors

    @property
    def errors(self) -> tuple[Fault, ...]:
        """What stops it."""
        return tuple(fault for fault in self.faults if fault.severity == "error")

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """What was repaired, guessed or doubted."""
        return tuple(fault for fault in self.faults if fault.severity == "warning")

    def text(self) -> str:
        """The report as ``coapt check`` prints it."""
        return self._text

    def to_dict(self) -> dict[str, Json]:
        """The report as ``coapt check --format json`` prints it."""
        return cast("dict[str, Json]", json.loads(self._json))


def check(scene: str | os.PathLike[str] | Valve, *, max_faces: int | None = None) -> CheckResult:
    """Reads and validates a scene without closing it, and tells every fault with its line: ``coapt check``.

    Parameters
    ----------
    scene : path or Valve
        A scene file, or a folder with a ``scene.toml``; a valve tells what was repaired or doubted when it was made.
    max_faces : int, optional
        Refuse valves of more triangles. Default: what the scene says, usually 250 000.

    Returns
    -------
    CheckResult
        Also of a scene that cannot be closed, or that does not exist: ask ``ready``. Nothing is raised for it.

    Examples
    --------
    >>> import coapt
    >>> coapt.check(coapt.generate("healthy", faces=160)).ready
    True
    """
    told = _core.check_valve(scene._native) if isinstance(scene, Valve) else _core.check_file(scene, max_faces)
    as_json, text = told
    report: dict[str, Any] = json.loads(as_json)
    mesh = report["mesh"] or {}
    return CheckResult(
        report["scene"],
        tuple(made(Fault, fault) for fault in report["faults"]),
        mesh.get("vertices"),
        mesh.get("faces"),
        mesh.get("chords"),
        tuple(made(SpringQuality, quality) for quality in report["springs"]),
        as_json,
        text,
    )
