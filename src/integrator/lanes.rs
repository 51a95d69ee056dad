//! Several states of one body, stepped together in lanes: one lane of the processor's vectors for
//! each state.
//!
//! A stage is a loop over the lanes around the function that a single state uses, with numbers that
//! are stored component by component. The compiler vectorises it. So the operations on a state and
//! their order are those of a single state, and so are its bits.
//!
//! *Branches.* A branch is a choice between values that are all computed. The branches that a step
//! seldom takes are computed state by state if one lane needs them. So is the applied force.
//!
//! *Bodies* have three equal moments of inertia, or two equal ones and a larger one. The rotation
//! of three different moments is a series whose length depends on the state. It takes most of a
//! step, and lanes would gain nothing. That of two equal ones and a smaller one is
//! [corrected](super::free_error) state by state.
//!
//! Each stage is a function of its own. The compiler then knows that its results do not overlap its
//! arguments.
//!
//! *Gain:* the table of [`guide::modelling`](crate::guide::modelling), written by `.ci/lanes.sh`.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index of several arrays"
)]

use crate::body::{ContactRange, InertiaProperties};
use crate::contact::{AddRow, AxesInLanes, LANES, Loads, Motions, Numbers, Ranges, Vectors};
use crate::force::Force;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::{self, BodyAxis, Rotation, Series};
use crate::scene::Dynamics;
use crate::state::State;

/// Rotation of each lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Rotations<R> {
    w: Numbers<R>,
    v: Vectors<R>,
}

impl<R: Real> Rotations<R> {
    pub(in crate::integrator) const ZERO: Self = Self {
        w: [R::ZERO; LANES],
        v: Vectors::ZERO,
    };

    #[inline(always)]
    pub(in crate::integrator) fn get(&self, i: usize) -> Rotation<R> {
        Rotation::of_parts(self.w[i], self.v.get(i))
    }

    #[inline(always)]
    pub(in crate::integrator) fn set(&mut self, i: usize, rotation: Rotation<R>) {
        let (w, v) = rotation.parts();
        self.w[i] = w;
        self.v.set(i, v);
    }

    /// Stores rotations scaled to length 1.
    #[inline(never)]
    fn set_normalised(&mut self, rotations: &Self) {
        let mut near = 0;
        for i in 0..LANES {
            let rotation = rotations.get(i);
            near += usize::from(rotation.is_almost_unit());
            self.set(i, rotation.normalised_almost_unit());
        }
        if near < LANES {
            for i in 0..LANES {
                self.set(i, rotations.get(i).normalised());
            }
        }
    }

    /// Stores the quaternion products with an axis of the body.
    #[inline]
    fn set_times(&mut self, rotations: &Self, axis: BodyAxis<R>) {
        // Each arm is compiled for its own axis, without a branch in its loop.
        match axis {
            BodyAxis::X => self.set_times_axis(rotations, BodyAxis::X),
            BodyAxis::Y => self.set_times_axis(rotations, BodyAxis::Y),
            BodyAxis::Z => self.set_times_axis(rotations, BodyAxis::Z),
            BodyAxis::Other(vector) => self.set_times_axis(rotations, BodyAxis::Other(vector)),
        }
    }

    #[inline(always)]
    fn set_times_axis(&mut self, rotations: &Self, axis: BodyAxis<R>) {
        for i in 0..LANES {
            self.set(i, rotations.get(i).times(axis));
        }
    }
}

/// The thirteen numbers of a state, or of its time derivative, of each lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Points<R> {
    pub(in crate::integrator) position: Vectors<R>,
    pub(in crate::integrator) linear_velocity: Vectors<R>,
    pub(in crate::integrator) orientation: Rotations<R>,
    pub(in crate::integrator) angular_momentum: Vectors<R>,
}

impl<R: Real> Points<R> {
    pub(in crate::integrator) const ZERO: Self = Self {
        position: Vectors::ZERO,
        linear_velocity: Vectors::ZERO,
        orientation: Rotations::ZERO,
        angular_momentum: Vectors::ZERO,
    };

    #[inline(always)]
    pub(in crate::integrator) fn get(&self, i: usize) -> Point<R> {
        Point {
            position: self.position.get(i),
            linear_velocity: self.linear_velocity.get(i),
            orientation: self.orientation.get(i),
            angular_momentum: self.angular_momentum.get(i),
        }
    }

    #[inline(always)]
    pub(in crate::integrator) fn set(&mut self, i: usize, point: &Point<R>) {
        self.position.set(i, point.position);
        self.linear_velocity.set(i, point.linear_velocity);
        self.orientation.set(i, point.orientation);
        self.angular_momentum.set(i, point.angular_momentum);
    }

