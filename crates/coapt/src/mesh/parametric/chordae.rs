//! The chordae: which parts of the leaflets they reach, from which papillary head, how they branch and how
//! long they are when slack.

use super::annulus::Side;
use super::closed_shape::{ClosedShape, interpolate, margin_fractions};
use super::parameters::{ChordPattern, PapillaryPositions, ValveParameters};
use super::surface::Surface;
use crate::Vec3;
use crate::scene::{ChordGroup, LineMesh, default_insertion_radius_mm};

/// Kinds of chordae, in the order of their groups.
const GROUP_NAMES: [&str; 4] = ["marginal", "intermediate", "basal", "strut"];
const MARGINAL: usize = 0;
const INTERMEDIATE: usize = 1;
const BASAL: usize = 2;
const STRUT: usize = 3;

/// How far down the leaflet the inner chordae insert [1]. Struts at 60 % of the height and basal chordae in
/// the third next to the annulus: Lam 1970 and our choice; intermediate ones in the rough zone: our choice.
const DOWN: [f64; 4] = [1.0, 0.75, 0.33, 0.6];
/// Struts insert this far to either side of the middle of the anterior leaflet [share of the hinge]: at 4 and
/// 8 o'clock.
const STRUT_OFFSET: f64 = 0.18;
/// Distance between the branches of a strut [share of the hinge]. Our choice, about 2 mm.
const STRUT_SPREAD: f64 = 0.05;
/// Chordae that reach the margin this near a commissure come from the middle head [share of the margin].
const COMMISSURAL_SHARE: f64 = 0.2;

/// A chord before it has points.
struct Plan {
    group: usize,
    muscle: usize,
    head: usize,
    side: Side,
    /// Fractions across the hinge where its branches insert, the middle one first.
    across: Vec<f64>,
}

/// Heads of both muscles [mm]: anterior, middle, posterior. Where they are, and where they were when the
/// chordae had the right length.
pub(super) struct Heads {
    pub(super) now_mm: [[Vec3; 3]; 2],
    before_mm: [[Vec3; 3]; 2],
}

/// Places the papillary heads.
pub(super) fn heads(papillary: &PapillaryPositions) -> Heads {
    let spread = papillary.head_spread_mm;
    // The outer heads stand a little lower than the middle one.
    let offsets = [
        [0.0, -spread, -0.25 * spread],
        [0.0; 3],
        [0.0, spread, -0.25 * spread],
    ]
    .map(Vec3::from);
    let tips = [papillary.anterolateral_mm, papillary.posteromedial_mm].map(Vec3::from);
    let shifts = [papillary.anterolateral_shift_mm, papillary.posteromedial_shift_mm].map(Vec3::from);
    let before_mm = tips.map(|tip| offsets.map(|offset| tip + offset));
    let mut now_mm = before_mm;
    for (muscle, shift) in now_mm.iter_mut().zip(shifts) {
        for head in muscle {
            *head += shift;
        }
    }
    Heads { now_mm, before_mm }
}

/// The chord groups that have chordae.
pub(super) fn chord_groups(parameters: &ValveParameters, surface: &Surface) -> Vec<ChordGroup> {
    let margins = [Side::Anterior, Side::Posterior].map(|side| margin_fractions(surface, side));
    let plans = plan(&parameters.chordae, &margins);
    let meshes = lines(parameters, &plans, surface);
    let chordae = &parameters.chordae;
    let thin = (chordae.marginal_diameter_mm, chordae.marginal_modulus_mpa);
    let thick = (chordae.basal_diameter_mm, chordae.basal_modulus_mpa);
    (meshes
        .into_iter()
        .zip(GROUP_NAMES)
        .zip([thin, thin, thick, thick]))
    .filter(|((mesh, _), _)| !mesh.segments.is_empty())
    .map(|((mesh, name), (diameter_mm, modulus_mpa))| ChordGroup {
        name: name.into(),
        mesh_file: None,
        mesh: Some(mesh),
        diameter_mm,
        modulus_mpa: Some(modulus_mpa),
        law: None,
        rest_length_scale: chordae.rest_length_scale,
        insertion_radius_mm: default_insertion_radius_mm(),
    })
    .collect()
}

/// All chordae of the pattern, but for ruptured ones.
fn plan(pattern: &ChordPattern, margins: &[Vec<f64>; 2]) -> Vec<Plan> {
    let mut plans: Vec<Plan> = (0..2).map(commissural).collect();
    for (side, count) in [
        (Side::Anterior, pattern.marginal_anterior),
        (Side::Posterior, pattern.marginal_posterior),
    ] {
        for chord in 0..count {
            let fractions = branch_order(pattern.branches)
                .map(|branch| (f64::from(chord) + branch) / f64::from(count))
                .map(|fraction| invert(&margins[side as usize], fraction));
            plans.push(at_margin(MARGINAL, side, fractions.collect()));
        }
    }
    for side in [Side::Anterior, Side::Posterior] {
        plans
            .extend(evenly(pattern.intermediate_per_leaflet).map(|x| at_margin(INTERMEDIATE, side, vec![x])));
    }
    plans.extend(evenly(pattern.basal_posterior).map(|x| at_margin(BASAL, Side::Posterior, vec![x])));
    if pattern.struts {
        plans.extend([0.5 - STRUT_OFFSET, 0.5 + STRUT_OFFSET].map(|middle| {
            let spread = |branch: f64| (branch - 0.5) * STRUT_SPREAD * f64::from(pattern.branches);
            let across = branch_order(pattern.branches).map(|branch| middle + spread(branch));
            at_margin(STRUT, Side::Anterior, across.collect())
        }));
    }
    let ruptured = 0.5 * pattern.ruptured_posterior_fraction;
    plans.retain(|plan| !(plan.side == Side::Posterior && is_ruptured(plan, &margins[1], ruptured)));
    plans
}

