//! How triangles hang together: edges, boundary chains, winding, components. Numbers only, no coordinates.
//!
//! Every result depends on the numbering alone, never on hashing, so that equal input gives equal output.

use std::collections::BTreeMap;

/// The edges of a triangle mesh, in ascending order of their ends.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edges {
    /// The two vertices of each edge, smaller first, shape `[edge]`.
    pub ends: Vec<[u32; 2]>,
    /// Faces of edge `e` are `faces[offsets[e]..offsets[e + 1]]`, shape `[edge + 1]`.
    pub offsets: Vec<usize>,
    /// Faces at the edges, ascending within each edge.
    pub faces: Vec<u32>,
}

impl Edges {
    /// Number of edges.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no edge.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The faces that meet at an edge.
    pub fn faces_of(&self, edge: usize) -> &[u32] {
        &self.faces[self.offsets[edge]..self.offsets[edge + 1]]
    }
}

/// Vertices that follow each other along edges.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chain {
    /// Vertices in order.
    pub vertices: Vec<u32>,
    /// Whether the last vertex joins the first.
    pub closed: bool,
}

/// The three directed edges of a face, in winding order.
pub fn face_edges(face: [u32; 3]) -> [[u32; 2]; 3] {
    [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]]
}

/// All edges of a mesh with the faces at each.
pub fn edges(faces: &[[u32; 3]]) -> Edges {
    // Sorted by lower end by counting, then each vertex' few sides by comparing: a fifth of the time of one
    // sort at 10,000 faces.
    let vertex_count = faces.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    let sides = || {
        (0..)
            .zip(faces)
            .flat_map(|(number, &face)| face_edges(face).map(|side| (side, number)))
    };
    let mut end = vec![0; vertex_count + 1];
    sides().for_each(|([a, b], _)| end[a.min(b) as usize + 1] += 1);
    (0..vertex_count).for_each(|v| end[v + 1] += end[v]);
    let mut at_lower = vec![(0, 0); 3 * faces.len()];
    for ([a, b], number) in sides() {
        let slot: &mut usize = &mut end[a.min(b) as usize];
        at_lower[*slot] = (a.max(b), number);
        *slot += 1;
    }
    let mut edges = Edges::default();
    let mut from = 0;
    for (lower, &to) in end[..vertex_count].iter().enumerate() {
        at_lower[from..to].sort_unstable();
        for &(upper, face) in &at_lower[from..to] {
            if edges.ends.last() != Some(&[lower as u32, upper]) {
                edges.ends.push([lower as u32, upper]);
                edges.offsets.push(edges.faces.len());
            }
            edges.faces.push(face);
        }
        from = to;
    }
    edges.offsets.push(edges.faces.len());
    edges
}

/// Edges with one face, directed as that face winds.
pub fn boundary_edges(faces: &[[u32; 3]], edges: &Edges) -> Vec<[u32; 2]> {
    let mut boundary = Vec::new();
    for edge in 0..edges.len() {
        if let [face] = *edges.faces_of(edge) {
            let [a, b] = edges.ends[edge];
            let forward = face_edges(faces[face as usize]).contains(&[a, b]);
            boundary.push(if forward { [a, b] } else { [b, a] });
        }
    }
    boundary
}

/// Strings directed edges together. Open chains come first, each from its start; then closed ones, each from its
/// lowest vertex; both in ascending order of first vertex. Where several edges leave one vertex (a figure of
/// eight) the chain follows the lowest one not yet used.
pub fn chains(directed: &[[u32; 2]]) -> Vec<Chain> {
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut surplus: BTreeMap<u32, i64> = BTreeMap::new();
    for &[a, b] in directed {
        next.entry(a).or_default().push(b);
        *surplus.entry(a).or_default() += 1;
        *surplus.entry(b).or_default() -= 1;
    }
    for targets in next.values_mut() {
        targets.sort_unstable_by(|a, b| b.cmp(a));
    }
    let starts = surplus.iter().flat_map(|(&v, &s)| (0..s).map(move |_| v));
    let mut found: Vec<Chain> = starts.map(|start| follow(&mut next, start)).collect();
    let rest: Vec<u32> = next.keys().copied().collect();
    for start in rest {
        while next.get(&start).is_some_and(|targets| !targets.is_empty()) {
            found.push(follow(&mut next, start));
        }
    }
    found
}