    /// Replaces each point by a function of itself and of others.
    #[inline(never)]
    pub(in crate::integrator) fn replace_by_sum(
        &mut self,
        [second, third, fourth]: [&Self; 3],
        sum: impl Fn(&Point<R>, [&Point<R>; 3]) -> Point<R>,
    ) {
        for i in 0..LANES {
            let others = [&second.get(i), &third.get(i), &fourth.get(i)];
            self.set(i, &sum(&self.get(i), others));
        }
    }
}

/// States that are stepped together, with the workspace of their steps.
#[derive(Clone, Debug)]
pub struct Lanes<R: Real> {
    pub(in crate::integrator) states: Points<R>,
    /// Rotation of each lane within a step, of length 1.
    pub(in crate::integrator) rotations: Rotations<R>,
    pub(in crate::integrator) axes: AxesInLanes<R>,
    pub(in crate::integrator) spins: Vectors<R>,
    pub(in crate::integrator) ranges: Ranges<R>,
    pub(in crate::integrator) loads: Loads<R>,
}

impl<R: Real> Lanes<R> {
    /// Creates lanes from at most [`LANES`] states. The last state fills the lanes that are left.
    pub(crate) fn of(states: &[State<R>]) -> Self {
        let mut lanes = Self {
            states: Points::ZERO,
            rotations: Rotations::ZERO,
            axes: AxesInLanes::ZERO,
            spins: Vectors::ZERO,
            ranges: Ranges::none(),
            loads: Loads::ZERO,
        };
        for i in 0..LANES {
            if let Some(state) = states.get(i).or(states.last()) {
                let point = Point {
                    position: state.position,
                    linear_velocity: state.linear_velocity,
                    orientation: Rotation::unscaled(state.orientation),
                    angular_momentum: state.angular_momentum,
                };
                lanes.states.set(i, &point);
            }
        }
        lanes
    }

    /// States of the lanes.
    pub(crate) fn states(&self) -> [State<R>; LANES] {
        core::array::from_fn(|i| {
            let point = self.states.get(i);
            State {
                orientation: point.orientation.to_quat(),
                position: point.position,
                linear_velocity: point.linear_velocity,
                angular_momentum: point.angular_momentum,
            }
        })
    }

    /// Returns true if every number of the states is finite, and their sum too.
    pub(crate) fn are_finite(&self) -> bool {
        let states = self.states();
        states.iter().all(|state| state.not_finite().is_none())
    }

    /// Computes the rotations and the axes of the states.
    #[inline]
    pub(in crate::integrator) fn begin(&mut self) {
        self.rotations.set_normalised(&self.states.orientation);
        set_axes(&mut self.axes, &self.rotations);
    }

    /// Computes the axes of the rotations.
    #[inline]
    pub(in crate::integrator) fn set_axes(&mut self) {
        set_axes(&mut self.axes, &self.rotations);
    }

    /// Computes the axes of the states, for quaternions of any length.
    #[inline]
    pub(in crate::integrator) fn set_axes_of_any_length(&mut self) {
        set_axes_of_any_length(&mut self.axes, &self.states.orientation);
    }

    /// Contact range of each lane.
    #[inline]
    pub(in crate::integrator) fn contact_ranges(&self) -> [ContactRange; LANES] {
        *self.ranges.get()
    }

