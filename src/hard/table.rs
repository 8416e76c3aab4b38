//! Results of hard cases as a table.

use super::{Failure, Numbers, Trial, Verdict, verdict::Count};
use crate::table;

/// Columns of the table, separated by commas.
pub const COLUMNS: &str =
    "case,model,method,held,area_error,energy_gain,outside,unsolved_steps,energy_left,untangle,reason";

/// Row of the table for a trial as CSV: the deciding numbers, rounded, and the reason why it is not held, if known.
pub fn row(trial: &Trial, verdict: &Verdict) -> String {
    let Trial { name, case, model, method } = trial;
    let Numbers { gain, outside, area, unsolved, elastic, opens, .. } = verdict.numbers;
    let held = if verdict.held() { "held" } else { "not held" };
    // Energy left if a body did not return to its rest shape [J], and whether it returns after untangling.
    let (mut left, mut untangle) = (String::new(), "");
    if area.is_some() && !verdict.held() {
        (left, untangle) = (format!("{elastic:.1e}"), if opens { "home" } else { "" });
    }
    let area = area.map_or(String::new(), rounded);
    let (gain, outside, unsolved) = (rounded(gain), rounded(outside), unsolved.to_string());
    let cells = [name, model.name(), method.name(), held, &area, &gain, &outside, &unsolved, &left, untangle];
    let reason = verdict.failure.map_or(String::new(), |failure| {
        let why = case.cannot(*model, *method).unwrap_or("UNEXPLAINED");
        table::quoted(&format!("{}: {}", failure.words(&verdict.numbers), why.replace('"', "'")))
    });
    table::row(cells) + "," + &reason
}

/// Share rounded to two digits. Values far below every limit are unified, so that the table does not change with them.
fn rounded(share: f64) -> String {
    if share <= 0.0 {
        "0".to_owned()
    } else if share < 1e-6 {
        "<1e-6".to_owned()
    } else {
        format!("{share:.1e}")
    }
}

impl Failure {
    /// Failure in plain words.
    fn words(self, numbers: &Numbers) -> String {
        match self {
            Self::Stopped => format!("stopped at {:.2} s", numbers.time),
            Self::Energy => "energy from nowhere".to_owned(),
            Self::Outside => "through a wall".to_owned(),
            Self::Inverted => format!("{} inverted", Count(numbers.inverted, "triangle", "triangles")),
            Self::Wound => format!("{} wound twice", Count(numbers.wound, "vertex", "vertices")),
            Self::Area => "not in its rest shape".to_owned(),
        }
    }
}