/// Uses up edges from `start` until it is back there or nothing leads on.
fn follow(next: &mut BTreeMap<u32, Vec<u32>>, start: u32) -> Chain {
    let mut vertices = vec![start];
    let mut at = start;
    while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
        if to == start {
            return Chain {
                vertices,
                closed: true,
            };
        }
        vertices.push(to);
        at = to;
    }
    Chain {
        vertices,
        closed: false,
    }
}

/// Faces grouped by shared edges: the component of each face, numbered from 0 in order of first face, and how
/// many there are.
pub fn components(face_count: usize, edges: &Edges) -> (Vec<u32>, usize) {
    let mut sets = DisjointSets::new(face_count);
    for edge in 0..edges.len() {
        for pair in edges.faces_of(edge).windows(2) {
            sets.join(pair[0], pair[1]);
        }
    }
    sets.numbered()
}

/// Makes neighbouring faces wind alike. In each component the winding of the majority stays (the first face's,
/// where there is none).
///
/// Gives the faces that were turned, or, for a surface with one side only, an edge where the winding cannot
/// agree. Edges with more than two faces are passed over.
pub fn orient(faces: &mut [[u32; 3]], edges: &Edges) -> Result<Vec<u32>, [u32; 2]> {
    let neighbours = neighbours(faces, edges);
    let mut turned: Vec<Option<bool>> = vec![None; faces.len()];
    let mut flipped = Vec::new();
    for seed in 0..faces.len() {
        if turned[seed].is_some() {
            continue;
        }
        turned[seed] = Some(false);
        let mut component = vec![seed as u32];
        let mut at = 0;
        while let Some(&face) = component.get(at) {
            for &(other, agrees) in &neighbours[face as usize] {
                let wanted = turned[face as usize] == Some(agrees);
                match turned[other as usize] {
                    None => {
                        turned[other as usize] = Some(wanted);
                        component.push(other);
                    }
                    Some(is) if is != wanted => return Err(shared_edge(faces, face, other)),
                    Some(_) => {}
                }
            }
            at += 1;
        }
        let count = component
            .iter()
            .filter(|&&f| turned[f as usize] == Some(true))
            .count();
        let minority = 2 * count <= component.len();
        flipped.extend(
            component
                .into_iter()
                .filter(|&f| turned[f as usize] == Some(minority)),
        );
    }
    for &face in &flipped {
        faces[face as usize].swap(1, 2);
    }
    flipped.sort_unstable();
    Ok(flipped)
}

/// Each face's neighbours over edges with two faces, and whether the two wind alike.
fn neighbours(faces: &[[u32; 3]], edges: &Edges) -> Vec<Vec<(u32, bool)>> {
    let mut neighbours = vec![Vec::new(); faces.len()];
    for edge in 0..edges.len() {
        if let [f, g] = *edges.faces_of(edge) {
            let forward = |face: u32| face_edges(faces[face as usize]).contains(&edges.ends[edge]);
            let agrees = forward(f) != forward(g);
            neighbours[f as usize].push((g, agrees));
            neighbours[g as usize].push((f, agrees));
        }
    }
    neighbours
}

fn shared_edge(faces: &[[u32; 3]], f: u32, g: u32) -> [u32; 2] {
    let other = faces[g as usize];
    face_edges(faces[f as usize])
        .into_iter()
        .find(|[a, b]| other.contains(a) && other.contains(b))
        .unwrap_or([faces[f as usize][0]; 2])
}

/// Vertices whose faces do not form one fan, as where two cones touch at their tips; ascending.
pub fn pinched_vertices(faces: &[[u32; 3]], edges: &Edges, vertex_count: usize) -> Vec<u32> {
    // The corners of a vertex are in one fan when edges at that vertex join their faces.
    let corner = |face: u32, vertex: u32| {
        let place = faces[face as usize]
            .iter()
            .position(|&v| v == vertex)
            .unwrap_or(0);
        3 * face + place as u32
    };
    let mut sets = DisjointSets::new(3 * faces.len());
    for edge in 0..edges.len() {
        for pair in edges.faces_of(edge).windows(2) {
            for vertex in edges.ends[edge] {
                sets.join(corner(pair[0], vertex), corner(pair[1], vertex));
            }
        }
    }
    let mut fan: Vec<Option<u32>> = vec![None; vertex_count];
    let mut pinched = vec![false; vertex_count];
    for (number, face) in faces.iter().enumerate() {
        for (place, &vertex) in face.iter().enumerate() {
            let root = sets.root((3 * number + place) as u32);
            match fan[vertex as usize] {
                None => fan[vertex as usize] = Some(root),
                Some(other) => pinched[vertex as usize] |= other != root,
            }
        }
    }
    (0..vertex_count as u32)
        .filter(|&v| pinched[v as usize])
        .collect()
}

