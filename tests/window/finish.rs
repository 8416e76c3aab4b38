//! How cloth looks: finishes and normals.

use crate::{folder::Folder, harness::*};
use eframe::egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gingerbread::{
    finish::{Colour, Finish, Pattern, Sheen},
    picture::Picture,
};

/// Chooses an entry of a menu.
fn pick(window: &mut Window, menu: &str, entry: &str) {
    widget(window, Role::ComboBox, menu).click();
    window.run_steps(2);
    window.get_by_label(entry).click();
    window.run_steps(2);
}

fn finish(window: &Window) -> Finish {
    window.state().snapshot().level.membranes[0].finish.clone()
}

#[test]
fn patterns_and_sheens_are_chosen_and_undone() {
    let mut window = open("toronto_cloth");
    draw(&window);
    for (pattern, sheen) in Pattern::ALL.into_iter().skip(1).zip(Sheen::ALL.into_iter().skip(1)) {
        pick(&mut window, "Pattern", pattern.name());
        pick(&mut window, "Sheen", sheen.name());
        assert_eq!((finish(&window).pattern, finish(&window).sheen), (pattern, sheen));
        draw(&window);
    }
    slide(&mut window, "Pattern size", 0.05);
    assert_eq!(finish(&window).size.get(), 0.05);
    draw(&window);
    for _ in 0..7 {
        click(&mut window, "Undo");
    }
    assert_eq!(finish(&window), Finish::default());
}

#[test]
fn an_image_is_put_on_a_cloth_saved_and_taken_off() {
    let folder = Folder::new("image");
    let path = folder.0.join("flag.png");
    let rgba: Vec<u8> =
        (0..300 * 200).flat_map(|pixel| [(pixel % 300 / 2) as u8, (pixel / 300) as u8, 90, 255]).collect();
    std::fs::write(&path, Picture { size: [300, 200], rgba }.png().unwrap()).unwrap();
    let mut window = open("toronto_cloth");
    click_in_panel(&mut window, "Open an image");
    type_path(&mut window, &path, "Open");
    draw(&window);
    let image = finish(&window).image.unwrap();
    assert_eq!(image.picture().unwrap().size, [256, 170], "it is made smaller");
    let saved = folder.0.join("cloth.ron");
    window.state_mut().save(&saved);
    let level = gingerbread::files::read(&saved).unwrap();
    assert_eq!(level.membranes[0].finish.image, Some(image), "a level needs no other file");

    std::fs::write(&path, "no picture").unwrap();
    click_in_panel(&mut window, "Open an image");
    type_path(&mut window, &path, "Open");
    let told = window.state().notice().unwrap();
    assert!(told.contains("flag.png: this is no PNG picture"), "{told}");
    assert!(finish(&window).image.is_some(), "what was there stays");
    click_in_panel(&mut window, "Remove the image");
    assert_eq!(finish(&window), Finish::default());
    click(&mut window, "Undo");
    assert!(finish(&window).image.is_some());

    // A text that is no image is told with its place.
    let text = std::fs::read_to_string(&saved).unwrap();
    let wrong = text.replace("iVBORw0KGgo", "R0lGODlh");
    let line = 1 + wrong[..wrong.find("R0lGODlh").unwrap()].matches('\n').count();
    let error = gingerbread::files::parse(&wrong, "x.ron").unwrap_err().to_string();
    assert!(error.contains(&format!("x.ron:{line}:")) && error.contains("no image"), "{error}");
}

#[test]
fn a_finish_does_not_stop_time_or_change_motion() {
    let mut window = in_mode("toronto_cloth", gingerbread::command::Mode::Collide);
    let steps = window.state().snapshot().steps;
    pick(&mut window, "Pattern", "Checks");
    let now = window.state().snapshot();
    assert!(now.steps > steps && now.running, "time goes on");
}

#[test]
fn colours_follow_normals() {
    let mut window = open("toronto_cloth");
    click_in_panel(&mut window, "Normals");
    draw(&window);
    let mut boxes = window.query_all_by_label("Vertices").filter(|node| node.accesskit_node().role() == Role::CheckBox);
    assert!(boxes.next().is_none(), "vertices of cloth are not drawn");
}

#[test]
fn every_cloth_has_controls_of_its_finish() {
    for name in ["cornell_sphere", "mit_cloth", "toronto_sphere", "tablecloth"] {
        let window = open(name);
        for control in ["Front colour", "Pattern", "Sheen"] {
            assert!(window.query_all_by_label(control).next().is_some(), "{name}: {control}");
        }
    }
    let window = open("gingerbread");
    assert!(window.query_all_by_label("Sheen").next().is_none(), "a body is dough with icing");
}

#[test]
fn a_finish_is_saved_and_misspelt_ones_are_told() {
    let mut now = level("tablecloth");
    let written = ron::to_string(&now.membranes[0].finish).unwrap();
    assert_eq!(ron::from_str::<Finish>(&written).unwrap(), now.membranes[0].finish, "{written}");
    now.membranes[0].finish.back = Some(Colour([1, 2, 3]));
    let text = gingerbread::files::write(&now).unwrap();
    assert!(text.contains("back: \"#010203\""), "{text}");
    let wrong = text.replace("#010203", "#01020");
    let line = 1 + wrong[..wrong.find("#01020\"").unwrap()].matches('\n').count();
    let error = gingerbread::files::parse(&wrong, "x.ron").unwrap_err().to_string();
    assert!(error.contains(&format!("x.ron:{line}:")) && error.contains("six hexadecimal digits"), "{error}");
}
