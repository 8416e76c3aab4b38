//! Renders the reference of level files from the lists and the doc comments of the code.

use gingerbread::{
    effects::EffectKind,
    finish::Image,
    integrators::{Class, IntegratorKind},
    level::Substeps,
    materials::{Model, TypedEnergy},
    meshes::MeshKind,
    nets::NetKind,
    obstacles::{MotionKind, ObstacleKind},
    quantity::{self, Spec},
    toys::ToyKind,
};
use ron::{extensions::Extensions, ser::PrettyConfig};
use std::{fmt::Write as _, fs};

/// Start of the page.
const HEAD: &str = "\
# Level format

This page lists every field of a level file. It is generated from the code by `tests/docs.rs`. Do not edit it by hand: renew it with
`GINGERBREAD_RENEW=1 cargo test --test docs`. [How to write a level](levels.md) explains the format with an example.

A level is a [RON](https://github.com/ron-rs/ron) file. Lengths are in metres, angles in degrees, all other quantities in SI units.
";

/// Types with a section of their own: declaration, file below `src`, and heading.
const DECLARED: &[(&str, &str, &str)] = &[
    ("struct Level", "level.rs", "Level"),
    ("struct BodyLevel", "level.rs", "Body"),
    ("enum ElementKind", "elements/kind.rs", "Element of a body"),
    ("struct Place", "level.rs", "Place of a body"),
    ("enum MassLevel", "level.rs", "Mass of a body"),
    ("enum StartShape", "level.rs", "Start shape of a body"),
    ("enum Pin", "meshes/pin.rs", "Pin"),
    ("enum Side", "level.rs", "Side of a body"),
    ("enum Plane", "materials/parameters.rs", "Plane strain and plane stress"),
    ("struct NetLevel", "level.rs", "Net"),
    ("struct MembraneLevel", "level.rs", "Membrane"),
    ("struct SpacePlace", "level.rs", "Place in space"),
    ("struct Finish", "finish.rs", "Finish of cloth"),
    ("enum Pattern", "finish.rs", "Pattern of cloth"),
    ("enum Sheen", "finish.rs", "Sheen of cloth"),
    ("struct EffectLevel", "level.rs", "Effect in a level"),
    ("struct SurfaceFriction", "effects/friction.rs", "Friction of a surface"),
    ("enum ProjectedPins", "effects/projection.rs", "Pins and projection"),
    ("enum WireShape", "effects/wire.rs", "Wires"),
    ("enum SpringOrder", "nets/sheet.rs", "Order of springs"),
    ("enum Switch", "level.rs", "Switch of an effect"),
    ("enum When", "level.rs", "Modes of an effect"),
    ("enum RunMode", "level.rs", "Run mode"),
    ("enum Toggle", "level.rs", "On and off"),
    ("enum Sleep", "level.rs", "Sleep"),
    ("enum SubstepMode", "level/steps.rs", "Multirate stepping"),
    ("struct StretchTest", "level.rs", "Test of stretch and compression"),
    ("struct ScriptedAction", "level/script.rs", "Scripted action"),
    ("enum Action", "level/script.rs", "Kinds of scripted actions"),
    ("struct RecordedEnd", "level/script.rs", "End of a recorded run"),
    ("struct Check", "level/check.rs", "Known result"),
    ("enum CheckPlace", "level/check.rs", "Place of a known result"),
    ("struct Note", "level/note.rs", "Note"),
    ("enum NotePlace", "level/note.rs", "Place of a note"),
    ("enum Diagonals", "meshes/rectangle.rs", "Diagonals of a rectangle"),
    ("struct Case", "hard/case.rs", "Hard case"),
    ("enum Lasts", "hard/case.rs", "Duration of a hard case"),
    ("enum Expects", "hard/case.rs", "Expected end of a hard case"),
    ("struct Cannot", "hard/case.rs", "Known failure of a hard case"),
    ("enum Method", "hard/method.rs", "Method of a hard case"),
    ("enum Experiment", "hard/experiment.rs", "Experiment of a hard case"),
];

/// Types that are lists of kinds or are described by hand, and the headings of their sections.
const LISTED: &[(&str, &str)] = &[
    ("MaterialParameters", "Material"),
    ("TypedEnergy", "Typed energy"),
    ("Model", "Models"),
    ("MeshKind", "Meshes"),
    ("NetKind", "Nets"),
    ("ToyKind", "Toys"),
    ("EffectKind", "Effects"),
    ("ObstacleKind", "Obstacles"),
    ("MotionKind", "Motions"),
    ("IntegratorKind", "Integrators"),
];

macro_rules! specs {
    ($($Name:ident)+) => { &[$((stringify!($Name), &quantity::$Name::SPEC)),+] };
}

/// All quantities by the names of their types; [`unlisted_quantities`] finds those that are missing.
#[rustfmt::skip]
const SPECS: &[(&str, &Spec)] = specs![
    PatternSize Young Poisson Density Mass Coordinate Time Period Length Width Height Depth Factor Noise Angle Velocity VelocityX VelocityY Spin Gravity
    DampingRate DampingTime Spring VerletDamping RelativeTolerance AbsoluteTolerance SleepTolerance StructuralSpring ShearSpring FlexionSpring RestLength
    ParticleMass DragCoefficient Radius Weight Swing Reach FrictionCoefficient RestitutionCoefficient CompressionStrength SkinModulus
    SkinThickness ImpactSpeed Dissipation Thickness Triangles Tolerance Cells Springs Rings Passes Separation StructuralCorrection ShearCorrection FlexionCorrection WindSpeed FaceResistance
    OwnMotion GustShare GustPeriod TurbulenceShare EddySize Circulation CoreRadius Updraft DropRate DropImpulse DropDuration RecoveryRate ForceFactor BendingFactor
    TractionX TractionY Pressure KnownValue Deviation
];

/// Longest example that is shown [characters].
const LONGEST: usize = 120;

/// A field of a struct or a variant of an enum, as its source declares it.
#[derive(Default)]
pub struct Item {
    /// Its name.
    pub name: String,
    /// Type of a field, or of what a variant holds; empty if a variant holds nothing.
    kind: String,
    /// Fields of a variant with named fields, with their types.
    fields: Vec<(String, String)>,
    /// Whether a field may be left out, or a variant is the default.
    default: bool,
    /// Whether no file can hold it.
    is_hidden: bool,
    /// Its doc comment.
    doc: String,
}

/// First paragraph of the doc comment of a declaration, and its fields or variants. `head` is its line up to the brace, such as
/// `pub struct Level {`.
pub fn declared(file: &str, head: &str) -> (String, Vec<Item>) {
    let text = fs::read_to_string(format!("src/{file}")).unwrap_or_else(|error| panic!("src/{file}: {error}"));
    let lines: Vec<&str> = text.lines().collect();
    let start = lines.iter().position(|line| line.starts_with(head));
    let start = start.unwrap_or_else(|| panic!("src/{file} does not declare `{head}`"));
    let above = lines[..start].iter().rev().take_while(|line| line.starts_with("///") || line.starts_with("#["));
    let mut above: Vec<&str> = above.copied().collect();
    above.reverse();
    let all_optional = above.iter().any(|line| line.starts_with("#[serde(") && line.contains("default"));
    let about = above.iter().filter_map(|line| line.strip_prefix("///")).map(str::trim);
    let about: Vec<&str> = about.take_while(|line| !line.is_empty()).collect();
    let mut items = Vec::new();
    if lines[start].ends_with('{') {
        let body: Vec<&str> = lines[start + 1..].iter().copied().take_while(|line| *line != "}").collect();
        items = members(&body);
    }
    for item in &mut items {
        item.default |= all_optional;
    }
    (plain(&about.join(" ")), items)
}

/// The fields or variants between two braces.
fn members(body: &[&str]) -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    let mut next = Item::default();
    for line in body {
        let text = line.trim();
        let depth = line.len() - line.trim_start().len();
        if depth > 4 {
            // A field of the last variant.
            if let (Some((name, kind)), Some(item)) = (text.split_once(": "), items.last_mut())
                && name.chars().all(|letter| letter.is_ascii_lowercase() || letter == '_')
            {
                item.fields.push((name.to_owned(), kind.trim_end_matches(',').to_owned()));
            }
        } else if let Some(words) = text.strip_prefix("///") {
            next.doc.push_str(if next.doc.is_empty() { "" } else { " " });
            next.doc.push_str(words.trim());
        } else if text.starts_with("#[") {
            next.default |= text.contains("default");
            next.is_hidden |= text.contains("skip_deserializing");
        } else if let Some((name, kind)) = text.strip_prefix("pub ").and_then(|field| field.split_once(": ")) {
            name.clone_into(&mut next.name);
            kind.trim_end_matches(',').clone_into(&mut next.kind);
            items.push(std::mem::take(&mut next));
        } else if text.starts_with(|first: char| first.is_ascii_uppercase()) {
            let end = text.find(['(', ' ', ',']).unwrap_or(text.len());
            let held = text[end..].trim_end_matches(',').strip_prefix('(').and_then(|held| held.strip_suffix(')'));
            let held = held.map_or("", |held| held.split_once("] ").map_or(held, |(_, kind)| kind));
            (next.name, next.kind) = (text[..end].to_owned(), held.to_owned());
            items.push(std::mem::take(&mut next));
        } else {
            next = Item::default();
        }
    }
    // What a file cannot hold is made in code.
    items.retain(|item| !item.is_hidden);
    for item in &mut items {
        item.doc = plain(&item.doc);
    }
    items
}

