//! Which columns are eliminated together, and in what order.
//!
//! The elimination tree (Liu 1990) says which columns must wait for which; columns with nearly the same rows are merged
//! into nodes (Ashcraft & Grimes 1989) as long as the arithmetic on zeros costs less than what the merging saves.

use crate::relax::block_matrix::BlockMatrix;

/// No node, no column.
pub(super) const NONE: u32 = u32::MAX;

/// Columns in the order of elimination, grouped into nodes, children before parents.
pub(super) struct Tree {
    /// Original index of each column.
    pub(super) order: Vec<u32>,
    /// Where each node's columns start in `order`, shape `[node + 1]`.
    pub(super) starts: Vec<u32>,
    /// Parent of each node; [`NONE`] at a root.
    pub(super) parents: Vec<u32>,
    /// How many blocks each node's columns have below its triangle, shape `[node]`.
    pub(super) heights: Vec<u32>,
}

impl Tree {
    /// Keeps the given order of elimination but for reorderings that do not change the fill.
    pub(super) fn new(matrix: &BlockMatrix, order: &[u32]) -> Self {
        let left = LeftPattern::new(matrix, order);
        let parents = elimination_tree(&left);
        let counts = column_counts(&left, &parents);
        let merged = merge(&parents, &counts);
        collect(order, &parents, &counts, &merged)
    }
}

/// The inverse of a permutation.
pub(super) fn places(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        places[old as usize] = new as u32;
    }
    places
}

/// For each permuted row, the columns left of the diagonal.
struct LeftPattern {
    starts: Vec<u32>,
    columns: Vec<u32>,
}

impl LeftPattern {
    fn new(matrix: &BlockMatrix, order: &[u32]) -> Self {
        let places = places(order);
        let each = |take: &mut dyn FnMut(u32, u32)| {
            for column in 0..matrix.size() {
                let range = matrix.column_starts[column] + 1..matrix.column_starts[column + 1];
                for &row in &matrix.rows[range] {
                    let (i, j) = (places[row as usize], places[column]);
                    take(i.max(j), i.min(j));
                }
            }
        };
        let mut starts = vec![0; order.len() + 1];
        each(&mut |row, _| starts[row as usize] += 1);
        // Ends first; filling from the back leaves the starts.
        for row in 0..order.len() {
            starts[row + 1] += starts[row];
        }
        let mut columns = vec![0; matrix.rows.len() - order.len()];
        each(&mut |row, column| {
            starts[row as usize] -= 1;
            columns[starts[row as usize] as usize] = column;
        });
        Self { starts, columns }
    }

