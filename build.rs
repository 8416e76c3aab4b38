//! Lists the files of `levels/` and `levels/hard/`, so that adding a level is adding a file; and names the commit, for the heads of tables.

use std::{env, fmt::Write as _, fs, io, path::Path, process::Command};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=levels");
    let root = env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?;
    name_commit(Path::new(&root));
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    let levels = Path::new(&root).join("levels");
    let mut list = String::new();
    for (folder, name, what) in [(levels.clone(), "BUILT_IN", "level"), (levels.join("hard"), "HARD", "hard case")] {
        writeln!(list, "/// File name and text of each built-in {what}, by name.").map_err(io::Error::other)?;
        list_files(&folder, name, &mut list)?;
    }
    fs::write(Path::new(&out).join("levels.rs"), list)
}

/// Adds a constant with the names and texts of a folder's levels.
fn list_files(folder: &Path, constant: &str, list: &mut String) -> io::Result<()> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if Path::new(&name).extension().is_some_and(|extension| extension == "ron") {
            names.push(name);
        }
    }
    names.sort();
    writeln!(list, "pub const {constant}: &[(&str, &str)] = &[").map_err(io::Error::other)?;
    for name in names {
        let path = folder.join(&name);
        println!("cargo::rerun-if-changed={}", path.display());
        writeln!(list, "    ({name:?}, include_str!({:?})),", path.display().to_string()).map_err(io::Error::other)?;
    }
    list.push_str("];\n");
    Ok(())
}

/// Sets `GINGERBREAD_COMMIT`, if this is a git checkout and there is a git to ask.
fn name_commit(root: &Path) {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    // A package unpacked inside another repository must not take that one's commit for its own.
    let Some(top) = git(&["rev-parse", "--show-toplevel"]) else { return };
    if fs::canonicalize(top).ok() != fs::canonicalize(root).ok() {
        return;
    }
    if let Some(commit) = git(&["rev-parse", "HEAD"]) {
        println!("cargo::rustc-env=GINGERBREAD_COMMIT={commit}");
    }
    // The file that says where HEAD is changes with every commit and checkout.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={}", root.join(log).display());
    }
}
