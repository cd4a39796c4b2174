use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::OnceLock;

use coapt::film::{Film, film};
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Moment, Status, relax};
use coapt::repair::parse_ring_spec;
use coapt::scene::{Repair, Scene};
use coapt::state::State;
use prost::Message;

use super::message::SceneUpdate;
use super::*;

fn scene(preset: Preset, faces: u32) -> Scene {
    let parameters = ValveParameters {
        face_count_target: faces,
        ..ValveParameters::preset(preset)
    };
    generate(&parameters).unwrap()
}

/// A small valve, its film of five frames, and both as bytes.
struct Small {
    scene: Scene,
    model: Model,
    film: Film,
    bytes: Vec<u8>,
}

fn small() -> &'static Small {
    static SMALL: OnceLock<Small> = OnceLock::new();
    SMALL.get_or_init(|| {
        let scene = scene(Preset::Healthy, 160);
        let model = Model::build(&scene).unwrap().model;
        let closed = relax(&model, &State::open(&model));
        let film = film(&model, &closed, 5);
        let bytes = bytes(&scene, &model, &film);
        Small {
            scene,
            model,
            film,
            bytes,
        }
    })
}

fn bytes(scene: &Scene, model: &Model, film: &Film) -> Vec<u8> {
    let source = Source {
        scene,
        repairs_before: &[],
        repairs: &[],
    };
    let filmed = Filmed {
        model,
        film,
        repairs: &[],
    };
    recording(source, filmed, None).unwrap()
}

fn go_on(_: &Moment) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn what_is_read_is_what_was_filmed_bit_for_bit() {
    let Small {
        scene,
        model,
        film,
        bytes,
    } = small();
    let read = read_bytes(bytes).unwrap();
    assert!(!read.cut);
    assert_eq!(&read.scene, scene);
    assert_eq!(read.films.len(), 1);
    let recorded = &read.films[0];
    assert_eq!(recorded.topic, "/valve");
    assert_eq!(recorded.faces, model.faces);
    assert_eq!(recorded.open_gap_mm, film.open_gap_mm);
    assert_eq!(recorded.annulus_mm.len(), model.annulus.len());
    assert_eq!(
        recorded.tips_mm.len(),
        model
            .papillary
            .iter()
            .map(|muscle| muscle.tips.len())
            .sum::<usize>()
    );
    assert_eq!(recorded.frames.len(), film.frames.len());
    for (frame, filmed) in recorded.frames.iter().zip(&film.frames) {
        let positions = &filmed.equilibrium.state.positions_mm;
        let bits = |point: [f64; 3]| point.map(f64::to_bits);
        let leaflets = positions.iter().take(model.leaflet_vertex_count);
        let expected: Vec<_> = leaflets.map(|&point| bits(point.into())).collect();
        assert_eq!(
            frame
                .positions_mm
                .iter()
                .map(|&point| bits(point))
                .collect::<Vec<_>>(),
            expected
        );
        assert_eq!(frame.chords_mm.len(), model.chords.ends.len());
        for (chord, ends) in frame.chords_mm.iter().zip(&model.chords.ends) {
            let expected = ends.map(|end| bits(model.chords.point_mm(end, positions).into()));
            assert_eq!(chord.map(bits), expected);
        }
        assert!(frame.certified);
        assert_eq!(
            frame.figures.residual,
            Some(filmed.equilibrium.certificate.residual)
        );
    }
}

/// Left out as a default, the sign of zero would be lost.
#[test]
fn minus_zero_comes_back() {
    let Small {
        scene, model, film, ..
    } = small();
    let mut film = film.clone();
    film.frames[2].equilibrium.state.positions_mm[3].x = -0.0;
    let read = read_bytes(&bytes(scene, model, &film)).unwrap();
    let x = read.films[0].frames[2].positions_mm[3][0];
    assert_eq!(x.to_bits(), (-0.0_f64).to_bits());
}

#[test]
fn equal_films_give_equal_bytes_at_any_number_of_threads() {
    let Small {
        scene,
        model,
        film,
        bytes: first,
    } = small();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        assert_eq!(&pool.install(|| bytes(scene, model, film)), first);
    }
}

