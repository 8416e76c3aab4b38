//! What goes wrong outside: bits that flip in a running state, edits that make no shape, saves that are cut off. Nothing panics,
//! nothing good is lost, and it goes on from there.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failing test should panic, and a child reports")]

use crate::common::{Random, folder::Folder, level, released, seen, simulation};
use gingerbread::{
    command::{Command, Mode},
    files,
    integrators::IntegratorKind,
    level::{EffectLevel, Level, SavedState},
    meshes::{Files, MeshKind},
    quantity::Position,
    sandbox::Sandbox,
    simulation::Simulation,
    state::State,
};
use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Command as Process, Stdio},
};

/// A sheet that swings over a ball, under every kind that remembers something, and one that does not.
fn swinging() -> impl Iterator<Item = Level> {
    let kinds = IntegratorKind::all().into_iter();
    let remembering = ["SymplecticEuler", "PositionVerlet", "DormandPrince", "Bdf2"];
    kinds.filter(move |kind| remembering.contains(&kind.name())).map(|integrator| {
        let effects = "(effect: Gravity(down: 9.8)), (effect: Walls(obstacles: [Ball(centre: (0.5, 0.2), radius: 0.09, eps: 0.01)]))";
        Level { integrator, ..released(&format!("effects: [{effects}]")) }
    })
}

/// Sign, highest and lowest bit and one more of the exponent, highest and lowest of the mantissa.
const BITS: [u32; 6] = [63, 62, 57, 52, 51, 0];

/// Every flipped bit of one random number in positions, velocities and memory each, and of the time.
fn flipped(state: &State, random: &mut Random) -> Vec<State> {
    let flip = |number: &mut f64, bit: u32| *number = f64::from_bits(number.to_bits() ^ (1 << bit));
    let mut all = Vec::new();
    for bit in BITS {
        let fields: [fn(&mut State) -> &mut [f64]; 4] = [
            |state| &mut state.x,
            |state| &mut state.v,
            |state| &mut state.memory,
            |state| std::slice::from_mut(&mut state.time),
        ];
        for field in fields {
            let mut hit = state.clone();
            let numbers = field(&mut hit);
            // A scheme may remember nothing.
            if numbers.is_empty() {
                continue;
            }
            let at = (random.between(0.0, numbers.len() as f64) as usize).min(numbers.len() - 1);
            flip(&mut numbers[at], bit);
            all.push(hit);
        }
        let mut hit = state.clone();
        hit.steps ^= 1 << bit;
        all.push(hit);
    }
    all
}

/// A fault keeps the last good state.
#[test]
fn a_flipped_bit_ends_in_finite_numbers_or_a_fault() {
    let (mut random, mut faults, mut went_on) = (Random(21), 0, 0);
    for level in swinging() {
        let mut good = simulation(&level);
        good.advance(40, &mut || true);
        let before = good.state().clone();
        good.advance(20, &mut || true);
        for _ in 0..4 {
            for hit in flipped(&before, &mut random) {
                let mut run = simulation(&level);
                run.set_state(hit.clone());
                let taken = run.advance(20, &mut || true);
                if let Some(fault) = run.fault() {
                    assert!(!fault.to_string().is_empty());
                    // Bits show what is not a number to be the same.
                    let bits = |state: &State| {
                        state.x.iter().chain(&state.v).map(|number| number.to_bits()).collect::<Vec<_>>()
                    };
                    assert!(run.state().is_finite() || (taken == 0 && bits(run.state()) == bits(&hit)));
                    faults += 1;
                } else {
                    assert!(run.state().is_finite() && taken == 20);
                    went_on += 1;
                }
                assert_eq!(run.state().steps, hit.steps + taken);
                // Nothing of it stays behind.
                run.set_state(before.clone());
                assert_eq!(run.advance(20, &mut || true), 20);
                assert_eq!(run.state(), good.state(), "{}", level.integrator.name());
            }
        }
    }
    assert!(faults > 20 && went_on > 100, "{faults} faults, {went_on} went on");
}

/// Everything a person could miss.
fn all(sandbox: &Sandbox) -> (Level, bool, bool, Mode, State) {
    let seen = seen(sandbox);
    (sandbox.saved(), seen.can_undo, seen.can_redo, seen.mode, sandbox.simulation().state().clone())
}

