//! Thins a triangle mesh: vertex after vertex is pulled along an edge into a neighbour, the most crowded first.
//!
//! What is left is a subset of the vertices. A pull is refused where it would change the topology (the link
//! condition of Dey, Edelsbrunner, Guha & Nekhayev 1999) or make a face that is flat or turned over.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::place::Place;
use crate::Vec3;

/// No vertex, no face, end of a list.
pub(super) const NONE: u32 = u32::MAX;

/// A pull must leave faces at least this good, or no worse than they were: shape (1 for equilateral) times the
/// cosine of the angle by which the face turns [1]. Lower, and slivers appear, whose springs are stiff and soft
/// at once; higher, and too few vertices can go.
const LEAST_SCORE: f64 = 0.3;

/// Area around a vertex of a mesh of equilateral triangles over the edge length squared: six triangles.
const AREA_PER_EDGE_SQUARED: f64 = 2.598;

/// A mesh on its way to fewer vertices.
pub(super) struct Thinning<'a> {
    points: &'a [Vec3],
    /// Factors by which vertices count as less crowded than they are, shape `[vertex]`.
    reluctance: &'a [f32],
    /// Vertices of each face; [`NONE`] for faces that are gone. Shape `[face]`.
    pub(super) faces: Vec<[u32; 3]>,
    /// The face that a face fell to: itself while it stands. Shape `[face]`.
    pub(super) heir: Vec<u32>,
    /// The vertex that a vertex was pulled into: itself while it stands. Shape `[vertex]`.
    pub(super) pulled_into: Vec<u32>,
    place: Vec<Place>,
    /// Corners `3 face + k` of each vertex as linked lists: first of a vertex, next of a corner.
    first: Vec<u32>,
    next: Vec<u32>,
    /// Area of the faces around each vertex [mm²].
    area: Vec<f64>,
    heap: BinaryHeap<Reverse<u64>>,
    /// Key under which a vertex is in the heap; infinite if it is not.
    queued: Vec<f32>,
    /// Room for the normals of the faces around a vertex.
    normals: Vec<Vec3>,
}

/// A face around a vertex: its number and its two other vertices in winding order.
#[derive(Clone, Copy, Debug)]
struct Wedge {
    face: u32,
    ends: [u32; 2],
}

impl<'a> Thinning<'a> {
    pub(super) fn new(
        points: &'a [Vec3],
        faces: &[[u32; 3]],
        place: Vec<Place>,
        reluctance: &'a [f32],
    ) -> Self {
        let count = place.len();
        let mut thinning = Self {
            points,
            reluctance,
            faces: faces.to_vec(),
            heir: (0..faces.len() as u32).collect(),
            pulled_into: (0..count as u32).collect(),
            place,
            first: vec![NONE; count],
            next: vec![NONE; 3 * faces.len()],
            area: vec![0.0; count],
            heap: BinaryHeap::with_capacity(2 * count),
            queued: vec![f32::INFINITY; count],
            normals: Vec::new(),
        };
        // From the back, so that each list is in ascending order.
        for (number, face) in faces.iter().enumerate().rev() {
            let area = area(face.map(|v| points[v as usize]));
            for (k, &vertex) in face.iter().enumerate() {
                thinning.list(vertex, (3 * number + k) as u32);
                thinning.area[vertex as usize] += area;
            }
        }
        thinning
    }

    /// Pulls vertices in until so many are left, or no more can go; returns how many are left.
    pub(super) fn run(&mut self, target: usize) -> usize {
        let mut left = self.place.len();
        (0..left as u32).for_each(|vertex| self.queue(vertex));
        let mut ring = Vec::new();
        while left > target
            && let Some(Reverse(entry)) = self.heap.pop()
        {
            let (key, vertex) = (f32::from_bits((entry >> 32) as u32), entry as u32);
            if self.queued[vertex as usize] != key {
                continue;
            }
            self.queued[vertex as usize] = f32::INFINITY;
            if self.key(vertex) > key {
                self.queue(vertex);
                continue;
            }
            self.ring(vertex, &mut ring);
            if let Some(into) = self.best_neighbour(vertex, &ring) {
                self.pull(vertex, into, &ring);
                left -= 1;
            }
        }
        left
    }