/// A doc comment as text for a page: links to items become code, and brackets of units need no escape.
fn plain(doc: &str) -> String {
    doc.replace("[`", "`").replace("`]", "`").replace("`Self::", "`").replace("\\[", "[").replace("\\]", "]")
}

/// Text for a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The anchor that GitHub gives to a heading.
pub fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|letter| letter.is_alphanumeric() || [' ', '-', '_'].contains(letter));
    kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect::<String>().to_lowercase()
}

/// The name of the file of a kind: `MouseSpring` is in `mouse_spring`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

/// What is written for a type, in words.
fn value(kind: &str) -> String {
    let kind = kind.trim_start_matches("quantity::");
    let of = |outer: &str| kind.strip_prefix(outer)?.strip_prefix('<')?.strip_suffix('>');
    if let Some(inner) = of("Option").or_else(|| of("Box")) {
        return value(inner);
    }
    if let Some(inner) = of("Vec") {
        return format!("list `[…]` of: {}", value(inner));
    }
    if let Some(inner) = of("Whole") {
        return format!("whole {}", value(inner));
    }
    if let Some(members) = kind.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
        let members: Vec<String> = members.split(", ").map(value).collect();
        let same = members.iter().all(|member| *member == members[0]);
        let each = if same { format!("each: {}", members[0]) } else { members.join("; ") };
        return format!("group `({})`, {each}", vec!["…"; members.len()].join(", "));
    }
    if !kind.contains(['<', '(']) && kind.contains(", ") {
        return kind.split(", ").map(value).collect::<Vec<_>>().join("; ");
    }
    if let Some((_, spec)) = SPECS.iter().find(|(name, _)| *name == kind) {
        return format!("number, {}", spec.range());
    }
    let declared = DECLARED.iter().find(|(declaration, ..)| declaration.split(' ').nth(1) == Some(kind));
    let listed = LISTED.iter().find(|(listed, _)| *listed == kind);
    if let Some(heading) = declared.map(|(.., heading)| heading).or_else(|| listed.map(|(_, heading)| heading)) {
        return format!("[{heading}](#{})", anchor(heading));
    }
    match kind {
        "String" => "text in double quotes".to_owned(),
        "PointFormula" => "formula in double quotes, of `x`, `y`, `z`, `vx`, `vy`, `vz` and `t`".to_owned(),
        "Colour" => "colour in double quotes: `#` and two hexadecimal digits each of red, green and blue".to_owned(),
        "Image" => format!("PNG file of at most {0} x {0} pixels in double quotes, as base64 text", Image::MOST_PIXELS),
        "PathBuf" => "path in double quotes".to_owned(),
        "Point" => "point `(x, y)` in m".to_owned(),
        "SpacePoint" => "point `(x, y, z)` in m".to_owned(),
        "Position" => "point `(x, y)`, or `(x, y, z)` in space, in m".to_owned(),
        "Substeps" => format!("whole number, at least 1 and at most {}", Substeps::MAX),
        "u32" => format!("whole number, at least 0 and at most {}", u32::MAX),
        "bool" => "`true` or `false`".to_owned(),
        "SavedState" => "state, as the program saves it".to_owned(),
        other => format!("`{other}`"),
    }
}

