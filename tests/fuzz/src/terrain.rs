//! Height fields of any numbers under every integrator.
//!
//! A field that breaks the contract may end a step with an error. It must not make a step hang,
//! panic, return an invalid state, or increase the energy of `EnergyMomentum`.

use tumble::{Elevation, Force, Ground, NoForce, Real, SpringDamper, State, Stepper, Terrain};

use super::input::Input;
use super::parts::{Meter, body, friction, gravity, method, state};
use super::scene::steps;

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    if input.flag() {
        play::<f32>(&mut input);
    } else {
        play::<f64>(&mut input);
    }
}

/// Terms of a field: a polynomial of order 2, a wave, and cells with values of their own.
struct Field<R> {
    polynomial: [R; 6],
    wave: [R; 2],
    cell: R,
    cells: Vec<Elevation<R>>,
}

impl<R: Real> Field<R> {
    fn read(input: &mut Input<'_>) -> Self {
        let polynomial = [0; 6].map(|_| input.signed(1e-3, 1.0));
        let wave = [input.signed(1e-3, 1.0), input.size(0.1, 10.0)];
        let count = input.below(4);
        Self {
            polynomial,
            wave,
            cell: input.size(1e-2, 1.0),
            cells: (0..count).map(|_| elevation(input)).collect(),
        }
    }

    fn elevation(&self, x: R, y: R) -> Elevation<R> {
        if !self.cells.is_empty() {
            let cell = (x.abs() / self.cell).floor_index() ^ (y.abs() / self.cell).floor_index();
            // One cell in two is the polynomial's.
            if let Some(own) = self.cells.get(cell % (2 * self.cells.len())) {
                return *own;
            }
        }
        let [a, b, c, d, e, f] = self.polynomial;
        let [amplitude, number] = self.wave;
        let (sin, cos) = (x * number).sin_cos();
        let gradient = [
            b + d * R::TWO * x + e * y + amplitude * number * cos,
            c + e * x + f * R::TWO * y,
        ];
        let height = a + b * x + c * y + d * x * x + e * x * y + f * y * y + amplitude * sin;
        Elevation::new(height, gradient).with_hessian([
            d * R::TWO - amplitude * number * number * sin,
            e,
            f * R::TWO,
        ])
    }
}

fn elevation<R: Real>(input: &mut Input<'_>) -> Elevation<R> {
    let height = input.signed(1e-3, 1.0);
    let gradient = [0; 2].map(|_| input.signed(1e-3, 1.0));
    Elevation::new(height, gradient).with_hessian([0; 3].map(|_| input.signed(1e-3, 1.0)))
}

fn play<R: Real>(input: &mut Input<'_>) {
    let field = Field::<R>::read(input);
    let law = SpringDamper {
        stiffness: input.size(1e2, 1e6),
        damping: input.size(1e-2, 1e2),
    };
    let shape = Terrain::of(move |x: R, y: R| field.elevation(x, y));
    let ground = Meter::new(Box::new(Ground { law, shape }), true);
    let (method, friction, gravity) = (method(input), friction::<R>(input), gravity(input));
    let Ok(body) = body::<R>(input) else {
        return;
    };
    let stepper = Stepper::new(&*body)
        .and_then(|stepper| stepper.with_ground(&ground))
        .and_then(|stepper| stepper.with_friction(&*friction))
        .and_then(|stepper| stepper.with_gravity(gravity))
        .and_then(|stepper| stepper.with_force(&NoForce as &dyn Force<R>))
        .and_then(|stepper| stepper.with_integrator(method));
    let Ok(stepper) = stepper else {
        return;
    };
    let mut state: State<R> = state(input);
    let _ = stepper.lowest_point(&state).map(|lowest| lowest.gap);
    let _ = stepper.largest_stable_step(&state);
    steps(&stepper, &mut state, 12, input);
}
