//! What is refused, and what is odd.

use nalgebra::Isometry3;

use super::super::*;
use super::{compared, hills, moved, square, surface_rows};

/// The number of threads changes no bit.
#[test]
fn threads_change_nothing() {
    let (a, b) = (
        hills(30),
        moved(&hills(41), &Isometry3::translation(0.1, 0.2, 0.7)),
    );
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| compared(&a, &b))
    };
    assert_eq!(with(1), with(3));
}

/// Everything that is no surface is refused with its name and what was found; nothing panics.
#[test]
fn what_is_no_surface_is_refused() {
    let good = square(2, 0.0);
    let spoilt = |change: fn(&mut ComparedSurface)| {
        let mut bad = good.clone();
        bad.name = "bad".into();
        change(&mut bad);
        bad
    };
    let cases: [(ComparedSurface, &str); 9] = [
        (ComparedSurface::default(), "no faces"),
        (spoilt(|s| s.faces.clear()), "no faces, only 9 points"),
        (spoilt(|s| s.faces[1] = [0, 1, 9]), "face 1 is [0, 1, 9]"),
        (spoilt(|s| s.points_mm[3].y = f64::NAN), "point 3 is (0, NaN, 0)"),
        (spoilt(|s| s.points_mm[3].y = 1e9), "within a kilometre"),
        (spoilt(|s| s.contact = Some(vec![true])), "1 values of `contact`"),
        (spoilt(|s| s.annulus = Some(vec![])), "0 values of `annulus`"),
        (spoilt(|s| s.face_cell = vec![1]), "1 cells of faces"),
        (
            spoilt(|s| s.points_mm.iter_mut().for_each(|p| p.x = 0.0)),
            "have no area",
        ),
    ];
    for (bad, expected) in &cases {
        for (a, b) in [(bad, &good), (&good, bad)] {
            let faults = compare(a, b, &CompareSettings::default()).unwrap_err();
            assert!(
                faults.len() == 1 && faults[0].message.contains(expected),
                "{faults:?}"
            );
            assert_eq!(faults[0].place, bad.name);
        }
    }
    let settings = CompareSettings {
        atrial_direction: Some(Vec3::zeros()),
        contact_thickness_mm: f64::NAN,
    };
    assert_eq!(compare(&cases[1].0, &good, &settings).unwrap_err().len(), 3);
}

/// Scattered faces of any size, folded, doubled, without area, anywhere within a kilometre: every number is finite, and
/// alignment makes nothing worse.
#[test]
fn odd_surfaces_have_finite_distances() {
    let mut seed = 7u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / f64::from(1u32 << 31)
    };
    for (size, far) in [(1e-60, 0.0), (1e-6, 1e5), (10.0, 0.0), (10.0, 9e5), (9e5, 0.0)] {
        let mut scatter = |count: usize| {
            let mut place = || Vec3::new(random(), random(), random()) * size + Vec3::repeat(far);
            let points_mm = (0..count).map(|_| place()).collect();
            let mut corner = || (random() * count as f64) as u32;
            let scattered = (0..2 * count).map(|_| [corner(), corner(), corner()]);
            ComparedSurface {
                points_mm,
                // The first one has area.
                faces: [[0, 1, 2]].into_iter().chain(scattered).collect(),
                contact: Some((0..count).map(|v| v % 3 == 0).collect()),
                ..ComparedSurface::default()
            }
        };
        for count in [3, 7, 40] {
            let found = compared(&scatter(count), &scatter(30));
            for part in [
                found.as_given.whole,
                found.aligned.whole,
                found.as_given.in_contact.unwrap(),
            ] {
                for d in surface_rows(&part) {
                    let numbers = [d.mean_mm, d.sd_mm, d.rms_mm, d.p05_mm, d.p95_mm, d.max_mm];
                    assert!(numbers.iter().all(|x| x.is_finite()), "{size} {far} {d:?}");
                }
            }
            let a = found.alignment;
            assert!(
                a.offset_mm.iter().chain(&a.translation_mm).all(|x| x.is_finite()),
                "{a:?}"
            );
            assert!(a.rms_mm[1] <= a.rms_mm[0] && a.rotation_deg.is_finite(), "{a:?}");
        }
    }
}