    fn list(&mut self, vertex: u32, corner: u32) {
        self.next[corner as usize] = self.first[vertex as usize];
        self.first[vertex as usize] = corner;
    }

    /// Crowded vertices have low keys: the area around them, or what it would be in an even mesh with the edges of
    /// the line they lie on.
    fn key(&self, vertex: u32) -> f32 {
        let area = match self.place[vertex as usize] {
            Place::Inner => self.area[vertex as usize],
            Place::Line(ends) => {
                let at = self.points[vertex as usize];
                let edges = ends.map(|end| (self.points[end as usize] - at).norm());
                AREA_PER_EDGE_SQUARED * (0.5 * (edges[0] + edges[1])).powi(2)
            }
            Place::Corner => return f32::INFINITY,
        };
        // Sums of differences may fall below zero by rounding, where bits are in another order.
        area.max(0.0) as f32 * self.reluctance[vertex as usize]
    }

    /// Puts a vertex into the heap, unless it is there already with no higher key: such an entry is corrected when
    /// it comes up.
    fn queue(&mut self, vertex: u32) {
        let key = self.key(vertex);
        if key < self.queued[vertex as usize] {
            self.queued[vertex as usize] = key;
            // Bits of positive floats are in the order of the floats.
            self.heap
                .push(Reverse(u64::from(key.to_bits()) << 32 | u64::from(vertex)));
        }
    }

    /// The faces around a vertex; unlists those that are gone.
    fn ring(&mut self, vertex: u32, ring: &mut Vec<Wedge>) {
        ring.clear();
        let mut corner = self.first[vertex as usize];
        let mut last = NONE;
        while corner != NONE {
            let next = self.next[corner as usize];
            let face = self.faces[corner as usize / 3];
            if face[0] == NONE {
                match last {
                    NONE => self.first[vertex as usize] = next,
                    last => self.next[last as usize] = next,
                }
            } else {
                last = corner;
                ring.push(wedge(corner, face));
            }
            corner = next;
        }
    }

    /// The neighbour that makes the best faces, if any will do.
    fn best_neighbour(&mut self, vertex: u32, ring: &[Wedge]) -> Option<u32> {
        let mut normals = std::mem::take(&mut self.normals);
        normals.clear();
        normals.extend(ring.iter().map(|wedge| self.normal(vertex, wedge)));
        let mut best = (None, LEAST_SCORE.min(self.worst_score(vertex, ring, &normals)));
        let mut consider = |into: u32| {
            let score = self.worst_score(into, ring, &normals);
            if score > best.1 && self.keeps_topology(vertex, into, ring) {
                best = (Some(into), score);
            }
        };
        match self.place[vertex as usize] {
            Place::Inner => ring.iter().for_each(|wedge| consider(wedge.ends[0])),
            Place::Line(ends) => ends.into_iter().for_each(consider),
            Place::Corner => {}
        }
        self.normals = normals;
        best.0
    }

    fn normal(&self, vertex: u32, wedge: &Wedge) -> Vec3 {
        let [p, q] = wedge
            .ends
            .map(|v| self.points[v as usize] - self.points[vertex as usize]);
        p.cross(&q).normalize()
    }

    /// The worst score of the faces that are left around `first`, if it takes the place of the vertex within
    /// the ring.
    fn worst_score(&self, first: u32, ring: &[Wedge], normals: &[Vec3]) -> f64 {
        let left = ring.iter().zip(normals).filter(|(w, _)| !w.ends.contains(&first));
        let at = self.points[first as usize];
        left.map(|(wedge, normal)| self.score(at, wedge, normal))
            .fold(f64::INFINITY, f64::min)
    }

