//! Meshes that are refined where the stress has its error, against meshes that are finer everywhere.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{built_in, released, studies::WHOLE};
use gingerbread::{
    elements::ElementKind,
    meshes::NoFiles,
    study::{Measure, MeshMoment, MeshPlan, MeshStudy, Refinement},
};

/// The numbers of triangles of one refinement, with their errors.
fn errors(study: &MeshStudy, refinement: Refinement) -> Vec<(usize, f64)> {
    let own = study.points().filter(|point| point.series.refinement == refinement);
    own.map(|point| (point.triangles, study.error_of(point).unwrap())).collect()
}

/// The energy of linear elements is off by the square of the error of the stress, in the energy norm. Around a hole a quarter of the triangles is
/// enough for the same error.
#[test]
fn adaptive_meshes_need_a_quarter_of_the_triangles() {
    let plan = MeshPlan {
        triangles: vec![150, 1200, 2400, 9600, 38400],
        elements: vec![ElementKind::Linear],
        measure: Measure::ElasticEnergy,
        adaptive: true,
        threads: 2,
        ..MeshPlan::default()
    };
    let mut study = MeshStudy::new(&built_in("plate_with_hole"), &NoFiles, 1.0, plan).unwrap();
    while !study.advance(WHOLE).finished {}
    let [uniform, adaptive] = [Refinement::Uniform, Refinement::Adaptive].map(|kind| errors(&study, kind));
    // The reference is extrapolated from the finest uniform mesh.
    let (triangles, error) = uniform[uniform.len() - 2];
    let (enough, _) = *adaptive.iter().find(|(_, own)| *own <= error).unwrap();
    assert!(4 * enough <= triangles, "{uniform:?} {adaptive:?}");
    assert_eq!(adaptive.len(), 4, "none for the coarsest mesh, which is the first");
    assert!(adaptive.windows(2).all(|pair| pair[1].1 < pair[0].1), "{adaptive:?}");
    assert!(study.csv(&[]).contains("Adaptive"));
    let exact = study.as_exact();
    assert!(exact.iter().any(|[point, other]| point.series != other.series), "what is as exact is told");
}

#[test]
fn meshes_that_never_rest_are_not_refined_by_error() {
    let plan = MeshPlan {
        moment: MeshMoment::AtTheEnd,
        triangles: vec![24, 96],
        adaptive: true,
        threads: 1,
        ..MeshPlan::default()
    };
    let study = MeshStudy::new(&released(""), &NoFiles, 0.1, plan).unwrap();
    assert!(study.points().all(|point| point.series.refinement == Refinement::Uniform));
}
