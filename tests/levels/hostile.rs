//! Level files that are broken on purpose: each is refused with its place, or is a level that can be run.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::Random;
use gingerbread::{files, level::Level, levels::BUILT_IN, meshes::NoFiles, scene::Scene, simulation::Simulation};

/// Small enough to be built and run many times in a test.
fn is_small(level: &Level) -> bool {
    let text = files::write(level).unwrap_or_default();
    let numbers = text.split(|c: char| !(c.is_ascii_digit() || c == '.')).filter_map(|word| word.parse::<f64>().ok());
    text.len() < 100_000 && numbers.into_iter().filter(|number| number.fract() == 0.0).all(|number| number < 3000.0)
}

/// Reads a text, and runs what comes out for a moment. A refusal names line and column.
fn survive(text: &str) -> bool {
    match files::parse(text, "hostile.ron") {
        Err(error) => {
            let told = error.to_string();
            let mut parts = told.splitn(4, ':');
            assert_eq!(parts.next(), Some("hostile.ron"), "{told}");
            assert!(
                parts.next().unwrap().parse::<usize>().is_ok() && parts.next().unwrap().parse::<usize>().is_ok(),
                "{told}"
            );
            assert!(!parts.next().unwrap().trim().is_empty(), "{told}");
            false
        }
        Ok(level) => {
            if is_small(&level)
                && let Ok(scene) = Scene::build(&level, level.mode, &NoFiles, None)
                && let Ok(state) = scene.first_state(level.state.as_ref())
            {
                let mut run = Simulation::new(scene, state);
                run.advance(3, &mut || true);
                assert!(run.state().is_finite() || run.state().steps == 0);
            }
            true
        }
    }
}

fn pick(random: &mut Random, below: usize) -> usize {
    (random.between(0.0, below as f64) as usize).min(below - 1)
}

#[test]
fn mutated_levels_are_refused_with_their_place_or_run() {
    const WORDS: &[&str] = &[
        "NaN",
        "inf",
        "-inf",
        "-1",
        "0",
        "1e308",
        "-1e308",
        "1e-308",
        "1e999",
        "99999999999999999999",
        "-0.0",
        "()",
        "[]",
        "(",
        ")",
        "\"",
        "Some(1)",
        "true",
        "Corotated",
        "/*",
        "'",
        "\u{0}",
        "\u{feff}",
        "é",
        "r#\"",
        "1_0",
        "0x10",
        ",",
        ":",
        "None",
    ];
    let mut random = Random(7);
    let (mut refused, mut accepted) = (0, 0);
    for (_, text) in BUILT_IN {
        for _ in 0..150 {
            let mut text: Vec<char> = text.chars().collect();
            for _ in 0..=pick(&mut random, 3) {
                let (at, to) = (pick(&mut random, text.len()), pick(&mut random, 12));
                let end = (at + to).min(text.len());
                match pick(&mut random, 5) {
                    0 => drop(text.drain(at..end)),
                    1 => drop(text.splice(at..end, WORDS[pick(&mut random, WORDS.len())].chars())),
                    2 => text.truncate(at.max(1)),
                    3 => {
                        let copy = text[at..end].to_vec();
                        drop(text.splice(at..at, copy));
                    }
                    _ => {
                        // A number where a number was.
                        let is_number = |c: &char| c.is_ascii_digit() || *c == '.';
                        if let Some(start) = text[at..].iter().position(is_number).map(|found| at + found) {
                            let length = text[start..].iter().take_while(|c| is_number(c)).count();
                            drop(text.splice(start..start + length, WORDS[pick(&mut random, 11)].chars()));
                        }
                    }
                }
                if text.is_empty() {
                    text.push('(');
                }
            }
            let ran = survive(&text.into_iter().collect::<String>());
            accepted += u32::from(ran);
            refused += u32::from(!ran);
        }
    }
    assert!(refused > 500 && accepted > 50, "{refused} refused, {accepted} accepted");
}

#[test]
fn every_beginning_of_a_level_is_refused_with_its_place() {
    let text = gingerbread::levels::built_in("three_models").unwrap().trim_end();
    for end in (0..text.len()).step_by(7) {
        assert!(!survive(&text[..end]), "cut at {end}");
    }
}

#[test]
fn deep_nesting_is_refused_and_not_followed_down() {
    for bracket in ["(", "[", "Some(", "{"] {
        assert!(!survive(&format!("(name: \"deep\", bodies: {}", bracket.repeat(100_000))));
    }
}

#[test]
fn ten_megabytes_of_anything_are_read_or_refused() {
    let size = 10 << 20;
    assert!(!survive(&"a".repeat(size)));
    assert!(!survive(&"(".repeat(size)));
    assert!(!survive(&format!("(name: \"{}", "x".repeat(size))));
    assert!(survive(&format!("(name: \"{}\", toy: Circle(radius: 1), integrator: Heun())", "x".repeat(size))));
    assert!(survive(&format!("// {}\n(name: \"\", toy: Circle(radius: 1), integrator: Heun())", "x".repeat(size))));
}
