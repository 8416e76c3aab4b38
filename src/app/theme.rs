//! Colour themes, dark and light, and egui's style.

use eframe::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, Style, TextStyle, Visuals, style, vec2,
};

/// All colours of the window for one mode.
#[derive(Debug, PartialEq)]
pub struct Theme {
    /// Background outside the world, top and bottom.
    pub sky: [Color32; 2],
    /// Falling snow.
    pub snow: Color32,
    /// Snow on the ground.
    pub ground: [Color32; 2],
    /// The world square.
    pub world: Color32,
    /// Edge of the world square.
    pub world_edge: Color32,
    /// Inside of the house, top and bottom.
    pub inside: [Color32; 2],
    /// Glass and frames of the windows.
    pub window: [Color32; 2],
    /// Gingerbread walls.
    pub wall: Color32,
    /// Shaded parts of the walls.
    pub wall_shade: Color32,
    /// Dough of bodies.
    pub dough: Color32,
    /// Baked rim of bodies.
    pub crust: Color32,
    /// Royal icing.
    pub icing: Color32,
    /// Shaded rim of icing.
    pub icing_shade: Color32,
    /// Colours of candy: red, green.
    pub candy: [Color32; 2],
    /// Arrow of the mouse spring.
    pub pull: Color32,
    /// Vertex that a click would pick.
    pub glow: Color32,
    /// Lines and numbers on the stage.
    pub annotation: Color32,
    /// Less important lines and numbers on the stage.
    pub faint_annotation: Color32,
    /// Cards behind numbers on the stage.
    pub card: Color32,
    /// Background of panels.
    pub panel: Color32,
    /// Background of text fields and plots.
    pub well: Color32,
    /// Buttons: at rest, hovered, pressed.
    pub button: [Color32; 3],
    /// Thin separator lines.
    pub line: Color32,
    /// Text.
    pub text: Color32,
    /// Secondary text.
    pub faint_text: Color32,
    /// Selection: background of a segment, filled part of a slider.
    pub accent: Color32,
    /// Text on a selection.
    pub on_accent: Color32,
    /// Accent colour of lines and text.
    pub accent_line: Color32,
    /// Success: stable, valid.
    pub good: Color32,
    /// Warning.
    pub warning: Color32,
    /// Error.
    pub bad: Color32,
    /// Line colours of plots, in this order. They can be told apart with colour blindness.
    pub series: [Color32; 6],
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const fn rgba(hex: u32, alpha: u8) -> Color32 {
    Color32::from_rgba_unmultiplied_const((hex >> 16) as u8, (hex >> 8) as u8, hex as u8, alpha)
}

/// Dark theme: a winter night.
static NIGHT: Theme = Theme {
    sky: [rgb(0x0F_1A2E), rgb(0x1E_2F4D)],
    snow: rgb(0xDC_E8FA),
    ground: [rgb(0xC3_D3EC), rgb(0x7F_95BA)],
    world: rgba(0xFF_FFFF, 10),
    world_edge: rgba(0xB9_CBE8, 46),
    inside: [rgb(0x2C_222B), rgb(0x45_302B)],
    window: [rgb(0x1B_2A48), rgb(0x66_5552)],
    wall: rgb(0x7A_4420),
    wall_shade: rgb(0x5A_3016),
    dough: rgb(0xB5_713A),
    crust: rgb(0x8A_4F22),
    icing: rgb(0xFF_F7EA),
    icing_shade: rgb(0xC9_BFB8),
    candy: [rgb(0xD7_443E), rgb(0x3E_9B6E)],
    pull: rgb(0xE5_484D),
    glow: rgb(0xFF_D98A),
    annotation: rgb(0xF2_F5FB),
    faint_annotation: rgb(0xA9_B9D4),
    card: rgba(0x0C_1526, 205),
    panel: rgb(0x16_2238),
    well: rgb(0x0E_1829),
    button: [rgb(0x25_3552), rgb(0x31_4568), rgb(0x1D_2B45)],
    line: rgb(0x2C_3D5C),
    text: rgb(0xE6_ECF6),
    faint_text: rgb(0x9F_AFCB),
    accent: rgb(0x9C_5E2B),
    on_accent: rgb(0xFF_F7EA),
    accent_line: rgb(0xE0_A067),
    good: rgb(0x6F_CF97),
    warning: rgb(0xF2_B85C),
    bad: rgb(0xFF_7B7F),
    series: [rgb(0xE0_A067), rgb(0x6C_B6F2), rgb(0x6F_CF97), rgb(0xF0_82B4), rgb(0xF2_E06B), rgb(0xB9_A5F5)],
};

/// Light theme: a kitchen table in the morning.
static DAY: Theme = Theme {
    sky: [rgb(0xFB_F6EC), rgb(0xF6_EDDC)],
    snow: rgb(0xD9_C9AC),
    ground: [rgb(0xFF_FFFF), rgb(0xE9_E3DA)],
    world: rgb(0xF3_E6CE),
    world_edge: rgb(0xDC_C7A1),
    inside: [rgb(0xF8_E5C3), rgb(0xEF_D2A3)],
    window: [rgb(0xDF_EBF0), rgb(0xD2_AE7C)],
    wall: rgb(0x8A_4F26),
    wall_shade: rgb(0x6B_3A19),
    dough: rgb(0xB5_713A),
    crust: rgb(0x8A_4F22),
    icing: rgb(0xFF_FAF1),
    icing_shade: rgb(0xD3_BC98),
    candy: [rgb(0xD7_443E), rgb(0x3E_9B6E)],
    pull: rgb(0xE5_484D),
    glow: rgb(0xFF_C24B),
    annotation: rgb(0x3A_2614),
    faint_annotation: rgb(0x7C_674E),
    card: rgba(0xFF_FCF5, 225),
    panel: rgb(0xF7_EFE0),
    well: rgb(0xFF_FCF5),
    button: [rgb(0xEB_DCC0), rgb(0xE2_CEA8), rgb(0xD6_BE92)],
    line: rgb(0xDD_CCAE),
    text: rgb(0x3A_2614),
    faint_text: rgb(0x76_6049),
    accent: rgb(0x9A_5A26),
    on_accent: rgb(0xFF_FBF3),
    accent_line: rgb(0x8F_4F1C),
    good: rgb(0x1F_7A4D),
    warning: rgb(0x9A_5B00),
    bad: rgb(0xB8_2A30),
    series: [rgb(0xA0_5A1E), rgb(0x1F_6FB5), rgb(0x1F_7A4D), rgb(0xB8_3B78), rgb(0x8A_7400), rgb(0x6B_4FC0)],
};

impl Theme {
    /// Theme of the window.
    pub fn of(ctx: &egui::Context) -> &'static Self {
        Self::for_mode(ctx.theme())
    }

