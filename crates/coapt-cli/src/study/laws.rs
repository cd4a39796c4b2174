//! `coapt study --laws`: closes one valve under every tissue law, so that a user can choose one.

use coapt::model::Model;
use coapt::scene::{Fault, Scene};
use coapt_io::study::{FACES_OF_LAWS, LawStudy, Laws, MeshOfLaws, carry_out_laws, text_of_laws, write_laws};

use super::{Arguments, cases, prepare, timed};
use crate::case::{self, Case};
use crate::closure::on_threads;
use crate::output::{Failure, Verdict, print, say};

/// Runs the verb.
pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (cases, finest) = cases(arguments, &FACES_OF_LAWS)?;
    // Before minutes of work, not after.
    prepare(&arguments.out)?;
    let laws = Laws::new()?;
    let study = on_threads(arguments.threads, || {
        Ok(study(&cases, finest.as_ref(), &laws, arguments.repeats)?)
    })?;
    write_laws(&arguments.out, &study).map_err(Failure::Outside)?;
    print(&text_of_laws(&study))?;
    say(&format!("results are in {}", arguments.out.display()));
    Ok(match study.rows.iter().any(|row| row.certified) {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

fn study(cases: &[Case], finest: Option<&Case>, laws: &Laws, repeats: u16) -> Result<LawStudy, Vec<Fault>> {
    let builds: Vec<_> = cases.iter().map(build).collect();
    let meshes: Vec<MeshOfLaws> = cases
        .iter()
        .zip(&builds)
        .map(|(case, build)| MeshOfLaws {
            scene: &case.scene,
            build,
        })
        .collect();
    let build_finest = finest.map(build);
    let finest = finest.zip(build_finest.as_ref()).map(|(case, build)| MeshOfLaws {
        scene: &case.scene,
        build,
    });
    carry_out_laws(&meshes, finest.as_ref(), laws, repeats, &timed, &say)
}

/// Makes the valve of a case under another tissue; faults are told with the lines of the case.
fn build(case: &Case) -> impl Fn(Scene) -> Result<Model, Vec<Fault>> {
    move |scene| {
        let case = Case {
            scene,
            source: case.source.clone(),
            warnings: case.warnings.clone(),
        };
        Ok(case::build(&case)?.model)
    }
}