fn is_ruptured(plan: &Plan, margin: &[f64], half_width: f64) -> bool {
    let margin_chord = plan.group == MARGINAL || plan.group == INTERMEDIATE;
    margin_chord && (interpolate(margin, plan.across[0]) - 0.5).abs() < half_width
}

/// The chord to a commissure itself.
fn commissural(muscle: usize) -> Plan {
    Plan {
        group: MARGINAL,
        muscle,
        head: 1,
        side: Side::Anterior,
        across: vec![muscle as f64],
    }
}

/// A chord from the muscle of its own side: from the middle head near the commissure, else from the head
/// nearer to its leaflet.
fn at_margin(group: usize, side: Side, across: Vec<f64>) -> Plan {
    let middle = across[0];
    let lateral = match side {
        Side::Anterior => middle < 0.5,
        Side::Posterior => middle > 0.5,
    };
    let near_commissure = middle.min(1.0 - middle) < COMMISSURAL_SHARE && group != BASAL;
    let head = if near_commissure { 1 } else { 2 * (side as usize) };
    Plan {
        group,
        muscle: usize::from(!lateral),
        head,
        side,
        across,
    }
}

fn evenly(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| (f64::from(i) + 0.5) / f64::from(count))
}

/// Middles of so many equal parts of [0, 1], the middlemost first.
fn branch_order(count: u32) -> impl Iterator<Item = f64> {
    let mut parts: Vec<f64> = evenly(count).collect();
    parts.sort_by(|a, b| (a - 0.5).abs().total_cmp(&(b - 0.5).abs()));
    parts.into_iter()
}

/// Where in an ascending table over [0, 1] a value lies.
fn invert(table: &[f64], value: f64) -> f64 {
    let last = table.len() - 1;
    let after = table.partition_point(|&entry| entry <= value).clamp(1, last);
    let step = table[after] - table[after - 1];
    let share = if step > 0.0 {
        (value - table[after - 1]) / step
    } else {
        0.0
    };
    (after as f64 - 1.0 + share) / last as f64
}

/// Segments of each group, with rest lengths from the closed shape.
fn lines(parameters: &ValveParameters, plans: &[Plan], surface: &Surface) -> [LineMesh; 4] {
    let pattern = &parameters.chordae;
    let closed = ClosedShape::new(
        parameters,
        &pattern.rest_annulus.unwrap_or(parameters.annulus),
        surface,
    );
    let heads = heads(&parameters.papillary);
    let mut meshes: [LineMesh; 4] = std::array::from_fn(|_| LineMesh {
        rest_length_mm: Some(Vec::new()),
        ..LineMesh::default()
    });
    for plan in plans {
        let down = DOWN[plan.group];
        let end = |&across: &f64| {
            let arc = surface.annulus.arc_of(plan.side, across);
            let open = surface.at(arc, down * surface.height_mm(arc));
            [open, closed.at(plan.side, across, down)]
        };
        let ends: Vec<[Vec3; 2]> = plan.across.iter().map(end).collect();
        let head = [
            heads.now_mm[plan.muscle][plan.head],
            heads.before_mm[plan.muscle][plan.head],
        ];
        add_chord(&mut meshes[plan.group], pattern, head, &ends);
    }
    meshes
}

/// Appends one chord: a single segment, or a trunk and its branches. Points come as open and closed position.
fn add_chord(mesh: &mut LineMesh, pattern: &ChordPattern, head: [Vec3; 2], ends: &[[Vec3; 2]]) {
    if ends.is_empty() {
        return;
    }
    let mut add_point = |point: Vec3| {
        let known = mesh
            .points_mm
            .iter()
            .position(|&other| Vec3::from(other) == point);
        known.unwrap_or_else(|| {
            mesh.points_mm.push(point.into());
            mesh.points_mm.len() - 1
        }) as u32
    };
    let start = add_point(head[0]);
    let tips: Vec<u32> = ends.iter().map(|end| add_point(end[0])).collect();
    let (from, joint) = if ends.len() == 1 {
        (start, head)
    } else {
        let joint = [0, 1].map(|phase| {
            let mean = ends.iter().map(|end| end[phase]).sum::<Vec3>() / ends.len() as f64;
            head[phase] + (mean - head[phase]) * pattern.branch_position
        });
        (add_point(joint[0]), joint)
    };
    let rest = mesh.rest_length_mm.get_or_insert_default();
    if from != start {
        mesh.segments.push([start, from]);
        rest.push((joint[1] - head[1]).norm() / (1.0 + pattern.closed_strain));
    }
    for (tip, end) in tips.into_iter().zip(ends) {
        mesh.segments.push([from, tip]);
        rest.push((end[1] - joint[1]).norm() / (1.0 + pattern.closed_strain));
    }
}