/// Reset, rewind and undo lead on from there.
#[test]
fn a_saved_level_with_a_flipped_bit_is_refused_or_runs() {
    let mut random = Random(22);
    let (mut refused, mut opened) = (0, 0);
    for level in swinging() {
        let mut sandbox = Sandbox::new(level.clone(), Box::new(NoFiles)).unwrap();
        sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
        sandbox.advance(40, &mut || true);
        let saved = sandbox.saved();
        let state = sandbox.simulation().state().clone();
        for hit in flipped(&state, &mut random) {
            let mut text = files::write(&saved).unwrap();
            for (from, to) in state.x.iter().chain(&state.v).zip(hit.x.iter().chain(&hit.v)) {
                if from.to_bits() != to.to_bits() {
                    text = text.replacen(&format!("{from:?}"), &format!("{to:?}"), 1);
                }
            }
            let hurt = match files::parse(&text, "hurt.ron") {
                Ok(hurt) => hurt,
                Err(error) => {
                    assert!(error.to_string().contains("must be "), "{error}");
                    refused += 1;
                    continue;
                }
            };
            opened += 1;
            let before = all(&sandbox);
            sandbox.apply(Command::Open(Box::new(hurt))).unwrap();
            sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
            sandbox.advance(40, &mut || true);
            assert!(sandbox.simulation().state().is_finite());
            assert!(seen(&sandbox).positions.iter().all(|x| x.is_finite()));
            assert_eq!(
                Level { state: None, ..sandbox.saved() },
                Level { state: None, ..saved.clone() },
                "the level stays"
            );
            sandbox.apply(Command::Rewind(1.0)).unwrap();
            assert!(sandbox.simulation().fault().is_none() && !sandbox.is_live());
            sandbox.apply(Command::Reset).unwrap();
            sandbox.apply(Command::SetRunning(true)).unwrap();
            assert_eq!(sandbox.advance(40, &mut || true), 40);
            assert_eq!(sandbox.simulation().state(), &state, "from the start it goes as ever");
            // The first step back takes back the reset, and the next one the opening.
            sandbox.apply(Command::Undo).unwrap();
            sandbox.apply(Command::Undo).unwrap();
            let after = all(&sandbox);
            assert_eq!((after.0, after.1, after.4), (before.0, before.1, before.4));
        }
    }
    assert!(refused > 3 && opened > 50, "{refused} refused, {opened} opened");
}

/// Files that hold a triangle without area, and nothing else.
struct NoFiles;

impl Files for NoFiles {
    fn read(&self, path: &std::path::Path) -> Result<String, String> {
        match path.to_str().unwrap() {
            "flat.obj" => Ok("v 0 0\nv 1 1\nv 2 2\nf 1 2 3\n".to_owned()),
            _ => Err("there is no such file".to_owned()),
        }
    }
}

fn mesh(text: &str) -> MeshKind {
    let text = format!(
        "(name: \"\", bodies: [(name: \"\", mesh: {text}, mass: Total(1), material: (model: Corotated, young: 1, poisson: 0))])"
    );
    level(&text).bodies.remove(0).mesh
}

