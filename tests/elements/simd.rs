//! What steps eight triangles or springs at a time is what the formula says for one, to the last bit.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, greatest_gap, level, one_by_one, rotation, simulation};
use gingerbread::{
    effects::{Effect, Motion},
    materials::{Material, Model, Parts, Visitor, with_eigenvalues},
    simd::{LANES, Mat2, Order, Quads, Real, Wide, sets},
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
};
use nalgebra::{Matrix2, Vector4};
use pulp::{Arch, Scalar, Simd, WithSimd};

/// Numbers of every size and kind: whole range of exponents, dense near 1, subnormal, special.
fn numbers() -> Vec<f64> {
    let mut random = Random(1);
    let mut numbers = vec![0.0, -0.0, 1.0, -1.0, 2.0, 0.5, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX];
    numbers.extend([f64::MIN_POSITIVE, f64::from_bits(1), f64::from_bits(0x000f_ffff_ffff_ffff), -f64::from_bits(7)]);
    numbers.extend([f64::MIN_POSITIVE.next_down(), 1.0_f64.next_up(), 1.0_f64.next_down(), 0.5_f64.sqrt(), -f64::MAX]);
    for exponent in -1074..1024 {
        numbers.push(random.between(1.0, 2.0) * 2.0_f64.powi(exponent));
        numbers.push(1.0 + random.between(-1.0, 1.0) * 2.0_f64.powi(-(exponent.abs() % 53)));
    }
    numbers.extend((0..20_000).map(|_| random.between(0.5, 2.0)));
    numbers.extend((0..20_000).map(|_| f64::from_bits(random.between(0.0, 1.8e19) as u64)));
    numbers.resize(numbers.len().next_multiple_of(LANES), 1.0);
    numbers
}

#[test]
fn the_logarithm_has_the_bits_of_libm_over_the_whole_range() {
    struct Logs<'a>(&'a [[f64; LANES]]);
    impl WithSimd for Logs<'_> {
        type Output = [Vec<f64>; 2];
        #[inline(always)]
        fn with_simd<S: Simd>(self, set: S) -> Self::Output {
            let [mut logs, mut of_normal] = [(); 2].map(|()| vec![[0.0; LANES]; self.0.len()]);
            for ((log, of_normal), x) in logs.iter_mut().zip(&mut of_normal).zip(self.0) {
                for part in 0..Wide::<S>::PARTS {
                    Wide::load(set, x, part).logarithm().store(log, part);
                    Wide::load(set, x, part).logarithm_of_normal().store(of_normal, part);
                }
            }
            [logs.into_flattened(), of_normal.into_flattened()]
        }
    }
    let numbers = numbers();
    for set in sets() {
        let [wide, wide_of_normal] = set.dispatch(Logs(numbers.as_chunks().0));
        for (x, (wide, wide_of_normal)) in numbers.iter().zip(wide.into_iter().zip(wide_of_normal)) {
            let (one, expected) = (x.logarithm(), libm::log(*x));
            let same = |log: f64| log.to_bits() == expected.to_bits() || (log.is_nan() && expected.is_nan());
            assert!(same(one) && same(wide), "ln {x:e} = {expected:e}, not {one:e} or {wide:e}");
            let of_normal = x.logarithm_of_normal();
            let any = !(x.is_normal() && *x > 0.0);
            assert!(any || same(of_normal) && same(wide_of_normal), "ln {x:e}: {of_normal:e} or {wide_of_normal:e}");
        }
    }
}

#[test]
fn eight_elements_are_found_where_the_order_says() {
    fn check<S: Simd>(set: S, order: Order) {
        let quads: Quads = std::array::from_fn(|element| [0, 10, 20, 30].map(|number| (number + element) as f64));
        let (mut lanes, mut pairs, mut stored) = ([[0.0; LANES]; 4], [[0.0; 2]; LANES], Quads::default());
        for part in 0..Wide::<S>::PARTS {
            let loaded = Wide::load_quads(set, &quads, part);
            loaded.iter().zip(&mut lanes).for_each(|(loaded, lanes)| loaded.store(lanes, part));
            Wide::store_pairs(loaded[1], loaded[2], &mut pairs, part);
            Wide::store_quads(loaded, &mut stored, part);
        }
        for element in 0..LANES {
            let read = lanes.map(|lanes| lanes[order.lane[element]]);
            assert_eq!(read, quads[element]);
            assert_eq!(pairs[order.place[element]], [quads[element][1], quads[element][2]]);
            assert_eq!(stored[order.quad[element]], quads[element]);
        }
    }
    struct Check(Order);
    impl WithSimd for Check {
        type Output = ();
        fn with_simd<S: Simd>(self, set: S) {
            check(set, self.0);
        }
    }
    for set in sets() {
        set.dispatch(Check(Order::new(set)));
    }
    let natural = std::array::from_fn(|element| element);
    check(Scalar, Order { set: Arch::Scalar, lane: natural, place: natural, quad: natural });
}

