//! Facts about the sparse factorisation: against dense solutions, however vertices are numbered, and where there is none.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::Random;
use gingerbread::solvers::{Block, BlockMatrix, Equations, Factor, LinearSolver, Newton, SparseMatrix, Tangent};
use nalgebra::{DMatrix, DVector};

/// Couples of several shapes: none, a chain, a star, all with all, a grid, islands, and whatever chance gives.
fn patterns() -> Vec<(usize, Vec<[u32; 2]>)> {
    let mut random = Random(5);
    let grid = |n: u32| {
        let across = (0..n).flat_map(move |y| (1..n).map(move |x| [y * n + x, y * n + x - 1]));
        let up = (1..n).flat_map(move |y| (0..n).map(move |x| [y * n + x - n, y * n + x]));
        let diagonal = (1..n).flat_map(move |y| (1..n).map(move |x| [y * n + x, y * n + x - n - 1]));
        (((n * n) as usize), across.chain(up).chain(diagonal).collect::<Vec<_>>())
    };
    let mut patterns = vec![
        (1, vec![]),
        (7, vec![]),
        (40, (1..40).map(|vertex| [vertex - 1, vertex]).collect()),
        (30, (1..30).map(|vertex| [0, vertex]).collect()),
        (41, (0..41).flat_map(|a| (0..a).map(move |b| [a, b])).collect()),
        grid(3),
        grid(12),
        grid(20),
        (50, (0..50).filter(|vertex| vertex % 5 != 0).map(|vertex| [vertex, vertex - 1]).collect()),
    ];
    for count in [10_u32, 60, 150] {
        let any = |random: &mut Random| random.between(0.0, f64::from(count)) as u32;
        let pattern = (0..2 * count).map(|_| [any(&mut random), any(&mut random)]).filter(|[a, b]| a != b);
        patterns.push((count as usize, pattern.collect()));
    }
    patterns
}

/// A positive definite matrix with this pattern.
fn filled<const D: usize>(vertices: usize, pattern: &[[u32; 2]]) -> BlockMatrix<D> {
    let mut random = Random(vertices as u64);
    let mut matrix = BlockMatrix::new(vertices, pattern);
    for [a, b] in pattern {
        let block = Block::from_fn(|_, _| random.between(-1.0, 1.0));
        matrix.off_diagonal(&block);
        for vertex in [*a, *b] {
            matrix.diagonal(vertex as usize, &Block::from_diagonal_element(D as f64));
        }
    }
    for vertex in 0..vertices {
        let mut own = Block::from_diagonal_element(0.0);
        for (row, column) in (0..D).flat_map(|row| (0..row).map(move |column| (row, column))) {
            own[(row, column)] = random.between(-0.5, 0.5) / (D - 1) as f64;
            own[(column, row)] = own[(row, column)];
        }
        (0..D).for_each(|axis| own[(axis, axis)] = random.between(0.6, 1.0));
        matrix.diagonal(vertex, &own);
    }
    assert!(matrix.is_full());
    matrix
}

fn dense<const D: usize>(matrix: &BlockMatrix<D>) -> DMatrix<f64> {
    let count = D * matrix.vertices();
    DMatrix::from_columns(
        &(0..count)
            .map(|column| {
                let mut product = DVector::zeros(count);
                let unit: Vec<_> = (0..count).map(|number| f64::from(u8::from(number == column))).collect();
                matrix.add_product(&unit, product.as_mut_slice());
                product
            })
            .collect::<Vec<_>>(),
    )
}

/// The numbering of the vertices does not matter.
#[test]
fn the_factor_agrees_with_a_dense_solution() {
    check_the_factor_agrees_with_a_dense_solution::<1>();
    check_the_factor_agrees_with_a_dense_solution::<2>();
    check_the_factor_agrees_with_a_dense_solution::<3>();
}