/// Wherever a recording is cut off, the frames that are whole come back as they were; a cut before them is told.
#[test]
fn of_a_cut_recording_the_whole_frames_are_read() {
    let Small { bytes, .. } = small();
    let whole = read_bytes(bytes).unwrap();
    let mut counts = BTreeSet::new();
    for end in (0..bytes.len())
        .step_by(331)
        .chain([bytes.len() - 1, bytes.len() - 8])
    {
        match read_bytes(&bytes[..end]) {
            Ok(read) => {
                assert!(read.cut, "cut at {end}");
                let frames = read.films.first().map_or(0, |film| film.frames.len());
                counts.insert(frames);
                if frames > 0 {
                    assert_eq!(read.films[0].frames, whole.films[0].frames[..frames]);
                }
            }
            Err(fault) => {
                counts.insert(0);
                assert!(
                    fault.message.contains("cut off before"),
                    "cut at {end}: {fault:?}"
                );
            }
        }
    }
    assert!(counts.contains(&0) && counts.contains(&5), "{counts:?}");
}

/// Several chunks: of a long film cut in the middle, about half is there.
#[test]
fn a_long_film_cut_in_the_middle_has_its_first_frames() {
    let Small {
        scene, model, film, ..
    } = small();
    let mut long = film.clone();
    long.frames = (0..200).map(|number| film.frames[number % 5].clone()).collect();
    let bytes = bytes(scene, model, &long);
    let whole = read_bytes(&bytes).unwrap();
    let half = read_bytes(&bytes[..bytes.len() / 2]).unwrap();
    let frames = half.films[0].frames.len();
    assert!(half.cut && (40..160).contains(&frames), "{frames}");
    assert_eq!(half.films[0].frames, whole.films[0].frames[..frames]);
}

/// A plain generator (Marsaglia's xorshift64): the same bytes are spoilt in the same way on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

/// Checksums cover every byte that is read: spoilt ones are refused, or were of no matter, or seem to be a cut; other frames than
/// those recorded never come out.
#[test]
fn spoilt_bytes_never_give_other_frames() {
    let Small { bytes, .. } = small();
    let whole = read_bytes(bytes).unwrap();
    let mut random = Random(0x00c0_ffee);
    let mut refused = 0;
    for _ in 0..1500 {
        let mut spoilt = bytes.clone();
        for _ in 0..=random.below(3) {
            let at = match random.below(3) {
                // Where sizes stand: at the beginning and in the summary.
                0 => random.below(200),
                1 => bytes.len() - 1 - random.below(800),
                _ => random.below(bytes.len()),
            };
            spoilt[at] = random.below(256) as u8;
        }
        if random.below(8) == 0 {
            spoilt.truncate(random.below(bytes.len()));
        }
        match read_bytes(&spoilt) {
            Ok(read) => {
                for film in &read.films {
                    assert_eq!(film.frames, whole.films[0].frames[..film.frames.len()]);
                }
            }
            Err(fault) => {
                refused += 1;
                assert!(!fault.message.is_empty() && fault.message.len() < 2000);
            }
        }
    }
    assert!(refused > 1000, "{refused}");
}

/// A recording without compression and checksums, as a fuzzer needs it: there changes reach the messages.
#[test]
fn spoilt_messages_give_faults_or_numbers() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fuzz/seeds/recording/plain.mcap"
    );
    let bytes = std::fs::read(file).unwrap();
    assert_eq!(read_bytes(&bytes).unwrap().films[0].frames.len(), 2);
    let mut random = Random(0x0bad_cafe);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..4000 {
        let mut spoilt = bytes.clone();
        for _ in 0..=random.below(4) {
            spoilt[random.below(bytes.len())] = random.below(256) as u8;
        }
        match read_bytes(&spoilt) {
            Ok(recording) => {
                read += 1;
                for film in &recording.films {
                    let vertices = film.frames.first().map_or(0, |frame| frame.positions_mm.len());
                    assert!(
                        film.faces
                            .as_flattened()
                            .iter()
                            .all(|&vertex| (vertex as usize) < vertices)
                    );
                    for frame in &film.frames {
                        assert_eq!(frame.positions_mm.len(), vertices);
                        assert!(
                            frame
                                .positions_mm
                                .as_flattened()
                                .iter()
                                .all(|number| number.is_finite())
                        );
                    }
                }
            }
            Err(fault) => {
                refused += 1;
                assert!(!fault.message.is_empty() && fault.message.len() < 2000);
            }
        }
    }
    assert!(read > 400 && refused > 400, "{read} {refused}");
}

