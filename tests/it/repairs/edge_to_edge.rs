//! Clips and stitches.

use coapt::mesh::parametric::Preset;
use coapt::scene::{Alfieri, Clip, ClipModel, ClipSize, Repair, Site};

use super::{assert_told, closed, preset, refused, repaired};

fn clip_at(site: Site) -> Clip {
    Clip {
        site: Some(site),
        ..Clip::default()
    }
}

#[test]
fn explore() {
    for which in [
        Preset::Flail,
        Preset::Dilated,
        Preset::Healthy,
        Preset::Barlow,
        Preset::Restricted,
    ] {
        let model = preset(which);
        let name = which.name();
        closed(name, &model);
        for site in [Site::A1P1, Site::A2P2, Site::A3P3] {
            for m in [ClipModel::Springs, ClipModel::Rigid] {
                let clip = Clip {
                    model: m,
                    size: ClipSize::Short,
                    ..clip_at(site)
                };
                match coapt::repair::apply(&model, &Repair::Clip(clip)) {
                    Ok(done) => {
                        let r = std::panic::catch_unwind(|| {
                            closed(&format!("{name} {site:?} {m:?}"), &done.model);
                        });
                        if r.is_err() {
                            println!("FAILED");
                        }
                    }
                    Err(faults) => println!("{name} {site:?} {m:?}: {faults:?}"),
                }
            }
        }
        let a = Alfieri {
            site: Some(Site::A2P2),
            ..Alfieri::default()
        };
        let done = repaired(&model, &[Repair::Alfieri(a)]);
        let _ = std::panic::catch_unwind(|| {
            closed(&format!("{name} alfieri"), &done);
        });
    }
}
