"""How a mitral valve closes: before and after a repair, with a certificate that says how far to trust it.

>>> import coapt
>>> valve = coapt.generate("dilated", faces=160)
>>> closed = valve.close()
>>> repaired = valve.with_repair(coapt.Ring.physio_like(30)).close()
>>> repaired.coaptation.length_mean_mm > closed.coaptation.length_mean_mm
True

Units are in the names: mm, N, MPa, mmHg. Coordinates are the patient's, LPS. Everything is frozen: repairs and settings make
new valves. Wrong input raises :class:`InputError` with all its faults; not converging is a ``status`` of the result.

Research use, not a medical device.
"""

from coapt._certificate import NOTICE, Certificate, Iteration
from coapt._check import CheckResult, SpringQuality, check
from coapt._closed import Closed
from coapt._closure import Closure, closure
from coapt._coapt import __version__
from coapt._compare import Comparison, compare
from coapt._curve import FileCurve, read_curve
from coapt._errors import Fault, InputError
from coapt._export import export
from coapt._fit_tissue import TissueFit, fit_tissue
from coapt._live import Live
from coapt._measures import (
    Annulus,
    Billow,
    ChordGroupForces,
    Chords,
    Coaptation,
    LeafletMeasures,
    Measures,
    Orifice,
    PapillaryForce,
    SutureForces,
    Tenting,
)
from coapt._parts import ChordGroup, Leaflet, PapillaryMuscle
from coapt._personalise import ChordScale, FitResult, TargetDistance, personalise
from coapt._plan import PlanResult, plan
from coapt._repairs import (
    Alfieri,
    Augment,
    Clip,
    CloseCleft,
    CutChord,
    Neochord,
    RelocatePapillary,
    Repair,
    Resect,
    Ring,
    Rupture,
    TransferChord,
)
from coapt._replay import FrameDifference, ReplayResult, replay
from coapt._settings import Contact, Landmarks, Settings, Weld
from coapt._study import LawStudyResult, StudyResult, study
from coapt._tissue import (
    AnisotropicSprings,
    BilinearSprings,
    ChordCollagen,
    ChordExponential,
    ChordLaw,
    ChordLinear,
    ChordPiecewiseLinear,
    ChordTable,
    Exponential,
    MayNewman,
    SpringBranches,
    StVenantKirchhoff,
    Tissue,
)
from coapt._valve import Valve, close_many, generate, load

__all__ = [
    "NOTICE",
    "Alfieri",
    "AnisotropicSprings",
    "Annulus",
    "Augment",
    "BilinearSprings",
    "Billow",
    "Certificate",
    "CheckResult",
    "ChordCollagen",
    "ChordExponential",
    "ChordGroup",
    "ChordGroupForces",
    "ChordLaw",
    "ChordLinear",
    "ChordPiecewiseLinear",
    "ChordScale",
    "ChordTable",
    "Chords",
    "Clip",
    "CloseCleft",
    "Closed",
    "Closure",
    "Coaptation",
    "Comparison",
    "Contact",
    "CutChord",
    "Exponential",
    "Fault",
    "FileCurve",
    "FitResult",
    "FrameDifference",
    "InputError",
    "Iteration",
    "Landmarks",
    "LawStudyResult",
    "Leaflet",
    "LeafletMeasures",
    "Live",
    "MayNewman",
    "Measures",
    "Neochord",
    "Orifice",
    "PapillaryForce",
    "PapillaryMuscle",
    "PlanResult",
    "RelocatePapillary",
    "Repair",
    "ReplayResult",
    "Resect",
    "Ring",
    "Rupture",
    "Settings",
    "SpringBranches",
    "SpringQuality",
    "StVenantKirchhoff",
    "StudyResult",
    "SutureForces",
    "TargetDistance",
    "Tenting",
    "Tissue",
    "TissueFit",
    "TransferChord",
    "Valve",
    "Weld",
    "__version__",
    "check",
    "close_many",
    "closure",
    "compare",
    "export",
    "fit_tissue",
    "generate",
    "load",
    "personalise",
    "plan",
    "read_curve",
    "replay",
    "study",
]
