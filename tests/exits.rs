//! Facts about what begins inside a wall or beyond an edge of the world: it comes out, slowly and in its own shape.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

use common::{Random, level, models, seen, simulation};
use gingerbread::{
    command::{Command, Mode},
    files,
    integrators::{Class, IntegratorKind},
    level::{Level, Paces},
    levels::built_in,
    meshes::NoFiles,
    obstacles::Inside,
    quantity::Point,
    sandbox::Sandbox,
    simulation::Simulation,
};

/// A disk of radius 0.2 m, 2 kg/m² and shear waves of 4 m/s, with its middle at a point.
fn disk([x, y]: [f64; 2], (integrator, substeps): (&str, u32), model: &str, more: &str) -> Level {
    level(&format!(
        "(name: \"disk\", integrator: {integrator}(), substeps: {substeps}, bodies: [(name: \"disk\",
            mesh: Disk(centre: ({x:?}, {y:?}), radius: 0.2, rings: 6), mass: Density(2),
            material: (model: {model}, young: 83.2, poisson: 0.3, plane: Strain))], {more})"
    ))
}

/// A tenth of the speed of waves [m/s].
const SLOW: f64 = 0.4;

fn walls(obstacle: &str) -> String {
    format!("effects: [(effect: Walls(obstacles: [{obstacle}]))]")
}

/// What the disk overlaps, with its middle at (0.5, 0.5).
fn overlapped() -> Vec<(&'static str, String)> {
    vec![
        ("floor", walls("Plane(point: (0, 0.45), normal: (0, 1), eps: 0.005)")),
        ("ball", walls("Ball(centre: (0.4, 0.25), radius: 0.15, eps: 0.005)")),
        ("box", walls("Cuboid(centre: (0.5, 0.3), width: 0.8, height: 0.2, turn: 10, eps: 0.005)")),
        ("wedge", walls("Polygon(points: [(0.4, 0), (0.8, 0.1), (0.8, 0.6), (0.4, 0.4)], eps: 0.005)")),
        ("edges", "effects: [(effect: Boundary(least: (0, 0.45), greatest: (3, 3)))]".to_owned()),
    ]
}

/// Every scheme with steps a frame, but forward Euler, which needs no wall to fly apart; Heun's takes short ones for the same reason.
fn schemes() -> impl Iterator<Item = (&'static str, u32)> {
    IntegratorKind::all().into_iter().filter(|kind| kind.name() != "ForwardEuler").map(|kind| {
        let substeps = match (kind.kind().class(), kind.kind().stability_limit()) {
            (Class::Implicit, _) => 4,
            (_, Some(0.0)) => 400,
            _ => 20,
        };
        (kind.name(), substeps)
    })
}

fn mass(simulation: &Simulation) -> f64 {
    simulation.scene().mass.iter().step_by(2).sum()
}

/// Runs until nothing is inside any more; the least J and the greatest energy of motion and deformation on the way.
fn leave(simulation: &mut Simulation, seconds: f64) -> (f64, f64) {
    let steps = (seconds / simulation.scene().step) as u64;
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..steps {
        simulation.advance(1, &mut || true);
        let energies = simulation.energies();
        (least, most) = (least.min(simulation.inversion().0), most.max(energies.kinetic + energies.elastic));
    }
    (least, most)
}

#[test]
fn what_begins_inside_an_obstacle_comes_out_in_its_own_shape_under_every_scheme() {
    for scheme in schemes() {
        for (what, effects) in overlapped() {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "Corotated", &effects));
            let inside = simulation.count_inside();
            assert!(inside > 10, "{what}: only {inside} vertices begin inside");
            let (least, most) = leave(&mut simulation, 1.5);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
            assert_eq!(simulation.count_inside(), 0, "{what}");
            assert!(least > 0.6, "{what}: least J {least}");
            let given = 0.5 * mass(&simulation) * SLOW * SLOW;
            // What bounces off a wall that comes at speed u leaves at twice that speed.
            assert!(most < 4.0 * given, "{what}: {most} J of motion and deformation, {given} J as a whole");
            let counts = simulation.counts();
            assert_eq!((counts.guarded, counts.retaken), (0, 0), "{what}: nothing came from nowhere");
            assert!(counts.pushed_out > 5 && !simulation.pushes_out(), "{what}: {counts:?}");
        }
    }
}