/// A sheet of 2 x 5 x 7 triangles, which leaves lanes over, of every model and for each map of its points.
fn for_every_sheet(mut check: impl FnMut(&Simulation, &[f64], Model)) {
    let mut random = Random(2);
    let far = random.gradient(0.3, 3.0);
    let maps = [Matrix2::identity(), rotation(2.0), rotation(-0.7) * 1.5, Matrix2::new(1.2, 0.0, 0.0, 1.0), far];
    let exact = [Model::NeoHookean, Model::FixedCorotated].map(|model| (model, "StressExact"));
    for (model, plane) in Model::ALL.iter().map(|model| (*model, "Strain")).chain(exact) {
        for (map, noise) in maps.iter().flat_map(|map| [0.0, 1e-9, 0.01].map(|noise| (map, noise))) {
            let simulation = simulation(&crate::common::level(&format!(
                "(name: \"\", bodies: [(name: \"\", mass: Density(1), material: (model: {}, young: 100, poisson: 0.3, plane: {plane}),
                  mesh: Rectangle(width: 0.5, height: 0.7, columns: 5, rows: 7, diagonals: Alternating))])",
                model.name()
            )));
            let rest = simulation.scene().rest.chunks_exact(2);
            let x: Vec<_> = rest
                .flat_map(|point| [0, 1].map(|row| map[(row, 0)] * point[0] + map[(row, 1)] * point[1]))
                .map(|coordinate| coordinate + random.between(-noise, noise))
                .collect();
            check(&simulation, &x, model);
        }
    }
}

#[test]
fn swept_triangles_match_single_ones_for_every_model() {
    for_every_sheet(|simulation, x, model| {
        let elements = &simulation.scene().bodies[0].elements;
        let (energy, expected) = one_by_one(simulation, x);
        let motion =
            Motion { dimension: 2, x, v: x, mass: &simulation.scene().mass, inverse_mass: &[], ..Motion::NONE };
        let (mut scratch, mut force) = (vec![f64::NAN; elements.scratch()], vec![0.0; x.len()]);
        elements.force(motion, &mut scratch, &mut force);
        // Stresses of 100 Pa on edges of 0.1 m.
        assert!(force.iter().all(|force| force.is_finite()), "what was in scratch is of no matter");
        let error = greatest_gap(&force, &expected);
        let scale = expected.iter().fold(10.0, |most: f64, force| most.max(force.abs()));
        assert!(error < 1e-14 * scale, "{}: {error:e} of {scale}", model.title());
        let found = elements.energy(motion);
        assert!((found - energy).abs() <= 1e-13 * energy.abs().max(1.0), "{}: {found} against {energy}", model.title());
    });
}

