//! `gingerbread render`: pictures without a window.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::{
    film::{self, Film},
    program::{Folder, gingerbread, said},
};
use std::{fs, io::Cursor, path::Path};

/// Size, and red, green, blue and alpha of each pixel.
fn decoded(path: &str) -> ([u32; 2], Vec<u8>) {
    let mut reader = png::Decoder::new(Cursor::new(fs::read(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    ([info.width, info.height], pixels)
}

#[test]
fn a_gif_has_its_size_rate_and_length() {
    let folder = Folder::new("render-gif");
    let [one, other] = ["one.gif", "other.gif"].map(|name| folder.file(name));
    for path in [&one, &other] {
        let arguments = ["render", "gingerbread_house", "--out", path, "--seconds", "0.5", "--rate", "20"];
        let ended = gingerbread(&[&arguments[..], &["--size", "96x64"]].concat());
        assert!(ended.status.success(), "{}", said(&ended.stderr));
        assert!(said(&ended.stdout).contains("10 frames of 96 x 64 pixels"), "{}", said(&ended.stdout));
    }
    let bytes = fs::read(&one).unwrap();
    assert_eq!(bytes, fs::read(&other).unwrap(), "the same bytes on every run");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut film = options.read_info(Cursor::new(bytes)).unwrap();
    assert_eq!((film.width(), film.height(), film.repeat()), (96, 64, gif::Repeat::Infinite));
    let mut frames = Vec::new();
    while let Some(frame) = film.read_next_frame().unwrap() {
        assert_eq!(frame.delay, 5, "hundredths of a second");
        frames.push(frame.buffer.to_vec());
    }
    assert_eq!(frames.len(), 10);
    assert!(frames.windows(2).all(|pair| pair[0] != pair[1]), "he falls");
}

#[test]
fn an_mp4_has_its_size_rate_and_length() {
    let folder = Folder::new("render-mp4");
    let [one, other, last] = ["one.mp4", "other.mp4", "last.png"].map(|name| folder.file(name));
    let arguments = ["gingerbread_house", "--size", "128x96", "--rate", "30"];
    for path in [&one, &other] {
        let ended = gingerbread(&[&["render", "--out", path, "--seconds", "0.5"], &arguments[..]].concat());
        assert!(ended.status.success(), "{}", said(&ended.stderr));
        assert!(said(&ended.stdout).contains("15 frames of 128 x 96 pixels"), "{}", said(&ended.stdout));
    }
    let bytes = fs::read(&one).unwrap();
    assert_eq!(bytes, fs::read(&other).unwrap(), "the same bytes on every run");
    let Film { size, interval, frames } = film::mp4(&bytes);
    assert_eq!((size, interval, frames.len()), ([128, 96], Some(1.0 / 30.0), 15));
    assert!(frames.windows(2).all(|pair| pair[0] != pair[1]), "he falls");
    // The last frame is the picture of its time, as far as the coding keeps it.
    let time = format!("{}", 14.0 / 30.0);
    assert!(gingerbread(&[&["render", "--out", &last, "--seconds", &time], &arguments[..]].concat()).status.success());
    let (_, pixels) = decoded(&last);
    let differences = frames[14].iter().zip(&pixels).map(|(a, b)| f64::from(a.abs_diff(*b)));
    let mean = differences.sum::<f64>() / pixels.len() as f64;
    // Colours have a quarter of the pixels, and the coding is lossy.
    assert!(mean < 5.0, "{mean} of 255");
}

#[test]
fn plane_space_and_toys_are_drawn_in_both_themes() {
    let folder = Folder::new("render-png");
    for level in ["jelly_disk", "tablecloth", "hanging_net", "pendulum"] {
        let pictures = ["dark", "light"].map(|theme| {
            let path = folder.file(&format!("{level}-{theme}.png"));
            let arguments = ["render", level, "--out", &path, "--seconds", "0.1", "--size", "120x90", "--theme", theme];
            let ended = gingerbread(&[&arguments[..], &["--colour", "von-mises", "--wireframe"]].concat());
            assert!(ended.status.success(), "{level}: {}", said(&ended.stderr));
            let (size, pixels) = decoded(&path);
            assert_eq!(size, [120, 90]);
            let corner = &pixels[..4];
            let others = pixels.chunks(4).filter(|pixel| pixel.iter().zip(corner).any(|(a, b)| a.abs_diff(*b) > 40));
            assert!(others.count() > 50, "{level}: something is seen before the sky");
            corner.iter().map(|channel| u32::from(*channel)).sum::<u32>()
        });
        assert!(pictures[0] + 200 < pictures[1], "{level}: night is darker than day: {pictures:?}");
    }
}

/// A view is chosen by an option or by the link that names the level, which are the same.
#[test]
fn pictures_are_seen_from_where_a_link_says() {
    let folder = Folder::new("render-camera");
    let drawn = |level: &str, more: &[&str]| {
        let path = folder.file("view.png");
        let ended =
            gingerbread(&[&["render", level, "--out", &path, "--seconds", "0", "--size", "80x60"], more].concat());
        assert!(ended.status.success(), "{level}: {}", said(&ended.stderr));
        decoded(&path).1
    };
    for (level, camera) in [("gingerbread", "0.5,0.8,4"), ("tablecloth", "-0.1,0.2,0,0.4,0.3,1.2")] {
        let (whole, near) = (drawn(level, &[]), drawn(level, &["--camera", camera]));
        assert_ne!(whole, near, "{level}");
        assert_eq!(drawn(&format!("?level={level}&camera={camera}"), &[]), near, "{level}");
        assert_ne!(drawn(&format!("?level={level}&camera={camera}&wireframe"), &[]), near, "{level}");
    }
}

/// A level that was saved while it ran goes on from there.
#[test]
fn a_saved_level_is_drawn_from_its_state_on() {
    let folder = Folder::new("render-saved");
    let [saved, film] = ["saved.ron", "film.gif"].map(|name| folder.file(name));
    assert!(gingerbread(&["run", "jelly_disk", "--seconds", "0.2", "--save", &saved]).status.success());
    let ended = gingerbread(&["render", &saved, "--seconds", "0.4", "--rate", "10", "--size", "64x64", "--out", &film]);
    assert!(said(&ended.stdout).contains("4 frames of 64 x 64 pixels"), "{}", said(&ended.stdout));
    assert!(said(&ended.stdout).contains("to 0.500 s"), "{}", said(&ended.stdout));
}

#[test]
fn what_cannot_be_drawn_is_told_and_leaves_no_file() {
    let folder = Folder::new("render-wrong");
    for (name, arguments, why) in [
        ("man.bmp", &["gingerbread"][..], "must end in .mp4, .gif or .png"),
        ("man", &["gingerbread"], "must end in .mp4, .gif or .png"),
        ("man.gif", &["gingerbread", "--size", "9x9"], "in [16, 4096] pixels"),
        ("man.gif", &["gingerbread", "--size", "640"], "such as 640x480"),
        ("man.gif", &["gingerbread", "--rate", "60"], "at most 50 frames a second, not 60"),
        ("man.mp4", &["gingerbread", "--rate", "61"], "61 is not in 1..=60"),
        ("man.mp4", &["gingerbread", "--size", "65x64"], "65 x 64 are not"),
        ("man.mp4", &["gingerbread", "--size", "4000x64"], "at most 3840 x 2160 pixels"),
        ("man.gif", &["gingerbread", "--seconds", "-1"], "at least 0"),
        ("man.gif", &["gingerbread", "--seconds", "1e6"], "too many for a film"),
        ("man.png", &["gingerbred"], "gingerbred"),
        ("man.png", &["gingerbread", "--camera", "0,0"], "expected X,Y,SCALE"),
        ("man.png", &["gingerbread", "--camera", "0,0,0,1,0,0"], "this scene takes three numbers X,Y,SCALE"),
        ("none/man.png", &["gingerbread"], "--out"),
    ] {
        let path = folder.file(name);
        let ended = gingerbread(&[&["render", "--out", &path], arguments].concat());
        let told = said(&ended.stderr);
        assert_eq!((ended.status.code(), told.contains(why)), (Some(2), true), "{name} {arguments:?}: {told}");
        assert!(!Path::new(&path).exists(), "{name}");
    }
}
