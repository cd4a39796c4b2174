//! What readers must know to decode the messages: the schemas that stand in a recording.
//!
//! The description of `foxglove.SceneUpdate` is made here from the published names, numbers and types, so that no generated
//! file has to be kept; all parts are described, also those that coapt never writes, since viewers ask for them.

use prost::Message;
use serde_json::{Value, json};

/// Name of the schema of frames; viewers know it by this name.
pub(super) const SCENE_UPDATE: &str = "foxglove.SceneUpdate";
/// Name of the schema of figures.
pub(super) const FIGURES: &str = "coapt.Figures";

/// Type of a field.
#[derive(Clone, Copy)]
enum Kind {
    Double,
    Int64,
    Int32,
    Bool,
    String,
    Bytes,
    Message(&'static str),
    /// An enumeration of the same message.
    Enum(&'static str),
    /// Any number of messages.
    Messages(&'static str),
    Fixed32s,
}

use Kind::{Bool, Bytes, Double, Enum, Fixed32s, Int32, Int64, Message as Msg, Messages, String as Text};

/// A message: its name and its fields, which are numbered from 1 without gaps.
type MessageRow = (&'static str, &'static [(&'static str, Kind)]);

const TIMESTAMP: &str = ".google.protobuf.Timestamp";
const DURATION: &str = ".google.protobuf.Duration";
const POSE: &str = ".foxglove.Pose";
const COLOR: &str = ".foxglove.Color";
const VECTOR3: &str = ".foxglove.Vector3";
const POINT3: &str = ".foxglove.Point3";

const MESSAGES: &[MessageRow] = &[
    (
        "SceneUpdate",
        &[
            ("deletions", Messages(".foxglove.SceneEntityDeletion")),
            ("entities", Messages(".foxglove.SceneEntity")),
        ],
    ),
    (
        "SceneEntityDeletion",
        &[
            ("timestamp", Msg(TIMESTAMP)),
            ("type", Enum(".foxglove.SceneEntityDeletion.Type")),
            ("id", Text),
        ],
    ),
    (
        "SceneEntity",
        &[
            ("timestamp", Msg(TIMESTAMP)),
            ("frame_id", Text),
            ("id", Text),
            ("lifetime", Msg(DURATION)),
            ("frame_locked", Bool),
            ("metadata", Messages(".foxglove.KeyValuePair")),
            ("arrows", Messages(".foxglove.ArrowPrimitive")),
            ("cubes", Messages(".foxglove.CubePrimitive")),
            ("spheres", Messages(".foxglove.SpherePrimitive")),
            ("cylinders", Messages(".foxglove.CylinderPrimitive")),
            ("lines", Messages(".foxglove.LinePrimitive")),
            ("triangles", Messages(".foxglove.TriangleListPrimitive")),
            ("texts", Messages(".foxglove.TextPrimitive")),
            ("models", Messages(".foxglove.ModelPrimitive")),
        ],
    ),
    ("KeyValuePair", &[("key", Text), ("value", Text)]),
    ("Vector3", &[("x", Double), ("y", Double), ("z", Double)]),
    ("Point3", &[("x", Double), ("y", Double), ("z", Double)]),
    (
        "Quaternion",
        &[("x", Double), ("y", Double), ("z", Double), ("w", Double)],
    ),
    (
        "Pose",
        &[
            ("position", Msg(VECTOR3)),
            ("orientation", Msg(".foxglove.Quaternion")),
        ],
    ),
    (
        "Color",
        &[("r", Double), ("g", Double), ("b", Double), ("a", Double)],
    ),
    (
        "ArrowPrimitive",
        &[
            ("pose", Msg(POSE)),
            ("shaft_length", Double),
            ("shaft_diameter", Double),
            ("head_length", Double),
            ("head_diameter", Double),
            ("color", Msg(COLOR)),
        ],
    ),
    (
        "CubePrimitive",
        &[("pose", Msg(POSE)), ("size", Msg(VECTOR3)), ("color", Msg(COLOR))],
    ),
    (
        "SpherePrimitive",
        &[("pose", Msg(POSE)), ("size", Msg(VECTOR3)), ("color", Msg(COLOR))],
    ),
    (
        "CylinderPrimitive",
        &[
            ("pose", Msg(POSE)),
            ("size", Msg(VECTOR3)),
            ("bottom_scale", Double),
            ("top_scale", Double),
            ("color", Msg(COLOR)),
        ],
    ),
    (
        "LinePrimitive",
        &[
            ("type", Enum(".foxglove.LinePrimitive.Type")),
            ("pose", Msg(POSE)),
            ("thickness", Double),
            ("scale_invariant", Bool),
            ("points", Messages(POINT3)),
            ("color", Msg(COLOR)),
            ("colors", Messages(COLOR)),
            ("indices", Fixed32s),
        ],
    ),
    (
        "TriangleListPrimitive",
        &[
            ("pose", Msg(POSE)),
            ("points", Messages(POINT3)),
            ("color", Msg(COLOR)),
            ("colors", Messages(COLOR)),
            ("indices", Fixed32s),
        ],
    ),
    (
        "TextPrimitive",
        &[
            ("pose", Msg(POSE)),
            ("billboard", Bool),
            ("font_size", Double),
            ("scale_invariant", Bool),
            ("color", Msg(COLOR)),
            ("text", Text),
        ],
    ),
    (
        "ModelPrimitive",
        &[
            ("pose", Msg(POSE)),
            ("scale", Msg(VECTOR3)),
            ("color", Msg(COLOR)),
            ("override_color", Bool),
            ("url", Text),
            ("media_type", Text),
            ("data", Bytes),
        ],
    ),
];

/// Enumerations called `Type`, by their message; values are numbered from 0.
const TYPES: &[(&str, &[&str])] = &[
    ("SceneEntityDeletion", &["MATCHING_ID", "ALL"]),
    ("LinePrimitive", &["LINE_STRIP", "LINE_LOOP", "LINE_LIST"]),
];

/// The description of `foxglove.SceneUpdate`, a `google.protobuf.FileDescriptorSet`.
pub(super) fn scene_update() -> Vec<u8> {
    let time = |name: &'static str, file: &str| FileDescriptor {
        name: file.to_owned(),
        package: "google.protobuf".to_owned(),
        dependency: Vec::new(),
        message_type: vec![described(&(name, &[("seconds", Int64), ("nanos", Int32)]))],
        syntax: "proto3".to_owned(),
    };
    let files = [
        "google/protobuf/timestamp.proto",
        "google/protobuf/duration.proto",
    ];
    let scene = FileDescriptor {
        name: "foxglove/SceneUpdate.proto".to_owned(),
        package: "foxglove".to_owned(),
        dependency: files.map(str::to_owned).to_vec(),
        message_type: MESSAGES.iter().map(described).collect(),
        syntax: "proto3".to_owned(),
    };
    let file = vec![time("Timestamp", files[0]), time("Duration", files[1]), scene];
    FileDescriptorSet { file }.encode_to_vec()
}

fn described((name, fields): &MessageRow) -> Descriptor {
    let types = TYPES.iter().filter(|(message, _)| message == name);
    Descriptor {
        name: (*name).to_owned(),
        field: (1..)
            .zip(*fields)
            .map(|(number, field)| described_field(number, *field))
            .collect(),
        enum_type: types.map(|(_, values)| described_type(values)).collect(),
    }
}

fn described_field(number: i32, (name, kind): (&str, Kind)) -> FieldDescriptor {
    // As `google/protobuf/descriptor.proto` numbers them.
    const ONE: i32 = 1;
    const MANY: i32 = 3;
    let (label, r#type, type_name) = match kind {
        Double => (ONE, 1, ""),
        Int64 => (ONE, 3, ""),
        Int32 => (ONE, 5, ""),
        Fixed32s => (MANY, 7, ""),
        Bool => (ONE, 8, ""),
        Text => (ONE, 9, ""),
        Msg(name) => (ONE, 11, name),
        Messages(name) => (MANY, 11, name),
        Bytes => (ONE, 12, ""),
        Enum(name) => (ONE, 14, name),
    };
    FieldDescriptor {
        name: name.to_owned(),
        number,
        label,
        r#type,
        type_name: (!type_name.is_empty()).then(|| type_name.to_owned()),
    }
}

fn described_type(values: &[&str]) -> EnumDescriptor {
    EnumDescriptor {
        name: "Type".to_owned(),
        value: (0..)
            .zip(values)
            .map(|(number, name)| EnumValueDescriptor {
                name: (*name).to_owned(),
                number: Some(number),
            })
            .collect(),
    }
}

#[derive(Clone, PartialEq, Message)]
struct FileDescriptorSet {
    #[prost(message, repeated, tag = "1")]
    file: Vec<FileDescriptor>,
}

#[derive(Clone, PartialEq, Message)]
struct FileDescriptor {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(string, tag = "2")]
    package: String,
    #[prost(string, repeated, tag = "3")]
    dependency: Vec<String>,
    #[prost(message, repeated, tag = "4")]
    message_type: Vec<Descriptor>,
    #[prost(string, tag = "12")]
    syntax: String,
}

#[derive(Clone, PartialEq, Message)]
struct Descriptor {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, repeated, tag = "2")]
    field: Vec<FieldDescriptor>,
    #[prost(message, repeated, tag = "4")]
    enum_type: Vec<EnumDescriptor>,
}

#[derive(Clone, PartialEq, Message)]
struct FieldDescriptor {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(int32, tag = "3")]
    number: i32,
    #[prost(int32, tag = "4")]
    label: i32,
    #[prost(int32, tag = "5")]
    r#type: i32,
    #[prost(string, optional, tag = "6")]
    type_name: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
struct EnumDescriptor {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, repeated, tag = "2")]
    value: Vec<EnumValueDescriptor>,
}

