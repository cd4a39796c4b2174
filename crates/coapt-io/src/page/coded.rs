//! Numbers as the page's script reads them: little-endian, in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};

/// Numbers in a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coded<T>(pub Vec<T>);

/// A number of a few bytes.
pub trait Number {
    /// Adds its bytes, the least first.
    fn add_to(&self, bytes: &mut Vec<u8>);
}

macro_rules! number {
    ($($kind:ty),*) => {$(
        impl Number for $kind {
            fn add_to(&self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        }
    )*};
}

number!(u8, u16, u32, f32);

impl<T: Number> Serialize for Coded<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut bytes = Vec::with_capacity(self.0.len() * size_of::<T>());
        self.0.iter().for_each(|number| number.add_to(&mut bytes));
        serializer.serialize_str(&STANDARD.encode(bytes))
    }
}