#[test]
fn every_model_keeps_its_shape_on_the_way_out() {
    for model in models() {
        for (what, effects) in overlapped() {
            let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), model, &effects));
            let (least, _) = leave(&mut simulation, 1.5);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{model}, {what}");
            assert!(least > 0.6, "{model}, {what}: least J {least}");
        }
    }
}

/// Put on the edges at once, all of it would be in one point.
#[test]
fn a_body_that_begins_far_beyond_the_world_comes_in_whole_and_at_its_own_speed() {
    let effects = "effects: [(effect: Boundary(least: (0, 0), greatest: (1, 1)))]";
    let mut simulation = simulation(&disk([2.0, 0.5], ("SymplecticEuler", 20), "NeoHookean", effects));
    let start = simulation.state().x.clone();
    let (least, _) = leave(&mut simulation, 1.0);
    assert!(least > 0.999_999, "it moves as a whole: least J {least}");
    let state = simulation.state();
    for (x, start) in state.x.chunks_exact(2).zip(start.chunks_exact(2)) {
        assert!((x[0] - (start[0] - SLOW * state.time)).abs() < 1e-9 && (x[1] - start[1]).abs() < 1e-9);
    }
    let (least, _) = leave(&mut simulation, 3.0);
    assert!(simulation.count_inside() == 0 && least > 0.6, "least J {least}");
}

#[test]
fn nothing_bounces_off_a_wall_that_it_comes_out_of() {
    let effects = "effects: [(effect: Walls(obstacles: [Plane(point: (0, 0.45), normal: (0, 1), eps: 0.005)])),
        (effect: Restitution(coefficient: 1)), (effect: Friction(coefficient: 0.5))]";
    let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", effects));
    let (least, most) = leave(&mut simulation, 1.0);
    assert!(simulation.count_inside() == 0 && least > 0.6, "least J {least}");
    assert!(most < 1.5 * mass(&simulation) * SLOW * SLOW, "{most} J");
}

/// The sooner steps end the nearer the answers lie: how fast it comes out is a matter of the body, not of the step.
#[test]
fn the_way_out_does_not_depend_on_the_step() {
    let (_, effects) = overlapped().swap_remove(0);
    let middle = |substeps: u32| {
        let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", substeps), "Corotated", &effects));
        leave(&mut simulation, 0.7);
        let heights = simulation.state().x.iter().skip(1).step_by(2);
        heights.clone().sum::<f64>() / heights.count() as f64
    };
    let [coarse, fine, finer] = [20, 80, 320].map(middle);
    assert!((finer - 0.5).abs() > 0.1, "it came out: {finer}");
    assert!((coarse - finer).abs() < 0.01 && (fine - finer).abs() < 0.004, "{coarse} {fine} {finer}");
}

#[test]
fn a_body_at_its_own_pace_comes_out_as_it_does_at_the_common_one() {
    let (_, effects) = overlapped().swap_remove(1);
    let common = disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", &effects);
    let own = Level { paces: Paces::Own, ..common.clone() };
    let [common, own] = [common, own].map(|level| {
        let mut simulation = simulation(&level);
        simulation.advance(400, &mut || true);
        assert!(simulation.counts().pushed_out > 5);
        simulation.state().x.clone()
    });
    let apart = common.iter().zip(&own).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-12, "{apart:e}");
}

#[test]
fn switching_walls_on_over_a_limb_is_told_and_flattens_nothing() {
    let mut low = files::parse(built_in("gingerbread").unwrap(), "gingerbread.ron").unwrap();
    low.bodies[0].place.offset = Point::new([0.0, -0.12]).unwrap();
    let mut sandbox = Sandbox::new(low, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100, &mut || true);
    assert_eq!(seen(&sandbox).inside, Inside::Nothing);
    let before = sandbox.simulation().energies();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    assert!(sandbox.simulation().count_inside() > 20, "his feet are below the floor");
    let mut told = false;
    let mut least = f64::INFINITY;
    for _ in 0..60 {
        sandbox.advance(30, &mut || true);
        let now = seen(&sandbox);
        told |= now.inside == Inside::ComesOut;
        least = least.min(now.min_j);
        let energies = now.energies;
        assert!(energies.kinetic + energies.elastic < 2.0, "{before:?} became {energies:?}");
    }
    assert!(told && least > 0.5, "told: {told}, least J {least}");
    assert_eq!(sandbox.simulation().count_inside(), 0);
    assert_eq!(seen(&sandbox).inside, Inside::Nothing, "nothing is inside any more");
}