/// As coordinates of frames: viewers and panels of others are handed what was read.
#[test]
fn supports_that_are_not_finite_are_refused() {
    let Small {
        scene, model, film, ..
    } = small();
    let ring = Repair::Ring(parse_ring_spec("physio-like:32").unwrap());
    let report = repair::apply(model, &ring).unwrap().report;
    let repair::Report::Ring(mut spoilt) = report else {
        panic!("{report:?}")
    };
    let film = Film {
        open_gap_mm: Some(f64::INFINITY),
        ..film.clone()
    };
    let written = |ring: &repair::RingReport| {
        let source = Source {
            scene,
            repairs_before: &[],
            repairs: &[],
        };
        let repairs = &[repair::Report::Ring(ring.clone())];
        let filmed = Filmed {
            model,
            film: &film,
            repairs,
        };
        read_bytes(&recording(source, filmed, None).unwrap())
    };
    // What is no number is not known.
    assert_eq!(written(&spoilt).unwrap().films[0].open_gap_mm, None);
    spoilt.curve_mm[1].y = f64::NAN;
    assert_eq!(
        written(&spoilt).unwrap_err().message,
        "is spoilt: the supports of `/valve` have coordinates that are not finite"
    );
}

#[test]
fn what_is_no_recording_is_refused_in_plain_words() {
    let message = |bytes: &[u8]| read_bytes(bytes).unwrap_err().message;
    assert!(message(b"# vtk DataFile Version 3.0\n").contains("is no MCAP file"));
    let empty = Container::new().unwrap().finish().unwrap();
    assert_eq!(
        message(&empty),
        "is no recording of coapt: it has no metadata `coapt`"
    );
    let mut newer = Container::new().unwrap();
    newer
        .tell(FACTS, words([("schema", "coapt-recording/9")]))
        .unwrap();
    assert_eq!(
        message(&newer.finish().unwrap()),
        "has the layout \"coapt-recording/9\"; expected \"coapt-recording/1\""
    );
}

/// A chunk of 10 bytes that says that it holds a terabyte: refused before anything is asked of the memory.
#[test]
fn a_size_is_not_believed() {
    let empty = Container::new().unwrap().finish().unwrap();
    // The mark of MCAP, and the record of the header: its kind, its length, what it holds.
    let header_end = 8 + 9 + u64::from_le_bytes(empty[9..17].try_into().unwrap()) as usize;
    let mut bytes = empty[..header_end].to_vec();
    let mut chunk = Vec::new();
    chunk.extend([0; 16]);
    chunk.extend((1_u64 << 40).to_le_bytes());
    chunk.extend([0; 4]);
    chunk.extend(3_u32.to_le_bytes());
    chunk.extend(b"lz4");
    chunk.extend(10_u64.to_le_bytes());
    chunk.extend([7; 10]);
    bytes.push(6);
    bytes.extend((chunk.len() as u64).to_le_bytes());
    bytes.extend(chunk);
    let message = read_bytes(&bytes).unwrap_err().message;
    assert!(
        message.contains("a chunk of 10 bytes says that it holds"),
        "{message}"
    );
    for length in [u64::MAX, 1 << 40, 100] {
        for kind in [1, 4, 5, 6, 9, 12, 15, 2] {
            let mut bytes = empty[..header_end].to_vec();
            bytes.push(kind);
            bytes.extend(length.to_le_bytes());
            bytes.extend([0xff; 100]);
            assert!(read_bytes(&bytes).is_err());
        }
    }
}

/// A text that says that it is 4 GB long, in each kind of record that is read. The test of seeds of fuzzing sees that no memory is
/// asked for it, by `long_text.mcap`.
#[test]
fn a_text_that_is_not_there_is_not_believed() {
    let empty = Container::new().unwrap().finish().unwrap();
    let header_end = 8 + 9 + u64::from_le_bytes(empty[9..17].try_into().unwrap()) as usize;
    // Bytes before the first text: channel, chunk, attachment, metadata.
    for (kind, before) in [(4, 4), (6, 28), (9, 16), (12, 0)] {
        let mut bytes = empty[..header_end].to_vec();
        bytes.push(kind);
        bytes.extend((before as u64 + 14).to_le_bytes());
        bytes.extend(vec![0; before]);
        bytes.extend(u32::MAX.to_le_bytes());
        bytes.extend([b'a'; 10]);
        assert_eq!(
            read_bytes(&bytes).unwrap_err().message,
            "is spoilt: a record ends within what it says that it holds",
            "{kind}"
        );
    }
}

