//! What depends on the pattern alone: nodes, their rows, and where every number goes.

use super::dense::{self, ROWS, SLOTS};
use super::order;
use super::shared::is_worth_sharing;
use super::tree::{NONE, Tree, places};
use crate::Mat3;
use crate::relax::block_matrix::BlockMatrix;
use std::ops::Range;

/// The plan of a factorisation.
#[derive(Clone, Debug, Default)]
pub struct Symbolic {
    /// Original index of each column, in the order of elimination.
    pub(super) order: Vec<u32>,
    /// Children before parents.
    pub(super) nodes: Vec<Node>,
    /// Rows below the triangle of each node, as original indices.
    pub(super) rows: Vec<u32>,
    /// The same rows, as places in the front of the parent.
    pub(super) places_in_parent: Vec<u32>,
    /// The blocks of A, node by node.
    pub(super) sources: Vec<Source>,
    /// Lanes of all panels.
    pub(super) panel_size: usize,
    /// Lanes of the two stacks of updates.
    pub(super) stack_sizes: [usize; 2],
    /// Strips of the largest triangle.
    pub(super) widest_strips: usize,
    /// Whether any node is worth more than one thread.
    pub(super) is_shared: bool,
    /// Indices of blocks that are taken to be zero.
    left_out: Vec<u32>,
}

/// Columns that are eliminated together.
///
/// Its front has a place for each row: first its own columns, up to a full strip, then the rows below. The panel holds
/// the strips of the front in the node's columns, strip by strip; the update the lower triangle of the rest, where strip
/// k has the columns of strips 0..=k.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Its columns in `order`.
    pub(super) columns: Range<usize>,
    /// Its part of `rows` and `places_in_parent`.
    pub(super) rows: Range<usize>,
    /// Its part of `sources`.
    pub(super) sources: Range<usize>,
    /// Its lanes of the panels.
    pub(super) panel: Range<usize>,
    /// Its lanes of the stack of updates.
    pub(super) update: Range<usize>,
    /// Which stack.
    pub(super) deep: bool,
    pub(super) first_child: u32,
    pub(super) next_sibling: u32,
}

/// Where a block of A goes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Source {
    /// Index of the block.
    pub(super) slot: u32,
    /// First of its three lanes in the panel of its node.
    pub(super) lane: u32,
    /// First of its rows in the lanes.
    pub(super) first: u8,
    pub(super) transposed: bool,
}

impl Node {
    /// Columns [blocks].
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }
}

/// Strips that the columns of a node take as rows.
pub(super) fn triangle_strips(width: usize) -> usize {
    width.div_ceil(SLOTS)
}

impl Symbolic {
    /// Orders the pattern and finds where L fills in.
    pub fn new(matrix: &BlockMatrix) -> Self {
        Self::with_order(matrix, &order::minimum_degree(matrix))
    }

    /// As [`Self::new`], for a matrix whose zero blocks stay zero, which [`Self::covers`] tells.
    ///
    /// Most places of contact are empty: a point above a face that is nearest to an edge of it or to a vertex moves
    /// two or one of its three vertices. Without them a closed valve of 10 000 faces takes 0.6 times as long.
    pub fn of_nonzero(matrix: &BlockMatrix) -> Self {
        let mut pattern = BlockMatrix {
            column_starts: vec![0],
            ..BlockMatrix::default()
        };
        let (mut kept, mut left_out) = (Vec::new(), Vec::new());
        for column in matrix.column_starts.windows(2) {
            for slot in column[0]..column[1] {
                // The shift comes to the diagonal.
                let is_needed = slot == column[0] || matrix.blocks[slot] != Mat3::zeros();
                let slots = if is_needed { &mut kept } else { &mut left_out };
                slots.push(slot as u32);
            }
            pattern.column_starts.push(kept.len());
        }
        pattern.rows = kept.iter().map(|&slot| matrix.rows[slot as usize]).collect();
        let mut symbolic = Self::new(&pattern);
        for source in &mut symbolic.sources {
            source.slot = kept[source.slot as usize];
        }
        symbolic.left_out = left_out;
        symbolic
    }