/// A table of the fields of a struct.
fn fields(page: &mut String, items: &[Item]) {
    page.push_str("\n| field | value | | meaning |\n|---|---|---|---|\n");
    for Item { name, kind, default, doc, .. } in items {
        let needed = if *default { "optional" } else { "required" };
        writeln!(page, "| `{name}` | {} | {needed} | {} |", cell(&value(kind)), cell(doc)).unwrap();
    }
}

/// A table of the variants of an enum.
fn variants(page: &mut String, items: &[Item]) {
    page.push_str("\n| value | meaning |\n|---|---|\n");
    for Item { name, kind, fields, default, doc, .. } in items {
        let (written, mut meaning) = match (kind.is_empty(), fields.is_empty()) {
            (true, true) => (name.clone(), doc.clone()),
            (false, _) => (format!("{name}(…)"), format!("{doc} Holds: {}.", value(kind))),
            (true, false) => {
                let each: Vec<String> =
                    fields.iter().map(|(name, kind)| format!("`{name}`: {}", value(kind))).collect();
                (format!("{name}(…)"), format!("{doc} Fields: {}.", each.join("; ")))
            }
        };
        if *default {
            meaning.push_str(" This is the default.");
        }
        writeln!(page, "| `{written}` | {} |", cell(&meaning)).unwrap();
    }
}

