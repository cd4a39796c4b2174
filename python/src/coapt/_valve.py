"""Valves: read, generated or made from arrays; repaired and closed."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Literal, cast, final

import coapt._coapt as _core
from coapt._arrays import FloatArray, IndexArray
from coapt._errors import Fault, fault_of
from coapt._given import A_CLOSED, A_PRESSURE, A_VALVE, counted, each_of_type, number, of_type, wrong_type
from coapt._optional import needed
from coapt._parts import CHORD_KEYS, ChordGroup, Leaflet, PapillaryMuscle, keys_of
from coapt._plain import Json, PlainData, Value, natives_of_repairs
from coapt._progress import Progress
from coapt._repairs import Repair
from coapt._settings import Contact, Landmarks, Settings, Weld
from coapt._tissue import Tissue

if TYPE_CHECKING:
    import pyvista

    from coapt._closed import Closed
    from coapt._live import Live
    from coapt._panel import Panel
    from coapt._slicer import MarkupsNode, ModelNode

Preset = Literal["healthy", "dilated", "flail", "barlow", "restricted"]

SCHEMA_VERSION = 1


@final
class Valve:
    """A mitral valve, open, with what was done to it. It never changes: repairs and settings make new ones.

    Made from arrays here, by :func:`coapt.load` from files, by :func:`coapt.generate` from parameters. All three go the
    same way, and wrong ones are told in the same words.

    Parameters
    ----------
    leaflets : sequence of Leaflet
        Points that several leaflets share are welded.
    chordae : sequence of ChordGroup
        Groups of chordae, each with one tissue.
    papillary : sequence of PapillaryMuscle
        The muscles with the tips that chordae spring from.
    annulus_mm : ndarray of float64, shape (n, 3), optional
        The annulus as a closed curve [mm], where leaflets do not mark its points.
    annulus_tolerance_mm : float, optional
        Boundary points this near the curve are annulus [mm].
    pressure_mmhg : float
        Transvalvular pressure at peak systole [mmHg]. Our choice of 100 is within 70 to 120.
    name : str
        What the case is called in reports.
    space : {"LPS", "RAS"}
        Patient frame of all coordinates given here. Everything that comes back is LPS.
    contact, landmarks, settings, weld : optional
        How leaflets touch; named points on the annulus; how the equilibrium is sought; how near points are one.

    Raises
    ------
    InputError
        Every fault of arrays and scene, with found and expected.
    """

    __slots__ = ("_native",)
    _native: _core.Valve

    def __init__(
        self,
        leaflets: Sequence[Leaflet],
        chordae: Sequence[ChordGroup] = (),
        papillary: Sequence[PapillaryMuscle] = (),
        *,
        annulus_mm: FloatArray | None = None,
        annulus_tolerance_mm: float | None = None,
        pressure_mmhg: float = 100.0,
        name: str = "valve",
        space: Literal["LPS", "RAS"] = "LPS",
        contact: Contact | None = None,
        landmarks: Landmarks | None = None,
        settings: Settings | None = None,
        weld: Weld | None = None,
    ) -> None:
        leaflets = each_of_type(Leaflet, "leaflets", leaflets, "a coapt.Leaflet")
        chordae = each_of_type(ChordGroup, "chordae", chordae, "a coapt.ChordGroup")
        papillary = each_of_type(PapillaryMuscle, "papillary", papillary, "a coapt.PapillaryMuscle")
        scene: dict[str, Value | None] = {
            "schema_version": SCHEMA_VERSION,
            "name": name,
            "space": space,
            "load": {"pressure_mmhg": pressure_mmhg},
            "leaflets": [keys_of(leaflet, "name", "thickness_mm", "tissue") for leaflet in leaflets],
            "chordae": [keys_of(group, *CHORD_KEYS) for group in chordae],
            "papillary": [keys_of(muscle, "name") for muscle in papillary],
            "annulus": {} if annulus_tolerance_mm is None else {"curve_tolerance_mm": annulus_tolerance_mm},
            "contact": None if contact is None else contact.to_dict(),
            "landmarks": None if landmarks is None else landmarks.to_dict(),
            "settings": None if settings is None else settings.to_dict(),
            "weld": None if weld is None else weld.to_dict(),
        }
        made = _core.Valve.assemble(
            {key: value for key, value in scene.items() if value is not None},
            [(it.points_mm, it.triangles, it.annulus_points, it.annulus_displacement_mm) for it in leaflets],
            [(it.points_mm, it.segments, it.rest_length_mm, it.area_mm2) for it in chordae],
            [(it.tips_mm, it.displacements_mm) for it in papillary],
            annulus_mm,
        )
        object.__setattr__(self, "_native", made)

    @classmethod
    def _of(cls, made: _core.Valve) -> Valve:
        valve = cls.__new__(cls)
        object.__setattr__(valve, "_native", made)
        return valve

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a valve does not change; cannot set {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a valve does not change; cannot delete {name!r}")

    def __reduce__(self) -> tuple[object, tuple[bytes]]:
        return valve_of_bytes, (self._native.stored(),)

    def __repr__(self) -> str:
        done = f", {counted(len(self.repairs), 'repair')}" if self.repairs else ""
        return f"<coapt.Valve {self.name!r}: {len(self.triangles)} triangles, {self.pressure_mmhg:g} mmHg{done}>"

    @property
    def name(self) -> str:
        """What the case is called."""
        return self._native.name

    @property
    def pressure_mmhg(self) -> float:
        """Transvalvular pressure [mmHg]."""
        return self._native.pressure_mmhg

    @property
    def points_mm(self) -> FloatArray:
        """Open positions of all vertices [mm], LPS, shape (n, 3), read-only: leaflets, then chord nodes, then tips."""
        return self._native.points_mm

    @property
    def triangles(self) -> IndexArray:
        """Triangles of all leaflets, shape (m, 3), read-only; normals to the atrium."""
        return self._native.triangles

    @property
    def triangle_leaflet(self) -> IndexArray:
        """Which of ``leaflet_names`` each triangle belongs to, shape (m,), read-only."""
        return self._native.triangle_leaflet

    @property
    def leaflet_names(self) -> tuple[str, ...]:
        """Names of the leaflets."""
        return tuple(self._native.leaflet_names)

    @property
    def leaflet_vertex_count(self) -> int:
        """The first so many vertices belong to leaflets."""
        return self._native.leaflet_vertex_count

    @property
    def annulus(self) -> IndexArray:
        """Vertices of the annulus in order, counter-clockwise seen from the atrium, shape (k,), read-only."""
        return self._native.annulus

    @property
    def chords(self) -> tuple[FloatArray, IndexArray]:
        """Ends of the chord segments in the open valve [mm], shape (n, 3), and the segments, shape (m, 2); read-only."""
        return self._native.chords()

    @property
    def chord_groups(self) -> tuple[IndexArray, tuple[str, ...]]:
        """Group of each chord segment, shape (m,), and the names of the groups."""
        groups, names = self._native.chord_groups
        return groups, tuple(names)

    @property
    def repairs(self) -> tuple[dict[str, Json], ...]:
        """What was done, with the keys of plans, all defaults told."""
        return tuple(cast("list[dict[str, Json]]", json.loads(self._native.repairs_json)))

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """What was repaired, guessed or doubted while it was read, built and repaired."""
        return tuple(fault_of(told) for told in self._native.warnings)

    def with_repair(self, *repairs: Repair) -> Valve:
        """The same valve with these repairs, after those that it has. Nothing moves before it is closed.

        Raises
        ------
        InputError
            Why a repair cannot be carried out; a second ring.
        """
        return Valve._of(self._native.with_repairs(natives_of_repairs(repairs)))

    def with_pressure(self, pressure_mmhg: float) -> Valve:
        """The same valve under another transvalvular pressure [mmHg].

        Raises
        ------
        InputError
            A pressure that no scene may have.
        """
        pressure_mmhg = number("pressure_mmhg", pressure_mmhg, A_PRESSURE)
        return Valve._of(self._native.altered(pressure_mmhg, {}, {}))

    def with_settings(self, settings: Settings) -> Valve:
        """The same valve, its equilibrium sought otherwise; what is left out of the settings stays.

        Raises
        ------
        InputError
            Settings that no scene may have.
        """
        keys = of_type(Settings, "settings", settings, "a coapt.Settings").to_dict()
        return Valve._of(self._native.altered(None, keys, {}))

    def with_contact(self, contact: Contact) -> Valve:
        """The same valve with another contact; what is left out of it stays.

        Raises
        ------
        InputError
            A contact that no scene may have.
        """
        keys = of_type(Contact, "contact", contact, "a coapt.Contact").to_dict()
        return Valve._of(self._native.altered(None, {}, keys))

    def close(
        self,
        *,
        pressure_mmhg: float | None = None,
        settings: Settings | None = None,
        start: Closed | None = None,
    ) -> Closed:
        """Closes the valve. Other Python threads run meanwhile; Ctrl-C ends it.

        Parameters
        ----------
        pressure_mmhg : float, optional
            Another pressure than the valve's [mmHg].
        settings : Settings, optional
            How the equilibrium is sought; what is left out is as in the valve.
        start : Closed, optional
            A closed state of the same mesh to begin at, instead of the open valve: faster, but where several stable shapes
            are possible, the one that is found depends on it.

        Returns
        -------
        Closed
            Also where the solver did not converge: ask ``certified`` and ``status``.

        Raises
        ------
        InputError
            A pressure or settings that no scene may have; a start of another mesh.
        KeyboardInterrupt
            Within 0.2 s of Ctrl-C.
        """
        from coapt._closed import Closed

        made = self
        if pressure_mmhg is not None:
            made = made.with_pressure(pressure_mmhg)
        if settings is not None:
            made = made.with_settings(settings)
        if start is None:
            return Closed._of(made._native.close(None))
        return Closed._of(made._native.close(of_type(Closed, "start", start, A_CLOSED).positions_mm))

    def interactive(self) -> Live:
        """Closes the valve, to be edited then as by a slider: see :class:`coapt.Live`."""
        from coapt._live import Live

        return Live(self.close())

    def panel(self) -> Panel:
        """A panel for notebooks: rings, clips and neochordae as sliders, the closed valve redrawn as they move; needs anywidget.

        Research use, not a medical device.
        """
        with needed("anywidget", "panel()"):
            from coapt._panel import Panel

        return Panel(self.close())

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what ``coapt generate --out`` writes, ``scene.toml`` with its meshes, for :func:`coapt.load` and the program.

        Raises
        ------
        InputError
            A valve with repairs, which no scene holds: write it before them, and them as a plan.
        OSError
            What the file system says.
        """
        self._native.write(folder)

    def to_pyvista(self) -> pyvista.PolyData:
        """The open leaflets; needs PyVista. Cells carry ``leaflet``, points ``annulus``."""
        from coapt._pyvista import leaflets

        return leaflets(self, self.points_mm)

    @staticmethod
    def from_pyvista(
        leaflets: pyvista.PolyData | Mapping[str, pyvista.PolyData],
        chordae: Mapping[str, pyvista.PolyData] | None = None,
        papillary: Mapping[str, FloatArray] | None = None,
        *,
        pressure_mmhg: float = 100.0,
        name: str = "valve",
        space: Literal["LPS", "RAS"] = "LPS",
    ) -> Valve:
        """A valve of PyVista surfaces.

        Parameters
        ----------
        leaflets : PolyData, or mapping of name to PolyData
            Triangle meshes [mm]. A point array ``annulus``, non-zero on the annulus, marks it; cells of a single mesh are
            parted by their array ``leaflet`` (0 anterior, 1 posterior), where it has one.
        chordae : mapping of name to PolyData, optional
            Line meshes; cell arrays ``rest_length_mm`` and ``area_mm2`` are read where present.
        papillary : mapping of name to ndarray of float64, shape (n, 3), optional
            Papillary tips [mm].
        pressure_mmhg, name, space
            As of :class:`Valve`.

        Raises
        ------
        InputError
            As of :class:`Valve`; cells that are no triangles or lines.
        ImportError
            Without PyVista.
        """
        from coapt._pyvista import chord_groups, leaflets_of

        muscles = [PapillaryMuscle(muscle, tips) for muscle, tips in (papillary or {}).items()]
        return Valve(
            leaflets_of(leaflets),
            chord_groups(chordae or {}),
            muscles,
            pressure_mmhg=pressure_mmhg,
            name=name,
            space=space,
        )

    def to_slicer(self) -> ModelNode:
        """Puts the open leaflets into the scene of 3D Slicer; needs to run in it. Otherwise as :meth:`Closed.to_slicer`.

        Returns
        -------
        vtkMRMLModelNode
            Cells carry ``leaflet``, points ``annulus``.

        Raises
        ------
        ImportError
            Outside Slicer.
        """
        from coapt._slicer import open_leaflets

        return open_leaflets(self)

    @staticmethod
    def from_slicer(
        leaflets: ModelNode | Mapping[str, ModelNode],
        chordae: Mapping[str, ModelNode] | None = None,
        papillary: Mapping[str, MarkupsNode] | None = None,
        *,
        annulus: MarkupsNode | None = None,
        annulus_tolerance_mm: float | None = None,
        pressure_mmhg: float = 100.0,
        name: str = "valve",
    ) -> Valve:
        """A valve of nodes in the scene of 3D Slicer, all where Slicer shows them, below their transforms.

        Slicer's scene is in RAS, and nodes are taken as such: the valve is made with ``space="RAS"`` and has LPS coordinates, like
        every other.

        Parameters
        ----------
        leaflets : vtkMRMLModelNode, or mapping of name to vtkMRMLModelNode
            Triangle meshes [mm], with arrays as of :meth:`from_pyvista`.
        chordae : mapping of name to vtkMRMLModelNode, optional
            Line meshes, with arrays as of :meth:`from_pyvista`.
        papillary : mapping of name to vtkMRMLMarkupsNode, optional
            Papillary tips: the control points of each node, a point list or any other.
        annulus : vtkMRMLMarkupsNode, optional
            The annulus, where leaflets do not mark its points: a closed curve as it is drawn, or a point list in order.
        annulus_tolerance_mm, pressure_mmhg, name
            As of :class:`Valve`.

        Raises
        ------
        InputError
            As of :class:`Valve`; cells that are no triangles or lines; nodes of another kind; points that were not placed.
        ImportError
            Without VTK, which Slicer has.
        """
        from coapt._meshes import chord_groups_of, leaflets_of
        from coapt._slicer import curve_points, lines_of, marked_points, surfaces_of

        muscles = [PapillaryMuscle(muscle, marked_points(muscle, tips)) for muscle, tips in (papillary or {}).items()]
        return Valve(
            leaflets_of(surfaces_of(leaflets)),
            chord_groups_of(lines_of(chordae or {})),
            muscles,
            annulus_mm=None if annulus is None else curve_points("annulus", annulus),
            annulus_tolerance_mm=annulus_tolerance_mm,
            pressure_mmhg=pressure_mmhg,
            name=name,
            space="RAS",
        )