/// Towards the nearest surfaces it would be torn to all sides, and hang on the obstacle for ever.
#[test]
fn a_body_put_over_an_obstacle_slips_off_it_whole() {
    let over = [
        ("ball", "Ball(centre: (0.45, 0.5), radius: 0.06, eps: 0.003)"),
        ("plate", "Cuboid(centre: (0.5, 0.46), width: 1, height: 0.04, turn: 3, eps: 0.003)"),
        ("post", "Polygon(points: [(0.4, 0.2), (0.46, 0.2), (0.46, 0.55), (0.4, 0.55)], eps: 0.003)"),
        (
            "moving ball",
            "Moving(obstacle: Ball(centre: (0.45, 0.5), radius: 0.06, eps: 0.003), motions: [Slide(velocity: (0.1, 0))])",
        ),
    ];
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for (what, obstacle) in over {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "NeoHookean", &walls(obstacle)));
            assert!(simulation.count_inside() > 5, "{what}");
            let (least, _) = leave(&mut simulation, 1.5);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{what}: {:?}", simulation.fault());
            assert!(least > 0.4, "{what}: least J {least}");
            let (low, high) = spread(&simulation);
            assert!(high - low < 0.45, "{what}: it hangs on it, from {low} to {high}");
        }
    }
}

/// Each box alone would send it into the other, and the box on the floor down into that.
#[test]
fn out_of_several_obstacles_there_is_one_way() {
    let between = [
        (
            "two boxes side by side",
            [0.5, 0.4],
            "Cuboid(centre: (0, 0.25), width: 1, height: 0.5, eps: 0.003), Cuboid(centre: (1, 0.25), width: 1, height: 0.5, eps: 0.003)",
        ),
        (
            "a box on the floor",
            [0.5, 0.22],
            "Plane(point: (0, 0), normal: (0, 1), eps: 0.003), Cuboid(centre: (0.75, 0.25), width: 0.3, height: 0.46, eps: 0.003)",
        ),
    ];
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for (what, middle, obstacles) in between {
            let mut simulation = simulation(&disk(middle, scheme, "NeoHookean", &walls(obstacles)));
            let (least, _) = leave(&mut simulation, 2.0);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{what}: {:?}", simulation.fault());
            assert!(least > 0.5, "{what}: least J {least}");
        }
    }
}

/// Only from behind may the rest follow: the other sides of the same obstacle stop it as ever.
#[test]
fn what_comes_out_of_a_wall_does_not_fall_through_the_floor_that_belongs_to_it() {
    let corner = "Polygon(points: [(-1, -0.2), (2, -0.2), (2, 0), (0, 0), (0, 3), (-1, 3)], eps: 0.003)";
    let mut level = disk([0.18, 0.6], ("SymplecticEuler", 40), "NeoHookean", &walls(corner));
    let velocity = |value: f64| gingerbread::quantity::Velocity::new(value).unwrap();
    level.bodies[0].velocity = (velocity(0.0), velocity(-1.5));
    let mut simulation = simulation(&level);
    assert!(simulation.count_inside() > 3);
    for _ in 0..100 {
        simulation.advance(24, &mut || true);
        let (low, _) = spread(&simulation);
        assert!(low > -0.01, "its lowest vertex is at {low} m");
    }
    assert!(simulation.fault().is_none() && simulation.count_inside() == 0);
}

/// One wall may press a vertex a little into another; that is no reason to push it out.
#[test]
fn a_body_thrown_into_an_acute_corner_began_outside() {
    let corner = "Plane(point: (0, 0), normal: (-0.34, 0.94), eps: 0.01), Plane(point: (0, 0), normal: (-0.34, -0.94), eps: 0.01)";
    let mut level = disk([-0.7, 0.0], ("SymplecticEuler", 20), "NeoHookean", &walls(corner));
    let velocity = |value: f64| gingerbread::quantity::Velocity::new(value).unwrap();
    level.bodies[0].velocity = (velocity(1.5), velocity(0.2));
    let mut simulation = simulation(&level);
    simulation.advance(2400, &mut || true);
    let counts = simulation.counts();
    assert!(counts.constrained > 100 && counts.pushed_out == 0, "{counts:?}");
}

