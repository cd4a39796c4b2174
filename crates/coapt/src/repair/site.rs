//! Where along the line of closure something is done.
//!
//! A site is one number: the share of the free margin's arc length that lies between it and the anterolateral commissure,
//! measured on the open valve, on each leaflet along its own margin. So it names a point of the anterior margin and the one
//! of the posterior margin that faces it: middles face middles, commissures commissures. `A1P1`, `A2P2` and `A3P3` are the
//! middles of the thirds, 1/6, 1/2 and 5/6: our choice, by the widths that surgeons give the segments. The six sites of
//! paper 004, which shows them in a picture only, are six such numbers.

use super::leaflet::{LeafletMargin, leaflet_named};
use crate::model::Model;
use crate::scene::{Fault, Site};

/// The margins of both leaflets and a site on them.
#[derive(Clone, Debug)]
pub struct SiteMargins<'a> {
    /// How reports call the site: `A2P2`, or its number.
    pub name: String,
    /// Share of the margin from the anterolateral commissure [1].
    pub position: f64,
    /// Margin of the anterior leaflet, then of the posterior one.
    pub margins: [LeafletMargin<'a>; 2],
}

impl Site {
    /// Share of the margin from the anterolateral commissure [1].
    pub fn position(self) -> f64 {
        match self {
            Self::A1P1 => 1.0 / 6.0,
            Self::A2P2 => 0.5,
            Self::A3P3 => 5.0 / 6.0,
        }
    }

    /// The name as in plans.
    pub fn name(self) -> &'static str {
        match self {
            Self::A1P1 => "A1P1",
            Self::A2P2 => "A2P2",
            Self::A3P3 => "A3P3",
        }
    }
}

/// The site's name and its position, given as exactly one of a name and a number; `kind` is what the repair's faults begin
/// with.
///
/// # Errors
/// Neither or both are given, or the number is not within 0 to 1.
pub fn position(site: Option<Site>, position: Option<f64>, kind: &str) -> Result<(String, f64), Fault> {
    match (site, position) {
        (Some(site), None) => Ok((site.name().to_owned(), site.position())),
        (None, Some(position)) if (0.0..=1.0).contains(&position) => Ok((format!("{position}"), position)),
        (None, Some(position)) => {
            let message = format!(
                "is {position}, expected 0 (anterolateral commissure) to 1 (posteromedial commissure)"
            );
            Err(Fault::error(format!("{kind}.position"), message))
        }
        (Some(_), Some(_)) => Err(Fault::error(
            format!("{kind}.position"),
            "is given beside `site`; expected one of the two",
        )),
        (None, None) => Err(Fault::error(
            format!("{kind}.site"),
            "is missing; expected A1P1, A2P2 or A3P3, or `position`, a number from 0 to 1",
        )),
    }
}

/// A site on the anterior and on the posterior margin.
///
/// # Errors
/// As [`position`]; a model that lacks one of the leaflets, or whose margin does not go from commissure to commissure.
pub fn on_both_leaflets<'a>(
    model: &'a Model,
    site: Option<Site>,
    number: Option<f64>,
    kind: &str,
) -> Result<SiteMargins<'a>, Fault> {
    let (name, position) = position(site, number, kind)?;
    let place = format!("{kind}.{}", if site.is_some() { "site" } else { "position" });
    let margin = |leaflet: &str| LeafletMargin::new(model, leaflet_named(model, leaflet, &place)?, &place);
    Ok(SiteMargins {
        name,
        position,
        margins: [margin("anterior")?, margin("posterior")?],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::model::fixtures::{ROWS, built, skirt, skirt_point};

    /// In the skirt both middles lie on the y axis: columns 6 and 18.
    #[test]
    fn a_site_is_the_same_share_of_both_margins() {
        let model = built(&skirt()).model;
        let site = on_both_leaflets(&model, Some(Site::A2P2), None, "clip").unwrap();
        for (margin, column) in site.margins.iter().zip([6, 18]) {
            let point = margin.point_mm(site.position * margin.length_mm());
            // The ellipse is sampled evenly about the y axis, so to rounding.
            assert!((point - Vec3::from(skirt_point(column, ROWS - 1))).norm() < 1e-9);
        }
        let first = on_both_leaflets(&model, None, Some(0.0), "clip").unwrap();
        let [a, p] = &first.margins;
        assert_eq!(
            a.point_mm(0.0),
            p.point_mm(0.0),
            "leaflets meet at the commissure"
        );
        assert_eq!(first.name, "0");
    }

    #[test]
    fn what_is_no_site_is_told() {
        let told = |site, number| position(site, number, "clip").unwrap_err();
        assert_eq!(told(None, None).place, "clip.site");
        assert_eq!(
            told(Some(Site::A1P1), Some(0.5)).message,
            "is given beside `site`; expected one of the two"
        );
        for wrong in [-0.1, 1.5, f64::NAN] {
            let fault = told(None, Some(wrong));
            assert_eq!(fault.place, "clip.position");
            assert!(
                fault
                    .message
                    .contains(&format!("is {wrong}, expected 0 (anterolateral")),
                "{fault:?}"
            );
        }
        let mut model = built(&skirt()).model;
        model.leaflets[1].name = "septal".into();
        let fault = on_both_leaflets(&model, Some(Site::A2P2), None, "clip").unwrap_err();
        assert!(
            fault.place == "clip.site" && fault.message.contains("`posterior`"),
            "{fault:?}"
        );
    }
}
