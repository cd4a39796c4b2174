"""What leaflets and chordae are made of, with the keys of scenes.

Written by python/tools/plain_data.py from the schemas under assets/schema.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias, Union

from coapt._plain import PlainData

__all__ = [
    "AnisotropicSprings",
    "BilinearSprings",
    "ChordCollagen",
    "ChordExponential",
    "ChordLaw",
    "ChordLinear",
    "ChordPiecewiseLinear",
    "ChordTable",
    "Exponential",
    "MayNewman",
    "SpringBranches",
    "StVenantKirchhoff",
    "Tissue",
]


@dataclass(frozen=True, kw_only=True, slots=True)
class SpringBranches(PlainData):
    """The two branches of a bilinear spring.

    Parameters
    ----------
    pre_transition_modulus_mpa : float
        Modulus below the transition strain [MPa].
    transition_strain : float
        Strain at which the collagen takes over [mm/mm].
    post_transition_modulus_mpa : float
        Modulus above it [MPa].
    """

    pre_transition_modulus_mpa: float
    transition_strain: float
    post_transition_modulus_mpa: float


@dataclass(frozen=True, kw_only=True, slots=True)
class BilinearSprings(PlainData):
    """Isotropic network of edge springs, soft up to a transition strain and stiff beyond (paper 003).

    Parameters
    ----------
    bending_modulus_ratio : float, optional
        Modulus in bending over the pre-transition modulus [1]; 0: the leaflets bend freely.
        Default: 6.0.
    compression_modulus_ratio : float, optional
        Modulus in compression over the pre-transition modulus [1]. Default: 1.0.
    post_transition_modulus_mpa : float, optional
        Modulus above the transition strain [MPa]. Default: 4.0.
    pre_transition_modulus_mpa : float, optional
        Modulus below the transition strain [MPa]. Default: 0.08.
    transition_strain : float, optional
        Strain at which the collagen takes over [mm/mm]; 0.25 in paper 003. Default: 0.25.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("law", "bilinear-springs")

    bending_modulus_ratio: float | None = None
    compression_modulus_ratio: float | None = None
    post_transition_modulus_mpa: float | None = None
    pre_transition_modulus_mpa: float | None = None
    transition_strain: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class AnisotropicSprings(PlainData):
    """Edge springs with one law around the valve and another towards the margin. Between the two
    directions moduli and transition strains pass over as X(φ) = X₀ cos⁴φ + X₉₀ sin⁴φ + 2 √(X₀ X₉₀)
    sin²φ cos²φ (our choice: a fibre network's form).

    Parameters
    ----------
    circumferential : SpringBranches
        Along the annulus.
    radial : SpringBranches
        From the annulus to the margin.
    bending_modulus_mpa : float, optional
        Modulus in bending [MPa]; 0: the leaflet bends freely. Default: 0.48.
    compression_modulus_ratio : float, optional
        Modulus in compression over the pre-transition modulus [1]. Default: 1.0.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("law", "anisotropic-springs")

    circumferential: SpringBranches
    radial: SpringBranches
    bending_modulus_mpa: float | None = None
    compression_modulus_ratio: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class StVenantKirchhoff(PlainData):
    """Membrane, linear in Green's strain under plane stress (paper 002: 0.4 MPa anterior, 0.1 MPa
    posterior).

    Parameters
    ----------
    modulus_mpa : float
        Young's modulus [MPa].
    bending_modulus_mpa : float, optional
        Modulus in bending [MPa]; 0: the leaflet bends freely. Default: 0.48.
    poisson_ratio : float, optional
        Poisson's ratio [1]; 0.5 in paper 002. Default: 0.5.
    wrinkling : Literal["resolved", "tension-field"], optional
        What happens under compression. Default: "resolved".
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("law", "st-venant-kirchhoff")

    modulus_mpa: float
    bending_modulus_mpa: float | None = None
    poisson_ratio: float | None = None
    wrinkling: Literal["resolved", "tension-field"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Exponential(PlainData):
    """Membrane of isotropic tissue that stiffens exponentially, w = C₀/2 (I₁ − 3) + C₁/2 (exp(C₂ (I₁ −
    3)²) − 1); with C₁ = 0 neo-Hookean of shear modulus C₀. Tricuspid leaflets of Mathur 2022: C₀ 0.001
    MPa, C₁ 0.000124 to 0.000191 MPa, C₂ 4.6 to 17.8.

    Parameters
    ----------
    c0_mpa : float
        C₀ [MPa].
    c1_mpa : float
        C₁ [MPa].
    c2 : float
        C₂ [1].
    bending_modulus_mpa : float, optional
        Modulus in bending [MPa]; 0: the leaflet bends freely. Default: 0.48.
    compressibility_per_mpa : float, optional
        Twice the inverse of the bulk modulus, D in (J − 1)² / D [1/MPa]; 0: incompressible.
        Default: 0.0.
    wrinkling : Literal["resolved", "tension-field"], optional
        What happens under compression. Default: "resolved".
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("law", "exponential")

    c0_mpa: float
    c1_mpa: float
    c2: float
    bending_modulus_mpa: float | None = None
    compressibility_per_mpa: float | None = None
    wrinkling: Literal["resolved", "tension-field"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class MayNewman(PlainData):
    """Membrane of incompressible tissue with fibres around the valve, w = c₀ (exp(c₁ (I₁ − 3)² + c₂ (α −
    1)⁴) − 1), α the stretch of the fibres (May-Newman & Yin 1998; its constants, as often quoted and
    not checked by us: anterior c₀ 0.399 kPa, c₁ 4.325, c₂ 1446.5; posterior 0.414 kPa, 4.848, 305.4).

    Parameters
    ----------
    c0_mpa : float
        c₀ [MPa].
    c1 : float
        c₁ [1].
    c2 : float
        c₂ [1].
    bending_modulus_mpa : float, optional
        Modulus in bending [MPa]; 0: the leaflet bends freely. Default: 0.48.
    wrinkling : Literal["resolved", "tension-field"], optional
        What happens under compression. Default: "resolved".
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("law", "may-newman")

    c0_mpa: float
    c1: float
    c2: float
    bending_modulus_mpa: float | None = None
    wrinkling: Literal["resolved", "tension-field"] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class ChordLinear(PlainData):
    """σ = E ε (paper 003).

    Parameters
    ----------
    modulus_mpa : float
        Young's modulus E [MPa].
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "linear")

    modulus_mpa: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ChordPiecewiseLinear(PlainData):
    """A soft toe, then stiff (paper 000, after Kunzelman & Cochran 1990: marginal 3.06 then 33.4 MPa,
    basal 0.647 then 20.8 MPa, from a strain of 0.025).

    Parameters
    ----------
    toe_modulus_mpa : float
        Modulus of the toe [MPa].
    transition_strain : float
        Strain at which the toe ends [mm/mm].
    modulus_mpa : float
        Modulus beyond it [MPa].
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "piecewise-linear")

    toe_modulus_mpa: float
    transition_strain: float
    modulus_mpa: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ChordExponential(PlainData):
    """σ = a (e^{bε} − 1): paper 001 names such a law without its constants.

    Parameters
    ----------
    scale_mpa : float
        a [MPa].
    exponent : float
        b [1].
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "exponential")

    scale_mpa: float
    exponent: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ChordCollagen(PlainData):
    """σ = a (e^{bε} − 1) until all fibres are recruited, and on along a line from there: collagen of
    Kaiser et al. (arXiv 1902.00018; a 4.6434e-4 MPa, b 49.9643, 0.145, 32.5 MPa).

    Parameters
    ----------
    scale_mpa : float
        a [MPa].
    exponent : float
        b [1].
    full_recruitment_strain : float
        Strain from which all fibres carry [mm/mm].
    modulus_mpa : float
        Modulus from there on [MPa].
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "collagen")

    scale_mpa: float
    exponent: float
    full_recruitment_strain: float
    modulus_mpa: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ChordTable(PlainData):
    """Straight lines through measured points, and on along the last of them.

    Parameters
    ----------
    strain : Sequence[float]
        Strains, ascending from 0 [mm/mm], shape ``[point]``.
    stress_mpa : Sequence[float]
        Stresses, from 0 and nowhere falling [MPa], shape ``[point]``.
    """

    _TAG: ClassVar[tuple[str, str] | None] = ("kind", "table")
    _LISTS: ClassVar[tuple[str, ...]] = ("strain", "stress_mpa",)

    strain: Sequence[float]
    stress_mpa: Sequence[float]


#: A stress-strain law with its constants.
Tissue: TypeAlias = Union[BilinearSprings, AnisotropicSprings, StVenantKirchhoff, Exponential, MayNewman]


#: A law of engineering stress σ over strain ε = l / L − 1; slack chordae carry nothing.
ChordLaw: TypeAlias = Union[ChordLinear, ChordPiecewiseLinear, ChordExponential, ChordCollagen, ChordTable]
