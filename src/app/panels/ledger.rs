//! Cost of each effect in a frame of 1/60 s: its measurement, and its table with reasons where the effect was skipped.

use super::{PanelContext, View, count, numbers};
use crate::{
    app::jobs::JobRequest,
    app::language::{tr, tr_with},
    report::EffectCost,
    snapshot::Snapshot,
    study::Saving,
};
use eframe::egui::{self, Align, CollapsingHeader, Layout, RichText, Ui};

/// Simulated time between two readings \[s\].
const REFRESH: f64 = 0.25;

/// Cost of an effect in a frame of 1/60 s of simulated time in which it is computed; zero if it always slept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Name of the effect.
    pub name: &'static str,
    /// Time \[s\].
    pub time: f64,
    /// Share of steps in which its bodies and nets slept. These steps do not count for time, calls and elements.
    pub slept: f64,
    /// Number of calls.
    pub calls: f64,
    /// Number of elements touched, summed over the calls.
    pub elements: f64,
    /// Number of skipped calls; here the slept steps count.
    pub skipped: f64,
}

/// Measures the cost of effects in a running scene.
#[derive(Default)]
pub struct Meter {
    /// Simulated time \[s\], step and costs at the start of the present reading.
    since: (f64, u64, Vec<EffectCost>),
    shown: Vec<Use>,
}

impl Meter {
    /// Reads the costs of a frame. It starts again if the scene or the direction of time has changed.
    pub fn read(&mut self, now: &Snapshot) {
        let (began, steps, before) = &self.since;
        let same = before.len() == now.costs.len()
            && before
                .iter()
                .zip(&now.costs)
                .all(|(a, b)| a.name == b.name && a.calls <= b.calls && a.skipped <= b.skipped);
        let elapsed = now.time - began;
        if !same || elapsed < 0.0 || now.steps < *steps {
            self.shown.clear();
        } else if elapsed < REFRESH {
            return;
        } else {
            let (frames, steps) = (60.0 * elapsed, (now.steps - steps).max(1) as f64);
            let over = |of: f64, by: f64| if by > 0.0 { of / by } else { 0.0 };
            let pairs = || before.iter().zip(&now.costs);
            let time = |before: &EffectCost, now: &EffectCost| now.time.saturating_sub(before.time).as_secs_f64();
            let used = |(before, now): (&EffectCost, &EffectCost)| {
                let slept = now.slept.saturating_sub(before.slept) as f64 / steps;
                let computed = frames * (1.0 - slept).max(0.0);
                Use {
                    name: now.name,
                    time: over(time(before, now), computed),
                    slept,
                    calls: over((now.calls - before.calls) as f64, computed),
                    elements: over((now.elements - before.elements) as f64, computed),
                    skipped: over((now.skipped - before.skipped) as f64, frames),
                }
            };
            self.shown = pairs().map(used).collect();
        }
        (self.since.0, self.since.1) = (now.time, now.steps);
        self.since.2.clone_from(&now.costs);
    }

    /// Clears the measurement, because the ledger is closed.
    pub fn stop(&mut self) {
        *self = Self::default();
    }

    /// The last reading; empty before the first quarter of a second.
    pub fn shown(&self) -> &[Use] {
        &self.shown
    }
}

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    if context.now.costs.is_empty() {
        view.ledger = false;
        return;
    }
    let header = CollapsingHeader::new(tr("What each effect costs")).id_salt("ledger").show(ui, |ui| {
        let active = context.meter.shown().iter().zip(&context.now.costs).filter(|(_, cost)| cost.idle.is_none());
        let all = active.map(|(used, _)| used.time).sum::<f64>();
        for (number, cost) in context.now.costs.iter().enumerate() {
            entry(ui, context, number, cost, all);
        }
        off(ui, context);
        savings(ui, context, view);
    });
    view.ledger = header.body_returned.is_some();
}

/// Draws one effect: its time and share, and below these its state, the reason for skipping it, and the time saved.
fn entry(ui: &mut Ui, context: &PanelContext<'_>, number: usize, cost: &EffectCost, all: f64) {
    let used = context.meter.shown().get(number).filter(|used| used.name == cost.name);
    let timed = timed(cost, used);
    let time = timed.map_or_else(|| "–".to_owned(), |used| numbers::si_fixed(used.time, "s"));
    let share =
        timed.filter(|_| all > 0.0).map_or_else(String::new, |used| format!("{:3.0} %", 100.0 * used.time / all));
    let response = ui.horizontal(|ui| {
        ui.label(RichText::new(name(context, number, cost)).strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.monospace(format!("{time} {share:>5}"));
        });
    });
    response.response.on_hover_text(
        "Time in a frame of 1/60 s of simulated time in which it is computed, and its share of what all effects take",
    );
    let heat = if cost.heat == 0.0 { String::new() } else { format!("; {} to heat", numbers::si(cost.heat, "J")) };
    let words = match (state(cost, used), saving(context, number, cost)) {
        (state, Some(saving)) => format!("{state}{heat}; skipping saves {} a frame", numbers::si(saving.saved(), "s")),
        (state, None) => format!("{state}{heat}"),
    };
    ui.add(egui::Label::new(RichText::new(words).small()).wrap());
}

/// Measured use of an effect; `None` while the effect is skipped, because the measurement is from before.
fn timed<'a>(cost: &EffectCost, used: Option<&'a Use>) -> Option<&'a Use> {
    used.filter(|used| cost.idle.is_none() && used.slept < 1.0)
}

