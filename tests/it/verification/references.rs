//! Answers that are no closed form but an equation to be solved: a series, a shooting, a root, an integral.

/// The root of a continuous function between two points where its signs differ, by halving, to the last bit.
pub(super) fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let negative_below = f(low) < 0.0;
    assert_ne!(negative_below, f(high) < 0.0, "no root between {low} and {high}");
    loop {
        let middle = 0.5 * (low + high);
        if middle == low || middle == high {
            return middle;
        }
        if (f(middle) < 0.0) == negative_below {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// ∫ f over an interval, by Simpson's rule on 2000 pieces.
pub(super) fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PIECES: u32 = 2000;
    let step = (to - from) / f64::from(PIECES);
    let piece = |i: u32| {
        let left = from + step * f64::from(i);
        f(left) + 4.0 * f(left + 0.5 * step) + f(left + step)
    };
    (0..PIECES).map(piece).sum::<f64>() * step / 6.0
}

/// Hencky's clamped circular membrane: flat at rest, small rotations, dead load across.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hencky {
    /// Crown over a q^(1/3) [1], q = p a / (E h).
    pub(super) crown: f64,
    /// Radial stress at the centre over (E p² a² / h²)^(1/3) [1].
    pub(super) centre_stress: f64,
    /// The same at the rim [1].
    pub(super) rim_stress: f64,
    /// Volume below over π a³ q^(1/3) [1].
    pub(super) volume: f64,
}

/// Föppl's equations of the membrane in x = (r/a)², N = ¼ q^(2/3) E h B(x), B = Σ bₙ xⁿ:
///
/// ```text
/// compatibility   B² Σ 4 n (n+1) bₙ xⁿ = −8 x           bₙ from b₀, one power of x after the other
/// no slip at rim  Σ (2n + 1 − ν) bₙ = 0                 b₀
/// across          w' = −2 q^(1/3) r / B                  crown and volume
/// ```
pub(super) fn hencky(nu: f64) -> Hencky {
    const TERMS: usize = 60;
    let coefficients = |b0: f64| {
        let mut b = vec![b0];
        for n in 1..TERMS {
            // The power n of B² Σ 4 m (m+1) b_m x^m, but for the term with b_n, which is 4 n (n+1) b₀² b_n.
            let known: f64 = (1..n)
                .map(|m| {
                    let squared: f64 = (0..=n - m).map(|i| b[i] * b[n - m - i]).sum();
                    4.0 * (m * (m + 1)) as f64 * b[m] * squared
                })
                .sum();
            let right = if n == 1 { -8.0 } else { 0.0 };
            b.push((right - known) / (4.0 * (n * (n + 1)) as f64 * b0 * b0));
        }
        b
    };
    let slip = |b0: f64| -> f64 {
        let b = coefficients(b0);
        (0..TERMS).map(|n| (2.0 * n as f64 + 1.0 - nu) * b[n]).sum()
    };
    let b = coefficients(root(slip, 1.55, 2.0));
    let stress = |r: f64| b.iter().rev().fold(0.0, |sum, c| sum * r * r + c);
    Hencky {
        crown: integral(|r| 2.0 * r / stress(r), 0.0, 1.0),
        centre_stress: stress(0.0) / 4.0,
        rim_stress: stress(1.0) / 4.0,
        volume: integral(|r| 2.0 * r.powi(3) / stress(r), 0.0, 1.0),
    }
}

/// Derivatives of a membrane's energy per unloaded area by its two principal stretches: force per unloaded length [E h].
pub(super) type Law<'a> = &'a dyn Fn(f64, f64) -> [f64; 2];

/// A circular membrane under pressure that follows it, at whatever rotation and strain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    /// Crown over radius [1].
    pub(super) crown: f64,
    /// Strain at the centre [1].
    pub(super) centre_strain: f64,
    /// Volume over radius³ [1].
    pub(super) volume: f64,
}

