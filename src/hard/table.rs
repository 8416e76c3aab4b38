//! Results of hard cases as a table.

use super::{Experiment, Failure, Numbers, Trial, Verdict, verdict::Count};
use crate::table;

/// Columns of the table, separated by commas.
pub const COLUMNS: &str = "case,undamped,model,method,held,stable,off,off_in,until,strain,speed,energy_gain,outside,\
    unsolved_steps,guarded_steps,energy_left,untangle,shown_by,reason";

/// Row of the table for a trial as CSV: the deciding numbers, rounded, and if it is not stable, the reason and the experiment
/// that shows it: the one found, or else the one that the file of the case states.
pub fn row(trial: &Trial, verdict: &Verdict, found: Option<Experiment>) -> String {
    let Trial { name, case, model, method } = trial;
    let Numbers { gain, outside, strain, speed, unsolved, guarded, elastic, opens, distance, .. } = verdict.numbers;
    let yes = |yes: bool| if yes { "yes" } else { "no" };
    // Energy left if a body did not return to its rest shape [J], and whether it returns after untangling.
    let (mut left, mut untangle) = (String::new(), "");
    if strain.is_some() && !verdict.is_stable() {
        (left, untangle) = (format!("{elastic:.1e}"), if opens { "home" } else { "" });
    }
    let optional = |share: Option<f64>| share.map_or(String::new(), rounded);
    let (off, until) = (optional(distance.map(|distance| distance.share)), distance.map(|distance| distance.until));
    let until = until.map_or(String::new(), |until| format!("{until:.2}"));
    let cannot = if verdict.is_stable() { None } else { case.cannot(*model, *method) };
    let shown_by = found.or_else(|| cannot?.shown_by);
    let cells = [
        name.as_str(),
        yes(case.is_undamped_twin()),
        &trial.whole_material(),
        method.name(),
        yes(verdict.held()),
        yes(verdict.is_stable()),
        &off,
        distance.map_or("", |distance| distance.quantity.words()),
        &until,
        &optional(strain),
        &optional(speed),
        &rounded(gain),
        &rounded(outside),
        &unsolved.to_string(),
        &guarded.to_string(),
        &left,
        untangle,
        &shown_by.map_or(String::new(), |experiment| experiment.to_string()),
    ];
    let reason = verdict.failure.map_or(String::new(), |failure| {
        let why = cannot.map_or("UNEXPLAINED", |cannot| &cannot.why);
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
            Self::Crossed => "surfaces crossed".to_owned(),
            Self::Tangled => "surfaces did not come apart".to_owned(),
            Self::Inverted => format!("{} inverted", Count(numbers.inverted, "triangle", "triangles")),
            Self::Wound => format!("folded at {}", Count(numbers.wound, "vertex", "vertices")),
            Self::Strain => "not in its rest shape".to_owned(),
            Self::Motion => "not at rest".to_owned(),
        }
    }
}
