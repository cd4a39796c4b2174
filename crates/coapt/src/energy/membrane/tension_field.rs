//! Tissue that wrinkles finer than the mesh and carries no compression (tension-field theory: Pipkin 1986,
//! IMA J Appl Math 36:85).
//!
//! Wrinkles hide tissue: beneath them it is longer than its mean surface shows, C + Z with some Z ⪰ 0. It takes the Z
//! of least energy, w*(C) = min w(C + Z). Three cases: taut, Z = 0, where the stress of C has no compression; slack, no
//! energy at all, where C is nowhere longer than the unloaded tissue; wrinkled, Z = z zᵀ with S z = 0, in between. This
//! holds for any law whose unloaded state is its only minimum, with fibres or without.
//!
//! Derivatives: by the envelope theorem w*′ = w′(C + z zᵀ), and w*″ is what is left of w″ when z gives way.

use super::{Law, Metric, Response, UNLOADED};
use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector2};

/// Energy, stress and tangent at a metric.
#[inline(always)]
pub fn response(law: &Law, metric: &Metric) -> Response {
    let taut = law.response(metric);
    let slope = taut.slope_mpa;
    let stress = symmetric(slope[0], slope[1], 0.5 * slope[2]);
    if least(&stress) >= 0.0 {
        return taut;
    }
    let shortened = UNLOADED - metric;
    if least(&symmetric(shortened[0], shortened[1], shortened[2])) >= 0.0 {
        return Response::default();
    }
    wrinkled(law, metric, least_direction(&stress))
}

/// Newton's iterations for z are so many at most; 4 to 8 are enough.
const ITERATIONS: u32 = 60;
/// The residual S z counts as zero when Newton's next step would change z by less than this part [1].
const SOLVED: f64 = 1e-12;

/// Steps shorter than this part of z are taken without a look at the energy, which they change by less than its rounding [1].
const NEAR: f64 = 1e-5;

/// Minimises w(C + z zᵀ) over z. With s = w′ at C + z zᵀ and C′ = ∂C/∂z (columns (2z₁, 0, z₂) and (0, 2z₂, z₁)):
/// gradient C′ᵀ s, Hessian C′ᵀ w″ C′ + [2s₁, s₃; s₃, 2s₂].
fn wrinkled(law: &Law, metric: &Metric, direction: Vector2<f64>) -> Response {
    let mut hidden = direction * first_length(law, metric, direction);
    let mut state = State::new(law, metric, hidden);
    for _ in 0..ITERATIONS {
        let step = state.step();
        if step.norm() <= SOLVED * hidden.norm() {
            break;
        }
        let mut fraction = 1.0;
        let next = loop {
            let trial = State::new(law, metric, hidden + step * fraction);
            // So near the minimum that rounding hides the descent, Newton's step is right.
            let is_near = step.norm() < NEAR * hidden.norm();
            if is_near || trial.response.energy_mpa <= state.response.energy_mpa || fraction < 1e-6 {
                break trial;
            }
            fraction *= 0.5;
        };
        hidden += step * fraction;
        state = next;
    }
    state.relaxed()
}

/// Tries for a first length are so many at most; 2 to 8 are enough.
const TRIES: u32 = 12;
/// A first length leaves this part of the compression at most [1]. More, and Newton's method starts too far off where the
/// stress begins flat, as May and Newman's; less costs more than it saves.
const LEFT: f64 = 1e-2;
/// An end that is so many times as far from no stress as the other says nothing of where that is: the bracket is halved then.
const LOPSIDED: f64 = 10.0;

/// A length of z along the direction of most compression that takes about all of it away: the secant's zero of the stress, which
/// grows with the square of z, within a bracket (Illinois: an end that stays is pulled in by half).
fn first_length(law: &Law, metric: &Metric, direction: Vector2<f64>) -> f64 {
    let along = square(direction);
    let stress = |squared: f64| law.response(&(metric + along * squared)).slope_mpa.dot(&along);
    let (mut low, mut high) = ([0.0, stress(0.0)], [1.0, stress(1.0)]);
    while high[1] < 0.0 && high[0] < 256.0 {
        (low, high) = (high, [4.0 * high[0], stress(4.0 * high[0])]);
    }
    let most = LEFT * low[1].abs();
    for _ in 0..TRIES {
        let between = match high[1] > LOPSIDED * low[1].abs() {
            true => 0.5 * (low[0] + high[0]),
            false => low[0] - low[1] * (high[0] - low[0]) / (high[1] - low[1]),
        };
        let found = [between, stress(between)];
        if found[1].abs() <= most {
            return between.sqrt();
        }
        if found[1] < 0.0 {
            (low, high[1]) = (found, 0.5 * high[1]);
        } else {
            (high, low[1]) = (found, 0.5 * low[1]);
        }
    }
    high[0].sqrt()
}

/// The tissue beneath wrinkles of some depth z.
struct State {
    response: Response,
    /// ∂C/∂z.
    metric_slope: Matrix3x2<f64>,
    gradient: Vector2<f64>,
    hessian: Matrix2<f64>,
}

impl State {
    fn new(law: &Law, metric: &Metric, hidden: Vector2<f64>) -> Self {
        let response = law.response(&(metric + square(hidden)));
        let metric_slope = Matrix3x2::new(2.0 * hidden[0], 0.0, 0.0, 2.0 * hidden[1], hidden[1], hidden[0]);
        let slope = response.slope_mpa;
        Self {
            response,
            metric_slope,
            gradient: metric_slope.tr_mul(&slope),
            hessian: metric_slope.tr_mul(&(response.curvature_mpa * metric_slope))
                + Matrix2::new(2.0 * slope[0], slope[2], slope[2], 2.0 * slope[1]),
        }
    }

    /// Newton's step, or one downhill where the Hessian is not definite.
    fn step(&self) -> Vector2<f64> {
        let newton = self
            .hessian
            .try_inverse()
            .map(|inverse| -(inverse * self.gradient));
        match newton {
            Some(step) if step.dot(&self.gradient) < 0.0 => step,
            _ => -self.gradient / self.hessian.norm().max(f64::MIN_POSITIVE),
        }
    }

    fn relaxed(&self) -> Response {
        let mixed: Matrix3x2<f64> = self.response.curvature_mpa * self.metric_slope;
        let given_way: Matrix3<f64> = match self.hessian.try_inverse() {
            Some(inverse) => mixed * inverse * mixed.transpose(),
            None => Matrix3::zeros(),
        };
        Response {
            curvature_mpa: self.response.curvature_mpa - given_way,
            ..self.response
        }
    }
}

/// z zᵀ as a metric.
fn square(z: Vector2<f64>) -> Metric {
    Metric::new(z[0] * z[0], z[1] * z[1], z[0] * z[1])
}

fn symmetric(xx: f64, yy: f64, xy: f64) -> Matrix2<f64> {
    Matrix2::new(xx, xy, xy, yy)
}

/// The least eigenvalue.
fn least(matrix: &Matrix2<f64>) -> f64 {
    let half = 0.5 * (matrix[(0, 0)] - matrix[(1, 1)]);
    0.5 * matrix.trace() - (half * half + matrix[(0, 1)] * matrix[(0, 1)]).sqrt()
}

/// Its unit eigenvector. The greatest one's direction is at half the angle of (half, xy); the least one's stands on it.
fn least_direction(matrix: &Matrix2<f64>) -> Vector2<f64> {
    let half = 0.5 * (matrix[(0, 0)] - matrix[(1, 1)]);
    let (sin, cos) = (0.5 * matrix[(0, 1)].atan2(half)).sin_cos();
    Vector2::new(-sin, cos)
}