    /// Shape of the face with its first vertex at `at`, 1 if equilateral, times the cosine of its angle to
    /// `normal`.
    fn score(&self, at: Vec3, wedge: &Wedge, normal: &Vec3) -> f64 {
        let [p, q] = wedge.ends.map(|v| self.points[v as usize] - at);
        let squares = p.norm_squared() + q.norm_squared() + (q - p).norm_squared();
        2.0 * 3.0_f64.sqrt() * p.cross(&q).dot(normal) / squares
    }

    /// The link condition: whoever neighbours both ends is opposite to their edge. On a line, moreover, the vertex
    /// must not be the only thing between its two line neighbours.
    fn keeps_topology(&self, vertex: u32, into: u32, ring: &[Wedge]) -> bool {
        let opposite = |&w: &u32| ring.iter().any(|r| r.ends.contains(&into) && r.ends.contains(&w));
        if let Place::Line(ends) = self.place[vertex as usize]
            && ends.iter().filter(|&&end| end != into).any(opposite)
        {
            return false;
        }
        let shared = |w: &u32| ring.iter().any(|r| r.ends.contains(w));
        let mut corner = self.first[into as usize];
        while corner != NONE {
            let face = self.faces[corner as usize / 3];
            if face[0] != NONE && !face.contains(&vertex) {
                let ends = wedge(corner, face).ends;
                if ends.iter().any(|w| shared(w) && !opposite(w)) {
                    return false;
                }
            }
            corner = self.next[corner as usize];
        }
        true
    }

    fn pull(&mut self, vertex: u32, into: u32, ring: &[Wedge]) {
        self.pulled_into[vertex as usize] = into;
        for wedge in ring {
            let [p, q] = wedge.ends;
            let before = self.face_area(wedge.face);
            self.area[p as usize] -= before;
            self.area[q as usize] -= before;
            if wedge.ends.contains(&into) {
                self.faces[wedge.face as usize] = [NONE; 3];
                self.heir[wedge.face as usize] = heir(wedge, into, ring);
                continue;
            }
            let face = &mut self.faces[wedge.face as usize];
            let k = face.iter().position(|&v| v == vertex).unwrap_or(0);
            face[k] = into;
            self.list(into, 3 * wedge.face + k as u32);
            let after = self.face_area(wedge.face);
            for v in [p, q, into] {
                self.area[v as usize] += after;
            }
        }
        if let Place::Line(ends) = self.place[vertex as usize] {
            let other = if ends[0] == into { ends[1] } else { ends[0] };
            self.relink(other, vertex, into);
            self.relink(into, vertex, other);
        }
        ring.iter()
            .flat_map(|w| w.ends)
            .for_each(|neighbour| self.queue(neighbour));
    }

    /// On the line at `at`, `new` takes the place of `old`.
    fn relink(&mut self, at: u32, old: u32, new: u32) {
        if let Place::Line(ends) = &mut self.place[at as usize] {
            ends.iter_mut()
                .filter(|end| **end == old)
                .for_each(|end| *end = new);
        }
    }

    fn face_area(&self, face: u32) -> f64 {
        area(self.faces[face as usize].map(|v| self.points[v as usize]))
    }
}

fn wedge(corner: u32, face: [u32; 3]) -> Wedge {
    let k = corner as usize % 3;
    Wedge {
        face: corner / 3,
        ends: [face[(k + 1) % 3], face[(k + 2) % 3]],
    }
}

fn area([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Who takes over what a vanishing face was made of: its neighbour around the vertex that is pulled in.
fn heir(gone: &Wedge, into: u32, ring: &[Wedge]) -> u32 {
    let opposite = if gone.ends[0] == into {
        gone.ends[1]
    } else {
        gone.ends[0]
    };
    let neighbour = ring
        .iter()
        .find(|w| w.face != gone.face && w.ends.contains(&opposite));
    neighbour.map_or(NONE, |w| w.face)
}
