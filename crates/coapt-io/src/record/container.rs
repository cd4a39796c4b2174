//! A recording as bytes: MCAP, <https://mcap.dev/spec>.
//!
//! Records are those of the `mcap` crate, which also splits files into them; [`super::fields`] reads what they hold. Laying them
//! out is our own: the crate's writer compresses by C libraries only (a clean build spent 117 s on zstd and 29 s on lz4, on two
//! cores that had other work, and needs a C compiler), `lz4_flex` took 2.6 s; without compression a recording is three times as
//! large. LZ4 frames are one of the two compressions that every reader knows.
//!
//! Attachments, metadata, schemas and channels come before the frames, so that a recording that was cut off still tells what it
//! is of. No clock is read: equal contents give equal bytes.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use binrw::{BinWrite, BinWriterExt};
use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};
use mcap::MAGIC;
use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, DataEnd, Header, MessageHeader,
    MessageIndex, MessageIndexEntry, Metadata, MetadataIndex, SchemaHeader, Statistics, op,
};

/// Name of the compression in MCAP.
pub(super) const LZ4: &str = "lz4";

/// Bytes of messages after which a chunk ends [1]. Our choice, some ten frames of 650 triangles: a recording that is cut off loses
/// one chunk, and a viewer reads one to show a frame; half as much made files 2 % larger.
const CHUNK_BYTES: usize = 512 << 10;

/// What cannot be written: none of it is in our hands.
pub(super) type Result<T> = std::result::Result<T, binrw::Error>;

/// A recording as far as it is written.
pub(super) struct Container {
    bytes: Vec<u8>,
    chunk: Vec<u8>,
    /// Messages of the chunk: when, and where in it, by channel.
    chunk_index: BTreeMap<u16, Vec<MessageIndexEntry>>,
    /// Schemas and channels, which stand in the summary again.
    repeated: Vec<u8>,
    statistics: Statistics,
    chunk_indexes: Vec<ChunkIndex>,
    attachment_indexes: Vec<AttachmentIndex>,
    metadata_indexes: Vec<MetadataIndex>,
}

impl Container {
    pub(super) fn new() -> Result<Self> {
        let mut bytes = MAGIC.to_vec();
        let header = Header {
            profile: String::new(),
            library: concat!("coapt ", env!("CARGO_PKG_VERSION")).to_owned(),
        };
        add(&mut bytes, op::HEADER, &[&body(&header)?]);
        Ok(Self {
            bytes,
            chunk: Vec::new(),
            chunk_index: BTreeMap::new(),
            repeated: Vec::new(),
            statistics: Statistics::default(),
            chunk_indexes: Vec::new(),
            attachment_indexes: Vec::new(),
            metadata_indexes: Vec::new(),
        })
    }

    /// Adds a file; before any message.
    pub(super) fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> Result<()> {
        let header = AttachmentHeader {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
        };
        let mut content = body(&header)?;
        content.extend((data.len() as u64).to_le_bytes());
        content.extend(data);
        let checksum = crc32fast::hash(&content).to_le_bytes();
        let offset = self.bytes.len() as u64;
        add(&mut self.bytes, op::ATTACHMENT, &[&content, &checksum]);
        self.statistics.attachment_count += 1;
        self.attachment_indexes.push(AttachmentIndex {
            offset,
            length: self.bytes.len() as u64 - offset,
            log_time: 0,
            create_time: 0,
            data_size: data.len() as u64,
            name: header.name,
            media_type: header.media_type,
        });
        Ok(())
    }

    /// Adds named words; before any message.
    pub(super) fn tell(&mut self, name: &str, metadata: BTreeMap<String, String>) -> Result<()> {
        let record = Metadata {
            name: name.to_owned(),
            metadata,
        };
        let offset = self.bytes.len() as u64;
        add(&mut self.bytes, op::METADATA, &[&body(&record)?]);
        self.statistics.metadata_count += 1;
        self.metadata_indexes.push(MetadataIndex {
            offset,
            length: self.bytes.len() as u64 - offset,
            name: record.name,
        });
        Ok(())
    }

    /// Adds a schema; its number. Before any message.
    pub(super) fn schema(&mut self, name: &str, encoding: &str, data: &[u8]) -> Result<u16> {
        self.statistics.schema_count += 1;
        let id = self.statistics.schema_count;
        let header = SchemaHeader {
            id,
            name: name.to_owned(),
            encoding: encoding.to_owned(),
        };
        let length = (data.len() as u32).to_le_bytes();
        let parts: [&[u8]; 3] = [&body(&header)?, &length, data];
        add(&mut self.bytes, op::SCHEMA, &parts);
        add(&mut self.repeated, op::SCHEMA, &parts);
        Ok(id)
    }

    /// Adds a channel; its number. Before any message.
    pub(super) fn channel(&mut self, schema_id: u16, topic: &str, encoding: &str) -> Result<u16> {
        self.statistics.channel_count += 1;
        let record = Channel {
            id: self.statistics.channel_count as u16,
            schema_id,
            topic: topic.to_owned(),
            message_encoding: encoding.to_owned(),
            metadata: BTreeMap::new(),
        };
        let content = body(&record)?;
        add(&mut self.bytes, op::CHANNEL, &[&content]);
        add(&mut self.repeated, op::CHANNEL, &[&content]);
        Ok(record.id)
    }