    /// Whether all blocks that the plan leaves out are zero: else it factorises another matrix.
    pub fn covers(&self, matrix: &BlockMatrix) -> bool {
        let is_zero = |&slot: &u32| matrix.blocks[slot as usize] == Mat3::zeros();
        self.left_out.iter().all(is_zero)
    }

    /// Finds where L fills in if columns are eliminated in this order, shape `[size]`.
    pub fn with_order(matrix: &BlockMatrix, order: &[u32]) -> Self {
        let tree = Tree::new(matrix, order);
        let mut symbolic = Self::default();
        symbolic.lay_out(&tree);
        symbolic.order = tree.order;
        symbolic.connect(matrix);
        symbolic
    }

    /// Order of elimination, shape `[size]`: a good one for patterns not much different.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Blocks of L, zeros that are stored included.
    pub fn fill(&self) -> usize {
        let blocks = |node: &Node| node.width() * (node.width() + 1) / 2 + node.width() * node.rows.len();
        self.nodes.iter().map(blocks).sum()
    }

    /// The nodes that leave something to a node.
    #[inline(always)]
    pub(super) fn children(&self, node: &Node) -> impl Iterator<Item = &Node> {
        let first = self.nodes.get(node.first_child as usize);
        std::iter::successors(first, |child| self.nodes.get(child.next_sibling as usize))
    }

    /// Finds the size of everything, and links children to parents.
    fn lay_out(&mut self, tree: &Tree) {
        let mut row_count = 0;
        for (columns, &height) in tree.starts.windows(2).zip(&tree.heights) {
            let columns = columns[0] as usize..columns[1] as usize;
            self.widest_strips = self.widest_strips.max(triangle_strips(columns.len()));
            let height = height as usize;
            let strips = triangle_strips(columns.len()) + height.div_ceil(SLOTS);
            let lanes = strips * 3 * columns.len();
            self.nodes.push(Node {
                columns,
                rows: row_count..row_count + height,
                sources: 0..0,
                panel: self.panel_size..self.panel_size + lanes,
                update: 0..0,
                deep: false,
                first_child: NONE,
                next_sibling: NONE,
            });
            row_count += height;
            self.panel_size += lanes;
        }
        self.rows = vec![0; row_count];
        self.places_in_parent = vec![0; row_count];
        for (index, &parent) in tree.parents.iter().enumerate().rev() {
            if parent != NONE {
                let parent = &mut self.nodes[parent as usize];
                let (deep, sibling) = (
                    !parent.deep,
                    std::mem::replace(&mut parent.first_child, index as u32),
                );
                self.nodes[index].deep = deep;
                self.nodes[index].next_sibling = sibling;
            }
        }
        self.stack_updates();
    }

    fn stack_updates(&mut self) {
        let mut ends = [0; 2];
        for index in 0..self.nodes.len() {
            // The children are taken; the first one lies lowest.
            if let Some(first) = self.nodes.get(self.nodes[index].first_child as usize) {
                ends[usize::from(first.deep)] = first.update.start;
            }
            let node = &mut self.nodes[index];
            let strips = node.rows.len().div_ceil(SLOTS);
            let stack = usize::from(node.deep);
            node.update = ends[stack]..ends[stack] + ROWS * strips * (strips + 1) / 2;
            ends[stack] = node.update.end;
            let lanes = node.panel.len() / 2 + node.update.len();
            self.is_shared |= is_worth_sharing(dense::products(lanes, 3 * node.width()));
            self.stack_sizes[stack] = self.stack_sizes[stack].max(ends[stack]);
        }
    }

