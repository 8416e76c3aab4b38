//! Promises about scenes: effects, sleep, the guard, pins, nets, space and commands.

mod arrange;
mod body_force;
#[path = "../common/mod.rs"]
mod common;
mod constraints;
mod edge_load;
mod effects;
mod guard;
mod heat;
mod impulse;
mod islands;
mod mass;
mod moving_pins;
mod nets;
mod originals;
mod own_kinds;
mod probes;
mod projection;
mod recording;
mod refinement;
mod sandbox;
mod sleep;
mod sleeping_regions;
mod snapshot;
mod space;
mod space_levels;
mod starts;
mod stretch_test;
mod typed_energy;
mod wind;
