"""From published laws to the numbers of a scene: bilinear leaflet springs and tabulated chordae.

For one law, in one state of stretch, without a compiler. The general fit, of spring and membrane laws to
curves of any state, is the library's `tissue_fit` (`coapt fit-tissue`).

**Leaflet.** The continuum is isotropic and incompressible,
W = C0/2 (I1 - 3) + C1/2 (exp(C2 (I1 - 3)^2) - 1). With W1 = dW/dI1 its nominal stress at stretch s is

    equibiaxial  P = 2 W1 (s - s^-5),   I1 = 2 s^2 + s^-4
    uniaxial     P = 2 W1 (s - s^-2),   I1 = s^2 + 2/s

and the Cauchy stress is P s in both. A regular triangular lattice of springs, stress sigma(e) at strain
e, carries the nominal stress 1.5 sigma(e) when stretched equibiaxially (tension N = 1.5 t sigma(e) / (1 + e)
per current length), and sigma(e) when pulled uniaxially along a spring, where the slanting springs carry
nothing. So the springs should follow sigma(e) = P(1 + e) / c, c = 1.5 or 1, and thickness drops out.

The fit makes the *strain* right at a given tension, because the strain at the working tension decides the
closed shape. Samples are evenly spaced in Cauchy stress up to the largest working stress.

**Chordae.** Abaqus' Ogden form W = sum 2 mu_i / alpha_i^2 (s1^alpha_i + s2^alpha_i + s3^alpha_i - 3) has the
initial shear modulus sum mu_i, so an incompressible rod starts with Young's modulus E = 3 sum mu_i. Pulled
to s1 = s, s2 = s3 = s^(-1/2), its nominal stress dW/ds is
P = sum 2 mu_i / alpha_i (s^(alpha_i - 1) - s^(-alpha_i / 2 - 1)).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

LATTICE_FACTOR = {"equibiaxial": 1.5, "uniaxial": 1.0}


@dataclass(frozen=True)
class ExponentialLaw:
    """W = c0/2 (I1 - 3) + c1/2 (exp(c2 (I1 - 3)^2) - 1); c0 and c1 in MPa."""

    c0_mpa: float
    c1_mpa: float
    c2: float

    def nominal_stress_mpa(self, stretch: float, state: str) -> float:
        """Nominal stress [MPa] of the incompressible membrane or strip."""
        if state == "equibiaxial":
            excess = 2.0 * stretch**2 + stretch**-4 - 3.0
            lever = stretch - stretch**-5
        else:
            excess = stretch**2 + 2.0 / stretch - 3.0
            lever = stretch - stretch**-2
        # The exponent is capped: a search may look far beyond any stretch that tissue can take.
        growth = math.exp(min(self.c2 * excess**2, 200.0))
        return 2.0 * lever * (0.5 * self.c0_mpa + self.c1_mpa * self.c2 * excess * growth)


@dataclass(frozen=True)
class BilinearSprings:
    """The constants of the scene's `bilinear-springs` law."""

    pre_transition_modulus_mpa: float
    transition_strain: float
    post_transition_modulus_mpa: float

    def strain(self, stress_mpa: float) -> float:
        """Spring strain at a tensile spring stress [MPa]."""
        knee_mpa = self.pre_transition_modulus_mpa * self.transition_strain
        if stress_mpa <= knee_mpa:
            return stress_mpa / self.pre_transition_modulus_mpa
        return self.transition_strain + (stress_mpa - knee_mpa) / self.post_transition_modulus_mpa


@dataclass(frozen=True)
class SpringFit:
    """Fitted springs and how far they are from the law."""

    springs: BilinearSprings
    strain_error_rms: float
    strain_error_max: float


def stretch_at_cauchy_stress(law: ExponentialLaw, cauchy_mpa: float, state: str) -> float:
    """The stretch at which the law's Cauchy stress is `cauchy_mpa`, by bisection to the last bit."""
    low, high = 1.0, 1.1
    while law.nominal_stress_mpa(high, state) * high < cauchy_mpa:
        high *= 1.5
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if law.nominal_stress_mpa(middle, state) * middle < cauchy_mpa:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def spring_targets(law: ExponentialLaw, cauchy_max_mpa: float, state: str, count: int = 60) -> list[tuple]:
    """Pairs of spring stress [MPa] and strain that the springs should pass through."""
    pairs = []
    for sample in range(1, count + 1):
        stretch = stretch_at_cauchy_stress(law, cauchy_max_mpa * sample / count, state)
        pairs.append((law.nominal_stress_mpa(stretch, state) / LATTICE_FACTOR[state], stretch - 1.0))
    return pairs


