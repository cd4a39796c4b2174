//! The messages that draw a frame, as viewers know them: `foxglove.SceneUpdate` in Protocol Buffers.
//!
//! Names and numbers are those published at <https://docs.foxglove.dev/docs/sdk/schemas/scene-update>; parts that are never
//! written are left out here, and stand in [`super::schema`] alone, which viewers read.

use prost::Message;

/// Changes to what is drawn; an entity takes the place of an earlier one of its name.
#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneUpdate {
    #[prost(message, repeated, tag = "2")]
    pub(super) entities: Vec<SceneEntity>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneEntity {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(super) frame_id: String,
    #[prost(string, tag = "3")]
    pub(super) id: String,
    #[prost(message, repeated, tag = "6")]
    pub(super) metadata: Vec<KeyValuePair>,
    #[prost(message, repeated, tag = "9")]
    pub(super) spheres: Vec<SpherePrimitive>,
    #[prost(message, repeated, tag = "11")]
    pub(super) lines: Vec<LinePrimitive>,
    #[prost(message, repeated, tag = "12")]
    pub(super) triangles: Vec<TriangleListPrimitive>,
    #[prost(message, repeated, tag = "13")]
    pub(super) texts: Vec<TextPrimitive>,
}

/// Time since the beginning of the film.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Timestamp {
    #[prost(int64, tag = "1")]
    pub(super) seconds: i64,
    #[prost(int32, tag = "2")]
    pub(super) nanos: i32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct KeyValuePair {
    #[prost(string, tag = "1")]
    pub(super) key: String,
    #[prost(string, tag = "2")]
    pub(super) value: String,
}

/// A point, or a size along the axes. All three are always written: left out because they are zero, -0 would come back as 0.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Xyz {
    #[prost(double, optional, tag = "1")]
    pub(super) x: Option<f64>,
    #[prost(double, optional, tag = "2")]
    pub(super) y: Option<f64>,
    #[prost(double, optional, tag = "3")]
    pub(super) z: Option<f64>,
}

impl From<[f64; 3]> for Xyz {
    fn from([x, y, z]: [f64; 3]) -> Self {
        let [x, y, z] = [x, y, z].map(Some);
        Self { x, y, z }
    }
}

impl From<Xyz> for [f64; 3] {
    fn from(Xyz { x, y, z }: Xyz) -> Self {
        [x, y, z].map(Option::unwrap_or_default)
    }
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Quaternion {
    #[prost(double, tag = "4")]
    pub(super) w: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Pose {
    #[prost(message, optional, tag = "1")]
    pub(super) position: Option<Xyz>,
    #[prost(message, optional, tag = "2")]
    pub(super) orientation: Option<Quaternion>,
}

/// Parts from 0 to 1.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Color {
    #[prost(double, tag = "1")]
    pub(super) r: f64,
    #[prost(double, tag = "2")]
    pub(super) g: f64,
    #[prost(double, tag = "3")]
    pub(super) b: f64,
    #[prost(double, tag = "4")]
    pub(super) a: f64,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SpherePrimitive {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<Pose>,
    #[prost(message, optional, tag = "2")]
    pub(super) size: Option<Xyz>,
    #[prost(message, optional, tag = "3")]
    pub(super) color: Option<Color>,
}

/// How points are joined by lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, prost::Enumeration)]
#[repr(i32)]
pub(super) enum LineType {
    /// Each to the next.
    Strip = 0,
    /// The same, and the last to the first.
    Loop = 1,
    /// In pairs.
    List = 2,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct LinePrimitive {
    #[prost(enumeration = "LineType", tag = "1")]
    pub(super) r#type: i32,
    #[prost(message, optional, tag = "2")]
    pub(super) pose: Option<Pose>,
    #[prost(double, tag = "3")]
    pub(super) thickness: f64,
    #[prost(message, repeated, tag = "5")]
    pub(super) points: Vec<Xyz>,
    #[prost(message, optional, tag = "6")]
    pub(super) color: Option<Color>,
    #[prost(message, repeated, tag = "7")]
    pub(super) colors: Vec<Color>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct TriangleListPrimitive {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<Pose>,
    #[prost(message, repeated, tag = "2")]
    pub(super) points: Vec<Xyz>,
    #[prost(message, optional, tag = "3")]
    pub(super) color: Option<Color>,
    #[prost(message, repeated, tag = "4")]
    pub(super) colors: Vec<Color>,
    #[prost(fixed32, repeated, tag = "5")]
    pub(super) indices: Vec<u32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct TextPrimitive {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<Pose>,
    #[prost(bool, tag = "2")]
    pub(super) billboard: bool,
    #[prost(double, tag = "3")]
    pub(super) font_size: f64,
    #[prost(bool, tag = "4")]
    pub(super) scale_invariant: bool,
    #[prost(message, optional, tag = "5")]
    pub(super) color: Option<Color>,
    #[prost(string, tag = "6")]
    pub(super) text: String,
}

/// What reading needs of the messages above, by their names; all else is skipped. LZ4 makes 127 empty messages of one byte: each
/// must not take the room of what a viewer is told.
pub(super) mod read {
    use prost::Message;

    use super::Xyz;

    #[derive(Clone, PartialEq, Message)]
    pub(in super::super) struct SceneUpdate {
        #[prost(message, repeated, tag = "2")]
        pub(in super::super) entities: Vec<SceneEntity>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub(in super::super) struct SceneEntity {
        #[prost(string, tag = "3")]
        pub(in super::super) id: String,
        #[prost(message, repeated, tag = "9")]
        pub(in super::super) spheres: Vec<SpherePrimitive>,
        #[prost(message, repeated, tag = "11")]
        pub(in super::super) lines: Vec<LinePrimitive>,
        #[prost(message, repeated, tag = "12")]
        pub(in super::super) triangles: Vec<TriangleListPrimitive>,
    }

    #[derive(Clone, Copy, PartialEq, Message)]
    pub(in super::super) struct SpherePrimitive {
        #[prost(message, optional, tag = "1")]
        pub(in super::super) pose: Option<Pose>,
    }

    #[derive(Clone, Copy, PartialEq, Message)]
    pub(in super::super) struct Pose {
        #[prost(message, optional, tag = "1")]
        pub(in super::super) position: Option<Xyz>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub(in super::super) struct LinePrimitive {
        #[prost(message, repeated, tag = "5")]
        pub(in super::super) points: Vec<Xyz>,
    }

    #[derive(Clone, PartialEq, Message)]
    pub(in super::super) struct TriangleListPrimitive {
        #[prost(message, repeated, tag = "2")]
        pub(in super::super) points: Vec<Xyz>,
        #[prost(fixed32, repeated, tag = "5")]
        pub(in super::super) indices: Vec<u32>,
    }
}
