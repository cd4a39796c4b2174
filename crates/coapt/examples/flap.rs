use coapt::Vec3;
use coapt::mesh::parametric::*;
use coapt::model::*;
use coapt::relax::*;
use coapt::state::State;
use std::collections::BTreeMap;
struct Random(u64);
impl Random {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let preset = Preset::from_name(&a[1]).unwrap();
    let row = &a[2];
    let seed: u64 = a[3].parse().unwrap();
    let mut p = ValveParameters::preset(preset);
    p.face_count_target = 650;
    let mut scene = generate(&p).unwrap();
    match row.as_str() {
        "marginal" => scene.chordae.retain(|g| g.name != "marginal"),
        "long" => scene.chordae.iter_mut().for_each(|g| g.rest_length_scale = 3.0),
        _ => {}
    }
    let mut r = Random(seed);
    let mut m: BTreeMap<[u64; 3], Vec3> = BTreeMap::new();
    let sc = if seed == 0 { 0.0 } else { 1e-3 * 2.2 };
    for q in scene
        .leaflets
        .iter_mut()
        .filter_map(|l| l.mesh.as_mut())
        .flat_map(|m| &mut m.points_mm)
    {
        let k = q.map(f64::to_bits);
        *q = (*m.entry(k).or_insert_with(|| {
            let v = Vec3::new(r.signed(), r.signed(), r.signed());
            Vec3::from(*q) + v * sc
        }))
        .into();
    }
    let mut model = Model::build(&scene).unwrap().model;
    if let Some(n) = a.get(4) {
        model.settings.iteration_limit = n.parse().unwrap();
    }
    let t = std::time::Instant::now();
    let e = relax(&model, &State::open(&model));
    let every = a.get(5).map_or(50, |n| n.parse().unwrap());
    for (i, h) in e.history.iter().enumerate() {
        if i % every < 2 {
            println!(
                "{i} f{} res {:.2e} step {:.3} frac {:.3} damp {:.1e} {}",
                h.faces,
                h.residual,
                h.step_mm,
                h.fraction,
                h.damping,
                if h.exact { "E" } else { "P" }
            );
        }
    }
    println!(
        "{:?} {} its {:.1}s stable {}",
        e.status,
        e.history.len(),
        t.elapsed().as_secs_f64(),
        e.certificate.stable
    );
}