#[test]
fn an_edit_to_a_triangle_without_area_changes_nothing() {
    let base = released("effects: [(effect: Gravity(down: 9.8))]");
    let placed = |place: &str| {
        let text = files::write(&base).unwrap();
        Command::Open(Box::new(level(&text.replacen("material:", &format!("place: ({place}), material:"), 1))))
    };
    let effect = |text: &str| {
        let text = format!("(name: \"\", bodies: [], effects: [(effect: Walls(obstacles: [{text}]))])");
        level(&text).effects.remove(0)
    };
    let edits: Vec<(Command, &str)> = vec![
        (Command::SetMesh(0, mesh("Points(points: [(0, 0), (1, 1), (2, 2)], triangles: [(0, 1, 2)])")), "area"),
        (Command::SetMesh(0, mesh("Points(points: [(0, 0), (1, 0), (0, 1)], triangles: [(0, 1, 1)])")), "area"),
        (
            Command::SetMesh(0, mesh("Points(points: [(0, 0), (1e-200, 0), (0, 1e-200)], triangles: [(0, 1, 2)])")),
            "area",
        ),
        (Command::SetMesh(0, mesh("Outline(points: [(0, 0), (1, 0), (2, 0)], resolution: 100)")), ""),
        (Command::SetMesh(0, mesh("Obj(path: \"flat.obj\")")), "area"),
        (Command::SetEffect(0, effect("Polygon(points: [(0, 0), (1, 1), (2, 2)], eps: 0.01)")), "area"),
        (placed("scale: 1e-200"), "area"),
        (placed("offset: (1e14, 0), scale: 0.001"), "area"),
        (placed("offset: (-9e14, 9e14), scale: 0.5"), "area"),
    ];
    let mut sandbox = Sandbox::new(base.clone(), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(30, &mut || true);
    let listed = EffectLevel { switch: gingerbread::level::Switch::Off, ..base.effects[0].clone() };
    sandbox.apply(Command::SetEffect(0, listed)).unwrap();
    sandbox.apply(Command::Undo).unwrap();
    for (edit, reason) in edits {
        let before = all(&sandbox);
        let what = format!("{edit:?}");
        let why = sandbox.apply(edit).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(why.len() > 20 && why.contains(reason), "{what}: {why:?}");
        assert_eq!(all(&sandbox), before, "{what}");
    }
    let before = sandbox.simulation().state().steps;
    sandbox.advance(10, &mut || true);
    assert_eq!(sandbox.simulation().state().steps, before + 10, "and time runs on");
    for text in ["stretch: (0, 1)", "stretch: (1, -1)"] {
        let text = files::write(&base).unwrap().replacen("material:", &format!("{text}, material:"), 1);
        assert!(files::parse(&text, "flat.ron").is_err());
    }
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_failed_save_leaves_only_the_old_file() {
    let folder = Folder::new("failing");
    let path = folder.0.join("level.ron");
    let (old, new) = (released(""), Level { name: "new".to_owned(), ..released("") });
    files::save(&path, &old).unwrap();
    let part = folder.0.join(format!("level.ron.{}.part", std::process::id()));
    let refused = |before: &[&str]| {
        let why = files::save(&path, &new).unwrap_err().to_string();
        assert!(why.contains("level.ron: "), "{why}");
        assert_eq!(entries(&folder.0), before);
        assert_eq!(files::read(&path).unwrap(), old);
    };
    // Nothing can be begun.
    fs::create_dir(&part).unwrap();
    refused(&["level.ron", part.file_name().unwrap().to_str().unwrap()]);
    fs::remove_dir(&part).unwrap();
    // The disk is full.
    #[cfg(target_os = "linux")]
    {
        std::os::unix::fs::symlink("/dev/full", &part).unwrap();
        refused(&["level.ron"]);
    }
    // A half from before, of a process of the same number, is in nobody's way.
    fs::write(&part, "(name: \"ha").unwrap();
    files::save(&path, &new).unwrap();
    assert_eq!((files::read(&path).unwrap(), entries(&folder.0)), (new.clone(), vec!["level.ron".to_owned()]));
    // The name is taken by something that no file can replace.
    let taken = folder.0.join("taken.ron");
    fs::create_dir_all(taken.join("inside")).unwrap();
    assert!(files::save(&taken, &new).is_err());
    assert_eq!(
        (entries(&folder.0), entries(&taken)),
        (vec!["level.ron".to_owned(), "taken.ron".to_owned()], vec!["inside".to_owned()])
    );
}

/// Tells the child where to save.
const INTO: &str = "GINGERBREAD_TEST_SAVES_INTO";

/// Two levels that are long enough to be caught in the middle.
fn long_ones() -> [Level; 2] {
    let long = |number: f64| {
        let point = Position::new(&[number, 1.0 / 3.0]).unwrap();
        let time = gingerbread::quantity::Time::new(0.1).unwrap();
        let state = SavedState::new((3, time), vec![point; 60_000], vec![point; 60_000]);
        Level { state: Some(state), ..released("") }
    };
    [long(0.1), long(0.7)]
}

/// Saves for ever, if it is asked to: see the test after it.
#[test]
fn child_that_saves() {
    let Some(path) = std::env::var_os(INTO).map(PathBuf::from) else { return };
    let levels = long_ones();
    loop {
        println!("saving");
        files::save(&path, &levels[0]).unwrap();
        println!("saving");
        files::save(&path, &levels[1]).unwrap();
    }
}

/// It also fills a pipe.
#[test]
#[cfg(unix)]
fn saving_follows_links_and_keeps_permissions() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = Folder::new("special");
    let [file, link, pipe] = ["file", "link", "pipe"].map(|name| folder.0.join(name));
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
    symlink("file", &link).unwrap();
    files::write_text(&link, "new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink() && fs::read_to_string(&file).unwrap() == "new");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    assert!(Process::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| fs::read_to_string(&pipe).unwrap());
        files::write_text(&pipe, "through").unwrap();
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
        assert_eq!(reader.join().unwrap(), "through");
    });
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 3, "nothing is left over");
}

#[test]
fn a_killed_save_leaves_the_old_or_the_new_file_whole() {
    let folder = Folder::new("killed");
    let path = folder.0.join("level.ron");
    let levels = long_ones();
    for saves in 2..8 {
        let mut child = Process::new(std::env::current_exe().unwrap())
            .args(["--exact", "faults::child_that_saves", "--nocapture"])
            .env(INTO, &path)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let begun = lines.filter(|line| line.contains("saving")).take(saves).count();
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(begun, saves);
        let left = files::read(&path).unwrap();
        assert!(levels.contains(&left), "a half");
        files::save(&path, &levels[saves % 2]).unwrap();
        assert_eq!(files::read(&path).unwrap(), levels[saves % 2]);
    }
}

#[test]
fn a_simulation_recovers_from_a_grab_at_nan() {
    let mut run: Simulation = simulation(&released("effects: [(effect: MouseSpring(stiffness: 50))]"));
    run.set_grab(Some(gingerbread::effects::Grab { vertex: 0, target: [f64::NAN, 0.0, 0.0] }));
    run.advance(10, &mut || true);
    assert!(run.fault().is_some() && run.state().is_finite());
    run.set_grab(None);
    let state = run.state().clone();
    run.set_state(state);
    assert_eq!(run.advance(10, &mut || true), 10);
}
