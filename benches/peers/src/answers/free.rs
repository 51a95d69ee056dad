//! Bodies that rotate in empty space.

use tumble::State;
use tumble::glam::{DQuat, DVec3};

use crate::law::Law;
use crate::scene::{Case, Measure, Scene, Shape};

fn law(mass: f64, inertia: DVec3) -> Law {
    Law {
        mass,
        inertia,
        contacts: Vec::new(),
        rim: 0.0,
        stiffness: 1.0,
        damping: 0.0,
        coefficient: 0.0,
        slip_speed: 1.0,
        gravity: 0.0,
    }
}

fn scene(name: &'static str, about: String, law: Law, seconds: f64, case: Case) -> Scene {
    Scene {
        name,
        about,
        law,
        shape: Shape::Free,
        restitution: 0.0,
        seconds,
        soft: case,
        rigid: case,
        measure: Measure::Rim(0.5),
        unit: (1.0, "m"),
        useful: 0.1,
        steps: vec![10.0, 1.0, 1e-1, 3e-2, 1e-2, 3e-3, 1e-3],
        plain_steps: vec![3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4],
        rapier_steps: vec![1e-2, 1e-3, 1e-4],
        scale: (1.0, 1.0),
    }
}

/// The coin of the coin report in flight, its axis 15 degrees from its angular momentum of 1 kg
/// m²/s.
pub(crate) fn coin() -> Scene {
    let case = symmetric(DVec3::new(0.25, 0.125, 0.125), 1.0, 10.0);
    let about = "ring of 0.5 m, 8 rad/s, wobbling by 15°; its turn after 10 s, closed form".into();
    scene("coin in flight", about, law(1.0, case.0), 10.0, case.1)
}

/// The coin of the coin report in flight, with a spin of 1e4 rad/s.
pub(crate) fn fast_coin() -> Scene {
    let case = symmetric(DVec3::new(0.25, 0.125, 0.125), 1250.0, 1.0);
    let about = "the same at 10⁴ rad/s; its turn after 1 s, closed form".into();
    Scene {
        steps: vec![1e-2, 1e-3, 1e-4, 1e-5],
        plain_steps: vec![3e-5, 1e-5, 3e-6, 1e-6],
        rapier_steps: vec![1e-4, 1e-5],
        scale: (1.0, 1e-4),
        ..scene(
            "coin in flight, 10⁴ rad/s",
            about,
            law(1.0, case.0),
            1.0,
            case.1,
        )
    }
}

/// A symmetric top, which rotates about its angular momentum at `L/I1` and about its own axis at
/// `L cos θ (1/I3 - 1/I1)` (Euler).
fn symmetric(inertia: DVec3, momentum: f64, seconds: f64) -> (DVec3, Case) {
    let tilt = core::f64::consts::PI / 12.0;
    let start = State::at(DVec3::ZERO)
        .with_rotation_vector(DVec3::Y * -tilt)
        .with_angular_momentum(DVec3::X * momentum);
    let about_momentum = DQuat::from_rotation_x(momentum / inertia.y * seconds);
    let own = momentum * tilt.cos() * (1.0 / inertia.x - 1.0 / inertia.y) * seconds;
    let answer = State {
        orientation: about_momentum * start.orientation * DQuat::from_rotation_x(own),
        ..start
    };
    (inertia, Case { start, answer })
}

/// A box that spins about its middle axis and turns over every `2 K(m)/p` (Landau & Lifshitz,
/// Mechanics, section 37, with axes numbered by moment).
pub(crate) fn middle_axis() -> Scene {
    // 1 kg, 0.1 m by 0.2 m by 0.3 m: moments (b² + c²)/12, the smallest about the longest edge. The
    // axes x, y, z are numbered by moment.
    let inertia = DVec3::new(0.05, 0.10, 0.13) / 12.0;
    let seconds = 10.0;
    let spin = DVec3::new(0.005, 5.0, 0.0);
    let start = State::at(DVec3::ZERO).with_angular_momentum(inertia * spin);
    let last = euler(inertia, spin, seconds);
    let about = format!(
        "box of 0.1 m, 0.2 m, 0.3 m, ω = (0.005, 5, 0) rad/s in body axes, turns over at 3.39 s; the same after {seconds} s by Jacobi's functions"
    );
    // Only the spin in body axes is compared.
    let answer = State::at(DVec3::ZERO).with_angular_momentum(inertia * last);
    Scene {
        measure: Measure::BodySpin,
        unit: (1.0, "rad/s"),
        useful: 0.5,
        ..scene(
            "middle axis",
            about,
            law(1.0, inertia),
            seconds,
            Case { start, answer },
        )
    }
}

