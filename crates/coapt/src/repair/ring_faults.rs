//! What of a ring does not go together with the rest of it.

use crate::scene::{Attachment, Fault, Ring};

/// Anteroposterior over transverse diameter [1]: rings have 0.57 (three quarters of 0.76, Bothe 2010) to 0.75; as round as a
/// circle at most, and half of the width at least (our choice).
const AP_SHARE: std::ops::RangeInclusive<f64> = 0.5..=1.0;

/// Height of the anterior middle over the size, at most [1]: half as much again as the saddle family has (our choice).
const MOST_HEIGHT_SHARE: f64 = 0.4;

/// Single sutures: half of the fewest and twice the most that are usual (our choice).
const SUTURES: std::ops::RangeInclusive<u32> = 5..=28;

/// Everything wrong with proportions, sutures and flexibility.
pub(super) fn variant_faults(ring: &Ring) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut fault = |key: &str, message: String| faults.push(Fault::error(format!("ring.{key}"), message));
    let given = [("ap_mm", ring.ap_mm), ("saddle_height_mm", ring.saddle_height_mm)];
    for (key, value) in given {
        let (Some(value), Some(size_mm)) = (value, ring.size_mm) else {
            if value.is_some() && ring.family.is_none() {
                fault(
                    key,
                    "is given, but a curve has its own; expected a family beside it".into(),
                );
            }
            continue;
        };
        let range = match key {
            "ap_mm" => AP_SHARE,
            _ => 0.0..=MOST_HEIGHT_SHARE,
        };
        let [least, most] = [range.start(), range.end()].map(|share| share * size_mm);
        if ring.family.is_none() {
            fault(
                key,
                "is given, but a curve has its own; expected a family beside it".into(),
            );
        } else if !(least..=most).contains(&value) {
            fault(
                key,
                format!("is {value} mm, expected {least:.1} to {most:.1} for a size of {size_mm} mm"),
            );
        }
    }
    match ring.sutures {
        Some(_) if ring.attachment != Attachment::Sutures => fault(
            "sutures",
            "is given, but `attachment` is not `sutures`; expected both, or neither".into(),
        ),
        Some(count) if !SUTURES.contains(&count) => fault(
            "sutures",
            format!("is {count}, expected {} to {}", SUTURES.start(), SUTURES.end()),
        ),
        _ => {}
    }
    if ring.flexible && (ring.placed || ring.attachment != Attachment::ArcLength) {
        fault(
            "flexible",
            "is set, so that only the ring's length matters; expected neither `placed` nor `attachment`"
                .into(),
        );
    }
    if ring.flexible && (ring.ap_mm.is_some() || ring.saddle_height_mm.is_some()) {
        fault(
            "flexible",
            "is set, so that only the ring's length matters; expected neither `ap_mm` nor `saddle_height_mm`"
                .into(),
        );
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair::apply;
    use crate::repair::ring::tests::{curve, skirt_model};
    use crate::repair::ring_shape::{family_curve, parse_ring_spec};
    use crate::scene::{Repair, RingFamily};

    #[test]
    fn what_does_not_go_together_is_told() {
        let model = skirt_model();
        let ring = parse_ring_spec("physio-like:30").unwrap();
        let told = |ring: Ring, place: &str, words: &str| {
            let faults = apply(&model, &Repair::Ring(ring)).err().unwrap_or_default();
            let found = faults
                .iter()
                .any(|f| f.place == place && f.message.contains(words));
            assert!(found, "no `{place}` with `{words}` in {faults:#?}");
        };
        for ap_mm in [14.0, 31.0, f64::NAN] {
            let wrong = Ring {
                ap_mm: Some(ap_mm),
                ..ring.clone()
            };
            told(wrong, "ring.ap_mm", "expected 15.0 to 30.0 for a size of 30 mm");
        }
        let high = Ring {
            saddle_height_mm: Some(13.0),
            ..ring.clone()
        };
        told(high, "ring.saddle_height_mm", "is 13 mm, expected 0.0 to 12.0");
        let measured = Ring {
            ap_mm: Some(20.0),
            ..curve(&family_curve(RingFamily::Saddle, 30.0).points_mm)
        };
        told(measured, "ring.ap_mm", "a curve has its own");
        let lonely = Ring {
            sutures: Some(12),
            ..ring.clone()
        };
        told(lonely, "ring.sutures", "but `attachment` is not `sutures`");
        for sutures in [0, 4, 29] {
            let wrong = Ring {
                sutures: Some(sutures),
                attachment: Attachment::Sutures,
                ..ring.clone()
            };
            told(wrong, "ring.sutures", "expected 5 to 28");
        }
        let both = Ring {
            flexible: true,
            attachment: Attachment::Sutures,
            ..ring.clone()
        };
        told(both, "ring.flexible", "only the ring's length matters");
        let shaped = Ring {
            flexible: true,
            ap_mm: Some(20.0),
            ..ring
        };
        told(shaped, "ring.flexible", "neither `ap_mm`");
    }
}
