//! Fill-reducing elimination order and supernodes of a sparse Cholesky factorisation.

use super::BlockMatrix;
use std::ops::Range;

/// Relaxed supernodes: columns of L with nearly the same rows are merged, with explicit zeros: up to this many columns
/// while the fraction of zeros is at most the bound (Ashcraft and Grimes, *The influence of relaxed supernode
/// partitions on the multifrontal method*, ACM Transactions on Mathematical Software 15, 1989).
const RELAX: [(u64, f64); 4] = [(4, 0.8), (16, 0.2), (48, 0.1), (u64::MAX, 0.05)];

/// Most blocks of all panels together, about 70 GB.
const MOST: u64 = i32::MAX as u64;

/// Consecutive columns of L that share their rows below.
#[derive(Clone, Debug)]
struct Supernode {
    /// Its places in elimination order.
    places: Range<usize>,
    /// Number of rows below.
    depth: usize,
    /// Number of zeros that are stored because columns were merged.
    zeros: u64,
}

impl Supernode {
    /// Number of columns.
    const fn width(&self) -> u64 {
        (self.places.end - self.places.start) as u64
    }

    /// Merges it with its parent in the elimination tree, which begins where it ends; `None` if that takes too many
    /// zeros. Every column gets the rows of the parent.
    fn merged(&self, parent: &Self) -> Option<Self> {
        let (width, depth) = (self.width() + parent.width(), parent.depth as u64);
        let new = self.width() * (parent.width() + depth - self.depth as u64);
        let zeros = self.zeros + parent.zeros + new;
        let entries = (width * (width + 1) / 2 + width * depth) as f64;
        let relaxed = RELAX.iter().any(|(most, part)| width <= *most && zeros as f64 <= entries * part);
        let places = self.places.start..parent.places.end;
        (new == 0 || relaxed).then_some(Self { places, depth: parent.depth, zeros })
    }
}

/// Elimination order and structure of L.
#[derive(Clone, Debug)]
pub struct Supernodes {
    /// The vertex eliminated at each place.
    pub vertex_at: Vec<u32>,
    /// The place of each vertex.
    pub place_of: Vec<u32>,
    /// Supernodes by their places; each place is in one.
    nodes: Vec<Supernode>,
    /// The rows below, one supernode after the other.
    rows: Vec<u32>,
}

impl Supernodes {
    /// Analyses the pattern of a matrix; `None` if L does not fit in memory.
    ///
    /// The order is approximate minimum degree (Amestoy, Davis and Duff, *An approximate minimum degree ordering
    /// algorithm*, SIAM Journal on Matrix Analysis and Applications 17, 1996). It already follows a postorder of the
    /// assembly tree, and is not sorted again.
    pub fn new<const D: usize>(matrix: &BlockMatrix<D>) -> Option<Self> {
        let count = matrix.vertices();
        let pairs = || matrix.pattern().iter().copied().filter(|[row, column]| row != column);
        let upper = Columns::new(count, pairs())?;
        let size = u32::try_from(count).ok()?;
        let (vertex_at, place_of, _) = amd::order(size, &upper.starts, &upper.rows, &amd::Control::default()).ok()?;
        let upper = Columns::new(count, pairs().map(|pair| pair.map(|vertex| place_of[vertex as usize])))?;
        let tree = Tree::new(&upper);
        let nodes = relax(tree.supernodes(), &tree);
        let rows = rows_below(&upper, &tree, &nodes)?;
        Some(Self { vertex_at, place_of, nodes, rows })
    }

    /// Places and rows below of each supernode, the rows in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = (Range<usize>, &[u32])> {
        let mut end = 0;
        self.nodes.iter().map(move |node| {
            end += node.depth;
            (node.places.clone(), &self.rows[end - node.depth..end])
        })
    }
}

/// Upper triangle of a symmetric pattern by columns, with the diagonal.
struct Columns {
    starts: Vec<u32>,
    rows: Vec<u32>,
}