    /// Motions of the states, whose axes and angular velocities are known.
    #[inline(always)]
    pub(in crate::integrator) fn motions(&self) -> Motions<'_, R> {
        Motions {
            position: &self.states.position,
            axes: &self.axes,
            linear_velocity: &self.states.linear_velocity,
            angular_velocity: &self.spins,
        }
    }

    /// Computes the angular velocities of the states, whose axes are known.
    #[inline]
    pub(in crate::integrator) fn set_spins<D: Dynamics<R>>(&mut self, scene: &D) {
        let (mass, momenta) = (scene.inertia_properties(), &self.states.angular_momentum);
        set_spins(mass, &self.axes, momenta, &mut self.spins);
    }

    /// Finds the contacts that can touch at the positions of the states.
    #[inline]
    pub(in crate::integrator) fn find_contacts<D: Dynamics<R>>(&mut self, scene: &D) {
        let model = scene.contact_model();
        self.ranges.find(&model, &self.states.position, &self.axes);
    }

    /// Computes the loads of the contacts and of the applied force at the velocities of the states.
    #[inline]
    pub(in crate::integrator) fn find_loads<D: Dynamics<R>>(&mut self, scene: &D) {
        self.set_spins(scene);
        let motions = &Motions {
            position: &self.states.position,
            axes: &self.axes,
            linear_velocity: &self.states.linear_velocity,
            angular_velocity: &self.spins,
        };
        let model = scene.contact_model();
        let evaluate = |row: AddRow<'_, R>| scene.evaluate_in_lanes(row);
        model.loads_in_lanes(&self.ranges, motions, &evaluate, &mut self.loads);
        if scene.force().acts() {
            for i in 0..LANES {
                let applied = scene.force().wrench(&motions.get(i));
                self.loads.add(i, applied.force, applied.torque);
            }
        }
    }

    /// Linear velocities and angular momenta.
    #[inline]
    pub(in crate::integrator) fn velocities(&self) -> [Vectors<R>; 2] {
        [self.states.linear_velocity, self.states.angular_momentum]
    }

    /// Replaces linear velocities and angular momenta.
    #[inline]
    pub(in crate::integrator) fn set_velocities(&mut self, velocities: &[Vectors<R>; 2]) {
        [self.states.linear_velocity, self.states.angular_momentum] = *velocities;
    }

    /// Replaces linear velocities and angular momenta of some lanes.
    #[inline]
    pub(in crate::integrator) fn set_velocities_of(
        &mut self,
        lanes: &[bool; LANES],
        [velocities, momenta]: &[Vectors<R>; 2],
    ) {
        for i in 0..LANES {
            if lanes[i] {
                self.states.linear_velocity.set(i, velocities.get(i));
                self.states.angular_momentum.set(i, momenta.get(i));
            }
        }
    }

    /// Advances the velocities by gravity alone.
    #[inline]
    pub(in crate::integrator) fn fall<D: Dynamics<R>>(&mut self, scene: &D, seconds: R) {
        let gravity = scene.gravity();
        for i in 0..LANES {
            let velocity = self.states.linear_velocity.get(i) + gravity * seconds;
            self.states.linear_velocity.set(i, velocity);
        }
    }

    /// Replaces the states by `start + slope seconds`, and computes their axes.
    #[inline]
    pub(in crate::integrator) fn advance(
        &mut self,
        start: &Points<R>,
        slope: &Points<R>,
        seconds: R,
    ) {
        advance(start, slope, seconds, &mut self.states);
        self.set_axes_of_any_length();
    }

    /// Returns the time derivatives of the states, whose axes are known.
    #[inline]
    pub(in crate::integrator) fn slopes<D: Dynamics<R>>(&mut self, scene: &D) -> Points<R> {
        self.find_contacts(scene);
        self.find_loads(scene);
        let (inverse_mass, gravity) = (scene.inertia_properties().inverse_mass(), scene.gravity());
        let motions = (&self.spins, &self.loads);
        slopes((inverse_mass, gravity), &self.states, motions)
    }

    /// Scales the quaternions of the states to length 1.
    #[inline]
    pub(in crate::integrator) fn normalise(&mut self) {
        self.rotations.set_normalised(&self.states.orientation);
        self.end();
    }

    /// Advances the velocities by the loads.
    #[inline]
    pub(in crate::integrator) fn kick<D: Dynamics<R>>(&mut self, scene: &D, seconds: R) {
        kick(scene, &self.loads, seconds, &mut self.states);
    }

    /// Advances positions and rotations in flight without force. The rotations have the axes that
    /// were computed last.
    #[inline]
    pub(in crate::integrator) fn drift(&mut self, mass: &InertiaProperties<R>, seconds: R) {
        drift(seconds, &mut self.states);
        let before = (&self.rotations, &self.axes, &self.states.angular_momentum);
        let mut after = Rotations::ZERO;
        turn_symmetric(mass, before, seconds, &mut after);
        self.rotations.set_normalised(&after);
    }

    /// Stores the rotations in the states.
    #[inline]
    pub(in crate::integrator) fn end(&mut self) {
        self.states.orientation = self.rotations;
    }
}

#[inline(never)]
fn set_axes<R: Real>(axes: &mut AxesInLanes<R>, rotations: &Rotations<R>) {
    for i in 0..LANES {
        axes.set(i, &rotations.get(i).axes());
    }
}

#[inline(never)]
fn set_axes_of_any_length<R: Real>(axes: &mut AxesInLanes<R>, rotations: &Rotations<R>) {
    for i in 0..LANES {
        axes.set(i, &rotations.get(i).axes_of_any_length());
    }
}

#[inline(never)]
fn advance<R: Real>(start: &Points<R>, slope: &Points<R>, seconds: R, end: &mut Points<R>) {
    for i in 0..LANES {
        end.set(i, &start.get(i).plus(&slope.get(i), seconds));
    }
}

#[inline(never)]
fn slopes<R: Real>(
    (inverse_mass, gravity): (R, R::Vec3),
    points: &Points<R>,
    (spins, loads): (&Vectors<R>, &Loads<R>),
) -> Points<R> {
    let mut slopes = Points::ZERO;
    for i in 0..LANES {
        let slope = Point {
            position: points.linear_velocity.get(i),
            linear_velocity: loads.force.get(i) * inverse_mass + gravity,
            orientation: points.orientation.get(i).rate(spins.get(i)),
            angular_momentum: loads.torque.get(i),
        };
        slopes.set(i, &slope);
    }
    slopes
}

