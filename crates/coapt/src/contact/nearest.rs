//! Closest points of point-triangle and edge-edge pairs. The only file that names parry.

use crate::Vec3;
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::query::details::closest_points_segment_segment_with_locations_nD;
use parry3d_f64::shape::{SegmentPointLocation, Triangle, TrianglePointLocation};

/// How near two parts are. The separation is r = Σ wᵢ xᵢ over the four vertices of the pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Separation, from the second part to the first [mm].
    pub separation_mm: Vec3,
    /// Weights w of the four vertices [1]: positive on the first part, negative on the second.
    pub weights: [f64; 4],
    /// How the weights change along each free parameter of the closest points [1].
    pub parameters: Parameters,
}

/// Directions in weight space along which the closest points can slide: none, one or two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The directions; only the first `count` count.
    pub directions: [[f64; 4]; 2],
    /// How many.
    pub count: usize,
}

const NO_PARAMETERS: Parameters = Parameters {
    directions: [[0.0; 4]; 2],
    count: 0,
};

/// Point `p` against triangle `(a, b, c)`; vertex order of the weights: p, a, b, c.
pub fn point_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> Nearest {
    // Parry sees the triangle from p: small numbers, whatever the frame.
    let triangle = Triangle::new(local(a, p), local(b, p), local(c, p));
    let (_, location) = triangle.project_local_point_and_get_location(DVec3::ZERO, false);
    let (barycentric, parameters) = match location {
        TrianglePointLocation::OnVertex(vertex) => {
            let mut barycentric = [0.0; 3];
            barycentric[vertex as usize] = 1.0;
            (barycentric, NO_PARAMETERS)
        }
        TrianglePointLocation::OnEdge(edge, [u, v]) => {
            let (start, end) = [(0, 1), (1, 2), (0, 2)][edge as usize];
            let mut barycentric = [0.0; 3];
            barycentric[start] = u;
            barycentric[end] = v;
            let mut direction = [0.0; 4];
            direction[start + 1] = 1.0;
            direction[end + 1] = -1.0;
            (
                barycentric,
                Parameters {
                    directions: [direction, [0.0; 4]],
                    count: 1,
                },
            )
        }
        TrianglePointLocation::OnFace(_, barycentric) => {
            let directions = [[0.0, 1.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]];
            (barycentric, Parameters { directions, count: 2 })
        }
        // Only a solid query answers this, and this one is not solid.
        TrianglePointLocation::OnSolid => ([1.0, 0.0, 0.0], NO_PARAMETERS),
    };
    let [u, v, w] = barycentric;
    nearest([p, a, b, c], [1.0, -u, -v, -w], parameters)
}

/// Edge `(a, b)` against edge `(c, d)`; vertex order of the weights: a, b, c, d.
pub fn edge_edge(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Nearest {
    let zero = DVec3::ZERO;
    let (first, second) =
        closest_points_segment_segment_with_locations_nD((&zero, &local(b, a)), (&local(c, a), &local(d, a)));
    let mut parameters = NO_PARAMETERS;
    let mut slide = |direction: [f64; 4]| {
        parameters.directions[parameters.count] = direction;
        parameters.count += 1;
    };
    let (s, t) = (fraction(first), fraction(second));
    if is_inside(first) {
        slide([-1.0, 1.0, 0.0, 0.0]);
    }
    if is_inside(second) {
        slide([0.0, 0.0, 1.0, -1.0]);
    }
    nearest([a, b, c, d], [1.0 - s, s, t - 1.0, -t], parameters)
}

fn nearest(points: [&Vec3; 4], weights: [f64; 4], parameters: Parameters) -> Nearest {
    // The weights sum to zero: measured from the first point, rounding stays at the size of the pair.
    let separation_mm = (1..4).map(|k| (points[k] - points[0]) * weights[k]).sum();
    Nearest {
        separation_mm,
        weights,
        parameters,
    }
}

fn local(point: &Vec3, origin: &Vec3) -> DVec3 {
    (point - origin).into()
}

fn fraction(location: SegmentPointLocation) -> f64 {
    match location {
        SegmentPointLocation::OnVertex(vertex) => f64::from(vertex),
        SegmentPointLocation::OnEdge([_, v]) => v,
    }
}

fn is_inside(location: SegmentPointLocation) -> bool {
    matches!(location, SegmentPointLocation::OnEdge(_))
}
