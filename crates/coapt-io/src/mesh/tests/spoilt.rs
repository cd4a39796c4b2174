//! Fixtures cut, flipped and patched at random: read or refused, never a panic.

use super::*;

/// A plain generator (Marsaglia's xorshift64): the same files are spoilt in the same way on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % count.max(1) as u64) as usize
    }
}

#[test]
fn no_bytes_make_a_reader_panic() {
    let mut random = Random(0x5eed);
    let mut outcomes = [0_usize; 2];
    for name in VALVES.iter().chain(&SURFACES).chain(&STRIPS) {
        let whole = fixture(name);
        for round in 0..800 {
            let mut bytes = whole.clone();
            match round % 4 {
                0 => bytes.truncate(random.below(whole.len())),
                1 => (0..1 + random.below(4)).for_each(|_| {
                    let at = random.below(whole.len());
                    bytes[at] = random.below(256) as u8;
                }),
                // A count or an index that is far too large, or negative.
                2 => {
                    let digits: Vec<usize> =
                        (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
                    let at = digits[random.below(digits.len())];
                    let number = ["99999999999999999999", "4294967295", "-1", "1e999", "0"][random.below(5)];
                    bytes.splice(at..=at, number.bytes());
                }
                // A part of the file left out or repeated.
                _ => {
                    let start = random.below(whole.len());
                    let part = whole[start..]
                        .iter()
                        .copied()
                        .take(random.below(200))
                        .collect::<Vec<_>>();
                    let to = random.below(whole.len());
                    bytes.splice(to..(to + random.below(200)).min(whole.len()), part);
                }
            }
            let result = parse(name, &bytes);
            if let Ok((mesh, _)) = &result {
                assert!(
                    mesh.points.iter().flatten().all(|value| value.is_finite()),
                    "{name} {round}"
                );
                assert!(
                    mesh.triangles
                        .iter()
                        .flatten()
                        .all(|&point| (point as usize) < mesh.points.len())
                );
                assert_eq!(mesh.triangles.len(), mesh.triangle_source.len());
            }
            outcomes[usize::from(result.is_ok())] += 1;
        }
    }
    // The test would be idle if nothing was ever refused, or nothing ever read.
    assert!(outcomes[0] > 5000 && outcomes[1] > 1000, "{outcomes:?}");
}

#[test]
fn no_bytes_make_the_markups_reader_panic() {
    let mut random = Random(0xca11);
    let mut outcomes = [0_usize; 2];
    for name in ["annulus.mrk.json", "papillary.mrk.json"] {
        let whole = fixture(name);
        for round in 0..600 {
            let mut bytes = whole.clone();
            if round % 2 == 0 {
                bytes.truncate(random.below(whole.len()));
            } else {
                let at = random.below(whole.len());
                bytes[at] = random.below(256) as u8;
            }
            let mut faults = Faults::new(name.to_owned());
            let curve = markups::curve(&bytes, &mut faults);
            outcomes[usize::from(faults.finish(curve).is_ok())] += 1;
        }
    }
    // Half are cut, and none of those can be whole; most single bytes are spaces or in fields passed over.
    assert!(outcomes[0] >= 600 && outcomes[1] > 100, "{outcomes:?}");
}
