//! Draws toys: the exact path, the exact point and the computed point.

use super::{View, net::candy, shape_buffer::ShapeBuffer};
use crate::snapshot::{Snapshot, ToySnapshot};
use eframe::egui::{Color32, Pos2, Vec2};
use std::{collections::VecDeque, f32::consts::TAU};

/// Minimum distance of points of a trail [m].
const APART: f64 = 0.003;

/// Maximum number of points of a trail.
const LONGEST: usize = 2500;

/// Number of parts of a trail, each with one opacity.
const PARTS: usize = 40;

/// Recent path of a toy.
#[derive(Debug, Default)]
pub struct Trail {
    generation: u64,
    time: f64,
    /// Points in the world [m], the newest last.
    points: VecDeque<[f64; 2]>,
}

impl Trail {
    /// Records the position of the toy. It clears the trail if time went backwards or the scene has changed.
    pub fn follow(&mut self, snapshot: &Snapshot) {
        if self.generation != snapshot.generation || snapshot.time < self.time {
            self.points.clear();
            self.generation = snapshot.generation;
        }
        self.time = snapshot.time;
        let Some(toy) = &snapshot.toy else { return };
        let far = |last: &[f64; 2]| (last[0] - toy.at[0]).abs() + (last[1] - toy.at[1]).abs() > APART;
        if self.points.back().is_none_or(far) {
            self.points.push_back(toy.at);
        }
        if self.points.len() > LONGEST {
            self.points.pop_front();
        }
    }

    /// Draws the toy with its trail.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot) {
        let Some(toy) = &snapshot.toy else { return };
        self.draw_trail(buffer, view, toy);
        let path: Vec<Pos2> = toy.path.0.iter().map(|point| view.camera.screen_from_world(*point)).collect();
        buffer.line(&path, toy.path.1, 1.5, view.theme.annotation.gamma_multiply(0.75));
        let (at, exact) = (view.camera.screen_from_world(toy.at), view.camera.screen_from_world(toy.exact));
        if let Some(pivot) = toy.pivot {
            rod(buffer, view, view.camera.screen_from_world(pivot), at);
        }
        candy(buffer, at, view.size(0.02, 8.0, 44.0), view.theme.candy[0]);
        let radius = view.size(0.027, 10.0, 56.0);
        let ring: Vec<Pos2> = (0..40).map(|i| exact + Vec2::angled(TAU / 40.0 * i as f32) * radius).collect();
        buffer.line(&ring, true, 2.0, view.theme.glow);
    }

    fn draw_trail(&self, buffer: &mut ShapeBuffer, view: View, toy: &ToySnapshot) {
        let newest = std::iter::once(&toy.at);
        let line: Vec<Pos2> =
            self.points.iter().chain(newest).map(|point| view.camera.screen_from_world(*point)).collect();
        let (width, parts) = (view.size(0.007, 2.5, 16.0), line.len().div_ceil(PARTS).max(1));
        let (half, soft) = (0.5 * width, buffer.pixel());
        for (number, first) in (0..line.len().saturating_sub(1)).step_by(parts).enumerate() {
            let part = &line[first..(first + parts + 1).min(line.len())];
            let share = (number + 1) as f32 / PARTS as f32;
            let color = view.theme.candy[0].gamma_multiply(0.08 + 0.7 * share.min(1.0));
            buffer.bands(part, false, &[half + soft, half, -half, -half - soft], &[0.0, 1.0, 1.0, 0.0], color);
        }
    }
}

/// Draws a candy stick from the pivot to the toy.
fn rod(buffer: &mut ShapeBuffer, view: View, pivot: Pos2, at: Pos2) {
    let (width, along) = (view.size(0.009, 3.0, 20.0), at - pivot);
    buffer.line(&[pivot, at], false, width + 2.0, Color32::from_black_alpha(110));
    buffer.line(&[pivot, at], false, width, view.theme.icing);
    let stripes = (along.length() / (3.0 * width)).clamp(1.0, 200.0) as u16;
    for stripe in 0..stripes {
        let from = pivot + along * ((f32::from(stripe) + 0.3) / f32::from(stripes));
        let slant = (along.normalized() + along.normalized().rot90()) * (0.42 * width);
        let step = along.normalized() * (0.9 * width);
        buffer.area(&[from - slant, from + slant, from + slant + step, from - slant + step], view.theme.candy[1]);
    }
    candy(buffer, pivot, view.size(0.013, 5.0, 30.0), view.theme.icing);
}