impl Columns {
    /// Sorts pairs of different places by columns, each in the order of the pairs. `None` if there are too many.
    fn new(count: usize, pairs: impl Iterator<Item = [u32; 2]> + Clone) -> Option<Self> {
        let mut starts = vec![0; count + 1];
        for [a, b] in pairs.clone() {
            starts[a.max(b) as usize + 1] += 1;
        }
        let mut end = 0_u32;
        for start in &mut starts[1..] {
            end = end.checked_add(*start)?.checked_add(1)?;
            *start = end;
        }
        let mut next = starts.clone();
        let mut rows = vec![0; end as usize];
        let diagonal = (0..count as u32).map(|place| [place; 2]);
        for [a, b] in pairs.chain(diagonal) {
            let next = &mut next[a.max(b) as usize];
            rows[*next as usize] = a.min(b);
            *next += 1;
        }
        Some(Self { starts, rows })
    }

    /// Rows of each column.
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|range| &self.rows[range[0] as usize..range[1] as usize])
    }
}

/// Elimination tree: the parent of a column is its first row below the diagonal of L (Liu, *The role of elimination
/// trees in sparse factorization*, SIAM Journal on Matrix Analysis and Applications 11, 1990).
struct Tree {
    parents: Vec<Option<u32>>,
    /// Number of rows of each column below its diagonal.
    depths: Vec<usize>,
}

impl Tree {
    /// Climbs from each entry of a column of the upper triangle to the diagonal: row k of L has entries on the paths
    /// from the entries of column k to k.
    fn new(upper: &Columns) -> Self {
        let count = upper.starts.len() - 1;
        let (mut parents, mut depths) = (vec![None; count], vec![0; count]);
        let mut seen: Vec<_> = (0..count as u32).collect();
        for (last, rows) in (0_u32..).zip(upper.iter()) {
            for row in rows {
                let mut place = *row as usize;
                while seen[place] != last {
                    seen[place] = last;
                    depths[place] += 1;
                    place = *parents[place].get_or_insert(last) as usize;
                }
            }
        }
        Self { parents, depths }
    }

    /// Fundamental supernodes: a column joins its only child right before it, if that has the same rows below it (Liu,
    /// Ng and Peyton, *On finding supernodes for sparse matrix computations*, SIAM Journal on Matrix Analysis and
    /// Applications 14, 1993).
    fn supernodes(&self) -> Vec<Supernode> {
        let mut children = vec![0_u32; self.parents.len()];
        self.parents.iter().flatten().for_each(|parent| children[*parent as usize] += 1);
        let mut nodes: Vec<Supernode> = Vec::new();
        for (place, depth) in self.depths.iter().copied().enumerate() {
            match nodes.last_mut() {
                Some(node) if self.joins(node, place + 1) && children[place] == 1 && node.depth == depth + 1 => {
                    node.places.end += 1;
                    node.depth = depth;
                }
                _ => nodes.push(Supernode { places: place..place + 1, depth, zeros: 0 }),
            }
        }
        nodes
    }

    /// Whether the parent of the last column of a supernode lies before this place.
    fn joins(&self, node: &Supernode, end: usize) -> bool {
        self.parents[node.places.end - 1].is_some_and(|parent| (parent as usize) < end)
    }
}

/// Merges each supernode with the child right before it, where that takes few zeros.
fn relax(fundamental: Vec<Supernode>, tree: &Tree) -> Vec<Supernode> {
    let mut nodes: Vec<Supernode> = Vec::new();
    for node in fundamental {
        let child = nodes.last_mut().filter(|child| tree.joins(child, node.places.end));
        match child.and_then(|child| Some((child.merged(&node)?, child))) {
            Some((merged, child)) => *child = merged,
            None => nodes.push(node),
        }
    }
    nodes
}

