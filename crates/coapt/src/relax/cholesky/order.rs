//! Orders of elimination that keep the fill small.

use crate::relax::block_matrix::BlockMatrix;

/// Approximate minimum degree.
pub fn minimum_degree(matrix: &BlockMatrix) -> Vec<u32> {
    let size = matrix.size();
    let starts: Vec<i64> = matrix.column_starts.iter().map(|&start| start as i64).collect();
    let rows: Vec<i64> = matrix.rows.iter().map(|&row| i64::from(row)).collect();
    match amd::order(size as i64, &starts, &rows, &amd::Control::default()) {
        Ok((order, _, _)) => order.into_iter().map(|index| index as u32).collect(),
        // The pattern is valid by construction; the natural order is right in any case, only slower.
        Err(_) => (0..size as u32).collect(),
    }
}
