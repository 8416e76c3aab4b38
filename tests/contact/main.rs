//! Facts about contact: of bodies and cloth with obstacles, with each other and with themselves.

mod cloth_contact;
mod cloth_crossings;
#[path = "../common/mod.rs"]
mod common;
mod contact_potential;
mod impacts;
mod moving;
mod obstacles;
mod overlaps;
mod position_filter;
mod space_obstacles;
mod starts_inside;
mod surface_contact;
mod surface_obstacles;
mod surface_rules;
