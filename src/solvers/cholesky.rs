use super::BlockMatrix;
use faer::sparse::{
    SymbolicSparseColMatRef,
    linalg::{
        SupernodalThreshold,
        cholesky::{CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky},
    },
};
use nalgebra::{Matrix2, Vector2};

/// The factorisation `A = L D Lᵀ` of a symmetric positive definite [`BlockMatrix`], with 2 x 2 blocks throughout.
///
/// The order of elimination (approximate minimum degree) and the places of the entries of L come from faer, once for a
/// topology. The numbers are worked out here, row by row (Davis, *Direct Methods for Sparse Linear Systems*, section 4.7,
/// up-looking, by blocks), because they must be the same bits on every processor: faer's own kernels take whatever
/// vector and fused operations the machine at hand has. Blocks of two also need a quarter of the indices.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The vertex eliminated at each place.
    vertex_at: Vec<u32>,
    /// For each place the range of its row in `entries`.
    entry_ends: Vec<u32>,
    /// Place of the column, then twice the number of the block in the matrix, odd if it has to be transposed.
    entries: Vec<[u32; 2]>,
    /// For each place the range of its row in `row_columns`: the columns of L that have an entry in that row, ascending.
    row_ends: Vec<u32>,
    row_columns: Vec<u32>,
    /// For each place the start of its column in `rows` and `values`; entries below the diagonal, rows ascending.
    column_starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<Matrix2<f64>>,
    /// D⁻¹.
    inverse: Vec<Matrix2<f64>>,
    /// How far each column is filled.
    filled: Vec<u32>,
    /// The row that is worked on.
    row: Vec<Matrix2<f64>>,
    solution: Vec<Vector2<f64>>,
}

impl Factor {
    /// Settles where the entries of L are. `None` if they are too many for the memory.
    pub fn new(matrix: &BlockMatrix) -> Option<Self> {
        let count = matrix.vertices();
        let (starts, indices) = upper_columns(matrix);
        let pattern = SymbolicSparseColMatRef::new_checked(count, count, &starts, None, &indices);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..CholeskySymbolicParams::default()
        };
        let order = SymmetricOrdering::Amd;
        let symbolic = factorize_symbolic_cholesky(pattern, faer::Side::Upper, order, parameters).ok()?;
        let SymbolicCholeskyRaw::Simplicial(lower) = symbolic.raw() else { return None };
        let (vertex_at, place_of) = symbolic.perm()?.arrays();
        let (starts, rows) = (lower.col_ptr(), lower.row_idx());
        let columns = (0..count).flat_map(|column| {
            let rows = &rows[starts[column] as usize..starts[column + 1] as usize];
            rows.iter().filter(move |row| **row as usize > column).map(move |row| [*row, column as u32])
        });
        let (row_ends, row_columns) = bucketed(count, columns);
        let transposed = columns_of(&row_ends, &row_columns);
        let (column_ends, rows) = bucketed(count, transposed.into_iter());
        let entries = matrix.couples().iter().enumerate().map(|(block, [a, b])| {
            let (a, b) = (place_of[*a as usize], place_of[*b as usize]);
            (a.max(b), [a.min(b), 2 * block as u32 + u32::from(a < b)])
        });
        let (entry_ends, entries) = bucketed_pairs(count, entries);
        let values = vec![Matrix2::zeros(); rows.len()];
        Some(Self {
            vertex_at: vertex_at.to_vec(),
            entry_ends,
            entries,
            row_ends,
            row_columns,
            column_starts: std::iter::once(0).chain(column_ends).collect(),
            rows,
            values,
            inverse: vec![Matrix2::zeros(); count],
            filled: vec![0; count],
            row: vec![Matrix2::zeros(); count],
            solution: vec![Vector2::zeros(); count],
        })
    }

    /// Factorises `A + shift W`. Rows and columns of numbers whose 1/W is zero are taken to be those of the identity.
    /// Returns whether the matrix was positive definite; if not, nothing can be solved.
    pub fn factorise(&mut self, matrix: &BlockMatrix, inverse_weight: &[f64], shift: f64) -> bool {
        let count = self.vertex_at.len();
        self.filled.copy_from_slice(&self.column_starts[..count]);
        let mut entry = 0;
        let mut column_begin = 0;
        for place in 0..count {
            let vertex = self.vertex_at[place] as usize;
            let own = free(inverse_weight, vertex);
            for &[column, block] in &self.entries[entry..self.entry_ends[place] as usize] {
                let value = &matrix.blocks()[(block >> 1) as usize];
                let value = if block & 1 == 0 { *value } else { value.transpose() };
                self.row[column as usize] =
                    masked(&value, own, free(inverse_weight, self.vertex_at[column as usize] as usize));
            }
            entry = self.entry_ends[place] as usize;
            let mut diagonal = masked(&matrix.diagonals()[vertex], own, own);
            for (axis, free) in own.into_iter().enumerate() {
                diagonal[(axis, axis)] += if free { shift / inverse_weight[2 * vertex + axis] } else { 1.0 };
            }
            let columns = column_begin..self.row_ends[place] as usize;
            column_begin = columns.end;
            for at in columns {
                let column = self.row_columns[at] as usize;
                let value = std::mem::replace(&mut self.row[column], Matrix2::zeros());
                let filled = self.filled[column] as usize;
                let above = self.column_starts[column] as usize..filled;
                for (row, lower) in self.rows[above.clone()].iter().zip(&self.values[above]) {
                    self.row[*row as usize] -= value * lower.transpose();
                }
                let lower = value * self.inverse[column];
                diagonal -= lower * value.transpose();
                self.values[filled] = lower;
                self.filled[column] += 1;
            }
            let Some(inverse) = inverse(&diagonal) else {
                self.row.fill(Matrix2::zeros());
                return false;
            };
            self.inverse[place] = inverse;
        }
        true
    }

    /// Solves `A x = b` with the last factorisation; b is flat and is overwritten with x.
    pub fn solve(&mut self, b: &mut [f64]) {
        for (value, vertex) in self.solution.iter_mut().zip(&self.vertex_at) {
            let at = 2 * *vertex as usize;
            *value = Vector2::new(b[at], b[at + 1]);
        }
        let count = self.vertex_at.len();
        let column = |place: usize| self.column_starts[place] as usize..self.column_starts[place + 1] as usize;
        for place in 0..count {
            let value = self.solution[place];
            for (row, lower) in self.rows[column(place)].iter().zip(&self.values[column(place)]) {
                self.solution[*row as usize] -= lower * value;
            }
        }
        for place in (0..count).rev() {
            let mut value = self.inverse[place] * self.solution[place];
            for (row, lower) in self.rows[column(place)].iter().zip(&self.values[column(place)]) {
                value -= lower.transpose() * self.solution[*row as usize];
            }
            self.solution[place] = value;
        }
        for (value, vertex) in self.solution.iter().zip(&self.vertex_at) {
            let at = 2 * *vertex as usize;
            (b[at], b[at + 1]) = (value.x, value.y);
        }
    }

    /// Number of blocks of L below the diagonal.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }
}