/// A section with what a type of the code declares.
fn section(page: &mut String, kind: &str) {
    let entry = DECLARED.iter().find(|(declaration, ..)| declaration.split(' ').nth(1) == Some(kind));
    let (declaration, file, heading) = entry.unwrap_or_else(|| panic!("{kind} has no section"));
    let (about, items) = declared(file, &format!("pub {declaration} {{"));
    writeln!(page, "\n### {heading}\n\n{about}").unwrap();
    if declaration.starts_with("enum") { variants(page, &items) } else { fields(page, &items) }
}

/// A kind as a level file has it, with the parameters that the menus begin with.
fn written(kind: &impl serde::Serialize) -> String {
    let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
    let options = ron::Options::default().with_default_extension(extensions);
    options.to_string_pretty(kind, PrettyConfig::new().depth_limit(0)).unwrap()
}

/// A section of a kind: its fields, and an example if that is short. Without `about` the doc comment of its struct says what it is.
fn kind(page: &mut String, room: &str, name: &str, about: Option<&str>, example: &str) {
    let (doc, items) = declared(&format!("{room}/{}.rs", snake(name)), &format!("pub struct {name} {{"));
    writeln!(page, "\n### `{name}`\n\n{}", about.unwrap_or(&doc)).unwrap();
    if !items.is_empty() {
        fields(page, &items);
    }
    if example.chars().count() <= LONGEST {
        writeln!(page, "\nExample: `{example}`").unwrap();
    }
}

fn models(page: &mut String) {
    page.push_str("\n## Models\n\nThe key switches all bodies to the model. [Physics](physics.md#materials) has the formulas and sources.\n");
    page.push_str("\n| `model` | key | name | energy density | continuation of the formula |\n|---|---|---|---|---|\n");
    for model in Model::ALL {
        let (name, key, title) = (model.name(), model.letter(), model.title());
        let (formula, continuation) = (cell(model.formula()), cell(model.continuation()));
        writeln!(page, "| `{name}` | {key} | {title} | {formula} | {continuation} |").unwrap();
    }
}

fn material(page: &mut String) {
    page.push_str("\n## Material\n\n| field | value | | meaning |\n|---|---|---|---|\n");
    let rows = [
        ("model", "Model", "required", "Constitutive model."),
        ("young", "Young", "required", quantity::Young::SPEC.help),
        ("poisson", "Poisson", "required", quantity::Poisson::SPEC.help),
        ("plane", "Plane", "optional", "Whether the thickness or the stress through it is zero."),
    ];
    for (name, kind, needed, meaning) in rows {
        writeln!(page, "| `{name}` | {} | {needed} | {} |", cell(&value(kind)), cell(meaning.trim())).unwrap();
    }
    section(page, "Plane");
    let (about, _) = declared("materials/typed.rs", "pub struct TypedEnergy {");
    writeln!(page, "\n### Typed energy\n\n{about}").unwrap();
    page.push_str("\n| field | value | | meaning |\n|---|---|---|---|\n");
    page.push_str("| `formula` | formula in double quotes, of `I1`, `J`, `mu`, `lambda`, `E`, `nu` and the parameters | required | The energy density [J/m²]. |\n");
    page.push_str(
        "| `parameters` | list `[(\"name\", number), …]`, at most 12 | optional | Named numbers of the formula. |\n",
    );
    let example = TypedEnergy::new(
        "c/2*(I1 - 2) - c*log(J) + k*(J - 1)^2",
        [("c", 40.0), ("k", 2.5)].map(|(name, value)| (name.to_owned(), value)).into(),
    );
    writeln!(page, "\nExample: `energy: {}`", written(&example.unwrap())).unwrap();
}