/// Sets of numbers that grow together (union-find). The root of a set is its lowest member.
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every number below `count` on its own.
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
        }
    }

    /// The lowest number in the set of `item`.
    pub fn root(&mut self, item: u32) -> u32 {
        let mut at = item;
        while self.parent[at as usize] != at {
            let up = self.parent[self.parent[at as usize] as usize];
            self.parent[at as usize] = up;
            at = up;
        }
        at
    }

    /// Unites two sets; false if they were one already.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// The set of each number, sets numbered from 0 in order of lowest member, and how many sets there are.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        let mut number = vec![0; self.parent.len()];
        for item in 0..self.parent.len() as u32 {
            let root = self.root(item);
            if root == item {
                number[item as usize] = count;
                count += 1;
            } else {
                number[item as usize] = number[root as usize];
            }
        }
        (number, count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles, and a third that winds the wrong way.
    const STRIP: [[u32; 3]; 3] = [[0, 1, 2], [2, 1, 3], [2, 3, 4]];

    #[test]
    fn edges_know_their_faces() {
        let edges = edges(&STRIP);
        assert_eq!(edges.len(), 7);
        let shared: Vec<_> = (0..7)
            .filter(|&e| edges.faces_of(e).len() == 2)
            .map(|e| edges.ends[e])
            .collect();
        assert_eq!(shared, [[1, 2], [2, 3]]);
        assert!(self::edges(&[]).is_empty());
    }

    #[test]
    fn boundary_runs_as_the_faces_wind() {
        let edges = edges(&STRIP[..2]);
        let loops = chains(&boundary_edges(&STRIP[..2], &edges));
        assert_eq!(
            loops,
            [Chain {
                vertices: vec![0, 1, 3, 2],
                closed: true
            }]
        );
    }

    #[test]
    fn chains_are_open_or_closed_and_figures_of_eight_are_cut() {
        let found = chains(&[[5, 6], [6, 7], [1, 2], [2, 0], [0, 1]]);
        assert_eq!(
            found[0],
            Chain {
                vertices: vec![5, 6, 7],
                closed: false
            }
        );
        assert_eq!(
            found[1],
            Chain {
                vertices: vec![0, 1, 2],
                closed: true
            }
        );
        let eight = chains(&[[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]]);
        assert_eq!(eight.len(), 2);
        assert!(eight.iter().all(|c| c.closed && c.vertices.len() == 3));
    }

    #[test]
    fn the_minority_is_turned() {
        let mut faces = STRIP;
        faces[1].swap(0, 1);
        let edges = edges(&faces);
        assert_eq!(orient(&mut faces, &edges), Ok(vec![1]));
        let directed: Vec<_> = faces.iter().flat_map(|&f| face_edges(f)).collect();
        let distinct: std::collections::BTreeSet<_> = directed.iter().collect();
        assert_eq!(
            distinct.len(),
            directed.len(),
            "no directed edge twice: the winding agrees"
        );
    }

    #[test]
    fn a_moebius_band_has_one_side() {
        let mut band = [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [4, 5, 1], [1, 5, 0]];
        let edges = edges(&band);
        assert!(orient(&mut band, &edges).is_err());
    }

    #[test]
    fn touching_tips_are_pinched_and_apart_by_edges() {
        let faces = [[0, 1, 2], [2, 3, 4]];
        let edges = edges(&faces);
        assert_eq!(pinched_vertices(&faces, &edges, 5), [2]);
        assert_eq!(components(2, &edges), (vec![0, 1], 2));
        let strip = super::edges(&STRIP);
        assert!(pinched_vertices(&STRIP, &strip, 5).is_empty());
        assert_eq!(components(3, &strip).1, 1);
    }
}