    fn of_row(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

/// Davis 2006, section 4.1: the parent of a column is the first row below it in L.
fn elimination_tree(left: &LeftPattern) -> Vec<u32> {
    let size = left.starts.len() - 1;
    let mut parents = vec![NONE; size];
    let mut ancestors = vec![NONE; size];
    for row in 0..size {
        for &column in left.of_row(row) {
            let mut node = column;
            while node != NONE && node as usize != row {
                let next = std::mem::replace(&mut ancestors[node as usize], row as u32);
                if next == NONE {
                    parents[node as usize] = row as u32;
                }
                node = next;
            }
        }
    }
    parents
}

/// How many blocks each column of L has below its diagonal: a row has one in every column on the way up the tree from
/// its blocks in A.
fn column_counts(left: &LeftPattern, parents: &[u32]) -> Vec<u32> {
    let mut counts = vec![0; parents.len()];
    let mut marks = vec![NONE; parents.len()];
    for row in 0..parents.len() {
        marks[row] = row as u32;
        for &column in left.of_row(row) {
            let mut node = column as usize;
            while marks[node] != row as u32 {
                marks[node] = row as u32;
                counts[node] += 1;
                node = parents[node] as usize;
            }
        }
    }
    counts
}

/// What a node of so many columns and so many rows below them costs [cycles], but for what is the same for any grouping:
/// products of blocks, the addition of what it leaves to its parent, and a constant. Estimates for Zen 4. Nine sets of the
/// three and of a price per block stored, within a factor of two or so, could not be told apart by time: 302 to 317 µs
/// at 650 faces and 37 to 40 ms at 10 000, within the noise.
fn cost(width: f64, height: f64) -> f64 {
    // The last strip is not full.
    let padded = height + 1.5;
    let products = width * padded * (padded + width) / 2.0 + width.powi(3) / 6.0;
    4.0 * products + 4.0 * padded * padded + 400.0
}

/// For each column, the last column of the node it is merged into.
fn merge(parents: &[u32], counts: &[u32]) -> Vec<u32> {
    let mut widths = vec![1_u32; parents.len()];
    let mut merged: Vec<u32> = (0..parents.len() as u32).collect();
    for column in 0..parents.len() {
        let parent = parents[column];
        if parent == NONE {
            continue;
        }
        let [width, parent_width] = [widths[column], widths[parent as usize]].map(f64::from);
        let [height, parent_height] = [counts[column], counts[parent as usize]].map(f64::from);
        let apart = cost(width, height) + cost(parent_width, parent_height);
        let together = cost(width + parent_width, parent_height);
        if together <= apart {
            widths[parent as usize] += widths[column];
            merged[column] = parent;
        }
    }
    for column in (0..parents.len()).rev() {
        merged[column] = merged[merged[column] as usize];
    }
    merged
}

/// Numbers nodes and columns so that a node's columns follow each other and children come before parents.
fn collect(order: &[u32], parents: &[u32], counts: &[u32], merged: &[u32]) -> Tree {
    let size = order.len();
    let mut members = Lists::new(size);
    for column in (0..size as u32).rev() {
        members.push(merged[column as usize], column);
    }
    let parent_of = |top: u32| match parents[top as usize] {
        NONE => NONE,
        parent => merged[parent as usize],
    };
    let tops = children_first(merged, parent_of);
    let mut numbers = vec![NONE; size];
    let mut tree = Tree {
        order: Vec::with_capacity(size),
        starts: vec![0],
        parents: Vec::new(),
        heights: tops.iter().map(|&top| counts[top as usize]).collect(),
    };
    for (number, &top) in tops.iter().enumerate() {
        numbers[top as usize] = number as u32;
        while let Some(column) = members.pop(top) {
            tree.order.push(order[column as usize]);
        }
        tree.starts.push(tree.order.len() as u32);
    }
    let number_of = |top: u32| numbers.get(top as usize).copied().unwrap_or(NONE);
    let parents = tops.iter().map(|&top| number_of(parent_of(top)));
    tree.parents = parents.collect();
    tree
}

/// The last columns of all nodes, children before parents and each subtree in one piece.
fn children_first(merged: &[u32], parent_of: impl Fn(u32) -> u32) -> Vec<u32> {
    let mut children = Lists::new(merged.len());
    let mut path = Vec::new();
    let is_top = |column: &u32| merged[*column as usize] == *column;
    for top in (0..merged.len() as u32).rev().filter(is_top) {
        match parent_of(top) {
            NONE => path.push(top),
            parent => children.push(parent, top),
        }
    }
    let mut tops = Vec::new();
    while let Some(&top) = path.last() {
        match children.pop(top) {
            Some(child) => path.push(child),
            None => {
                path.pop();
                tops.push(top);
            }
        }
    }
    tops
}

/// Stacks of small numbers, chained through one array.
struct Lists {
    first: Vec<u32>,
    next: Vec<u32>,
}

impl Lists {
    fn new(size: usize) -> Self {
        Self {
            first: vec![NONE; size],
            next: vec![NONE; size],
        }
    }

    fn push(&mut self, list: u32, item: u32) {
        self.next[item as usize] = std::mem::replace(&mut self.first[list as usize], item);
    }

    fn pop(&mut self, list: u32) -> Option<u32> {
        let item = self.first[list as usize];
        (item != NONE).then(|| {
            self.first[list as usize] = self.next[item as usize];
            item
        })
    }
}
