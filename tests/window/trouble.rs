//! Files that are broken and bodies that fly apart.

use crate::{folder::Folder, harness::*};
use eframe::egui::{Key, Pos2, Rect, Role, epaint::Primitive};
use egui_kittest::kittest::Queryable as _;
use gingerbread::command::Mode;
use gingerbread::files::Disk;
use gingerbread::level::{SavedState, Substeps, Toggle};
use gingerbread::quantity::{Point, Position, Time};
use gingerbread::scene::Scene;
use std::path::Path;

/// The old scene goes on.
#[test]
fn a_broken_level_file_is_told_with_its_place() {
    let folder = Folder::new("window");
    let path = folder.0.join("broken.ron");
    std::fs::write(&path, "(\n    name: \"broken\",\n    bodies: 7,\n)\n").unwrap();
    let mut window = in_mode("gingerbread", Mode::Simulate);
    let time = window.state().snapshot().time;
    window.state_mut().open(&path);
    window.run_steps(10);
    assert!(window.query_by_label_contains("broken.ron:3:").is_some(), "{:?}", window.state().notice());
    let now = window.state().snapshot();
    assert!(now.time > time && now.level.name == level("gingerbread").name);
    window.state_mut().open(&folder.0.join("missing.ron"));
    window.run_steps(3);
    assert!(window.query_by_label_contains("missing.ron").is_some());
}

#[test]
fn what_is_saved_opens_again_as_it_was() {
    let folder = Folder::new("save");
    let path = folder.0.join("saved.ron");
    let mut window = in_mode("gingerbread", Mode::Simulate);
    press(&mut window, Key::Space);
    let positions = window.state().snapshot().positions.clone();
    window.state_mut().save(&path);
    assert!(window.state().notice().is_some_and(|notice| notice.starts_with("Saved as")));
    press(&mut window, Key::N);
    window.state_mut().open(&path);
    window.run_steps(3);
    assert_eq!(window.state().snapshot().positions, positions);
}

/// With the pins of now, and from its start.
#[test]
fn a_copied_link_opens_the_level_again_and_a_broken_one_changes_nothing() {
    let mut window = in_mode("gingerbread", Mode::Edit);
    let head = on_screen(&window, vertex(&window, 0));
    click_at(&mut window, head);
    let pinned = window.state().snapshot().level.clone();
    assert!(!pinned.bodies[0].pins.is_empty());
    click(&mut window, "Zoom in");
    click(&mut window, "Level");
    window.get_by_label("Copy link").click();
    let link = copied(&mut window);
    let seen = on_screen(&window, [0.25, 0.75]);
    choose(&mut window, "Jelly disk");
    window.state_mut().open(Path::new(&format!("https://page.example/{link}")));
    window.run_steps(3);
    assert_eq!(window.state().snapshot().level, pinned);
    assert!(on_screen(&window, [0.25, 0.75]).distance(seen) < 0.1, "it is seen from the same place");
    window.state_mut().open(Path::new("https://page.example/#level=x"));
    window.run_steps(3);
    assert!(window.state().notice().is_some_and(|notice| notice.contains("not complete")));
    assert_eq!(window.state().snapshot().level, pinned);
}

#[test]
fn when_time_stops_the_banner_says_why_and_its_buttons_mend_it() {
    let mut wild = level("gingerbread_pulled");
    wild.substeps = Substeps::new(2).unwrap();
    wild.guard = Toggle::Off;
    for label in ["Reset", "Shorter steps (2 × ", "Switch the guard on"] {
        let mut window = open_level(wild.clone(), 1280.0, 800.0);
        press(&mut window, Key::T);
        for _ in 0..300 {
            if window.state().snapshot().fault.is_some() {
                break;
            }
            window.run_steps(1);
        }
        window.run_steps(2);
        assert!(window.query_by_label("Time stopped").is_some(), "it must fail, and say so");
        draw(&window);
        assert!(window.state().snapshot().positions.iter().all(|x| x.is_finite()));
        press(&mut window, Key::Space);
        assert!(window.query_by_label("Damp").is_none(), "damping makes the longest stable step shorter");
        window.get_by_label_contains(label).click();
        window.run_steps(3);
        let now = window.state().snapshot();
        assert_eq!(now.fault, None, "{label}");
        assert_eq!(now.level.substeps.get() > 2, label.starts_with("Shorter"), "{label}");
        assert_eq!(now.level.guard == Toggle::On, label.starts_with("Switch"), "{label}");
    }
}

#[test]
fn a_body_that_flies_apart_does_not_bring_the_window_down() {
    for (model, young) in [(Key::C, "1e15"), (Key::V, "1e15"), (Key::N, "1e15"), (Key::V, "1e9")] {
        let mut window = open("gingerbread_house");
        press(&mut window, model);
        type_number(&mut window, "Young's modulus", young);
        press(&mut window, Key::T);
        for frame in 0..40 {
            for label in ["Energy density", "Von Mises stress", "Area ratio J"] {
                if frame % 10 == 0 {
                    click(&mut window, label);
                }
            }
            window.run_steps(1);
            draw(&window);
        }
        assert!(window.state().snapshot().positions.iter().all(|x| x.is_finite()));
    }
}