    /// Finds the rows of every node, and from them where blocks and updates go.
    fn connect(&mut self, matrix: &BlockMatrix) {
        let blocks = self.distribute(matrix, &places(&self.order));
        let mut marks = vec![NONE; self.order.len()];
        let mut front = vec![0_u32; self.order.len()];
        for index in 0..self.nodes.len() {
            self.collect_rows(index, &blocks, &mut marks);
            let node = &self.nodes[index];
            for (place, column) in node.columns.clone().enumerate() {
                front[column] = place as u32;
            }
            let below = triangle_strips(node.width()) * SLOTS;
            for (place, &row) in self.rows[node.rows.clone()].iter().enumerate() {
                front[row as usize] = (below + place) as u32;
            }
            let sources = &mut self.sources[node.sources.clone()];
            for (source, block) in sources.iter_mut().zip(&blocks[node.sources.clone()]) {
                let place = front[block.row as usize] as usize;
                let column = block.column as usize - node.columns.start;
                source.lane = ((place / SLOTS * node.width() + column) * 3) as u32;
                source.first = (place % SLOTS * 3) as u8;
            }
            let mut child = node.first_child;
            while let Some(from) = self.nodes.get(child as usize) {
                for at in from.rows.clone() {
                    self.places_in_parent[at] = front[self.rows[at] as usize];
                }
                child = from.next_sibling;
            }
        }
        // Solutions look rows up by their original index.
        for row in &mut self.rows {
            *row = self.order[*row as usize];
        }
    }

    /// The rows below a node's columns: those of its blocks of A and those its children leave, in ascending order.
    fn collect_rows(&mut self, index: usize, blocks: &[Place], marks: &mut [u32]) {
        let node = &self.nodes[index];
        let end = node.columns.end as u32;
        let (done, rows) = self.rows.split_at_mut(node.rows.start);
        let mut count = 0;
        let mut add = |row: u32| {
            if row >= end && std::mem::replace(&mut marks[row as usize], index as u32) != index as u32 {
                rows[count] = row;
                count += 1;
            }
        };
        for block in &blocks[node.sources.clone()] {
            add(block.row);
        }
        let mut child = node.first_child;
        while let Some(from) = self.nodes.get(child as usize) {
            done[from.rows.clone()].iter().for_each(|&row| add(row));
            child = from.next_sibling;
        }
        debug_assert_eq!(count, node.rows.len(), "the tree has counted the same rows");
        self.rows[node.rows.clone()].sort_unstable();
    }

    /// Gives each block of A to the node of its column.
    fn distribute(&mut self, matrix: &BlockMatrix, column_places: &[u32]) -> Vec<Place> {
        let mut node_of = vec![0_u32; self.order.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            node_of[node.columns.clone()].fill(index as u32);
        }
        let mut starts = vec![0_usize; self.nodes.len() + 1];
        for column in 0..matrix.size() {
            for &row in &matrix.rows[matrix.column_starts[column]..matrix.column_starts[column + 1]] {
                let first = column_places[row as usize].min(column_places[column]);
                starts[node_of[first as usize] as usize] += 1;
            }
        }
        let mut sum = 0;
        for (node, count) in self.nodes.iter_mut().zip(&mut starts) {
            node.sources = sum..sum + *count;
            sum += *count;
            *count = node.sources.start;
        }
        let mut blocks = vec![Place::default(); matrix.rows.len()];
        self.sources = vec![Source::default(); matrix.rows.len()];
        for column in 0..matrix.size() {
            for slot in matrix.column_starts[column]..matrix.column_starts[column + 1] {
                let (i, j) = (column_places[matrix.rows[slot] as usize], column_places[column]);
                let next = &mut starts[node_of[i.min(j) as usize] as usize];
                blocks[*next] = Place {
                    row: i.max(j),
                    column: i.min(j),
                };
                self.sources[*next].slot = slot as u32;
                self.sources[*next].transposed = i < j;
                *next += 1;
            }
        }
        blocks
    }
}

/// A block of the permuted matrix.
#[derive(Clone, Copy, Default)]
struct Place {
    row: u32,
    column: u32,
}
