//! Error against time as an SVG picture, both logarithmic.
//!
//! Colours are those of Okabe and Ito, told apart by the colour-blind, and every mesh has a mark of its own besides.
//! Words stand beside the plot, never in it, so that nothing can overlap whatever the figures are.

use std::fmt::Write;

use super::axis::{Axis, axis};
use super::front::place;
use super::{Factor, Row, Study};

const WIDTH: f64 = 960.0;
/// The plot: left, top, right, bottom [pixel].
const FRAME: [f64; 4] = [90.0, 60.0, 650.0, 500.0];
const LEGEND_X: f64 = 676.0;
const LEGEND_STEP: f64 = 23.0;
/// From line to line of one entry [pixel].
const LINE: f64 = 18.0;
/// Half the size of a mark [pixel].
const MARK: f64 = 5.0;

/// Okabe and Ito 2008, without yellow, which is too pale for lines.
const COLOURS: [&str; 7] = [
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000",
];

/// The picture.
pub fn svg(study: &Study) -> String {
    let [left, top, right, bottom] = FRAME;
    let places = || study.rows.iter().filter_map(place);
    let time = axis(places().map(|place| place[0]), [left, right]);
    let error = axis(places().map(|place| place[1]), [bottom, top]);
    let mut picture = Picture {
        body: String::new(),
        time,
        error,
        legend_y: top + 8.0,
    };
    picture.axes(study);
    picture.front(&study.rows);
    picture.meshes(&study.rows);
    picture.thicknesses(&study.rows);
    picture.knee(study);
    picture.words(study)
}

struct Picture {
    body: String,
    time: Axis,
    error: Axis,
    legend_y: f64,
}

impl Picture {
    fn put(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    fn text(&mut self, [x, y]: [f64; 2], attributes: &str, words: &str) {
        self.put(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" {attributes}>{}</text>",
            escaped(words)
        ));
    }

    fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], attributes: &str) {
        self.put(&format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {attributes}/>"
        ));
    }

    fn at(&self, [time_ms, error_mm]: [f64; 2]) -> [f64; 2] {
        [self.time.at(time_ms), self.error.at(error_mm)]
    }

    fn axes(&mut self, study: &Study) {
        let [left, top, right, bottom] = FRAME;
        let grid = "stroke=\"#d0d0d0\"";
        for (value, label) in self.time.ticks() {
            let x = self.time.at(value);
            self.line([x, top], [x, bottom], grid);
            self.text([x, bottom + 20.0], "text-anchor=\"middle\"", &label);
        }
        for (value, label) in self.error.ticks() {
            let y = self.error.at(value);
            self.line([left, y], [right, y], grid);
            self.text([left - 8.0, y + 5.0], "text-anchor=\"end\"", &label);
        }
        self.put(&format!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#404040\"/>",
            right - left,
            bottom - top
        ));
        let middle = (left + right) / 2.0;
        self.text(
            [middle, bottom + 44.0],
            "text-anchor=\"middle\"",
            "time of one closure, certificate included [ms]",
        );
        let (x, y) = (26.0, (top + bottom) / 2.0);
        self.text(
            [x, y],
            &format!("text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\""),
            match study.is_without_mesh_error() {
                true => "error of the visible surface without that of the mesh, root mean square [mm]",
                false => "error of the visible surface, root mean square [mm]",
            },
        );
    }

    /// The steps of the front: what can be had by a given time.
    fn front(&mut self, rows: &[Row]) {
        let mut places: Vec<[f64; 2]> = rows.iter().filter(|row| row.on_front).filter_map(place).collect();
        places.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if places.is_empty() {
            return;
        }
        let style = "fill=\"none\" stroke=\"#808080\" stroke-width=\"5\" stroke-opacity=\"0.4\"";
        let points: Vec<[f64; 2]> = places.into_iter().map(|place| self.at(place)).collect();
        self.polyline(&points, style);
        let y = self.legend_row();
        self.polyline(&[[LEGEND_X - 10.0, y], [LEGEND_X + 10.0, y]], style);
        self.legend_words(y, "front: none beats it in both");
    }

    fn polyline(&mut self, points: &[[f64; 2]], style: &str) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.put(&format!("<polyline points=\"{}\" {style}/>", points.join(" ")));
    }

    /// A line through the tolerances of each mesh.
    fn meshes(&mut self, rows: &[Row]) {
        let grid: Vec<&Row> = rows
            .iter()
            .filter(|row| row.varied == Factor::MeshAndTolerance)
            .collect();
        let mut faces: Vec<usize> = grid.iter().map(|row| row.faces).collect();
        faces.sort_unstable();
        faces.dedup();
        for (number, &faces) in faces.iter().enumerate() {
            let mut own: Vec<&Row> = grid.iter().filter(|row| row.faces == faces).copied().collect();
            own.sort_by(|a, b| b.residual_tolerance.total_cmp(&a.residual_tolerance));
            let colour = COLOURS[number % COLOURS.len()];
            let points: Vec<[f64; 2]> = own
                .iter()
                .filter_map(|row| place(row))
                .map(|place| self.at(place))
                .collect();
            self.polyline(
                &points,
                &format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\""),
            );
            self.marks(&own, number, colour);
            let words = match own[..] {
                [_] => format!("{faces} triangles"),
                _ => format!("{faces} triangles, {}", tolerances(&own)),
            };
            let y = self.legend_row();
            self.mark([LEGEND_X, y], number, colour);
            self.legend_words(y, &words);
        }
        if rows.iter().any(|row| !row.certified) {
            let y = self.legend_row();
            self.cross([LEGEND_X, y]);
            self.legend_words(y, "not certified");
        }
    }

    fn thicknesses(&mut self, rows: &[Row]) {
        let own: Vec<&Row> = rows
            .iter()
            .filter(|row| row.varied == Factor::ContactThickness)
            .collect();
        if own.is_empty() {
            return;
        }
        self.marks(&own, PLUS, "#404040");
        let thicknesses = || own.iter().map(|row| row.contact_thickness_mm);
        let (least, most) = (
            thicknesses().fold(f64::INFINITY, f64::min),
            thicknesses().fold(0.0, f64::max),
        );
        let y = self.legend_row();
        self.mark([LEGEND_X, y], PLUS, "#404040");
        self.legend_words(y, &format!("contact thickness {least} to {most} mm"));
    }

    fn marks(&mut self, rows: &[&Row], shape: usize, colour: &str) {
        for row in rows {
            let Some(place) = place(row) else { continue };
            let at = self.at(place);
            self.mark(at, shape, colour);
            if !row.certified {
                self.cross(at);
            }
        }
    }

    /// A mark by the number of its shape, which begins again after the last.
    fn mark(&mut self, [x, y]: [f64; 2], shape: usize, colour: &str) {
        let (r, d) = (MARK, 2.0 * MARK);
        let path = match shape {
            PLUS => {
                let style = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\"");
                let path = format!("M{:.1} {y:.1}h{d}M{x:.1} {:.1}v{d}", x - r, y - r);
                return self.put(&format!("<path d=\"{path}\" {style}/>"));
            }
            _ if shape.is_multiple_of(4) => {
                format!("M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", x - r)
            }
            _ if shape % 4 == 1 => format!("M{:.1} {:.1}h{d}v{d}h-{d}z", x - r, y - r),
            _ if shape % 4 == 2 => format!("M{x:.1} {:.1}l{r} {d}h-{d}z", y - r),
            _ => format!("M{x:.1} {:.1}l{r} {r}l-{r} {r}l-{r} -{r}z", y - r),
        };
        self.put(&format!(
            "<path d=\"{path}\" fill=\"{colour}\" stroke=\"white\" stroke-width=\"0.8\"/>"
        ));
    }

    fn cross(&mut self, [x, y]: [f64; 2]) {
        let r = MARK + 3.0;
        let style = "stroke=\"black\" stroke-width=\"1.8\"";
        self.line([x - r, y - r], [x + r, y + r], style);
        self.line([x - r, y + r], [x + r, y - r], style);
    }

    fn knee(&mut self, study: &Study) {
        let Some((row, [time_ms, error_mm])) = study
            .knee_row()
            .and_then(|row| place(row).map(|place| (row, place)))
        else {
            let y = self.legend_row();
            return self.legend_words(y, "no knee: the front has no bend");
        };
        let [x, y] = self.at([time_ms, error_mm]);
        let ring = "fill=\"none\" stroke=\"black\" stroke-width=\"2\"";
        self.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"11\" {ring}/>"));
        let y = self.legend_row();
        self.put(&format!(
            "<circle cx=\"{LEGEND_X}\" cy=\"{y:.1}\" r=\"9\" {ring}/>"
        ));
        let lines = [
            "knee: farthest below the line".to_owned(),
            "between the ends of the front".to_owned(),
            format!("{} triangles to {:e}", row.faces, row.residual_tolerance),
            format!("{time_ms:.1} ms, {} mm", significant(error_mm)),
        ];
        for (number, words) in lines.iter().enumerate() {
            self.legend_words(y + number as f64 * LINE, words);
        }
        self.legend_y += 3.0 * LINE;
    }

    fn legend_row(&mut self) -> f64 {
        let y = self.legend_y;
        self.legend_y += LEGEND_STEP;
        y
    }

    fn legend_words(&mut self, y: f64, words: &str) {
        self.text([LEGEND_X + 18.0, y + 5.0], "", words);
    }

    /// Title and foot around the rest.
    fn words(mut self, study: &Study) -> String {
        let foot = (FRAME[3] + 72.0).max(self.legend_y + LINE);
        let reference = study.reference;
        self.text(
            [FRAME[0], 36.0],
            "font-size=\"18\" font-weight=\"bold\"",
            &format!("{}: error against time", study.case),
        );
        let lines = [
            format!("Error: {}.", study.error),
            format!(
                "Reference: {} triangles, residual {:.0e}. Times: medians of {}.",
                reference.faces, reference.residual, study.repeats
            ),
            format!("coapt {}: {}.", study.version, study.notice),
        ];
        for (number, words) in lines.iter().enumerate() {
            let y = foot + number as f64 * LINE;
            self.text([FRAME[0], y], "font-size=\"12\"", words);
        }
        let height = foot + 3.0 * LINE;
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
             height=\"{height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"14\" fill=\"#202020\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
            self.body
        );
        out
    }
}

/// The shape of a plus, which no mesh has.
const PLUS: usize = usize::MAX;

/// The range of tolerances of some closures, loosest first.
fn tolerances(rows: &[&Row]) -> String {
    let ends = [rows.first(), rows.last()].map(|row| row.map_or(0.0, |row| row.residual_tolerance));
    format!("{:e} to {:e}", ends[0], ends[1])
}

/// Two digits that count.
fn significant(value: f64) -> String {
    if value < 1e-3 {
        return format!("{value:.1e}");
    }
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

fn escaped(words: &str) -> String {
    // Control characters are no XML.
    let clean: String = words.chars().filter(|letter| !letter.is_control()).collect();
    clean
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