/// Computes angular velocities from angular momenta, for two or three equal moments of inertia.
#[inline(never)]
pub(in crate::integrator) fn set_spins<R: Real>(
    mass: &InertiaProperties<R>,
    axes: &AxesInLanes<R>,
    momenta: &Vectors<R>,
    spins: &mut Vectors<R>,
) {
    let mut storage = Vectors::ZERO;
    let symmetry = in_world(mass.symmetry_axis(), axes, &mut storage);
    for i in 0..LANES {
        spins.set(
            i,
            mass.angular_velocity_of_symmetric(symmetry.get(i), momenta.get(i)),
        );
    }
}

/// Returns a direction fixed in the body in world axes.
#[inline(always)]
fn in_world<'a, R: Real>(
    axis: BodyAxis<R>,
    axes: &'a AxesInLanes<R>,
    storage: &'a mut Vectors<R>,
) -> &'a Vectors<R> {
    match axis {
        BodyAxis::X => &axes.x,
        BodyAxis::Y => &axes.y,
        BodyAxis::Z => &axes.z,
        BodyAxis::Other(vector) => {
            for i in 0..LANES {
                storage.set(i, axes.get(i).to_world(vector));
            }
            storage
        }
    }
}

#[inline(never)]
fn kick<R: Real, D: Dynamics<R>>(scene: &D, loads: &Loads<R>, seconds: R, states: &mut Points<R>) {
    let (inverse_mass, gravity) = (scene.inertia_properties().inverse_mass(), scene.gravity());
    for i in 0..LANES {
        let mut velocity = states.linear_velocity.get(i);
        velocity += (loads.force.get(i) * inverse_mass + gravity) * seconds;
        let momentum = states.angular_momentum.get(i) + loads.torque.get(i) * seconds;
        states.linear_velocity.set(i, velocity);
        states.angular_momentum.set(i, momentum);
    }
}

#[inline(never)]
fn drift<R: Real>(seconds: R, states: &mut Points<R>) {
    for i in 0..LANES {
        let path = states.linear_velocity.get(i) * seconds;
        states.position.set(i, states.position.get(i) + path);
    }
}

/// Computes [`InertiaProperties::turn_symmetric`] of rotations with their axes.
#[inline(never)]
fn turn_symmetric<R: Real>(
    mass: &InertiaProperties<R>,
    (rotations, axes, momenta): (&Rotations<R>, &AxesInLanes<R>, &Vectors<R>),
    seconds: R,
    turned: &mut Rotations<R>,
) {
    let mut storage = Vectors::ZERO;
    let symmetry = in_world(mass.symmetry_axis(), axes, &mut storage);
    let zero = [R::ZERO; LANES];
    let (mut halves, mut half_spins) = (Vectors::<R>::ZERO, zero);
    let (mut squares, mut spin_squares) = (zero, zero);
    for i in 0..LANES {
        let momentum = momenta.get(i);
        let half = mass.half_precession(momentum, seconds);
        let half_spin = mass.half_spin(symmetry.get(i), momentum, seconds);
        halves.set(i, half);
        half_spins[i] = half_spin;
        squares[i] = half.length_squared();
        spin_squares[i] = half_spin * half_spin;
    }
    let (mut precession, mut spin) = ((zero, zero), (zero, zero));
    cos_and_sinc(&squares, &mut precession);
    cos_and_sinc(&spin_squares, &mut spin);
    let mut products = Rotations::ZERO;
    products.set_times(rotations, mass.symmetry_axis());
    for i in 0..LANES {
        let of_spin = (spin.0[i], spin.1[i]);
        let spun = rotations
            .get(i)
            .spun_with(products.get(i), half_spins[i], of_spin);
        let of_precession = (precession.0[i], precession.1[i]);
        let precession = Rotation::of_half_vector(halves.get(i), of_precession);
        turned.set(i, precession.after(spun));
    }
}

/// Computes `cos h` and `sin(h)/h` from `h²`.
#[inline(never)]
fn cos_and_sinc<R: Real>(squares: &Numbers<R>, (cos, sinc): &mut (Numbers<R>, Numbers<R>)) {
    let count = |series: Series| {
        let each = squares
            .iter()
            .map(|square| usize::from(series.suffices(*square)));
        each.sum::<usize>()
    };
    if count(Series::Short) == LANES {
        for i in 0..LANES {
            (cos[i], sinc[i]) = Series::short(squares[i]);
        }
    } else if count(Series::Long) == LANES {
        for i in 0..LANES {
            (cos[i], sinc[i]) = Series::chosen(squares[i]);
        }
    } else {
        for i in 0..LANES {
            (cos[i], sinc[i]) = rotation::cos_and_sinc(squares[i]);
        }
    }
}