/// The least and the greatest y.
fn spread(simulation: &Simulation) -> (f64, f64) {
    let heights = simulation.state().x.iter().skip(1).step_by(2);
    heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(*y), high.max(*y)))
}

/// Pushed out past its own pin it would be torn: also where the pin is in the very middle of a ball, or beside it.
#[test]
fn what_a_pin_keeps_inside_a_solid_stays_there_unharmed() {
    for [x, y] in [[0.47, 0.49], [0.5, 0.5], [0.62, 0.55]] {
        let ball = walls(&format!("Ball(centre: ({x:?}, {y:?}), radius: 0.1, eps: 0.005)"));
        let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "NeoHookean", &ball);
        level.bodies[0].pins = vec![gingerbread::level::Pin::Nearest(Point::new([0.5, 0.5]).unwrap())];
        let mut simulation = simulation(&level);
        let (least, most) = leave(&mut simulation, 1.0);
        assert!(simulation.count_inside() > 5 && least > 0.5, "ball at ({x}, {y}): least J {least}");
        assert!(most < 0.02 && simulation.fault().is_none(), "ball at ({x}, {y}): {most} J");
        assert_eq!((simulation.inside(), simulation.counts().pushed_out), (Inside::Stays, 0));
    }
}

/// Carried along by what moves it would be torn from its pin.
#[test]
fn what_a_pin_keeps_inside_of_what_moves_is_passed_over() {
    let moving = walls(
        "Moving(obstacle: Ball(centre: (0.5, 0.5), radius: 0.1, eps: 0.005), motions: [Slide(velocity: (20, 0))])",
    );
    let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "NeoHookean", &moving);
    level.bodies[0].pins = vec![gingerbread::level::Pin::Nearest(Point::new([0.5, 0.5]).unwrap())];
    let mut simulation = simulation(&level);
    simulation.advance(4, &mut || true);
    assert_eq!(simulation.inside(), Inside::Stays);
    assert!(simulation.inversion().0 > 0.5, "least J {}", simulation.inversion().0);
}

/// Flattened in a gap of half its size, or between walls that face each other, it would be crushed.
#[test]
fn what_has_no_room_beyond_stays_inside_unharmed() {
    let shelf =
        "effects: [(effect: Walls(obstacles: [Cuboid(centre: (0.475, 0.54), width: 0.6, height: 0.42, eps: 0.003)])),
        (effect: Boundary(least: (0, 0.1), greatest: (1, 0.95)))]";
    let facing = walls(
        "Plane(point: (0.55, 0), normal: (1, 0), eps: 0.003), Plane(point: (0.4, 0), normal: (-1, 0.1), eps: 0.003)",
    );
    let small = "effects: [(effect: Boundary(least: (0.4, 0), greatest: (0.6, 1)))]";
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for effects in [shelf, facing.as_str(), small] {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "NeoHookean", effects));
            let inside = simulation.count_inside();
            let (least, most) = leave(&mut simulation, 1.0);
            let what = format!("{effects} under {}", scheme.0);
            assert!(simulation.fault().is_none() && least > 0.9, "{what}: least J {least}, {:?}", simulation.fault());
            assert!(most < 0.02, "{what}: {most} J");
            assert_eq!((simulation.inside(), simulation.count_inside()), (Inside::Stays, inside), "{what}");
        }
    }
}

