//! How viewers show a recording: a layout for Foxglove and Lichtblick, to be imported there.

use coapt::Vec3;
use coapt::model::Model;
use serde_json::{Map, Value, json};

/// Distance of the camera in radii of the valve [1], our choice: all of it in view, with some room.
const DISTANCE_RADII: f64 = 4.0;

/// The layout: the valve in space, twice where there are two films, and its figures as curves.
pub fn layout(model: &Model, with_after: bool) -> String {
    let camera = camera(model);
    let folders: &[&str] = if with_after { &["/before", "/after"] } else { &[""] };
    let mut panels = Map::new();
    let mut views = Vec::new();
    for (number, folder) in folders.iter().enumerate() {
        let name = format!("3D!coapt{number}");
        panels.insert(name.clone(), view(&camera, folder, folders));
        views.push(Value::from(name));
    }
    let curves = [
        ("Plot!coaptation", "coaptation_area_mm2"),
        ("Plot!orifice", "orifice_area_mm2"),
        ("Plot!pressure", "pressure_mmhg"),
    ];
    for (name, figure) in curves {
        panels.insert(name.to_owned(), plot(folders, figure));
    }
    let plots = curves.map(|(name, _)| Value::from(name)).to_vec();
    let layout = json!({
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": { "speed": 1 },
        "layout": { "direction": "column", "splitPercentage": 70, "first": side_by_side(&views), "second": side_by_side(&plots) },
    });
    format!("{layout:#}\n")
}

/// Looks at the middle of the open valve from the front, above the annulus, as a surgeon does: +z is superior, -y anterior.
fn camera(model: &Model) -> Value {
    let middle = model.rest_mm.iter().sum::<Vec3>() / model.rest_mm.len().max(1) as f64;
    let reach = |place: &Vec3| (place - middle).norm();
    let radius_mm = model.rest_mm.iter().map(reach).fold(0.0, f64::max);
    json!({
        "distance": (DISTANCE_RADII * radius_mm).round(),
        "perspective": true,
        "phi": 50,
        "thetaOffset": 180,
        "target": [0, 0, 0],
        "targetOffset": [middle.x.round(), middle.y.round(), middle.z.round()],
        "targetOrientation": [0, 0, 0, 1],
        "fovy": 45,
        "near": 0.5,
        "far": 5000,
    })
}

fn view(camera: &Value, folder: &str, folders: &[&str]) -> Value {
    let topics = folders.iter().flat_map(|other| {
        let visible = other == &folder;
        ["valve", "supports"].map(|name| (format!("{other}/{name}"), json!({ "visible": visible })))
    });
    let title = folder.trim_start_matches('/');
    json!({
        "foxglovePanelTitle": if title.is_empty() { "valve" } else { title },
        "cameraState": camera,
        "followMode": "follow-none",
        "followTf": super::FRAME_ID,
        "scene": { "backgroundColor": "#ffffff" },
        "topics": topics.collect::<Map<String, Value>>(),
        "layers": {},
    })
}

fn plot(folders: &[&str], figure: &str) -> Value {
    let paths = folders.iter().map(|folder| {
        json!({
            "value": format!("{folder}/figures.{figure}"),
            "label": folder.trim_start_matches('/'),
            "enabled": true,
            "timestampMethod": "receiveTime",
        })
    });
    json!({
        "foxglovePanelTitle": figure,
        "paths": paths.collect::<Vec<_>>(),
        "xAxisVal": "timestamp",
        "showLegend": true,
        "isSynced": true,
    })
}

/// One panel, or a row of them of equal width.
fn side_by_side(panels: &[Value]) -> Value {
    match panels {
        [] => Value::Null,
        [only] => only.clone(),
        [first, rest @ ..] => json!({
            "direction": "row",
            "splitPercentage": 100.0 / panels.len() as f64,
            "first": first,
            "second": side_by_side(rest),
        }),
    }
}