/// Name of an effect; with several bodies or nets also that of its owner.
fn name(context: &PanelContext<'_>, number: usize, cost: &EffectCost) -> String {
    let owner = context.now.part_names().nth(number);
    match owner.filter(|_| context.now.part_count() > 1) {
        Some(owner) => format!("{} of {owner}", cost.name),
        None => cost.name.to_owned(),
    }
}

/// State of an effect in words, with its number of calls.
fn state(cost: &EffectCost, used: Option<&Use>) -> String {
    let switch = if cost.auto { "Auto" } else { "On" };
    let acting = match (cost.idle, used) {
        (Some(why), _) => format!("skipped: {why}"),
        (None, Some(used)) if used.calls > 0.0 => format!(
            "{} calls a frame, {} elements each",
            count(used.calls.round() as usize),
            count((used.elements / used.calls).round() as usize)
        ),
        (None, _) => "active".to_owned(),
    };
    let skipped = used.filter(|used| cost.idle.is_none() && used.skipped >= 0.5);
    let skipped =
        skipped.map_or_else(String::new, |used| format!(", {} skipped", count(used.skipped.round() as usize)));
    let slept = used.filter(|used| used.slept > 0.0);
    let slept = slept.map_or_else(String::new, |used| format!("; slept in {:.0} % of the steps", 100.0 * used.slept));
    format!("{switch} – {acting}{skipped}{slept}")
}

fn saving(context: &PanelContext<'_>, number: usize, cost: &EffectCost) -> Option<Saving> {
    let measured = context.jobs.savings.findings()?.results.each.get(number).copied();
    // The measurement belongs to another scene if the names of its effects differ.
    measured.filter(|saving| saving.name == cost.name && saving.own < saving.forced && cost.auto)
}

/// Draws the effects of the level that are not active.
fn off(ui: &mut Ui, context: &PanelContext<'_>) {
    let there = |name: &str| context.now.costs.iter().any(|cost| cost.name == name);
    let titles = context.now.level.effects.iter().map(|listed| listed.effect.kind().title());
    let off: Vec<_> = titles.filter(|title| !there(title)).map(tr).collect();
    if !off.is_empty() {
        ui.label(RichText::new(tr_with("Not active: {effects}", &[("effects", &off.join(", "))])).small().weak())
            .on_hover_text(tr("Switched off, or not used in this mode: these take no memory and no time."));
    }
}

/// Draws the button that measures the saving, and the result for a whole frame.
fn savings(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View) {
    let help = "Runs one second of a copy of this scene twice from the present state: as it is, and with every effect evaluated \
                in every step and no body asleep.";
    let running = context.jobs.savings.is_running();
    let text = if running { "Measuring …" } else { "Measure what skipping saves" };
    if ui.add_enabled(!running, egui::Button::new(tr(text))).on_hover_text(tr(help)).clicked() {
        view.requests.push(JobRequest::Savings);
    }
    let Some(findings) = context.jobs.savings.findings() else { return };
    if let Some(trouble) = &findings.trouble {
        ui.label(RichText::new(trouble).small().color(ui.visuals().warn_fg_color));
    }
    if let Some([own, forced]) = findings.results.whole {
        let (own, forced, share) = (numbers::si(own, "s"), numbers::si(forced, "s"), 100.0 * (1.0 - own / forced));
        let words = format!("A frame takes {own} with skipping and {forced} without: {share:.0} % saved.");
        ui.add(egui::Label::new(RichText::new(words).small()).wrap());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::EffectCost;
    use std::time::Duration;

    fn at(time: f64, calls: u64) -> Snapshot {
        let cost = EffectCost {
            calls,
            elements: 7 * calls,
            time: Duration::from_micros(calls),
            ..EffectCost::none("a", true)
        };
        Snapshot { time, steps: (100.0 * time) as u64, costs: vec![cost], ..Snapshot::default() }
    }

    #[test]
    fn a_reading_is_per_frame_and_begins_anew_when_time_goes_back() {
        let mut meter = Meter::default();
        meter.read(&at(1.0, 1000));
        assert!(meter.shown().is_empty());
        meter.read(&at(1.5, 4000));
        let used = Use { name: "a", time: 100e-6, slept: 0.0, calls: 100.0, elements: 700.0, skipped: 0.0 };
        assert_eq!(meter.shown(), [used]);
        meter.read(&at(0.2, 0));
        assert!(meter.shown().is_empty());
    }

    #[test]
    fn a_reading_is_per_frame_that_was_computed() {
        let mut meter = Meter::default();
        meter.read(&at(1.0, 1000));
        let mut half_asleep = at(2.0, 4000);
        half_asleep.costs[0].slept = 50;
        meter.read(&half_asleep);
        let [used] = meter.shown() else { unreachable!("one effect") };
        assert_eq!((used.time, used.calls, used.slept), (100e-6, 100.0, 0.5));
        let mut asleep = at(3.0, 4000);
        asleep.costs[0].slept = 150;
        meter.read(&asleep);
        assert_eq!((meter.shown()[0].time, meter.shown()[0].slept), (0.0, 1.0));
    }

    #[test]
    fn an_effect_that_is_skipped_now_shows_no_time_from_before() {
        let used = Use { name: "Walls", time: 3e-4, slept: 0.0, calls: 20.0, elements: 600.0, skipped: 0.0 };
        let acts = EffectCost::none("Walls", true);
        let skipped = EffectCost { idle: Some("nothing within reach"), ..acts.clone() };
        assert_eq!(timed(&acts, Some(&used)), Some(&used));
        assert_eq!(timed(&skipped, Some(&used)), None);
        assert!(state(&skipped, Some(&used)).contains("skipped: nothing within reach"));
    }
}
