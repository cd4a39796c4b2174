use coapt::contact::{crossing::crossings, surface::Surface};
use coapt::mesh::parametric::*;
use coapt::model::*;
use coapt::relax::*;
use coapt::state::State;
fn main() {
    for preset in Preset::ALL {
        for k in [0.9, 1.0, 1.05, 1.1, 1.2, 1.3, 1.5, 2.0, 3.0] {
            let p = ValveParameters::preset(preset);
            let mut scene = generate(&p).unwrap();
            let low = scene
                .leaflets
                .iter()
                .flat_map(|l| &l.mesh.as_ref().unwrap().points_mm)
                .map(|p| p[2])
                .fold(0.0, f64::min);
            for l in &mut scene.leaflets {
                let m = l.mesh.as_mut().unwrap();
                for p in &mut m.points_mm {
                    let d = (p[2] / low).clamp(0.0, 1.0);
                    p[1] *= 1.0 - k * d;
                }
            }
            let mut off = scene.clone();
            off.contact.stiffness_mpa = 0.0;
            let m0 = match Model::build(&off) {
                Ok(b) => b.model,
                Err(e) => {
                    println!("{} {k} {:?}", preset.name(), e[0]);
                    continue;
                }
            };
            let n = crossings(&Surface::new(&m0.faces, &m0.rest_mm), &m0.rest_mm).len();
            let t = std::time::Instant::now();
            match Model::build(&scene) {
                Err(e) => println!("{} {k}: {n} crossings; REFUSED {}", preset.name(), e[0].message),
                Ok(b) => {
                    let tb = t.elapsed().as_secs_f64();
                    let w: Vec<_> = b
                        .warnings
                        .iter()
                        .filter(|w| w.message.contains("drawn apart"))
                        .map(|w| w.message.clone())
                        .collect();
                    let e = relax(&b.model, &State::open(&b.model));
                    println!(
                        "{} {k}: {n} crossings, build {tb:.3}; {} {:?} cert {} its {} res {:.1e} {:.2}s",
                        preset.name(),
                        w.first().map_or("", |w| &w[w.len().saturating_sub(60)..]),
                        e.status,
                        e.certificate.is_certified(e.status),
                        e.history.len(),
                        e.certificate.residual,
                        t.elapsed().as_secs_f64()
                    );
                }
            }
        }
    }
}