def valve_of_bytes(stored: bytes) -> Valve:
    """A pickled valve."""
    return Valve._of(_core.Valve.from_stored(stored))


def load(path: str | os.PathLike[str], *, max_faces: int | None = None) -> Valve:
    """Reads a scene file (TOML or JSON) with the meshes that it names, or a folder with a ``scene.toml``.

    Parameters
    ----------
    path : str or path
        The scene, or the folder that ``coapt generate`` wrote.
    max_faces : int, optional
        Refuse valves of more triangles. Default: what the scene says, usually 250 000.

    Raises
    ------
    InputError
        Every fault, with file and line where there is one; also a file that does not exist.
    """
    return Valve._of(_core.Valve.read(path, max_faces))


def generate(
    preset: Preset | str = "healthy", *, faces: int = 650, **parameters: Value | Tissue
) -> Valve:
    """Makes a parametric valve.

    Parameters
    ----------
    preset : {"healthy", "dilated", "flail", "barlow", "restricted"}
        Which valve.
    faces : int
        About so many triangles; the presets meet it within 10 %. 650 is that of the models of paper 003.
    **parameters
        Parameters by group, as ``annulus={"transverse_mm": 42}`` or ``chordae={"struts": False}``, and those without a
        group, such as ``pressure_mmhg=120``. Keys as of ``coapt generate --set``.

    Raises
    ------
    InputError
        An unknown key; a value out of its range; leaflets that cannot hang open.

    Examples
    --------
    >>> import coapt
    >>> coapt.generate("healthy", faces=160).close().certified
    True
    """
    dotted: dict[str, Value] = {"faces": faces}
    for key, value in parameters.items():
        if isinstance(value, Mapping):
            dotted.update({f"{key}.{inner}": _plain(it) for inner, it in value.items()})
        else:
            dotted[key] = _plain(value)
    return Valve._of(_core.Valve.generate(preset, dotted))