/// The shortest way out of each box leads out of the world, or along its edge.
#[test]
fn walls_and_the_edges_of_the_world_choose_a_way_together() {
    let both = [
        "Boundary(least: (0, 0), greatest: (1.3, 1))), (effect: Walls(obstacles: [Cuboid(centre: (0.35, 0.5), width: 0.76, height: 0.52, eps: 0.003)])",
        "Boundary(least: (0.21, -0.13), greatest: (1, 1.05))), (effect: Walls(obstacles: [Cuboid(centre: (0.64, 0.32), width: 0.23, height: 0.6, turn: 44.5, eps: 0.003)])",
        "Boundary(least: (-1, 0.4), greatest: (2, 2))), (effect: Walls(obstacles: [Cuboid(centre: (0.5, 0.3), width: 0.5, height: 0.4, eps: 0.003)])",
        "Boundary(least: (-1, 0.4), greatest: (2, 2))), (effect: Walls(obstacles: [Plane(point: (0.4, 0), normal: (1, -0.5), eps: 0.003)])",
    ];
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for effects in both {
            let level = disk([0.5, 0.5], scheme, "NeoHookean", &format!("effects: [(effect: {effects})]"));
            let mut simulation = simulation(&level);
            let (least, most) = leave(&mut simulation, 3.0);
            let what = format!("{effects} under {}", scheme.0);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{what}: {:?}", simulation.fault());
            assert!(least > 0.5, "{what}: least J {least}");
            assert!(most < 4.0 * 0.5 * mass(&simulation) * SLOW * SLOW, "{what}: {most} J");
        }
    }
}

/// Whatever it begins inside of: some hundred obstacles of all kinds, some with the edges of a world, that bounce or not.
#[test]
fn whatever_a_body_begins_inside_of_it_is_neither_thrown_nor_crushed() {
    let (mut random, mut out) = (Random(7), 0);
    let models: Vec<_> = models().collect();
    for number in 0..48 {
        let mut choose = |count: f64| random.between(0.0, count) as usize;
        let (count, scheme) =
            (1 + choose(3.0), [("SymplecticEuler", 20), ("VelocityVerlet", 20), ("ImplicitEuler", 4)][choose(3.0)]);
        let (model, edges, bounces) = (models[choose(models.len() as f64)], choose(2.0), choose(3.0));
        let obstacles: Vec<_> = (0..count).map(|_| random_obstacle(&mut random)).collect();
        let mut effects = vec![format!("(effect: Walls(obstacles: [{}]))", obstacles.join(", "))];
        let [left, bottom, right, top] = [-0.2, -0.2, 0.8, 0.8].map(|least| random.between(least, least + 0.5));
        if edges == 1 {
            effects.insert(
                0,
                format!("(effect: Boundary(least: ({left:?}, {bottom:?}), greatest: ({right:?}, {top:?})))"),
            );
        }
        if bounces == 1 {
            effects.push("(effect: Restitution(coefficient: 0.8)), (effect: Friction(coefficient: 0.3))".to_owned());
        }
        let effects = format!("effects: [{}]", effects.join(", "));
        let mut simulation = simulation(&disk([0.5, 0.5], scheme, model, &effects));
        let (least, most) = leave(&mut simulation, 1.5);
        let what = format!("number {number}, {model} under {}: {effects}", scheme.0);
        assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
        let given = 0.5 * mass(&simulation) * SLOW * SLOW;
        assert!(least > 0.2 && most < 8.0 * given, "{what}: least J {least}, {most} J for {given} J as a whole");
        out += u32::from(simulation.counts().pushed_out > 0 && simulation.count_inside() == 0);
    }
    assert!(out > 20, "{out} came out");
}

/// Somewhere over the disk.
fn random_obstacle(random: &mut Random) -> String {
    let [x, y] = [0; 2].map(|_| random.between(0.3, 0.7));
    let mut length = |least: f64, most: f64| random.between(least, most);
    match length(0.0, 4.0) as u32 {
        0 => format!("Ball(centre: ({x:?}, {y:?}), radius: {:?}, eps: 0.003)", length(0.03, 0.3)),
        1 => format!(
            "Cuboid(centre: ({x:?}, {y:?}), width: {:?}, height: {:?}, turn: {:?}, eps: 0.003)",
            length(0.05, 0.8),
            length(0.05, 0.8),
            length(0.0, 90.0)
        ),
        2 => {
            let corner =
                |angle: f64, far: f64| format!("({:?}, {:?})", x + far * libm::cos(angle), y + far * libm::sin(angle));
            let turn = length(0.0, 6.0);
            let corners: Vec<_> = (0..4).map(|side| corner(turn + 1.57 * f64::from(side), length(0.06, 0.3))).collect();
            format!("Polygon(points: [{}], eps: 0.003)", corners.join(", "))
        }
        _ => {
            let (angle, depth) = (length(0.0, 6.0), length(-0.3, 0.1));
            let [nx, ny] = [libm::cos(angle), libm::sin(angle)];
            let point = [0.5 + depth * nx, 0.5 + depth * ny];
            format!("Plane(point: ({:?}, {:?}), normal: ({nx:?}, {ny:?}), eps: 0.003)", point[0], point[1])
        }
    }
}

