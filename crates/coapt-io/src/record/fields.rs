//! The fields of a record of MCAP, in the order in which they come.

use std::collections::BTreeMap;

use mcap::records::ChunkHeader;

/// Why nothing can be made of a file.
pub(super) type Told<T> = Result<T, String>;

/// What is left of a record. The crate's own readers of records ask the memory for as much as a text says that it is long, up to
/// 4 GB, before they see that it is not there, and count on the checksum of an attachment to be there.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    pub(super) fn take(&mut self, length: u64) -> Told<&'a [u8]> {
        let length = usize::try_from(length).ok();
        let (taken, rest) = length
            .and_then(|length| self.0.split_at_checked(length))
            .ok_or("is spoilt: a record ends within what it says that it holds")?;
        self.0 = rest;
        Ok(taken)
    }

    pub(super) fn u16(&mut self) -> Told<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Told<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Told<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn text(&mut self) -> Told<String> {
        let length = self.u32()?;
        let text = std::str::from_utf8(self.take(length.into())?);
        text.map(str::to_owned)
            .map_err(|_| "is spoilt: a text of it is not UTF-8".to_owned())
    }

    pub(super) fn words(&mut self) -> Told<BTreeMap<String, String>> {
        let length = self.u32()?;
        let mut entries = Self(self.take(length.into())?);
        let mut words = BTreeMap::new();
        while !entries.0.is_empty() {
            let (key, word) = (entries.text()?, entries.text()?);
            if words.insert(key, word).is_some() {
                return Err("is spoilt: its metadata tell one thing twice".to_owned());
            }
        }
        Ok(words)
    }

    pub(super) fn chunk_header(&mut self) -> Told<ChunkHeader> {
        Ok(ChunkHeader {
            message_start_time: self.u64()?,
            message_end_time: self.u64()?,
            uncompressed_size: self.u64()?,
            uncompressed_crc: self.u32()?,
            compression: self.text()?,
            compressed_size: self.u64()?,
        })
    }

    fn array<const N: usize>(&mut self) -> Told<[u8; N]> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N as u64)?);
        Ok(bytes)
    }
}
