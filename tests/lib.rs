//! The coapt tests.