/// Once out of the right box it must not turn into the gap again.
#[test]
fn a_body_across_a_gap_leaves_it_to_one_side() {
    let gap = walls(
        "Cuboid(centre: (0.35, 0.5), width: 0.15, height: 0.6, eps: 0.005), Cuboid(centre: (0.65, 0.5), width: 0.15, height: 0.6, eps: 0.005)",
    );
    let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), "NeoHookean", &gap));
    let (least, most) = leave(&mut simulation, 3.0);
    assert!(simulation.count_inside() == 0 && least > 0.6, "least J {least}");
    assert!(most < 2.0 * mass(&simulation) * SLOW * SLOW, "{most} J");
}

#[test]
fn what_is_pinned_inside_stays_there_and_the_rest_comes_out() {
    let text = walls("Plane(point: (0, 0.4), normal: (0, 1), eps: 0.005)");
    let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", &text);
    level.bodies[0].pins = vec![gingerbread::level::Pin::Bottom];
    let mut simulation = simulation(&level);
    let pinned = simulation.scene().pins.len();
    leave(&mut simulation, 2.0);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    assert_eq!(simulation.count_inside(), pinned);
    assert!(!simulation.pushes_out(), "what is pinned is not on its way out");
}

/// What holds vertices while it solves for the rest does not know how hard it pushes: that is no energy from nowhere.
#[test]
fn no_implicit_scheme_stops_on_its_way_out_of_a_floor() {
    let floor = walls("Plane(point: (0, 0.4), normal: (0, 1), eps: 0.005)");
    let implicit = IntegratorKind::all().into_iter().filter(|kind| matches!(kind.kind().class(), Class::Implicit));
    for kind in implicit {
        for substeps in [1_u32, 4] {
            for young in [4e3, 6e4, 1e6] {
                let mut simulation = simulation(&level(&format!(
                    "(name: \"stiff\", integrator: {}(), substeps: {substeps}, bodies: [(name: \"disk\", mass: Density(100),
                        mesh: Disk(centre: (0.5, 0.55), radius: 0.2, rings: 6),
                        material: (model: NeoHookean, young: {young}, poisson: 0.4, plane: Strain))], {floor})",
                    kind.name()
                )));
                simulation.advance(120 * u64::from(substeps), &mut || true);
                let what = format!("{} with {substeps} steps a frame, {young} Pa", kind.name());
                assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
                assert!(simulation.count_inside() == 0 && simulation.counts().guarded == 0, "{what}");
                assert!(simulation.inversion().0 > 0.5, "{what}");
            }
        }
    }
}

/// An edge that two boxes hold between their corners stays where it is, and so has no speed to gather.
#[test]
fn what_hangs_between_two_boxes_gains_no_energy() {
    let level = level(
        "(name: \"hung\", bodies: [(name: \"jelly\", mesh: Disk(centre: (0.5, 0.5), radius: 0.13, rings: 6), mass: Density(100),
            material: (model: NeoHookean, young: 4000, poisson: 0.4, plane: Strain))],
          effects: [(effect: Gravity(down: 3)), (effect: Boundary(least: (0, 0), greatest: (1, 1))),
            (effect: Walls(obstacles: [
                Cuboid(centre: (0.305683, 0.289174), width: 0.352525, height: 0.0201128, turn: 56.429, eps: 0.01),
                Cuboid(centre: (0.398542, 0.567036), width: 0.232834, height: 0.171977, turn: 51.8546, eps: 0.004)]))])",
    );
    let mut simulation = simulation(&level);
    let start = simulation.energies().total();
    simulation.advance(6000, &mut || true);
    let energies = simulation.energies();
    assert!(simulation.fault().is_none() && energies.total() < 2.0 * start, "{start} J became {energies:?}");
}
