use super::*;
use crate::Vec3;
use crate::test_numbers::Numbers;
use nalgebra::{DMatrix, DVector};

fn add(matrix: &mut BlockMatrix, row: u32, column: u32, block: &Mat3) {
    let slot = matrix.slot(row, column).expect("in the pattern");
    matrix.add_at(slot, row < column, block);
}

/// Positive definite by dominance of the diagonal.
fn fill(size: usize, places: Vec<[u32; 2]>, numbers: &mut Numbers) -> BlockMatrix {
    let mut matrix = BlockMatrix::with_pattern(size, &places);
    for [row, column] in places.into_iter().filter(|[row, column]| row != column) {
        add(&mut matrix, row, column, &Mat3::from_fn(|_, _| numbers.next()));
        for end in [row, column] {
            add(&mut matrix, end, end, &Mat3::from_diagonal_element(3.0));
        }
    }
    for index in 0..size as u32 {
        let block = Mat3::from_fn(|_, _| numbers.next());
        let positive = block * block.transpose() + Mat3::identity() * 0.1;
        add(&mut matrix, index, index, &positive);
    }
    matrix
}

/// Patterns of every kind: none, alone, sparse enough to fall apart, meshes, dense.
fn matrices() -> Vec<BlockMatrix> {
    let mut numbers = Numbers(1);
    let mut matrices = Vec::new();
    for size in [0, 1, 2, 3, 4, 5, 9, 33, 50, 120, 200] {
        for density in [0, 1, 3, 8] {
            let count = if size == 0 { 0 } else { density * size / 2 };
            let places = (0..count)
                .map(|_| [numbers.below(size), numbers.below(size)])
                .collect();
            matrices.push(fill(size, places, &mut numbers));
        }
    }
    // One chunk of columns, one and a part, exactly two, and more.
    for size in [7, 40, 64, 70] {
        let places = (0..size).flat_map(|i| (0..i).map(move |j| [i, j])).collect();
        matrices.push(fill(size as usize, places, &mut numbers));
    }
    matrices
}

