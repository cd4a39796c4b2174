//! Reads recordings, also those that were cut off: what is whole up to the cut. Nothing is taken on trust: no size is believed
//! before the bytes are there, and every checksum is compared.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use coapt::relax::Status;
use coapt::scene::{Fault, Repair, Scene};
use lz4_flex::frame::FrameDecoder;
use mcap::McapError;
use mcap::records::{ChunkHeader, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use prost::Message;

use super::container::LZ4;
use super::fields::{Fields, Told};
use super::figures::Figures;
use super::message::Xyz;
use super::message::read::{LinePrimitive, SceneEntity, SceneUpdate, TriangleListPrimitive};
use super::{FACTS, FILM_FACTS, RECORDING_SCHEMA, REPAIRS_BEFORE_FILE, REPAIRS_FILE, SCENE_FILE, draw};
use crate::atomic::file_fault;

/// A recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// `/valve`, or `/before/valve` and `/after/valve`.
    pub films: Vec<RecordedFilm>,
    /// Whether it ends before its end: some frames may be missing.
    pub cut: bool,
    /// What is told of it: `schema`, `version`, `case`, `frames`, `notice`.
    pub facts: BTreeMap<String, String>,
    /// The scene that was filmed.
    pub scene: Scene,
    /// What was done to the valve before all.
    pub repairs_before: Vec<Repair>,
    /// What was done between `/before/valve` and `/after/valve`.
    pub repairs: Vec<Repair>,
}

impl Recording {
    /// What makes it likely that it does not come out the same, in a sentence each.
    pub fn doubts(&self) -> Vec<String> {
        let fact = |key: &str| self.facts.get(key).map_or("", String::as_str);
        let version = env!("CARGO_PKG_VERSION");
        let other = (fact("version") != version)
            .then(|| format!("recorded by version {}, made again by {version}", fact("version")));
        let cut = self.cut.then(|| {
            let films = self.films.iter();
            let frames: Vec<String> = films
                .map(|film| format!("{} of {}", film.frames.len(), film.topic))
                .collect();
            let (frames, all) = (frames.join(", "), fact("frames"));
            format!("the recording is cut off; of {all} frames to each film there are {frames}")
        });
        other.into_iter().chain(cut).collect()
    }
}

/// A film.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedFilm {
    /// `/valve`, `/before/valve` or `/after/valve`.
    pub topic: String,
    /// Triangles, shape `[face]`.
    pub faces: Vec<[u32; 3]>,
    /// From the one without pressure to the closed valve.
    pub frames: Vec<RecordedFrame>,
    /// Annulus in order [mm].
    pub annulus_mm: Vec<[f64; 3]>,
    /// Papillary tips [mm].
    pub tips_mm: Vec<[f64; 3]>,
    /// Rings [mm], each with its points in order.
    pub rings_mm: Vec<Vec<[f64; 3]>>,
    /// [`coapt::film::Film::open_gap_mm`].
    pub open_gap_mm: Option<f64>,
}

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedFrame {
    /// Transvalvular pressure [mmHg].
    pub pressure_mmhg: f64,
    /// Leaflet vertices [mm], shape `[leaflet vertex]`.
    pub positions_mm: Vec<[f64; 3]>,
    /// Ends of the chord segments [mm], shape `[segment]`.
    pub chords_mm: Vec<[[f64; 3]; 2]>,
    /// Why the solver stopped.
    pub status: Status,
    /// Whether it may be shown as a balance: converged, stable, nothing crosses.
    pub certified: bool,
    /// Everything else that is known of it.
    pub figures: Figures,
}

/// Reads a recording.
///
/// # Errors
/// What the file system says; what is no MCAP file or no recording of coapt; where the file is spoilt.
pub fn read(path: &Path) -> Result<Recording, Fault> {
    let bytes = std::fs::read(path).map_err(|error| file_fault(path, &error))?;
    read_bytes(&bytes).map_err(|fault| Fault {
        place: path.display().to_string(),
        ..fault
    })
}

/// The same from bytes.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8]) -> Result<Recording, Fault> {
    let mut found = Found::default();
    let cut = found.read(bytes).map_err(fault)?;
    found.recording(cut).map_err(fault)
}

