//! Pictures of the stage.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers, PointerButton, pos2, vec2};
use std::io::Cursor;

/// Size and pixels of the picture that is saved now.
fn saved(window: &mut Window, name: &str) -> ([u32; 2], Vec<u8>) {
    let folder = crate::folder::Folder::new(name);
    let path = folder.0.join("picture.png");
    press(window, Key::I);
    window.run_steps(3);
    type_path(window, &path, "Save");
    let mut reader = png::Decoder::new(Cursor::new(std::fs::read(&path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    ([info.width, info.height], pixels)
}

#[test]
fn a_picture_has_twice_the_size_of_the_stage() {
    let mut window = open("gingerbread");
    let stage = stage(&window).size();
    let (size, pixels) = saved(&mut window, "picture-man");
    assert_eq!(size, [2.0 * stage.x, 2.0 * stage.y].map(|pixels| pixels.round() as u32));
    let at = |x: u32, y: u32| &pixels[4 * (size[0] * y + x) as usize..][..3];
    assert_ne!(at(size[0] / 2, size[1] / 2), at(0, 0), "the man is before the sky");
}

#[test]
fn a_picture_of_cloth_is_seen_from_the_same_side() {
    let mut window = open("tablecloth");
    let (_, before) = saved(&mut window, "picture-cloth");
    let middle = stage(&window).center();
    let turn = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(middle));
    window.event(turn(middle, true));
    window.run_steps(2);
    window.event(Event::PointerMoved(middle + vec2(200.0, 30.0)));
    window.run_steps(2);
    window.event(turn(middle + vec2(200.0, 30.0), false));
    window.event(Event::PointerMoved(pos2(1.0, 1.0)));
    window.run_steps(2);
    let (_, after) = saved(&mut window, "picture-turned");
    assert!(before.len() == after.len() && before != after, "the stage was turned");
}