/// A body whose vertices lie anywhere, as after an explosion.
fn scattered(size: f64) -> gingerbread::level::Level {
    let mut level = level("gingerbread");
    let scene = Scene::build(&level, level.mode, &Disk, None).unwrap();
    let count = scene.rest.len() / 2;
    let place = |i: usize| {
        let chance = |salt: usize| ((i * 7919 + salt) * 104_729 % 10_007) as f64 / 10_007.0 - 0.5;
        Position::new(&[0.5 + size * chance(1), 0.5 + size * chance(5000)]).unwrap()
    };
    let velocities = vec![Position::new(&[0.0; 2]).unwrap(); count];
    level.state = Some(SavedState::new((0, Time::new(0.0).unwrap()), (0..count).map(place).collect(), velocities));
    level
}

/// Area of a triangle inside a rectangle: cut at each of its four sides in turn (Sutherland and Hodgman).
fn clipped_area(triangle: [Pos2; 3], seen: Rect) -> f32 {
    let mut corners = triangle.to_vec();
    // By how far a point is inside of each side.
    let sides: [&dyn Fn(Pos2) -> f32; 4] =
        [&|p| p.x - seen.left(), &|p| seen.right() - p.x, &|p| p.y - seen.top(), &|p| seen.bottom() - p.y];
    for inside in sides {
        let next = corners.iter().cycle().skip(1);
        let cut = corners.iter().zip(next).flat_map(|(&a, &b)| {
            let (da, db) = (inside(a), inside(b));
            let crossing = (da * db < 0.0).then(|| a + (b - a) * (da / (da - db)));
            (da >= 0.0).then_some(a).into_iter().chain(crossing)
        });
        corners = cut.collect();
    }
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a.x * b.y - a.y * b.x).sum::<f32>().abs()
}

#[test]
fn an_exploded_body_fills_no_more_than_some_times_the_stage() {
    for size in [1.0, 10.0, 1e9] {
        for (wireframe, vertices) in [(false, false), (true, true)] {
            let mut window = open_level(scattered(size), 1280.0, 800.0);
            for (on, name) in [(wireframe, "Wireframe"), (vertices, "Vertices")] {
                if on {
                    widget(&window, Role::CheckBox, name).click();
                    window.run_steps(3);
                }
            }
            let stage = stage(&window);
            let painted = window.ctx.tessellate(window.output().shapes.clone(), 1.0);
            let mut filled = 0.0;
            for mesh in &painted {
                let Primitive::Mesh(of) = &mesh.primitive else { continue };
                let seen = stage.intersect(mesh.clip_rect);
                for corners in of.indices.chunks_exact(3) {
                    filled += clipped_area([0, 1, 2].map(|i| of.vertices[corners[i] as usize].pos), seen);
                }
            }
            // The sky and the world square are painted once each.
            assert!(filled < 8.0 * stage.area(), "{size}: {} times the stage", filled / stage.area());
        }
    }
}

/// A key and a button untangle it.
#[test]
fn a_mirrored_body_is_told_and_untangled() {
    for by_key in [true, false] {
        let mut tangled = level("gingerbread");
        let scene = Scene::build(&tangled, tangled.mode, &Disk, None).unwrap();
        // Laid over itself: mirrored about its middle.
        let mirrored = scene.rest.chunks_exact(2).map(|at| Position::new(&[1.0 - at[0], at[1]]).unwrap());
        let velocities = vec![Position::new(&[0.0; 2]).unwrap(); scene.rest.len() / 2];
        tangled.state = Some(SavedState::new((0, Time::new(0.0).unwrap()), mirrored.collect(), velocities));
        let mut window = open_level(tangled, 1280.0, 800.0);
        let triangles = window.state().snapshot().triangles.len();
        assert_eq!(window.state().snapshot().inverted, triangles);
        assert!(window.query_by_label(&format!("{triangles} triangles are inside out")).is_some());
        if by_key {
            press(&mut window, Key::U);
        } else {
            click(&mut window, "Untangle");
        }
        let now = window.state().snapshot();
        assert_eq!((now.inverted, now.tangle.wound), (0, 0));
        assert!(window.query_by_label("Untangle").is_none(), "what is mended is not warned of");
    }
}

#[test]
fn what_is_inside_a_wall_is_told_until_it_is_out() {
    let mut low = level("gingerbread");
    low.bodies[0].place.offset = Point::new([0.0, -0.1]).unwrap();
    let mut window = open_level(low, 1280.0, 800.0);
    let told = |window: &Window| window.query_by_label_contains("inside walls, other bodies").is_some();
    press(&mut window, Key::T);
    window.run_steps(2);
    assert!(told(&window), "his feet begin below the floor");
    for _ in 0..240 {
        window.run_steps(1);
    }
    let now = window.state().snapshot();
    assert!(!told(&window) && now.min_j > 0.3 && now.fault.is_none(), "least J {}", now.min_j);
}
