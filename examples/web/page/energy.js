// Energy by kind, its course, and what is found about it.

const KINDS = ['translation', 'rotation', 'gravity', 'springs'];
const byId = (id) => document.getElementById(id);

// A quantity with three digits and a unit.
function shown(value, unitName = 'J') {
  if (value === 0) return `0 ${unitName}`;
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-12) return `${value.toExponential(1)} ${unitName}`;
  const prefixes = [
    [1e-3, 'k'],
    [1, ''],
    [1e3, 'm'],
    [1e6, 'µ'],
    [1e9, 'n'],
    [1e12, 'p'],
  ];
  const [factor, prefix] = prefixes.find(([times]) => size * times >= 1);
  return `${Number((value * factor).toPrecision(3))} ${prefix}${unitName}`;
}

class EnergyPanel {
  constructor() {
    this.canvas = byId('course');
    this.draw = this.canvas.getContext('2d');
    this.clear();
  }

  clear() {
    this.course = [];
    this.told = '';
    this.next = 0;
  }

  // Adds a point of the course: time and the energies of both runs, J.
  record(time, chosen, other) {
    this.course.push([time, chosen, other]);
    if (this.course.length > 1500) this.course = this.course.filter((_, i) => i % 2 === 0);
  }

  // Shows the energies of the run, at most eight times a second.
  show(run, other, now, method) {
    if (now < this.next) return;
    this.next = now + 120;
    const kinds = KINDS.map((_, i) => run[RUN.energies + i]);
    const total = kinds.reduce((sum, value) => sum + Math.max(0, value), 0) || 1;
    KINDS.forEach((kind, i) => {
      byId(`${kind}-bar`).style.width = `${(100 * Math.max(0, kinds[i])) / total}%`;
      byId(`${kind}-value`).textContent = shown(kinds[i]);
    });
    byId('total-value').textContent = shown(run[RUN.total]);
    this.state(run, other, method);
    this.drawCourse(other !== null);
  }

  // The finding in words. A reader of the screen hears it when its sense changes.
  state(run, other, method) {
    const rose = run[RUN.largest] > 0,
      steps = run[RUN.steps].toLocaleString('en');
    const verdict = rose
      ? `${method} has gained energy: ${shown(run[RUN.sum])} in ${steps} steps, ` +
        `at most ${shown(run[RUN.largest])} in one.`
      : `The energy never increased. Largest increase in ${steps} steps of ${method}: 0 J.`;
    const beside = other
      ? ` EnergyMomentum, from the same start: largest increase ${shown(other[RUN.largest])}.`
      : '';
    byId('verdict').textContent = verdict + beside;
    byId('verdict').className = rose ? 'gained' : 'kept';
    const told = rose ? `${method} has gained energy.` : `${method}: the energy never increased.`;
    if (told !== this.told && run[RUN.steps] > 0) {
      this.told = told;
      byId('spoken').textContent = told;
    }
  }

  drawCourse(both) {
    const { draw, canvas, course } = this,
      density = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * density))
      [canvas.width, canvas.height] = [Math.round(width * density), Math.round(height * density)];
    draw.setTransform(density, 0, 0, density, 0, 0);
    draw.clearRect(0, 0, width, height);
    if (course.length < 2) return;
    const finite = course.flatMap(([, a, b]) => (both ? [a, b] : [a])).filter(Number.isFinite);
    const [low, high] = [Math.min(0, ...finite), Math.max(...finite)];
    const [from, to] = [course[0][0], course[course.length - 1][0]];
    const x = (time) => 1 + ((width - 2) * (time - from)) / (to - from || 1);
    const y = (value) => height - 3 - ((height - 8) * (value - low)) / (high - low || 1);
    const style = getComputedStyle(document.documentElement);
    const line = (at, colour, dash) => {
      draw.strokeStyle = style.getPropertyValue(colour);
      draw.lineWidth = 2;
      draw.setLineDash(dash);
      draw.beginPath();
      course.forEach((point, i) =>
        i ? draw.lineTo(x(point[0]), y(point[at])) : draw.moveTo(x(point[0]), y(point[at])),
      );
      draw.stroke();
      draw.setLineDash([]);
    };
    if (both) line(2, '--ghost', [5, 4]);
    line(1, '--accent', []);
  }
}