fn fault(message: String) -> Fault {
    Fault::error("recording", message)
}

/// What stands in a file, in the order in which it comes.
#[derive(Default)]
struct Found {
    facts: BTreeMap<String, BTreeMap<String, String>>,
    attachments: BTreeMap<String, Vec<u8>>,
    topics: BTreeMap<u16, String>,
    /// Messages, by topic and time.
    pictures: BTreeMap<String, BTreeMap<u64, SceneUpdate>>,
    figures: BTreeMap<String, BTreeMap<u64, Figures>>,
}

impl Found {
    /// Reads the records; whether the file ends before its end.
    fn read(&mut self, mut bytes: &[u8]) -> Told<bool> {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            // A record that is longer than the file is not all there.
            .with_record_length_limit(bytes.len());
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(wanted)) => {
                    let (some, rest) = bytes.split_at(wanted.min(bytes.len()));
                    reader.insert(some.len()).copy_from_slice(some);
                    reader.notify_read(some.len());
                    bytes = rest;
                }
                Ok(LinearReadEvent::Record { opcode, data }) => self.record(opcode, data)?,
                Err(McapError::UnexpectedEof | McapError::RecordTooLarge { .. }) => return Ok(true),
                Err(McapError::BadMagic) if self.facts.is_empty() => {
                    return Err("is no MCAP file: it does not begin as one".to_owned());
                }
                Err(error) => return Err(format!("is spoilt: {error}")),
            }
        }
        Ok(false)
    }

    fn record(&mut self, opcode: u8, data: &[u8]) -> Told<()> {
        let mut fields = Fields(data);
        match opcode {
            op::ATTACHMENT => self.attachment(data)?,
            op::METADATA => {
                let name = fields.text()?;
                self.facts.insert(name, fields.words()?);
            }
            op::CHANNEL => {
                let (id, _schema) = (fields.u16()?, fields.u16()?);
                self.topics.insert(id, fields.text()?);
            }
            op::MESSAGE => {
                let (channel, _number, time, _published) =
                    (fields.u16()?, fields.u32()?, fields.u64()?, fields.u64()?);
                self.message(channel, time, fields.0)?;
            }
            op::CHUNK => {
                let header = fields.chunk_header()?;
                self.chunk(&header, fields.take(header.compressed_size)?)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn attachment(&mut self, data: &[u8]) -> Told<()> {
        let mut fields = Fields(data);
        let (_logged, _created) = (fields.u64()?, fields.u64()?);
        let (name, _media_type) = (fields.text()?, fields.text()?);
        let length = fields.u64()?;
        let content = fields.take(length)?;
        let checked = &data[..data.len() - fields.0.len()];
        let saved = fields.u32()?;
        if saved != 0 && saved != crc32fast::hash(checked) {
            return Err(format!("is spoilt: the checksum of its `{name}` does not fit"));
        }
        self.attachments.insert(name, content.to_vec());
        Ok(())
    }

    fn chunk(&mut self, header: &ChunkHeader, data: &[u8]) -> Told<()> {
        let records = uncompressed(header, data)?;
        if header.uncompressed_crc != 0 && header.uncompressed_crc != crc32fast::hash(&records) {
            return Err("is spoilt: the checksum of a chunk does not fit".to_owned());
        }
        let mut rest = &records[..];
        while let Some((&opcode, after)) = rest.split_first() {
            let record = after.split_at_checked(8).and_then(|(length, after)| {
                let length = u64::from_le_bytes(length.try_into().ok()?);
                after.split_at_checked(usize::try_from(length).ok()?)
            });
            let (record, after) = record.ok_or("is spoilt: a chunk ends within a record")?;
            match opcode {
                op::CHANNEL | op::MESSAGE => self.record(opcode, record)?,
                _ => {}
            }
            rest = after;
        }
        Ok(())
    }

    fn message(&mut self, channel: u16, time: u64, data: &[u8]) -> Told<()> {
        let topic = self
            .topics
            .get(&channel)
            .ok_or("is spoilt: a message has no channel")?;
        let wrong = |what: &dyn std::fmt::Display| format!("is spoilt: a message of `{topic}`: {what}");
        if topic.ends_with(FIGURES) {
            let figures: Figures = serde_json::from_slice(data).map_err(|error| wrong(&error))?;
            self.figures
                .entry(topic.clone())
                .or_default()
                .insert(time, figures);
        } else if topic.ends_with(VALVE) || topic.ends_with(SUPPORTS) {
            let picture = SceneUpdate::decode(data).map_err(|error| wrong(&error))?;
            self.pictures
                .entry(topic.clone())
                .or_default()
                .insert(time, picture);
        }
        Ok(())
    }

    fn recording(mut self, cut: bool) -> Told<Recording> {
        let cut_short = |what: &str| match cut {
            true => format!("is cut off before its {what}"),
            false => format!("is no recording of coapt: it has no {what}"),
        };
        let facts = self
            .facts
            .remove(FACTS)
            .ok_or_else(|| cut_short("metadata `coapt`"))?;
        match facts.get("schema").map(String::as_str) {
            Some(RECORDING_SCHEMA) => {}
            found => {
                let found = found.unwrap_or("missing");
                return Err(format!("has the layout {found:?}; expected {RECORDING_SCHEMA:?}"));
            }
        }
        let scene = self.json(SCENE_FILE)?.ok_or_else(|| cut_short("scene"))?;
        let repairs_before = self.json(REPAIRS_BEFORE_FILE)?.unwrap_or_default();
        let repairs = self.json(REPAIRS_FILE)?.unwrap_or_default();
        let valves: Vec<String> = self
            .topics
            .values()
            .filter(|topic| topic.ends_with(VALVE))
            .cloned()
            .collect();
        let films = valves
            .into_iter()
            .map(|topic| self.film(topic))
            .collect::<Told<_>>()?;
        Ok(Recording {
            films,
            cut,
            facts,
            scene,
            repairs_before,
            repairs,
        })
    }

    /// What an attachment holds, where there is one.
    fn json<T: serde::de::DeserializeOwned>(&self, name: &str) -> Told<Option<T>> {
        let Some(bytes) = self.attachments.get(name) else {
            return Ok(None);
        };
        let read = serde_json::from_slice(bytes);
        read.map(Some)
            .map_err(|error| format!("is spoilt: its `{name}`: {error}"))
    }

    /// The film of a topic, with the frames of which both parts are there.
    fn film(&mut self, topic: String) -> Told<RecordedFilm> {
        let folder = topic.strip_suffix(VALVE).unwrap_or_default();
        let supports = self
            .pictures
            .remove(&format!("{folder}{SUPPORTS}"))
            .unwrap_or_default();
        let entities = supports.into_values().next().unwrap_or_default().entities;
        let supports = Entities(entities);
        let pictures = self.pictures.remove(&topic).unwrap_or_default();
        let mut figures = self
            .figures
            .remove(&format!("{folder}{FIGURES}"))
            .unwrap_or_default();
        let mut film = RecordedFilm {
            faces: Vec::new(),
            frames: Vec::new(),
            annulus_mm: supports.lines(draw::ANNULUS_CURVE).flat_map(points).collect(),
            tips_mm: supports.spheres(draw::PAPILLARY_TIPS),
            rings_mm: supports.lines(draw::RING_CURVE).map(points).collect(),
            open_gap_mm: self
                .facts
                .get(&format!("{FILM_FACTS}{topic}"))
                .and_then(|facts| facts.get("open_gap_mm")?.parse().ok())
                .filter(|gap_mm: &f64| gap_mm.is_finite()),
            topic,
        };
        film.check_supports()?;
        for (time, picture) in pictures {
            if let Some(figures) = figures.remove(&time) {
                film.add(Entities(picture.entities), figures)?;
            }
        }
        Ok(film)
    }
}

/// Last parts of topics.
const VALVE: &str = "/valve";
const SUPPORTS: &str = "/supports";
const FIGURES: &str = "/figures";

impl RecordedFilm {
    fn check_supports(&self) -> Told<()> {
        let points = [&self.annulus_mm, &self.tips_mm]
            .into_iter()
            .chain(&self.rings_mm);
        match points.flatten().flatten().all(|number| number.is_finite()) {
            true => Ok(()),
            false => Err(format!(
                "is spoilt: the supports of `{}` have coordinates that are not finite",
                self.topic
            )),
        }
    }

    fn add(&mut self, picture: Entities, figures: Figures) -> Told<()> {
        let number = figures.frame;
        let wrong = |what: &str| format!("is spoilt: frame {number} of `{}` {what}", self.topic);
        let leaflets = picture.triangles().ok_or_else(|| wrong("has no leaflets"))?;
        let positions_mm: Vec<[f64; 3]> = leaflets.points.iter().map(|&point| point.into()).collect();
        let (faces, rest) = leaflets.indices.as_chunks::<3>();
        let exists = |&vertex: &u32| (vertex as usize) < positions_mm.len();
        if !rest.is_empty() || !faces.as_flattened().iter().all(exists) {
            return Err(wrong("has triangles of vertices that it does not have"));
        }
        if number != self.frames.len() {
            return Err(wrong(&format!("comes as the {}th", self.frames.len())));
        }
        let is_first = self.frames.is_empty();
        if !is_first && (faces != self.faces || positions_mm.len() != self.frames[0].positions_mm.len()) {
            return Err(wrong("is of another mesh than the first"));
        }
        let ends: Vec<[f64; 3]> = picture.lines(draw::CHORDAE).flat_map(points).collect();
        let chords_mm = ends.as_chunks::<2>().0.to_vec();
        let numbers = positions_mm
            .as_flattened()
            .iter()
            .chain(chords_mm.as_flattened().as_flattened());
        if !numbers.into_iter().all(|number| number.is_finite()) {
            return Err(wrong("has coordinates that are not finite"));
        }
        if is_first {
            self.faces = faces.to_vec();
        }
        self.frames.push(RecordedFrame {
            pressure_mmhg: figures.pressure_mmhg.ok_or_else(|| wrong("has no pressure"))?,
            positions_mm,
            chords_mm,
            status: figures.status,
            certified: figures.certified,
            figures,
        });
        Ok(())
    }
}

/// What a picture is made of.
struct Entities(Vec<SceneEntity>);

impl Entities {
    fn named(&self, id: &str) -> Option<&SceneEntity> {
        self.0.iter().find(|entity| entity.id == id)
    }

    fn triangles(&self) -> Option<&TriangleListPrimitive> {
        self.named(draw::LEAFLETS)?.triangles.first()
    }

    fn lines(&self, id: &str) -> impl Iterator<Item = &LinePrimitive> {
        self.named(id).into_iter().flat_map(|entity| &entity.lines)
    }

    fn spheres(&self, id: &str) -> Vec<[f64; 3]> {
        let spheres = self.named(id).into_iter().flat_map(|entity| &entity.spheres);
        let places = spheres.filter_map(|sphere| sphere.pose?.position);
        places.map(Into::into).collect()
    }
}

fn points(line: &LinePrimitive) -> Vec<[f64; 3]> {
    line.points.iter().map(|&point: &Xyz| point.into()).collect()
}

/// No LZ4 grows to more than so many times its bytes: a byte of a length stands for 255.
const LARGEST_RATIO: u64 = 255;

/// The records of a chunk.
fn uncompressed<'a>(header: &ChunkHeader, data: &'a [u8]) -> Told<Cow<'a, [u8]>> {
    match &*header.compression {
        "" => return Ok(Cow::Borrowed(data)),
        LZ4 => {}
        other => {
            return Err(format!(
                "is compressed by {other:?}; expected {LZ4:?}, as coapt writes it"
            ));
        }
    }
    let size = header.uncompressed_size;
    if size > LARGEST_RATIO * data.len() as u64 {
        return Err(format!(
            "is spoilt: a chunk of {} bytes says that it holds {size}",
            data.len()
        ));
    }
    let mut records = Vec::with_capacity(size as usize);
    let read = FrameDecoder::new(data).take(size + 1).read_to_end(&mut records);
    match read {
        Ok(_) if records.len() as u64 == size => Ok(Cow::Owned(records)),
        Ok(_) => Err("is spoilt: a chunk does not hold as much as it says".to_owned()),
        Err(error) => Err(format!("is spoilt: a chunk cannot be decompressed: {error}")),
    }
}