    /// Theme of a mode.
    pub const fn for_mode(mode: egui::Theme) -> &'static Self {
        match mode {
            egui::Theme::Dark => &NIGHT,
            egui::Theme::Light => &DAY,
        }
    }

    /// Blends a colour of the stage with the sky by its presence, from 0 (sky) to 1 (colour). The result is opaque.
    pub fn present(&self, color: Color32, presence: f32) -> Color32 {
        if presence >= 1.0 { color } else { self.sky[0].lerp_to_gamma(self.sky[1], 0.5).lerp_to_gamma(color, presence) }
    }

    fn widgets(&self) -> style::Widgets {
        let [rest, hover, press] = self.button;
        style::Widgets {
            noninteractive: style::WidgetVisuals {
                fg_stroke: Stroke::new(1.0, self.text),
                ..widget(self.panel, self.text, Stroke::new(1.0, self.line))
            },
            inactive: widget(rest, self.text, Stroke::NONE),
            hovered: widget(hover, self.text, Stroke::new(1.0, self.accent_line)),
            active: widget(press, self.text, Stroke::new(1.5, self.accent_line)),
            open: widget(press, self.text, Stroke::new(1.0, self.line)),
        }
    }

    fn visuals(&self, base: Visuals) -> Visuals {
        let shade = Shadow { offset: [0, 6], blur: 18, spread: 0, color: Color32::from_black_alpha(70) };
        Visuals {
            weak_text_color: Some(self.faint_text),
            widgets: self.widgets(),
            selection: style::Selection { bg_fill: self.accent, stroke: Stroke::new(1.0, self.on_accent) },
            hyperlink_color: self.accent_line,
            faint_bg_color: self.button[0].gamma_multiply(0.35),
            extreme_bg_color: self.well,
            code_bg_color: self.well,
            warn_fg_color: self.warning,
            error_fg_color: self.bad,
            window_corner_radius: CornerRadius::same(12),
            menu_corner_radius: CornerRadius::same(10),
            window_fill: self.panel,
            window_stroke: Stroke::new(1.0, self.line),
            panel_fill: self.panel,
            window_shadow: shade,
            popup_shadow: shade,
            slider_trailing_fill: true,
            handle_shape: style::HandleShape::Circle,
            indent_has_left_vline: false,
            ..base
        }
    }
}

/// Visuals of a widget in one state.
fn widget(fill: Color32, text: Color32, edge: Stroke) -> style::WidgetVisuals {
    style::WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: edge,
        corner_radius: CornerRadius::same(8),
        fg_stroke: Stroke::new(1.5, text),
        expansion: 0.0,
    }
}

/// Installs both themes in egui.
pub fn install(ctx: &egui::Context) {
    for (mode, visuals) in [(egui::Theme::Dark, Visuals::dark()), (egui::Theme::Light, Visuals::light())] {
        let visuals = Theme::for_mode(mode).visuals(visuals);
        ctx.style_mut_of(mode, |style| {
            style.visuals = visuals;
            measure(style);
        });
    }
}

/// Sets sizes: text readable from a distance, and targets large enough for touch.
fn measure(style: &mut Style) {
    let text = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, text(12.0)),
        (TextStyle::Body, text(14.5)),
        (TextStyle::Button, text(14.5)),
        (TextStyle::Heading, text(19.0)),
        (TextStyle::Monospace, FontId::new(13.5, FontFamily::Monospace)),
    ]
    .into();
    style.drag_value_text_style = TextStyle::Monospace;
    style.animation_time = 0.12;
    // Labels cannot be selected, so that a drag over a panel selects none. Messages allow it themselves.
    style.interaction.selectable_labels = false;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(8.0, 6.0);
    spacing.button_padding = vec2(10.0, 5.0);
    spacing.interact_size = vec2(40.0, 26.0);
    spacing.window_margin = Margin::same(12);
    spacing.menu_margin = Margin::same(8);
    spacing.slider_width = 120.0;
    spacing.slider_rail_height = 6.0;
    spacing.icon_width = 18.0;
    spacing.icon_width_inner = 10.0;
    spacing.icon_spacing = 6.0;
    spacing.combo_width = 120.0;
    spacing.tooltip_width = 320.0;
    // A visible scroll bar shows that content continues, even without the mouse on it.
    spacing.scroll.floating_width = 4.0;
    spacing.scroll.dormant_handle_opacity = 0.4;
}