/// Forces, energy and stiffness times a displacement, bit by bit.
fn bits_of(elements: &dyn Effect, motion: Motion<'_>) -> Vec<u64> {
    let mut random = Random(6);
    let (mut scratch, mut force) = (vec![f64::NAN; elements.scratch()], vec![0.0; motion.x.len()]);
    elements.force(motion, &mut scratch, &mut force);
    let mut pattern = Vec::new();
    elements.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
    let mut matrix = BlockMatrix::<2>::new(motion.x.len() / 2, &pattern);
    matrix.clear();
    elements.add_stiffness(motion, Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Definite }, &mut matrix);
    let d: Vec<_> = motion.x.iter().map(|_| random.between(-1.0, 1.0)).collect();
    let mut product = vec![0.0; d.len()];
    matrix.add_product(&d, &mut product);
    let mut change = vec![0.0; d.len()];
    elements.stiffness_times(motion, &d, &mut scratch, &mut change);
    force
        .iter()
        .chain(&product)
        .chain(&change)
        .chain([&elements.energy(motion)])
        .map(|number| number.to_bits())
        .collect()
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    assert!(sets().len() > 1 || !cfg!(target_arch = "x86_64"), "beside plain numbers there should be lanes");
    for_every_sheet(|simulation, x, model| {
        let motion =
            Motion { dimension: 2, x, v: x, mass: &simulation.scene().mass, inverse_mass: &[], ..Motion::NONE };
        let plain = bits_of(&simulation.scene().bodies[0].elements.in_set(Arch::Scalar), motion);
        for set in sets() {
            let found = bits_of(&simulation.scene().bodies[0].elements.in_set(set), motion);
            assert_eq!(found, plain, "{} with {set:?}", model.title());
        }
    });
    let net = simulation(&level(
        "(name: \"net\", nets: [(name: \"net\", mass: 0.001, net: Sheet(width: 1, height: 1, columns: 37, rows: 41, structural: 100,
          shear: 50, flexion: 20, corner: (0, 0)))])",
    ));
    let (mut random, scene) = (Random(7), net.scene());
    let x: Vec<_> = scene.rest.iter().map(|x| x + random.between(-0.02, 0.02)).collect();
    let motion = Motion { dimension: 2, x: &x, v: &x, mass: &scene.mass, inverse_mass: &[], ..Motion::NONE };
    let plain = bits_of(&scene.nets[0].springs.plane().unwrap().in_set(Arch::Scalar), motion);
    for set in sets() {
        assert_eq!(bits_of(&scene.nets[0].springs.plane().unwrap().in_set(set), motion), plain, "springs with {set:?}");
    }
}

/// The triangles may have any order.
/// Far more triangles than are kept before their forces are summed: row by row, in an order in which neighbours are far apart, and all
/// around one vertex, which waits for the last of them.
#[test]
fn forces_of_a_large_mesh_match_single_triangles() {
    let (rows, side) = (60, 61);
    let points: Vec<_> = (0..side * side).map(|i| (f64::from(i % side), f64::from(i / side))).collect();
    let square = |i: u32| {
        let corner = i / rows * side + i % rows;
        [(corner, corner + 1, corner + side), (corner + 1, corner + side + 1, corner + side)]
    };
    let by_row: Vec<_> = (0..rows * rows).flat_map(square).collect();
    // 2053 is a prime that does not divide their number: every triangle comes once.
    let scattered: Vec<_> = (0..by_row.len()).map(|i| by_row[i * 2053 % by_row.len()]).collect();
    // So many that the last and the hub are farther from each other than 16 bits reach.
    let spokes = 70_000;
    let rim = (0..spokes).map(|i| (f64::from(i) * std::f64::consts::TAU / f64::from(spokes)).sin_cos());
    let wheel: Vec<_> =
        [(0.0, 0.0)].into_iter().chain(rim.map(|(sin, cos)| (10_000.0 * cos, 10_000.0 * sin))).collect();
    let around: Vec<_> = (0..spokes).map(|i| (0, i + 1, (i + 1) % spokes + 1)).collect();
    // The wheel's are ten thousand times as long as wide: which edges one begins with tells in more places.
    for (points, triangles, most) in [(&points, by_row, 1e-13), (&points, scattered, 1e-13), (&wheel, around, 1e-12)] {
        let simulation = simulation(&level(&format!(
            "(name: \"large\", bodies: [(name: \"large\", mass: Density(1), mesh: Points(points: {points:?}, triangles: {triangles:?}),
              material: (model: Corotated, young: 1000, poisson: 0.3))])"
        )));
        let mut random = Random(5);
        let x: Vec<_> = simulation.scene().rest.iter().map(|x| x + random.between(-0.2, 0.2)).collect();
        let elements = &simulation.scene().bodies[0].elements;
        let (_, expected) = one_by_one(&simulation, &x);
        let (mut scratch, mut force) = (vec![f64::NAN; elements.scratch()], vec![0.0; x.len()]);
        elements.elastic_force(&x, &mut scratch, &mut force);
        assert!(force.iter().all(|force| force.is_finite()), "what was in scratch is of no matter");
        let error = greatest_gap(&force, &expected);
        let scale = expected.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        assert!(error < most * scale, "{error:e} of {scale}");
    }
}