def fit_springs(law: ExponentialLaw, cauchy_max_mpa: float, state: str = "equibiaxial") -> SpringFit:
    """Bilinear springs that follow the law up to a Cauchy stress [MPa], least squares in strain."""
    targets = spring_targets(law, cauchy_max_mpa, state)

    def springs_at(logs: list[float]) -> BilinearSprings:
        return BilinearSprings(*(math.exp(max(-50.0, min(50.0, value))) for value in logs))

    def mean_square(logs: list[float]) -> float:
        springs = springs_at(logs)
        return sum((springs.strain(stress) - strain) ** 2 for stress, strain in targets) / len(targets)

    starts = [
        [math.log(pre), math.log(knee * targets[-1][1]), math.log(post)]
        for pre in (0.003, 0.01, 0.03, 0.1)
        for knee in (0.6, 0.75, 0.9)
        for post in (0.3, 1.0, 3.0, 10.0)
    ]
    best = nelder_mead(mean_square, min(starts, key=mean_square))
    springs = springs_at(best)
    errors = [springs.strain(stress) - strain for stress, strain in targets]
    rms = math.sqrt(sum(error**2 for error in errors) / len(errors))
    return SpringFit(springs, rms, max(map(abs, errors)))


def nelder_mead(
    function: Callable[[list[float]], float], start: list[float], steps: int = 2000
) -> list[float]:
    """The lowest point that a downhill simplex (Nelder & Mead 1965, the usual 1, 2, 1/2, 1/2) finds."""
    simplex = [list(start)] + [
        [value + (0.2 if axis == moved else 0.0) for axis, value in enumerate(start)]
        for moved in range(len(start))
    ]
    ranked = sorted(([function(point), point] for point in simplex), key=lambda pair: pair[0])
    for _ in range(steps):
        if ranked[-1][0] - ranked[0][0] <= 1e-14 * abs(ranked[0][0]):
            break
        worst = ranked[-1][1]
        centre = [sum(pair[1][axis] for pair in ranked[:-1]) / len(start) for axis in range(len(start))]

        trial = beyond(function, centre, worst, 1.0)
        if trial[0] < ranked[0][0]:
            trial = min(trial, beyond(function, centre, worst, 2.0), key=lambda pair: pair[0])
        elif trial[0] >= ranked[-2][0]:
            trial = beyond(function, centre, worst, 0.5 if trial[0] < ranked[-1][0] else -0.5)
        if trial[0] < ranked[-1][0]:
            ranked[-1] = trial
        else:
            best = ranked[0][1]
            shrunk = [[0.5 * (b + p) for b, p in zip(best, pair[1])] for pair in ranked[1:]]
            ranked[1:] = [[function(point), point] for point in shrunk]
        ranked.sort(key=lambda pair: pair[0])
    return ranked[0][1]


def beyond(function: Callable, centre: list[float], worst: list[float], factor: float) -> list:
    """Value and place of the point beyond the centre, `factor` times as far from it as the worst."""
    point = [c + factor * (c - w) for c, w in zip(centre, worst)]
    return [function(point), point]


def ogden_modulus_mpa(terms: list[tuple[float, float]]) -> float:
    """Young's modulus [MPa] at no strain of an incompressible rod, from (mu_i [MPa], alpha_i)."""
    return 3.0 * sum(mu for mu, _ in terms)


def ogden_nominal_stress_mpa(terms: list[tuple[float, float]], stretch: float) -> float:
    """Nominal stress [MPa] of an incompressible rod, from (mu_i [MPa], alpha_i)."""
    return sum(2.0 * mu / a * (stretch ** (a - 1.0) - stretch ** (-0.5 * a - 1.0)) for mu, a in terms)
