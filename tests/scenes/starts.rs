//! Facts about the shapes a body may start in.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::{sheet, simulation};
use gingerbread::{files, level::StartShape, simulation::Simulation};

fn started(start: &str, more: &str) -> Simulation {
    simulation(&sheet("Corotated", &format!("start: {start}, {more}"), ""))
}

fn ratios(simulation: &Simulation) -> Vec<f64> {
    simulation.scene().bodies[0].elements.volume_ratios(&simulation.state().x).collect()
}

#[test]
fn collapsed_and_mirrored_starts_have_the_stated_area() {
    for seed in 0..20 {
        for (start, area) in [("Line", 0.0), ("Point", 0.0), ("Mirrored", -1.0)] {
            let simulation = started(&format!("{start}(seed: {seed}, noise: 0)"), "");
            for ratio in ratios(&simulation) {
                assert!((ratio - area).abs() < 1e-12, "{start} {seed}: {ratio}");
            }
            let x = &simulation.state().x;
            let spread = (0..2).map(|axis| {
                let along = x.iter().skip(axis).step_by(2);
                along.clone().fold(f64::MIN, |a, b| a.max(*b)) - along.fold(f64::MAX, |a, b| a.min(*b))
            });
            let size = spread.fold(0.0, f64::max);
            assert!(if start == "Point" { size < 1e-12 } else { size > 0.2 }, "{start} {seed}: {size}");
        }
    }
}

#[test]
fn noise_moves_every_vertex_and_none_farther_than_it_says() {
    let still = started("Mirrored(seed: 3, noise: 0)", "");
    let noisy = started("Mirrored(seed: 3)", "");
    // The default is a thousandth of the body's 0.4 m.
    let moved = |(a, b): (&f64, &f64)| (a - b).abs();
    for distance in still.state().x.iter().zip(&noisy.state().x).map(moved) {
        assert!(distance > 0.0 && distance <= 0.000_4, "{distance}");
    }
}

#[test]
fn a_scrambled_body_fills_its_box_and_is_half_inside_out() {
    let (mut inverted, mut count) = (0, 0);
    for seed in 0..100 {
        let simulation = started(&format!("Scrambled(seed: {seed})"), "");
        assert!(simulation.state().x.iter().all(|x| (0.3..=0.7).contains(x)));
        count += ratios(&simulation).len();
        inverted += ratios(&simulation).iter().filter(|ratio| **ratio < 0.0).count();
    }
    let share = inverted as f64 / count as f64;
    assert!((0.45..0.55).contains(&share), "{share}");
}

#[test]
fn the_same_seed_gives_the_same_shape_and_another_seed_another() {
    for start in ["Scrambled(seed: N)", "Line(seed: N)", "Point(seed: N)", "Mirrored(seed: N)"] {
        let hash = |seed: &str| started(&start.replace('N', seed), "").state().hash();
        assert_eq!(hash("1"), hash("1"));
        assert_ne!(hash("1"), hash("2"), "{start}");
    }
}

#[test]
fn what_is_pinned_or_slides_starts_where_it_belongs() {
    let simulation = started("Scrambled(seed: 1)", "pins: [Top], slides: [Left]");
    let (scene, x) = (simulation.scene(), &simulation.state().x);
    let held = (0..x.len()).filter(|number| scene.inverse_mass[*number] == 0.0);
    let off = |number: &usize| x[*number] != scene.rest[*number];
    assert_eq!((held.clone().count(), held.filter(off).count()), (2 * 5 + 4, 0));
}

#[test]
fn a_start_is_saved_with_its_level_and_a_bad_one_is_told() {
    for start in [
        StartShape::Rest,
        StartShape::Scrambled { seed: 4 },
        StartShape::Line { seed: u32::MAX, noise: gingerbread::quantity::Noise::new(0.25).unwrap() },
    ] {
        let mut level = sheet("Corotated", "", "");
        level.bodies[0].start = start;
        let text = files::write(&level).unwrap();
        assert_eq!(text.contains("start:"), start != StartShape::Rest, "the default needs no words");
        assert_eq!(files::parse(&text, "start.ron").unwrap(), level);
    }
    let bad = |start: &str| {
        let text = format!(
            "(name: \"a\", bodies: [(name: \"b\", mesh: Disk(radius: 0.2, rings: 5), mass: Total(25), start: {start},
                material: (model: Corotated, young: 10, poisson: 0.3))])"
        );
        files::parse(&text, "bad.ron").unwrap_err().to_string()
    };
    assert!(
        bad("Line(seed: 1, noise: 2)").contains("noise must be at least 0 and at most 1, got 2"),
        "{}",
        bad("Line(seed: 1, noise: 2)")
    );
    assert!(bad("Line(seed: -1)").contains("at least 0 and at most 4294967295, got -1"));
    assert!(bad("Line(seed: 1, sed: 2)").contains("sed"));
    assert!(bad("Melted(seed: 1)").contains("Scrambled"));
}
