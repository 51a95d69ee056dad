//! The scenes are what their documentation states.

use super::*;
use crate::body::RigidPointBody;
use crate::ground::SpringDamperGround;
use crate::integrator::{Integrator, Rk4};
use crate::scene::Dynamics;
use glam::DVec3;

const TIME_STEP: f64 = 0.01;

/// Corners of a scene's box below the ground, of the lower and of the upper four.
fn corners_below(setup: &Setup<f64, FullScene<f64>>, state: &State) -> [usize; 2] {
    let is_below = |point: DVec3| setup.scene.ground().surface(point).gap < 0.0;
    let count = |is_upper: bool| {
        let corners = setup.scene.body().contacts().iter();
        let of_face = corners.filter(|c| (c.position.z > 0.0) == is_upper);
        of_face
            .filter(|c| is_below(state.world_point(c.position)))
            .count()
    };
    [count(false), count(true)]
}

/// In the steps in which the order of a method is measured, and as many again.
#[test]
fn the_box_stays_on_its_four_lower_corners_or_in_flight() {
    for setup in with_each_role(TIME_STEP).map(Result::unwrap) {
        let on_ground = if setup.name.contains("flies") { 0 } else { 4 };
        let method = Rk4 {
            time_step: 0.1 * TIME_STEP,
        };
        let (mut state, mut near) = (setup.start, Default::default());
        for _ in 0..160 {
            assert_eq!(
                corners_below(&setup, &state),
                [on_ground, 0],
                "{}",
                setup.name
            );
            (method.step(&setup.scene, &mut state, TIME_STEP, &mut near)).unwrap();
        }
    }
}

#[test]
fn each_scene_has_one_role() {
    let setups = with_each_role(TIME_STEP).map(Result::unwrap);
    let roles = setups.map(|setup| {
        let motion = setup.scene.ground().motion;
        let friction = setup.scene.friction();
        [
            setup.scene.force().acts(),
            motion.velocity != DVec3::ZERO && motion.angular_velocity.z > 0.0,
            friction.rolling > 0.0 && friction.spinning > 0.0,
        ]
    });
    let [mounted, moving, resisting] = [0, 1, 2].map(|role| [0, 1, 2].map(|other| role == other));
    assert_eq!(roles, [mounted, mounted, moving, resisting]);
}

#[test]
fn the_oscillator_has_its_stiffness_and_damping_along_all_axes_and_no_torque() {
    let (stiffness, damping) = (3e4, 70.0);
    let setup = oscillator::<f64>(stiffness, damping, 2e-3).unwrap();
    let start = setup.start;
    assert!(start.position.cross(start.linear_velocity).length() > 1.0);
    let motion = setup.scene.motion(&start);
    let load = setup.scene.load(&motion);
    let expected = -start.position * stiffness - start.linear_velocity * damping;
    assert!((load.force - expected).length() < 1e-12 * expected.length());
    assert_eq!(load.torque, DVec3::ZERO);
    assert_eq!(setup.scene.gravity(), DVec3::ZERO);
    assert!((setup.scene.body().mass() - 1.0).abs() < 1e-15);
}
