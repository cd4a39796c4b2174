//! What a generated valve must be.
use super::*;

#[test]
fn dump() {
    let Ok(dir) = std::env::var("VALVE_DUMP") else {
        return;
    };
    for preset in Preset::ALL {
        for faces in [200, 650, 2600, 10_000, 100_000] {
            if let Ok(only) = std::env::var("ONLY") {
                if !only.contains(&format!("{}_{faces};", preset.name())) {
                    continue;
                }
            }
            let ev = |k: &str, d: f64| std::env::var(k).map_or(d, |v| v.parse().unwrap());
            let start = std::time::Instant::now();
            let p = ValveParameters {
                face_count_target: faces,
                ..ValveParameters::preset(preset)
            };
            let mut p = p;
            p.chordae.ruptured_posterior_fraction = ev("RUPT", p.chordae.ruptured_posterior_fraction);
            p.leaflets.height_scale *= ev("HS", 1.0);
            p.closed_shape.tenting_height_mm = ev("TENT", p.closed_shape.tenting_height_mm);
            p.closed_shape.coaptation_length_mm = ev("COAPT", p.closed_shape.coaptation_length_mm);
            p.closed_shape.closure_line_fraction = ev("CLF", p.closed_shape.closure_line_fraction);
            p.leaflets.opening_angle_deg = ev("OPEN", p.leaflets.opening_angle_deg);
            let s = match generate(&p) {
                Ok(s) => s,
                Err(f) => {
                    println!("{preset:?} {faces} {f:?}");
                    continue;
                }
            };
            println!("{preset:?} {faces} {:?}", start.elapsed());
            let surface = Surface::new(&p);
            let c = closed_shape::ClosedShape::new(&p, &p.annulus, &surface);
            let mut text = format!("closed = {{'A': [], 'P': []}}\n");
            for (n, side) in [("A", Side::Anterior), ("P", Side::Posterior)] {
                for i in 0..=20 {
                    let u = i as f64 / 20.0;
                    let col: Vec<[f64; 3]> =
                        (0..=20).map(|k| c.at(side, u, k as f64 / 20.0).into()).collect();
                    text += &format!("closed['{n}'].append({col:?})\n");
                }
                println!(
                    "  {n} stretch {:?}",
                    [0.0, 0.1, 0.25, 0.5, 0.75]
                        .map(|u| c.column_length_mm(side, u)
                            / surface.height_mm(surface.annulus.arc_of(side, u)))
                );
            }
            for l in &s.leaflets {
                let m = l.mesh.as_ref().unwrap();
                text += &format!(
                    "{} = dict(p={:?}, f={:?}, a={:?})\n",
                    l.name,
                    m.points_mm,
                    m.faces,
                    m.annulus_points.as_ref().unwrap()
                );
            }
            text += &format!(
                "tips = {:?}\nchords = {{}}\n",
                s.papillary.iter().map(|p| p.tips_mm.clone()).collect::<Vec<_>>()
            );
            for g in &s.chordae {
                let m = g.mesh.as_ref().unwrap();
                text += &format!(
                    "chords['{}'] = dict(p={:?}, s={:?}, l={:?}, k={}, d={}, e={})\n",
                    g.name,
                    m.points_mm,
                    m.segments,
                    m.rest_length_mm.as_ref().unwrap(),
                    g.rest_length_scale,
                    g.diameter_mm,
                    g.modulus_mpa
                );
            }
            std::fs::write(format!("{dir}/{}_{faces}.py", preset.name()), text).unwrap();
        }
    }
}