    /// Adds a message; times do not fall.
    pub(super) fn message(&mut self, channel_id: u16, log_time: u64, data: &[u8]) -> Result<()> {
        let statistics = &mut self.statistics;
        let count = statistics.channel_message_counts.entry(channel_id).or_default();
        let header = MessageHeader {
            channel_id,
            sequence: *count as u32,
            log_time,
            publish_time: log_time,
        };
        *count += 1;
        if statistics.message_count == 0 {
            statistics.message_start_time = log_time;
        }
        statistics.message_count += 1;
        statistics.message_end_time = log_time;
        let offset = self.chunk.len() as u64;
        let entries = self.chunk_index.entry(channel_id).or_default();
        entries.push(MessageIndexEntry { log_time, offset });
        add(&mut self.chunk, op::MESSAGE, &[&body(&header)?, data]);
        Ok(())
    }

    /// Tells that a frame is whole: a chunk may end here.
    pub(super) fn end_frame(&mut self) -> Result<()> {
        match self.chunk.len() >= CHUNK_BYTES {
            true => self.end_chunk(),
            false => Ok(()),
        }
    }

    fn end_chunk(&mut self) -> Result<()> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        let chunk = std::mem::take(&mut self.chunk);
        let index = std::mem::take(&mut self.chunk_index);
        let compressed = compressed(&chunk)?;
        let times = index.values().flatten().map(|entry| entry.log_time);
        let header = ChunkHeader {
            message_start_time: times.clone().min().unwrap_or_default(),
            message_end_time: times.max().unwrap_or_default(),
            uncompressed_size: chunk.len() as u64,
            uncompressed_crc: crc32fast::hash(&chunk),
            compression: LZ4.to_owned(),
            compressed_size: compressed.len() as u64,
        };
        let chunk_start_offset = self.bytes.len() as u64;
        add(&mut self.bytes, op::CHUNK, &[&body(&header)?, &compressed]);
        let end = self.bytes.len() as u64;
        let mut message_index_offsets = BTreeMap::new();
        for (channel_id, records) in index {
            message_index_offsets.insert(channel_id, self.bytes.len() as u64);
            let index = MessageIndex { channel_id, records };
            add(&mut self.bytes, op::MESSAGE_INDEX, &[&body(&index)?]);
        }
        self.statistics.chunk_count += 1;
        self.chunk_indexes.push(ChunkIndex {
            message_start_time: header.message_start_time,
            message_end_time: header.message_end_time,
            chunk_start_offset,
            chunk_length: end - chunk_start_offset,
            message_index_offsets,
            message_index_length: self.bytes.len() as u64 - end,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        });
        Ok(())
    }

    /// The whole recording, with its summary.
    pub(super) fn finish(mut self) -> Result<Vec<u8>> {
        self.end_chunk()?;
        let bytes = &mut self.bytes;
        let end = DataEnd {
            data_section_crc: crc32fast::hash(bytes),
        };
        add(bytes, op::DATA_END, &[&body(&end)?]);
        let summary_start = bytes.len();
        bytes.extend(&self.repeated);
        add(bytes, op::STATISTICS, &[&body(&self.statistics)?]);
        for index in &self.chunk_indexes {
            add(bytes, op::CHUNK_INDEX, &[&body(index)?]);
        }
        for index in &self.attachment_indexes {
            add(bytes, op::ATTACHMENT_INDEX, &[&body(index)?]);
        }
        for index in &self.metadata_indexes {
            add(bytes, op::METADATA_INDEX, &[&body(index)?]);
        }
        // The footer ends in a checksum of the summary and of its own beginning. Where groups of the summary begin is not told.
        bytes.push(op::FOOTER);
        bytes.extend(20_u64.to_le_bytes());
        bytes.extend((summary_start as u64).to_le_bytes());
        bytes.extend(0_u64.to_le_bytes());
        let checksum = crc32fast::hash(&bytes[summary_start..]);
        bytes.extend(checksum.to_le_bytes());
        bytes.extend(MAGIC);
        Ok(self.bytes)
    }
}

/// Adds a record of some parts.
fn add(bytes: &mut Vec<u8>, opcode: u8, parts: &[&[u8]]) {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    bytes.push(opcode);
    bytes.extend((length as u64).to_le_bytes());
    parts.iter().for_each(|part| bytes.extend(*part));
}

/// What a record holds.
fn body(record: &impl for<'a> BinWrite<Args<'a> = ()>) -> Result<Vec<u8>> {
    let mut cursor = Cursor::new(Vec::new());
    cursor.write_le(record)?;
    Ok(cursor.into_inner())
}

/// As one LZ4 frame.
fn compressed(bytes: &[u8]) -> Result<Vec<u8>> {
    let info = FrameInfo::new()
        .block_mode(BlockMode::Linked)
        .block_size(BlockSize::Max1MB);
    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
    encoder.write_all(bytes)?;
    encoder
        .finish()
        .map_err(|error| std::io::Error::from(error).into())
}
