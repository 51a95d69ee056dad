// Parameters of the scene: a slider and a number for each.

const SLIDERS = [
  {
    id: 'lean',
    label: 'Lean at the start',
    unit: '°',
    low: 0,
    high: 90,
    per: Math.PI / 180,
    starts: true,
  },
  { id: 'spin', label: 'Spin at the start', unit: 'rad/s', around: 2.5, starts: true },
  { id: 'friction', label: 'Friction coefficient', unit: '', low: 0, high: 1.5 },
  { id: 'damping', label: 'Damping, each contact', unit: 'N s/m', decades: 1.5 },
  { id: 'stiffness', label: 'Stiffness, each contact', unit: 'N/m', decades: 1.5 },
  { id: 'step', label: 'Step size', unit: 'ms', decades: 2, per: 1e-3 },
];
const EXPLICIT = 'Explicit. It gains energy if the step is too long.';
const ADAPTIVE = 'Adaptive: it divides each step. Tolerance: a thousandth of the bounding radius.';
const INTEGRATORS = [
  ['EnergyMomentum', 'The default. Its energy never increases.'],
  ['StrangSplitting', EXPLICIT],
  ['SymplecticEuler', EXPLICIT],
  ['Rk4', EXPLICIT],
  ['Nystrom', EXPLICIT],
  ['ForwardEuler', EXPLICIT],
  ['AdaptiveEnergyMomentum', `${ADAPTIVE} Its energy never increases.`],
  ['BogackiShampine32', ADAPTIVE],
  ['DormandPrince54', ADAPTIVE],
  ['Flight', 'Flight in closed form, and StrangSplitting in contact.'],
  ['Radau5', `${ADAPTIVE} Implicit.`],
  ['AdaptiveNystrom', ADAPTIVE],
];
const METHODS = INTEGRATORS.map(([name]) => name);
const isAdaptive = (method) => INTEGRATORS[method][1].startsWith(ADAPTIVE);

// One parameter. The slider covers an interval about the first value; the number takes any value.
class Slider {
  constructor(kind, tumble, changed) {
    Object.assign(this, { ...kind, per: kind.per ?? 1, tumble, changed });
    this.range = byId(`${this.id}-range`);
    this.number = byId(`${this.id}-number`);
    this.range.addEventListener('input', () => this.set(this.at(Number(this.range.value))));
    this.number.addEventListener('change', () =>
      this.set(this.number.value === '' ? NaN : Number(this.number.value)),
    );
  }

  // Ends of the slider for the first value of a scene.
  centre(first) {
    this.first = first / this.per;
    if (this.around)
      [this.low, this.high] = [-this.around, this.around].map(
        (times) => times * Math.abs(this.first || 1),
      );
  }

  // Value at a place of the slider from 0 to 1000, rounded to three digits.
  at(place) {
    const part = place / 1000;
    const value = this.decades
      ? this.first * 10 ** (this.decades * (2 * part - 1))
      : this.low + (this.high - this.low) * part;
    return Number(value.toPrecision(3));
  }

  place(value) {
    const part = this.decades
      ? 0.5 + Math.log10(value / this.first) / (2 * this.decades)
      : (value - this.low) / (this.high - this.low);
    return Math.round(1000 * Math.min(1, Math.max(0, part || 0)));
  }

  set(value) {
    this.changed(PARAMETER[this.id], value * this.per, Boolean(this.starts));
  }

  show() {
    const value = Number((this.tumble.parameters[PARAMETER[this.id]] / this.per).toPrecision(12));
    this.number.value = value;
    this.range.value = this.place(value);
    this.range.setAttribute('aria-valuetext', `${value} ${this.unit}`.trim());
  }
}

class Panel {
  // `changed` takes the index and the value of a parameter, and whether it belongs to the start.
  constructor(tumble, changed, chosen) {
    this.tumble = tumble;
    byId('sliders').innerHTML = SLIDERS.map(
      ({ id, label, unit: symbol }) => `
      <div class="slider"><label for="${id}-range">${label}</label>
      <input type="range" id="${id}-range" min="0" max="1000">
      <span class="value"><input type="number" step="any" id="${id}-number"
        aria-label="${label}${symbol ? ', ' + symbol : ''}">
      <span class="unit" aria-hidden="true">${symbol}</span></span></div>`,
    ).join('');
    this.sliders = SLIDERS.map((kind) => new Slider(kind, tumble, changed));
    byId('bodies').innerHTML = BODIES.map(
      ({ name }, i) => `
      <label><input type="radio" name="body" value="${i}"><span>${name}</span></label>`,
    ).join('');
    byId('bodies').addEventListener('change', (event) => chosen(Number(event.target.value)));
    byId('method').innerHTML = METHODS.map(
      (name, i) => `<option value="${i}">${name}${i ? '' : ', default'}</option>`,
    ).join('');
    byId('method').addEventListener('change', (event) =>
      changed(PARAMETER.method, Number(event.target.value), false),
    );
    byId('start').addEventListener('change', (event) =>
      changed(PARAMETER.start, Number(event.target.value), true),
    );
  }

  // Centres the sliders on the present scene, which is the first of a body.
  centre(first) {
    this.sliders.forEach((slider) => slider.centre(first[PARAMETER[slider.id]]));
  }

  show() {
    const { parameters } = this.tumble,
      body = parameters[PARAMETER.body];
    this.sliders.forEach((slider) => slider.show());
    document.querySelectorAll('input[name=body]').forEach((input, i) => {
      input.checked = i === body;
    });
    byId('method').value = parameters[PARAMETER.method];
    byId('method-note').textContent = INTEGRATORS[parameters[PARAMETER.method]][1];
    byId('start').innerHTML = BODIES[body].starts
      .map((text, i) => `<option value="${i}">${text}</option>`)
      .join('');
    byId('start').value = parameters[PARAMETER.start];
  }
}