def _plain(value: Value | Tissue) -> Value:
    return value.to_dict() if isinstance(value, PlainData) else value


def close_many(valves: Iterable[Valve], *, progress: Progress | None = None) -> list[Closed]:
    """Closes many valves side by side, on as many threads as there are; the results are those of :meth:`Valve.close`.

    Parameters
    ----------
    valves : iterable of Valve
        Each with its own pressure and settings.
    progress : callable, optional
        Called in this thread, some times in a second, with how many valves are closed and of how many.

    Raises
    ------
    TypeError
        What is no valve.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.
    Exception
        What ``progress`` raises; the work ends then.
    """
    from coapt._closed import Closed

    return [Closed._of(made) for made in _core.close_many(natives_of("valves", valves), progress)]


def natives_of(name: str, valves: Iterable[Valve]) -> list[_core.Valve]:
    """Valves as the native half takes them.

    Raises
    ------
    TypeError
        What is no valve.
    """
    # Text is a sequence too, and its letters are what nobody means.
    if isinstance(valves, (str, Valve)) or not isinstance(valves, Iterable):
        raise wrong_type(name, valves, "valves, such as [coapt.generate(\"healthy\")]")
    return [of_type(Valve, f"{name}[{number}]", valve, A_VALVE)._native for number, valve in enumerate(valves)]
