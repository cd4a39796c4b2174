//! The coapt benches.