/// Grey, without colours, and in words.
#[test]
fn what_is_no_balance_is_not_drawn_as_one() {
    let Small { model, film, .. } = small();
    let drawn = |frame| {
        SceneUpdate::decode(&*draw::frame(model, frame, 0))
            .unwrap()
            .entities
    };
    let good = drawn(&film.frames[1]);
    assert!(good[0].triangles[0].color.is_none() && !good[0].triangles[0].colors.is_empty());
    assert!(good[3].texts.is_empty());
    let mut lost = film.frames[1].clone();
    lost.equilibrium.status = Status::Stalled;
    let lost = drawn(&lost);
    assert!(lost[0].triangles[0].color.is_some() && lost[0].triangles[0].colors.is_empty());
    assert_eq!(lost[3].texts[0].text, "NOT CERTIFIED (Stalled)");
}

/// The schema is written by hand: it names what is written, and nothing else.
#[test]
fn the_schema_names_every_figure() {
    let Small { model, film, .. } = small();
    let written = serde_json::to_value(Figures::new(model, &film.frames[1], 1)).unwrap();
    let keys = |value: &serde_json::Value| -> BTreeSet<String> {
        value.as_object().unwrap().keys().cloned().collect()
    };
    assert_eq!(keys(&written), keys(&schema::figures()["properties"]));
    for (name, value) in Figures::new(model, &film.frames[1], 1).numbers() {
        assert_eq!(written[name], serde_json::json!(value));
    }
}

#[test]
fn the_layout_is_json_and_names_the_topics() {
    let layout: serde_json::Value = serde_json::from_str(&super::layout(&small().model, true)).unwrap();
    let panels = layout["configById"].as_object().unwrap();
    assert_eq!(panels["3D!coapt0"]["topics"]["/before/valve"]["visible"], true);
    assert_eq!(panels["3D!coapt0"]["topics"]["/after/valve"]["visible"], false);
    assert_eq!(panels["3D!coapt1"]["topics"]["/after/valve"]["visible"], true);
    assert_eq!(
        layout_path(Path::new("a/closing.mcap")),
        Path::new("a/closing.layout.json")
    );
}

/// Of all presets, as they are and before and after a ring.
#[test]
fn a_replay_agrees_to_the_last_bit() {
    for preset in Preset::ALL {
        let scene = scene(preset, 160);
        let ring = Repair::Ring(parse_ring_spec("physio-like:32").unwrap());
        for repairs in [Vec::new(), vec![ring]] {
            let recorded = Recording {
                films: Vec::new(),
                cut: false,
                facts: words([("frames", "6")]),
                scene: scene.clone(),
                repairs_before: Vec::new(),
                repairs,
            };
            let bytes = made_again(&recorded, &go_on).unwrap();
            let read = read_bytes(&bytes).unwrap();
            let films = if recorded.repairs.is_empty() { 1 } else { 2 };
            let found = replay(&read, &go_on).unwrap();
            assert_eq!(found.first, None, "{}", preset.name());
            assert_eq!(
                (found.frames, found.different, found.farthest_mm),
                (6 * films, 0, 0.0)
            );
            assert_eq!(made_again(&read, &go_on).unwrap(), bytes);
        }
    }
}

/// One bit of one coordinate.
#[test]
fn a_replay_names_the_first_frame_and_vertex_that_differ() {
    let mut read = read_bytes(&small().bytes).unwrap();
    let x = &mut read.films[0].frames[3].positions_mm[7][0];
    *x = f64::from_bits(x.to_bits() + 1);
    let moved_mm = 2.0_f64.powi(-52) * x.abs();
    read.films[0].frames[4].figures.residual = Some(1.0);
    let found = replay(&read, &go_on).unwrap();
    assert_eq!((found.frames, found.different), (5, 2));
    let first = found.first.unwrap();
    assert_eq!((first.frame, &*first.topic), (3, "/valve"));
    let (vertex, gap_mm) = first.vertex.unwrap();
    assert_eq!(vertex, 7);
    // A unit in the last place is half to all of that.
    assert!(
        gap_mm > 0.4 * moved_mm && gap_mm <= moved_mm,
        "{gap_mm} {moved_mm}"
    );
    assert_eq!(found.farthest_mm, gap_mm);
}