fn integrators(page: &mut String) {
    page.push_str(
        "\n## Integrators\n\n| `integrator` | name | order | limit of the step | about |\n|---|---|---|---|---|\n",
    );
    for listed in IntegratorKind::all() {
        let (name, scheme) = (listed.name(), listed.kind());
        let limit = match (scheme.class(), scheme.stability_limit()) {
            (Class::Implicit, _) => "accuracy only".to_owned(),
            (Class::ErrorControlled, _) => "its own error estimate".to_owned(),
            (Class::Explicit, Some(0.0)) => "unstable without damping".to_owned(),
            (Class::Explicit, Some(limit)) => format!("h < {limit:.3}/ω"),
            (Class::Explicit, None) => "none is known".to_owned(),
        };
        let (title, order, about) = (scheme.title(), scheme.order(), cell(scheme.about()));
        writeln!(page, "| `{name}()` | {title} | {order} | {limit} | {about} |").unwrap();
    }
    for listed in IntegratorKind::all() {
        let name = listed.name();
        let (_, items) = declared(&format!("integrators/{}.rs", snake(name)), &format!("pub struct {name} {{"));
        if !items.is_empty() {
            kind(page, "integrators", name, Some(listed.kind().about()), &written(&listed));
        }
    }
}

/// The whole page.
pub fn page() -> String {
    let mut page = HEAD.to_owned();
    page.push_str("\n## Structure\n");
    let bodies = "Level RunMode SubstepMode Toggle Sleep BodyLevel ElementKind Place MassLevel StartShape Pin Side NetLevel MembraneLevel SpacePlace Finish Pattern Sheen";
    let actions =
        "EffectLevel Switch When StretchTest ScriptedAction Action RecordedEnd Check CheckPlace Note NotePlace";
    for kind in bodies.split(' ').chain(actions.split(' ')) {
        section(&mut page, kind);
    }
    material(&mut page);
    models(&mut page);
    page.push_str("\n## Meshes\n");
    for listed in MeshKind::all() {
        kind(&mut page, "meshes", listed.name(), None, &written(&listed));
    }
    section(&mut page, "Diagonals");
    page.push_str("\n## Nets\n");
    for listed in NetKind::all() {
        kind(&mut page, "nets", listed.name(), None, &written(&listed));
    }
    section(&mut page, "SpringOrder");
    page.push_str("\n## Toys\n");
    for listed in ToyKind::all() {
        kind(&mut page, "toys", listed.name(), Some(listed.kind().about()), &written(&listed));
    }
    page.push_str("\n## Effects\n");
    for listed in EffectKind::all() {
        let about = format!("{}. {}", listed.kind().title(), listed.kind().about());
        kind(&mut page, "effects", listed.name(), Some(&about), &written(&listed));
    }
    section(&mut page, "SurfaceFriction");
    section(&mut page, "ProjectedPins");
    section(&mut page, "WireShape");
    page.push_str("\n## Obstacles\n");
    for listed in ObstacleKind::all() {
        kind(&mut page, "obstacles", listed.name(), None, &written(&listed));
    }
    page.push_str("\n## Motions\n");
    for listed in MotionKind::all() {
        kind(&mut page, "obstacles/motions", listed.name(), None, &written(&listed));
    }
    integrators(&mut page);
    page.push_str("\n## Hard cases\n");
    for kind in ["Case", "Lasts", "Expects", "Cannot", "Method", "Experiment"] {
        section(&mut page, kind);
    }
    page
}

/// Quantities of the code that [`SPECS`] lacks.
pub fn unlisted_quantities() -> Vec<String> {
    let text = fs::read_to_string("src/quantity.rs").unwrap();
    let names = text.lines().filter(|line| line.contains("\"] in ")).filter_map(|line| line.trim().split_once(": \""));
    let names = names.map(|(name, _)| name.to_owned());
    names.filter(|name| SPECS.iter().all(|(known, _)| known != name)).collect()
}
