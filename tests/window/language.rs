//! Language: the texts of the window in German, and in English where there is no translation.

use crate::harness::*;
use eframe::egui::{Key, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gingerbread::command::Mode;
use gingerbread::levels;

#[test]
fn the_window_speaks_german_where_it_can() {
    let mut window = open("gingerbread_house");
    click(&mut window, "Keys");
    assert!(window.query_by_label("run or pause").is_some());
    click(&mut window, "Deutsch");
    assert!(window.query_by_label("Sprache").is_some() && window.query_by_label("Start oder Pause").is_some());
    press(&mut window, Key::Escape);
    for german in ["Bearbeiten", "Kollidieren", "Einzelschritt", "Rückgängig", "Effekte", "Was es kostet"] {
        assert!(window.query_by_label(german).is_some(), "{german}");
    }
    for english in ["Edit", "Collide", "Single step", "Undo", "Effects", "What it costs"] {
        assert!(window.query_by_label(english).is_none(), "{english}");
    }
    widget(&window, Role::Slider, "Elastizitätsmodul");
    // Names of models are not translated.
    assert!(window.query_by_label("Neo-Hookean").is_some());
    // Buttons do what they did, and keys are the same.
    click(&mut window, "Kollidieren");
    assert_eq!(mode(&window), Mode::Collide);
    press(&mut window, Key::T);
    assert_eq!(mode(&window), Mode::Edit);
    click(&mut window, "Tasten");
    click(&mut window, "English");
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Collide").is_some() && window.query_by_label("Kollidieren").is_none());
}

/// Longer words push nothing out of the panels.
#[test]
fn german_fits_into_the_panels_of_every_level() {
    let mut window = open("gingerbread");
    click(&mut window, "Keys");
    click(&mut window, "Deutsch");
    press(&mut window, Key::Escape);
    for (file, text) in levels::BUILT_IN {
        window.state_mut().open_text(text, file);
        window.run_steps(4);
        let (stage, right) = (stage(&window), window.ctx.content_rect().right());
        for role in [Role::Slider, Role::SpinButton, Role::ComboBox, Role::Button] {
            let beside =
                window.query_all_by_role(role).filter(|found| stage.y_range().contains(found.rect().center().y));
            for found in beside {
                let (rect, name) = (found.rect(), found.accesskit_node().label());
                let limit = if rect.left() < stage.left() { stage.left() } else { right };
                assert!(rect.right() <= limit, "{file}: {name:?} reaches {} of {limit}", rect.right());
            }
        }
    }
}