#[derive(Clone, PartialEq, Message)]
struct EnumValueDescriptor {
    #[prost(string, tag = "1")]
    name: String,
    // Written even where it is 0: readers of proto2, which describes itself, ask for it.
    #[prost(int32, optional, tag = "2")]
    number: Option<i32>,
}

/// The JSON Schema of [`super::figures::Figures`].
pub(super) fn figures() -> Value {
    let number = |meaning: &str| json!({ "type": ["number", "null"], "description": meaning });
    json!({
        "title": FIGURES,
        "type": "object",
        "properties": {
            "frame": { "type": "integer", "description": "number of the frame, from 0" },
            "certified": { "type": "boolean", "description": "whether the frame is a balance: converged, stable, nothing crosses" },
            "status": { "type": "string", "description": "why the solver stopped" },
            "pressure_mmhg": number("transvalvular pressure [mmHg]"),
            "residual": number(
                "largest force on a free vertex over the mean nodal pressure force or, where that is more, the pull of a strain of \
                 1e-3 [1]",
            ),
            "elastic_energy_mj": number("energy that leaflets and chordae store [mJ]"),
            "coaptation_area_mm2": number("contact area of the leaflets [mm²]"),
            "orifice_area_mm2": number("anatomic orifice, open in systole [mm²]"),
            "max_penetration_mm": number("how far mid-surfaces in contact are nearer than the contact distance, at most [mm]"),
        },
    })
}