fn check_the_factor_agrees_with_a_dense_solution<const D: usize>() {
    for (number, (vertices, couples)) in patterns().into_iter().enumerate() {
        let matrix = filled::<D>(vertices, &couples);
        let mut random = Random(number as u64);
        let b: Vec<_> = (0..D * vertices).map(|_| random.between(-1.0, 1.0)).collect();
        let expected = dense(&matrix).cholesky().unwrap().solve(&DVector::from_column_slice(&b));
        let mut factor = Factor::new(&matrix).unwrap();
        let mut first = None;
        for _ in 0..2 {
            assert!(factor.factorise(&matrix, &vec![1.0; b.len()], 0.0));
            let mut x = b.clone();
            factor.solve(&mut x);
            for (x, expected) in x.iter().zip(&expected) {
                assert!((x - expected).abs() < 1e-12, "pattern {number}: {x} instead of {expected}");
            }
            // What is left from the first time does not show.
            assert_eq!(first.get_or_insert(x.clone()), &x);
        }
        // The same matrix with vertices in another order, and couples the other way round.
        let mut place: Vec<_> = (0..vertices as u32).collect();
        for last in (1..vertices).rev() {
            place.swap(last, random.between(0.0, last as f64 + 1.0) as usize);
        }
        let renumbered: Vec<_> =
            matrix.pattern().iter().map(|[a, b]| [place[*b as usize], place[*a as usize]]).collect();
        let mut other = BlockMatrix::<D>::new(vertices, &renumbered);
        matrix.blocks().iter().for_each(|block| other.off_diagonal(&block.transpose()));
        let mut moved = vec![0.0; b.len()];
        for (vertex, block) in matrix.diagonals().iter().enumerate() {
            let to = place[vertex] as usize;
            other.diagonal(to, block);
            moved[D * to..][..D].copy_from_slice(&b[D * vertex..][..D]);
        }
        let mut factor = Factor::new(&other).unwrap();
        assert!(factor.factorise(&other, &vec![1.0; b.len()], 0.0));
        factor.solve(&mut moved);
        for (number, expected) in expected.iter().enumerate() {
            let found = moved[D * place[number / D] as usize + number % D];
            assert!((found - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn what_is_fixed_is_left_out_and_a_shift_is_added_to_the_rest() {
    check_what_is_fixed_is_left_out_and_a_shift_is_added_to_the_rest::<1>();
    check_what_is_fixed_is_left_out_and_a_shift_is_added_to_the_rest::<2>();
    check_what_is_fixed_is_left_out_and_a_shift_is_added_to_the_rest::<3>();
}

fn check_what_is_fixed_is_left_out_and_a_shift_is_added_to_the_rest<const D: usize>() {
    for (number, (vertices, pattern)) in patterns().into_iter().enumerate() {
        let matrix = filled::<D>(vertices, &pattern);
        let mut random = Random(number as u64);
        let count = D * vertices;
        let weight: Vec<_> = (0..count).map(|_| random.between(-0.5, 1.0).max(0.0)).collect();
        let b: Vec<_> = weight.iter().map(|w| if *w > 0.0 { random.between(-1.0, 1.0) } else { 0.0 }).collect();
        let whole = dense(&matrix);
        let reduced = DMatrix::from_fn(count, count, |row, column| {
            let own = if weight[row] > 0.0 { 0.3 / weight[row] } else { 1.0 };
            let entry = if weight[row] > 0.0 && weight[column] > 0.0 { whole[(row, column)] } else { 0.0 };
            entry + if row == column { own } else { 0.0 }
        });
        let expected = reduced.cholesky().unwrap().solve(&DVector::from_column_slice(&b));
        let mut factor = Factor::new(&matrix).unwrap();
        assert!(factor.factorise(&matrix, &weight, 0.3));
        let mut x = b;
        factor.solve(&mut x);
        for ((x, expected), weight) in x.iter().zip(&expected).zip(&weight) {
            assert!((x - expected).abs() < 1e-12 && (*weight > 0.0 || *x == 0.0), "pattern {number}");
        }
    }
}

/// The factor serves again afterwards.
#[test]
fn an_indefinite_matrix_is_reported() {
    check_an_indefinite_matrix_is_reported::<1>();
    check_an_indefinite_matrix_is_reported::<2>();
    check_an_indefinite_matrix_is_reported::<3>();
}

fn check_an_indefinite_matrix_is_reported<const D: usize>() {
    for (vertices, couples) in patterns() {
        let matrix = filled::<D>(vertices, &couples);
        let least = dense(&matrix).symmetric_eigenvalues().min();
        let weight = vec![1.0; D * vertices];
        let mut factor = Factor::new(&matrix).unwrap();
        assert!(factor.factorise(&matrix, &weight, -least + 1e-6));
        assert!(!factor.factorise(&matrix, &weight, -least - 1e-6));
        for vertex in (0..vertices).step_by(7) {
            for bad in [-1e6, f64::NAN] {
                let mut spoilt = matrix.clone();
                let mut block = Block::from_diagonal_element(0.0);
                block[(D - 1, D - 1)] = bad;
                spoilt.diagonal(vertex, &block);
                assert!(!factor.factorise(&spoilt, &weight, 0.0));
            }
        }
        assert!(factor.factorise(&matrix, &weight, 0.0));
    }
}

#[test]
fn a_matrix_knows_which_list_it_was_made_for() {
    for (vertices, pattern) in patterns() {
        let matrix = filled::<2>(vertices, &pattern);
        assert!(matrix.is_for(vertices, &pattern));
        assert!(!matrix.is_for(vertices + 1, &pattern));
        if let Some(([a, b], rest)) = pattern.split_first() {
            assert!(!matrix.is_for(vertices, rest));
            assert!(!matrix.is_for(vertices, &[&[[*b, *a]], rest].concat()));
        }
    }
}

#[test]
fn nothing_at_all_is_solved_too() {
    let nothing = BlockMatrix::<2>::new(0, &[]);
    let mut factor = Factor::new(&nothing).unwrap();
    assert!(factor.factorise(&nothing, &[], 0.0));
    factor.solve(&mut []);
    assert_eq!(factor.entries(), 0);
}

/// `A z = b`, with some numbers fixed.
struct Linear<const D: usize> {
    matrix: BlockMatrix<D>,
    pattern: Vec<[u32; 2]>,
    b: Vec<f64>,
    inverse_weight: Vec<f64>,
}

impl<const D: usize> Equations for Linear<D> {
    fn block_size(&self) -> usize {
        D
    }

    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        g.fill(0.0);
        self.matrix.add_product(z, g);
        for ((g, b), inverse) in g.iter_mut().zip(&self.b).zip(&self.inverse_weight) {
            *g = if *inverse == 0.0 { 0.0 } else { *g - b };
        }
    }

    fn derivative(&mut self, _: &[f64], _: Tangent, matrix: &mut dyn SparseMatrix) {
        let matrix = matrix.blocks::<D>().unwrap();
        self.matrix.diagonals().iter().enumerate().for_each(|(vertex, block)| matrix.diagonal(vertex, block));
        self.matrix.blocks().iter().for_each(|block| matrix.off_diagonal(block));
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.pattern.iter().for_each(|[a, b]| add(*a, *b));
    }

    fn inverse_weight(&self) -> &[f64] {
        &self.inverse_weight
    }

    fn other_start(&self, _: &mut [f64]) {}

    fn tolerance(&self, _: &[f64]) -> f64 {
        1e-11
    }
}

/// Any vertices may be coupled and any numbers fixed.
#[test]
fn iterations_agree_with_the_factor() {
    check_iterations_agree_with_the_factor::<1>();
    check_iterations_agree_with_the_factor::<2>();
    check_iterations_agree_with_the_factor::<3>();
}

fn check_iterations_agree_with_the_factor<const D: usize>() {
    for (number, (vertices, pattern)) in patterns().into_iter().enumerate() {
        let matrix = filled::<D>(vertices, &pattern);
        let pattern = matrix.pattern().to_vec();
        let mut random = Random(number as u64);
        let b: Vec<_> = (0..D * vertices).map(|_| random.between(-1.0, 1.0)).collect();
        for fixed in [0.0, 0.3, 1.0] {
            let inverse_weight: Vec<_> =
                b.iter().map(|_| f64::from(u8::from(random.between(0.0, 1.0) >= fixed))).collect();
            let mut equations =
                Linear { matrix: matrix.clone(), pattern: pattern.clone(), b: b.clone(), inverse_weight };
            let [direct, iterative] = [LinearSolver::Direct, LinearSolver::Iterative].map(|path| {
                let mut z = vec![0.0; b.len()];
                let counts = Newton::new(path).solve(&mut equations, &mut z);
                assert_eq!((counts.unconverged, counts.indefinite), (0, 0), "pattern {number}: {counts:?}");
                assert!(path == LinearSolver::Direct || counts.abandoned == 0, "pattern {number}: {counts:?}");
                z
            });
            for (one, other) in direct.iter().zip(&iterative) {
                assert!((one - other).abs() < 1e-10, "pattern {number}: {one} instead of {other}");
            }
        }
    }
}
