//! Out of several obstacles at once, and into the world.

use super::{
    SLOW,
    common::{Random, level, models, simulation},
    disk, leave, mass, walls,
};

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
fn random_obstacles_neither_throw_nor_crush_a_body() {
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