/// One partition, and many.
#[test]
fn a_body_listed_after_another_has_its_forces_alone() {
    for side in [9, 258] {
        let body = |side: u32| {
            format!(
                "(name: \"sheet\", mass: Density(1), mesh: Rectangle(width: 1, height: 1, columns: {side}, rows: {side}),
                  material: (model: StVenantKirchhoff, young: 1000, poisson: 0.3))"
            )
        };
        let [alone, after] = [body(side), format!("{}, {}", body(3), body(side))]
            .map(|bodies| simulation(&level(&format!("(name: \"\", bodies: [{bodies}])"))));
        let forces = |simulation: &Simulation| {
            let elements = &simulation.scene().bodies.last().unwrap().elements;
            let mut random = Random(8);
            let mut x = simulation.scene().rest.clone();
            let own = 2 * elements.vertices().start;
            x[own..].iter_mut().for_each(|x| *x += random.between(-1e-4, 1e-4));
            let (mut scratch, mut force) = (vec![f64::NAN; elements.scratch()], vec![0.0; x.len()]);
            elements.elastic_force(&x, &mut scratch, &mut force);
            assert!(force[..own].iter().all(|force| *force == 0.0));
            (force.split_off(own), elements.elastic_energy(&x))
        };
        assert_eq!(forces(&after), forces(&alone), "{side}");
    }
}

const NUMBERS: usize = 15;

/// Stress, energy and moduli, these also without their negative part.
#[inline(always)]
fn numbers_of<M: Material, R: Real>(material: &M, f: Mat2<R>) -> [R; NUMBERS] {
    let p = material.piola(f);
    let moduli = material.moduli(&Parts::of(f));
    let positive = moduli.with_negative_times(0.0);
    let ([a, b, c], [d, e, g]) = (moduli.sizes, positive.sizes);
    let energy = material.psi(f);
    [p.m11, p.m12, p.m21, p.m22, energy, moduli.twist, moduli.flip, a, b, c, positive.twist, positive.flip, d, e, g]
}

/// Lanes of any width that the processor has give the very bits of `f64`.
#[test]
fn stress_and_stiffness_in_lanes_have_the_scalar_bits() {
    struct Stresses<'a, M>(&'a M, &'a [[[f64; LANES]; 4]]);
    impl<M: Material> WithSimd for Stresses<'_, M> {
        type Output = Vec<[[f64; LANES]; NUMBERS]>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, set: S) -> Self::Output {
            let mut out = vec![[[0.0; LANES]; NUMBERS]; self.1.len()];
            for (out, f) in out.iter_mut().zip(self.1) {
                for part in 0..Wide::<S>::PARTS {
                    let [m11, m12, m21, m22] = [0, 1, 2, 3].map(|entry| Wide::load(set, &f[entry], part));
                    let f = Mat2::new(m11, m12, m21, m22);
                    let results = numbers_of(self.0, f);
                    results.iter().zip(out.iter_mut()).for_each(|(result, out)| result.store(out, part));
                }
            }
            out
        }
    }
    struct Compare;
    impl Visitor for Compare {
        type Output = ();
        fn visit<M: Material>(self, material: &M) {
            let mut random = Random(3);
            let mut gradients: Vec<_> = (0..1000).map(|_| random.gradient(0.01, 8.0)).collect();
            gradients.extend((0..1000).map(|_| random.gradient(-8.0, 8.0)));
            gradients.extend((0..1000).map(|i| rotation(f64::from(i)) + random.gradient(0.1, 8.0) * 1e-9));
            gradients.extend([Matrix2::identity(), Matrix2::zeros(), Matrix2::new(1.0, 0.0, 0.0, -1.0)]);
            gradients.resize(gradients.len().next_multiple_of(LANES), Matrix2::identity());
            let blocks: Vec<_> = gradients
                .chunks(LANES)
                .map(|eight| {
                    let lanes = |entry: fn(&Matrix2<f64>) -> f64| std::array::from_fn(|lane| entry(&eight[lane]));
                    [lanes(|f| f.m11), lanes(|f| f.m12), lanes(|f| f.m21), lanes(|f| f.m22)]
                })
                .collect();
            let found: Vec<_> = sets().iter().map(|set| set.dispatch(Stresses(material, &blocks))).collect();
            for (number, f) in gradients.iter().enumerate() {
                let expected = numbers_of(material, Mat2::from(f));
                let p = material.stress(f);
                let same = |(a, b): (&f64, f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
                assert!(expected.iter().zip([p.m11, p.m12, p.m21, p.m22, material.energy(f)]).all(same));
                for found in &found {
                    let found = found[number / LANES].map(|lanes| lanes[number % LANES]);
                    for (found, expected) in found.iter().zip(expected) {
                        let same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
                        assert!(same, "{} at {f}: {found:e} against {expected:e}", M::TITLE);
                    }
                }
            }
        }
    }
    for &model in Model::ALL {
        model.visit(gingerbread::materials::Lame { mu: 0.7, lambda: 1.1 }, Compare);
    }
}