/// Spin in body axes by Jacobi's functions, for a body that starts without spin about the axis of
/// its largest moment, and with `L² < 2 E I2`.
///
/// `ω1 = A1 dn`, `ω2 = A2 sn`, `ω3 = A3 cn` solve Euler's equations: the textbook's with the axes 1
/// and 3 exchanged. The start is a quarter of the period after u = 0. The functions are then
/// `ω1(0)/dn`, `ω2(0) cn/dn` and `-A3 k' sn/dn`. Differences of nearly equal numbers, such as
/// `2 E I2 - L²`, are written as products, because the parameter is within 1e-6 of 1.
fn euler(inertia: DVec3, start: DVec3, seconds: f64) -> DVec3 {
    let (i1, i2, i3) = (inertia.x, inertia.y, inertia.z);
    let (n1, n2) = (i1 * start.x * start.x, i2 * start.y * start.y);
    // 2 E I3 - L² and L² - 2 E I1.
    let below = n1 * (i3 - i1) + n2 * (i3 - i2);
    let above = n2 * (i2 - i1);
    let rate = ((i2 - i1) * below / (i1 * i2 * i3)).sqrt();
    let complement = (i3 - i1) * n1 / below;
    let (sn, cn) = jacobi(rate * seconds, complement);
    let dn = (complement + (1.0 - complement) * cn * cn).sqrt();
    let last = (above / (i3 * (i3 - i1)) * complement).sqrt();
    DVec3::new(start.x, start.y * cn, -last * sn) / dn
}

/// Computes sn and cn of `u` for the parameter `1 - complement`, by the arithmetic-geometric mean
/// (Abramowitz & Stegun, 16.4).
fn jacobi(u: f64, complement: f64) -> (f64, f64) {
    let (mut a, mut b) = (1.0, complement.sqrt());
    let mut ratios = Vec::new();
    while (a - b).abs() > 1e-15 * a {
        let next = 0.5 * (a + b);
        ratios.push(0.5 * (a - b) / next);
        b = (a * b).sqrt();
        a = next;
    }
    let mut phi = u * a * 2.0_f64.powi(ratios.len() as i32);
    for ratio in ratios.into_iter().rev() {
        phi = 0.5 * (phi + (ratio * phi.sin()).asin());
    }
    phi.sin_cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the middle spin is zero after a quarter of the period, 3.393201 s, and that the
    /// box has turned over after twice that time.
    #[test]
    fn the_box_turns_over_when_the_quarter_period_says() {
        let (inertia, start) = (
            DVec3::new(0.05, 0.10, 0.13) / 12.0,
            DVec3::new(0.005, 5.0, 0.0),
        );
        assert!(euler(inertia, start, 3.393201).y.abs() < 1e-5);
        assert!(
            (euler(inertia, start, 2.0 * 3.3932015) - start * DVec3::new(1.0, -1.0, 1.0)).length()
                < 1e-5
        );
    }

    #[test]
    fn the_spin_by_jacobi_keeps_energy_and_momentum() {
        let (inertia, start) = (
            DVec3::new(0.05, 0.10, 0.13) / 12.0,
            DVec3::new(0.005, 5.0, 0.0),
        );
        for seconds in [0.7, 3.4, 10.0] {
            let spin = euler(inertia, start, seconds);
            let energy = spin.dot(inertia * spin) / start.dot(inertia * start);
            let momentum = (inertia * spin).length() / (inertia * start).length();
            assert!((energy - 1.0).abs() < 1e-13 && (momentum - 1.0).abs() < 1e-13);
        }
    }
}