/// Which of a vertex's two numbers may change.
#[inline]
fn free(inverse_weight: &[f64], vertex: usize) -> [bool; 2] {
    [inverse_weight[2 * vertex] > 0.0, inverse_weight[2 * vertex + 1] > 0.0]
}

/// The block without the rows and columns that are not free.
#[inline]
fn masked(block: &Matrix2<f64>, rows: [bool; 2], columns: [bool; 2]) -> Matrix2<f64> {
    if rows == [true; 2] && columns == [true; 2] {
        return *block;
    }
    Matrix2::from_fn(|row, column| if rows[row] && columns[column] { block[(row, column)] } else { 0.0 })
}

/// The inverse of the symmetric part of a block, if it is positive definite.
#[inline]
fn inverse(block: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    let off = 0.5 * (block.m12 + block.m21);
    let determinant = block.m11 * block.m22 - off * off;
    let positive = block.m11 > 0.0 && determinant > 0.0 && determinant.is_finite();
    positive.then(|| Matrix2::new(block.m22, -off, -off, block.m11) / determinant)
}

/// The upper triangle by columns, with the diagonal: starts of the columns, and rows.
fn upper_columns(matrix: &BlockMatrix) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0];
    let mut indices = Vec::with_capacity(matrix.couples().len() + matrix.vertices());
    let mut couples = matrix.couples().iter().peekable();
    for column in 0..matrix.vertices() as u32 {
        while let Some([_, row]) = couples.next_if(|couple| couple[0] == column) {
            indices.push(*row);
        }
        indices.push(column);
        starts.push(indices.len() as u32);
    }
    (starts, indices)
}

/// Sorts (bucket, value) pairs into buckets, keeping their order in each: ends of the buckets, and values.
fn bucketed(count: usize, pairs: impl Iterator<Item = [u32; 2]> + Clone) -> (Vec<u32>, Vec<u32>) {
    let (ends, values) = bucketed_pairs(count, pairs.map(|[bucket, value]| (bucket, [value, 0])));
    (ends, values.into_iter().map(|[value, _]| value).collect())
}

fn bucketed_pairs(count: usize, pairs: impl Iterator<Item = (u32, [u32; 2])> + Clone) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut ends = vec![0; count];
    for (bucket, _) in pairs.clone() {
        ends[bucket as usize] += 1;
    }
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum);
    }
    let mut values = vec![[0; 2]; sum as usize];
    for (bucket, value) in pairs {
        values[ends[bucket as usize] as usize] = value;
        ends[bucket as usize] += 1;
    }
    (ends, values)
}

/// The (column, row) pairs of rows given by their ends and columns.
fn columns_of(row_ends: &[u32], row_columns: &[u32]) -> Vec<[u32; 2]> {
    let mut begin = 0;
    let mut pairs = Vec::with_capacity(row_columns.len());
    for (row, &end) in row_ends.iter().enumerate() {
        pairs.extend(row_columns[begin..end as usize].iter().map(|column| [*column, row as u32]));
        begin = end as usize;
    }
    pairs
}