/// Balance of a membrane of revolution over its unloaded radius R in 0..1, T₁ and T₂ forces per unloaded length:
///
/// ```text
/// across    R T₁ sin φ = p r² / 2 =: V           along r    H := R T₁ cos φ,  H' = T₂ + p r z'
/// R T₁ = √(H² + V²)  →  λ₁ from the law          r' = λ₁ H / (R T₁),  z' = −λ₁ V / (R T₁)
/// ```
///
/// from the centre, where λ₁ = λ₂ is guessed, to the rim, where r = 1 decides the guess. Runge and Kutta's steps.
pub(super) fn follower(law: Law, q: f64, nu: f64) -> Follower {
    let shoot = |stretch: f64| shoot(law, q, stretch);
    let guess = 0.43 * q.powf(2.0 / 3.0) * (1.0 - nu);
    // Stretched too little, the membrane folds back on its axis and on to where there is no number.
    let stretch = root(
        |stretch| (shoot(stretch)[0] - 1.0).max(-1.0),
        1.0 + 0.5 * guess,
        1.0 + 4.0 * guess,
    );
    let [_, _, z, volume] = shoot(stretch);
    Follower {
        crown: -z,
        centre_strain: stretch - 1.0,
        volume,
    }
}

/// r, H, z and the volume at the rim.
fn shoot(law: Law, q: f64, stretch: f64) -> [f64; 4] {
    const STEPS: u32 = 150;
    // The centre itself divides by zero.
    let begin = 1e-6;
    let step = (1.0 - begin) / f64::from(STEPS);
    let rate = |radius: f64, [r, h, _, _]: [f64; 4]| {
        let v = 0.5 * q * r * r;
        let pull = h.hypot(v);
        let across = r / radius;
        let along = stretch_along(law, pull / radius, across);
        let (dr, dz) = (along * h / pull, -along * v / pull);
        [
            dr,
            law(along, across)[1] + q * r * dz,
            dz,
            -std::f64::consts::PI * r * r * dz,
        ]
    };
    let add = |x: [f64; 4], d: [f64; 4], part: f64| std::array::from_fn(|i| x[i] + part * d[i]);
    let mut x = [stretch * begin, begin * law(stretch, stretch)[0], 0.0, 0.0];
    for i in 0..STEPS {
        let radius = begin + step * f64::from(i);
        let a = rate(radius, x);
        let b = rate(radius + 0.5 * step, add(x, a, 0.5 * step));
        let c = rate(radius + 0.5 * step, add(x, b, 0.5 * step));
        let d = rate(radius + step, add(x, c, step));
        x = std::array::from_fn(|i| x[i] + step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    x
}

/// The stretch along the meridian at which the law pulls so much; by Newton's method.
fn stretch_along(law: Law, pull: f64, across: f64) -> f64 {
    let mut along = 1.0 + pull;
    for _ in 0..30 {
        let (here, ahead) = (law(along, across)[0], law(along + 1e-7, across)[0]);
        let step = (pull - here) * 1e-7 / (ahead - here);
        along += step.clamp(-0.2, 0.2);
        if step.abs() < 1e-13 {
            break;
        }
    }
    along
}

/// Hooke's law in the strains λ − 1 (Biot's), plane stress.
pub(super) fn biot(nu: f64) -> impl Fn(f64, f64) -> [f64; 2] {
    let stiffness = 1.0 / (1.0 - nu * nu);
    move |a, b| [(a, b), (b, a)].map(|(a, b)| stiffness * (a - 1.0 + nu * (b - 1.0)))
}

/// What a lattice of springs linear in length is on the mean over its orientations. Stretched by λ₁ and λ₂, a spring at the
/// angle θ has the stretch l = √(λ₁² cos² θ + λ₂² sin² θ), and W = 3/2 E h ⟨(l − 1)²⟩: for small strains Hooke's membrane
/// with ν = 1/3, for equal stretches exactly Biot's; for large unequal ones neither.
pub(super) fn spring_mean(a: f64, b: f64) -> [f64; 2] {
    const ANGLES: u32 = 12;
    let mut sum = [0.0; 2];
    for i in 0..ANGLES {
        let (sin, cos) = (std::f64::consts::PI * f64::from(i) / f64::from(ANGLES)).sin_cos();
        let length = (a * cos).hypot(b * sin);
        let pull = 3.0 * (length - 1.0) / (length * f64::from(ANGLES));
        sum[0] += pull * a * cos * cos;
        sum[1] += pull * b * sin * sin;
    }
    sum
}