fn grid(side: usize) -> BlockMatrix {
    let index = |x: usize, y: usize| (y * side + x) as u32;
    let mut places = Vec::new();
    for y in 0..side {
        for x in 0..side {
            let ends = [(x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let inside = ends.into_iter().filter(|&(x, y)| x < side && y < side);
            places.extend(inside.map(|(i, j)| [index(x, y), index(i, j)]));
        }
    }
    fill(side * side, places, &mut Numbers(2))
}

fn dense(matrix: &BlockMatrix, shift: &[f64]) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(3 * matrix.size(), 3 * matrix.size());
    for column in 0..matrix.size() {
        for slot in matrix.column_starts[column]..matrix.column_starts[column + 1] {
            let row = matrix.rows[slot] as usize;
            dense
                .fixed_view_mut::<3, 3>(3 * row, 3 * column)
                .copy_from(&matrix.blocks[slot]);
            let transposed = matrix.blocks[slot].transpose();
            dense
                .fixed_view_mut::<3, 3>(3 * column, 3 * row)
                .copy_from(&transposed);
        }
    }
    for (index, shift) in shift.iter().enumerate() {
        (0..3).for_each(|axis| dense[(3 * index + axis, 3 * index + axis)] += shift);
    }
    dense
}

/// Relative residual of a solution.
fn residual(matrix: &BlockMatrix, shift: &[f64], x: &[Vec3], right: &[Vec3]) -> f64 {
    let mut product = vec![Vec3::zeros(); x.len()];
    matrix.multiply_into(x, &mut product);
    let rows = x.iter().zip(shift).zip(product.iter().zip(right));
    let squared: f64 = rows
        .map(|((x, shift), (product, b))| (product + x * *shift - b).norm_squared())
        .sum();
    (squared / right.iter().map(Vec3::norm_squared).sum::<f64>()).sqrt()
}

/// The condition of these matrices is below 1e4: rounding (1e-16) leaves a good margin to 1e-11.
#[test]
fn agrees_with_a_dense_factorisation() {
    let mut numbers = Numbers(3);
    for matrix in matrices() {
        let size = matrix.size();
        let shift: Vec<f64> = (0..size).map(|_| 1.0 + numbers.next()).collect();
        let right = numbers.vectors(size);
        let symbolic = Symbolic::new(&matrix);
        let factor = symbolic.factor(&matrix, &shift).expect("positive definite");
        let x = symbolic.solve(&factor, &right);
        let flat = DVector::from_iterator(3 * size, right.iter().flat_map(|b| b.iter().copied()));
        let expected = nalgebra::Cholesky::new(dense(&matrix, &shift))
            .expect("positive definite")
            .solve(&flat);
        for (index, x) in x.iter().enumerate() {
            for axis in 0..3 {
                let (found, expected) = (x[axis], expected[3 * index + axis]);
                assert!(
                    (found - expected).abs() <= 1e-11 * expected.abs().max(1.0),
                    "{size}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn any_order_gives_the_same_solution() {
    let mut numbers = Numbers(4);
    for matrix in matrices() {
        let size = matrix.size();
        let mut order: Vec<u32> = (0..size as u32).collect();
        for index in (1..size).rev() {
            order.swap(index, numbers.below(index + 1) as usize);
        }
        let (shift, right) = (vec![0.0; size], numbers.vectors(size));
        let solution = |symbolic: Symbolic| {
            let factor = symbolic.factor(&matrix, &shift).expect("positive definite");
            symbolic.solve(&factor, &right)
        };
        let pair = [Symbolic::with_order(&matrix, &order), Symbolic::new(&matrix)].map(solution);
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            // As above.
            assert!((a - b).norm() <= 1e-11 * a.norm().max(1.0));
        }
    }
}

#[test]
fn blocks_that_are_zero_can_be_left_out() {
    let full = grid(12);
    let unneeded = (0..140).map(|index| [index, index + 4]);
    let mut matrix = BlockMatrix::with_pattern(144, &full.places().chain(unneeded).collect::<Vec<_>>());
    for column in 0..144 {
        for slot in full.column_starts[column]..full.column_starts[column + 1] {
            add(&mut matrix, full.rows[slot], column as u32, &full.blocks[slot]);
        }
    }
    let symbolic = Symbolic::of_nonzero(&matrix);
    let shift = vec![0.5; 144];
    let panels = |symbolic: &Symbolic, matrix| {
        let factor = symbolic.factor(matrix, &shift);
        factor.expect("positive definite").panels
    };
    // Not only nearly: they are the same sums.
    assert_eq!(panels(&symbolic, &matrix), panels(&Symbolic::new(&full), &full));
    assert!(symbolic.covers(&matrix));
    add(&mut matrix, 77, 73, &Mat3::identity());
    assert!(!symbolic.covers(&matrix));
}

#[test]
fn a_pivot_that_is_not_positive_is_an_error() {
    let matrix = grid(12);
    let symbolic = Symbolic::new(&matrix);
    for bad in [0, 77, 143] {
        for value in [-1e3, f64::NAN, f64::NEG_INFINITY, f64::INFINITY] {
            let mut shift = vec![0.0; matrix.size()];
            shift[bad] = value;
            let error = symbolic.factor(&matrix, &shift).err();
            assert_eq!(error, Some(NotPositiveDefinite { row: bad as u32 }), "{value}");
        }
    }
    let zero = BlockMatrix::with_pattern(1, &[]);
    let symbolic = Symbolic::new(&zero);
    assert_eq!(
        symbolic.factor(&zero, &[0.0]).err(),
        Some(NotPositiveDefinite { row: 0 })
    );
    assert!(symbolic.factor(&zero, &[1e-7]).is_ok());
}

#[test]
fn a_factor_is_filled_again_without_allocation_and_to_the_last_bit() {
    let matrix = grid(20);
    let symbolic = Symbolic::new(&matrix);
    let shift = vec![0.5; matrix.size()];
    let mut factor = symbolic.factor(&matrix, &shift).expect("positive definite");
    let first = factor.panels.clone();
    let addresses = |factor: &Factor| {
        let [even, odd] = &factor.updates;
        [factor.panels.as_ptr(), even.as_ptr(), odd.as_ptr()]
    };
    let before = addresses(&factor);
    let other = vec![7.0; matrix.size()];
    assert_eq!(symbolic.factor_into(&matrix, &other, &mut factor), Ok(()));
    assert_ne!(factor.panels, first);
    assert_eq!(symbolic.factor_into(&matrix, &shift, &mut factor), Ok(()));
    assert_eq!(factor.panels, first);
    assert_eq!(addresses(&factor), before);
}

/// Backward stable: some hundred roundings of 1e-16, on a grid of 10 000 block rows.
#[test]
fn a_large_grid_is_solved_to_rounding() {
    let matrix = grid(100);
    let (shift, right) = (vec![0.0; matrix.size()], Numbers(5).vectors(matrix.size()));
    let symbolic = Symbolic::new(&matrix);
    let factor = symbolic.factor(&matrix, &shift).expect("positive definite");
    let error = residual(&matrix, &shift, &symbolic.solve(&factor, &right), &right);
    assert!(error < 1e-12, "{error:e}");
}

/// A grid, whose nodes leave large updates, and a dense matrix, whose only node is large.
#[test]
fn any_number_of_threads_gives_the_same_to_the_last_bit() {
    let everywhere: Vec<[u32; 2]> = (0..250).flat_map(|i| (0..i).map(move |j| [i, j])).collect();
    for matrix in [grid(100), fill(250, everywhere, &mut Numbers(6))] {
        let symbolic = Symbolic::new(&matrix);
        assert!(symbolic.is_shared);
        let shift = vec![0.0; matrix.size()];
        let panels = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let factor = pool
                .expect("threads")
                .install(|| symbolic.factor(&matrix, &shift));
            factor.expect("positive definite").panels
        };
        let one = panels(1);
        assert!([2, 5].into_iter().all(|threads| panels(threads) == one));
    }
}

/// The instructions chosen for this machine and those for any agree but for rounding.
#[test]
fn machines_without_fused_arithmetic_get_the_same() {
    let matrix = grid(20);
    let symbolic = Symbolic::new(&matrix);
    let shift = vec![0.0; matrix.size()];
    let fused = symbolic.factor(&matrix, &shift).expect("positive definite");
    let mut plain = fused.clone();
    let factorisation = Factorisation {
        symbolic: &symbolic,
        matrix: &matrix,
        shift: &shift,
        factor: &mut plain,
    };
    assert_eq!(factorisation.run::<false>(), Ok(()));
    for (a, b) in fused
        .panels
        .as_flattened()
        .iter()
        .zip(plain.panels.as_flattened())
    {
        // Entries are of order one.
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}