/// Rows below of all supernodes: the climb of [`Tree::new`], from supernode to supernode. `None` if L does not fit.
fn rows_below(upper: &Columns, tree: &Tree, nodes: &[Supernode]) -> Option<Vec<u32>> {
    let mut own = vec![0; tree.parents.len()];
    let mut next = Vec::with_capacity(nodes.len());
    let (mut total, mut size) = (0, 0_u64);
    for (number, node) in nodes.iter().enumerate() {
        own[node.places.clone()].fill(number);
        next.push(total);
        total += node.depth;
        let panel = node.width().checked_mul(node.width() + node.depth as u64)?;
        size = size.checked_add(panel).filter(|size| *size <= MOST)?;
    }
    let parent = |node: &Supernode| tree.parents[node.places.end - 1].map(|place| own[place as usize]);
    let parents: Vec<_> = nodes.iter().map(parent).collect();
    let mut rows = Vec::new();
    rows.try_reserve_exact(total).ok()?;
    rows.resize(total, 0);
    let mut seen = vec![u32::MAX; nodes.len()];
    for ((last, of), column) in (0_u32..).zip(&own).zip(upper.iter()) {
        seen[*of] = last;
        for row in column {
            let mut node = own[*row as usize];
            while seen[node] != last {
                seen[node] = last;
                rows[next[node]] = last;
                next[node] += 1;
                node = parents[node]?;
            }
        }
    }
    Some(rows)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::expect_used, reason = "a failing test should panic")]

    use super::*;
    use crate::random::irregular;
    use std::collections::BTreeSet;

    /// Pairs of a random pattern: most near each other, some vertices without any.
    fn random_pairs(seed: u64, vertices: usize) -> Vec<[u32; 2]> {
        let number = |n: u64, bound: usize| (f64::midpoint(irregular(1000 * seed + n), 1.0) * bound as f64) as u32;
        let pair = |n: u64| {
            let first = number(2 * n, vertices);
            [first, (first + number(2 * n + 1, 9)) % vertices as u32]
        };
        (0..2 * vertices as u64).map(pair).filter(|[a, b]| a != b).collect()
    }

    /// Rows below the diagonal of each column of L, by elimination of one place after the other.
    fn columns(found: &Supernodes, pairs: &[[u32; 2]]) -> Vec<BTreeSet<u32>> {
        let mut columns = vec![BTreeSet::new(); found.vertex_at.len()];
        for [a, b] in pairs.iter().map(|pair| pair.map(|vertex| found.place_of[vertex as usize])) {
            columns[a.min(b) as usize].insert(a.max(b));
        }
        for place in 0..columns.len() {
            let mut rows = columns[place].clone();
            if let Some(parent) = rows.pop_first() {
                columns[parent as usize].extend(rows);
            }
        }
        columns
    }

    #[test]
    fn supernodes_contain_exact_structure() {
        for seed in 0..60 {
            let vertices = 2 * seed as usize;
            let pairs = random_pairs(seed, vertices);
            let found = Supernodes::new(&BlockMatrix::<1>::new(vertices, &pairs)).expect("fits");
            for (place, vertex) in found.vertex_at.iter().enumerate() {
                assert_eq!(found.place_of[*vertex as usize] as usize, place);
            }
            let exact = columns(&found, &pairs);
            let mut end = 0;
            for (places, rows) in found.iter() {
                assert_eq!(places.start, end);
                end = places.end;
                assert!(exact[end - 1].iter().eq(rows));
                for place in places {
                    let inside = |row: &u32| (*row as usize) < end || rows.contains(row);
                    assert!(exact[place].iter().all(inside));
                }
            }
            assert_eq!(end, vertices);
        }
    }

    #[test]
    fn merging_has_bounds() {
        let node = |places, depth| Supernode { places, depth, zeros: 0 };
        // The same rows: no zeros at any width.
        assert!(node(0..100, 7).merged(&node(100..105, 2)).is_some());
        // 2 zeros of 9 entries, and 8 of 25.
        assert!(node(0..2, 1).merged(&node(2..3, 1)).is_some_and(|merged| merged.zeros == 2));
        assert!(node(0..4, 1).merged(&node(4..5, 2)).is_none());
    }
}