/// What becomes of an eigenvalue.
type Change = fn(f64) -> f64;

/// Products of the stiffness with a displacement, one triangle after another, `A (dP) D0⁻ᵀ` with what `change` makes of the eigenvalues.
struct ProductOneByOne<'a>(&'a Simulation, &'a [f64], &'a [f64], Change);

impl Visitor for ProductOneByOne<'_> {
    type Output = Vec<f64>;
    fn visit<M: Material>(self, material: &M) -> Vec<f64> {
        let Self(simulation, x, d, change) = self;
        let elements = &simulation.scene().bodies[0].elements;
        let mut product = vec![0.0; x.len()];
        let edges = |of: &[f64], [a, b, c]: [u32; 3]| {
            let at = |i: u32| nalgebra::Vector2::new(of[2 * i as usize], of[2 * i as usize + 1]);
            Matrix2::from_columns(&[at(b) - at(a), at(c) - at(a)])
        };
        for (&triangle, (f, area)) in elements.corners().iter().zip(elements.gradients(x)) {
            let inverse = edges(&simulation.scene().rest, triangle).try_inverse().unwrap();
            let df = edges(d, triangle) * inverse;
            let stiffness = with_eigenvalues(&material.stiffness(&f), &f, change);
            let dp = stiffness * Vector4::from_column_slice(df.as_slice());
            let corners = Matrix2::from_column_slice(dp.as_slice()) * inverse.transpose() * area;
            let (one, two) = (corners.column(0).into_owned(), corners.column(1).into_owned());
            for (corner, force) in triangle.into_iter().zip([-one - two, one, two]) {
                product[2 * corner as usize] += force.x;
                product[2 * corner as usize + 1] += force.y;
            }
        }
        product
    }
}

#[test]
fn swept_stiffness_matches_single_triangles() {
    let kinds: [(Tangent, Change); 3] =
        [(Tangent::Exact, |e| e), (Tangent::Definite, |e| e.max(0.0)), (Tangent::Absolute, f64::abs)];
    let mut random = Random(4);
    for_every_sheet(|simulation, x, model| {
        let elements = &simulation.scene().bodies[0].elements;
        let mut pattern = Vec::new();
        elements.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
        let mut matrix = BlockMatrix::<2>::new(x.len() / 2, &pattern);
        let motion =
            Motion { dimension: 2, x, v: x, mass: &simulation.scene().mass, inverse_mass: &[], ..Motion::NONE };
        let d: Vec<_> = x.iter().map(|_| random.between(-1.0, 1.0)).collect();
        for (tangent, change) in kinds {
            matrix.clear();
            elements.add_stiffness(motion, Weights { position: 2.0, velocity: 1.0, tangent }, &mut matrix);
            assert!(matrix.is_full());
            let mut product = vec![0.0; x.len()];
            matrix.add_product(&d, &mut product);
            if tangent == Tangent::Exact {
                // Half of it, without the matrix.
                for product in &mut product {
                    *product *= 0.5;
                }
                let mut scratch = vec![f64::NAN; elements.scratch()];
                elements.stiffness_times(motion, &d, &mut scratch, &mut product);
            }
            let expected = elements.material().visit(ProductOneByOne(simulation, x, &d, change)).unwrap();
            let scale = expected.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            for (found, expected) in product.iter().zip(&expected) {
                let error = (found - 2.0 * expected).abs();
                assert!(error < 1e-12 * scale, "{} {tangent:?}: {error:e} of {scale}", model.title());
            }
        }
    });
}
