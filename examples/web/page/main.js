// The page: one run that is advanced with the clock, and everything that starts it anew.

const AT_MOST = 14; // ms of a picture's time that steps may take
const CHUNK = 8; // steps between two readings of the clock; one of an adaptive integrator

class Page {
  constructor(tumble, bytes) {
    Object.assign(this, {
      tumble,
      bytes,
      running: true,
      held: false,
      rate: 1,
      owed: 0,
      behind: false,
      simulated: 0,
    });
    this.view = new View(byId('view'));
    this.energy = new EnergyPanel();
    this.panel = new Panel(
      tumble,
      (index, value, starts) => this.change(index, value, starts),
      (body) => this.choose(body),
    );
    tumble.call('choose', 0);
    this.hand = new Hand(byId('view'), this.view, this);
    this.tosses = new Tosses(tumble, bytes);
    this.connect();
  }

  connect() {
    const click = (id, act) => byId(id).addEventListener('click', act);
    click('play', () => this.play(!this.running));
    click('one-step', () => this.oneStep());
    click('restart', () => this.attempt(() => this.begun('restart')));
    click('throw', () => this.throwAtRandom());
    click('set-down', () => this.attempt(() => this.begun('place')));
    click('share', () => this.share());
    click('too-long', () => this.tooLong());
    click('bits-again', () => checkBits(this.bytes));
    byId('rate').addEventListener('change', (event) => {
      this.rate = Number(event.target.value);
    });
    window.addEventListener('hashchange', () => {
      if (location.hash !== this.address) this.open();
    });
    document.addEventListener('keydown', (event) => this.key(event));
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.view.readTheme());
  }

  // Starts with the throw in the address, or with the first scene of the coin.
  open() {
    this.attempt(
      () => {
        const given = readAddress(this.tumble, location.hash);
        if (given) this.adopt();
        else this.choose(0);
      },
      () => this.choose(0),
    );
  }

  // Shows a body and a scene that are already set.
  adopt() {
    const body = this.tumble.parameters[PARAMETER.body],
      kept = [...this.tumble.parameterBits];
    this.tumble.call('choose', body);
    this.panel.centre(this.tumble.parameters);
    this.tumble.parameterBits.set(kept);
    this.showBody(body);
    this.begun();
  }

  choose(body) {
    this.attempt(() => {
      this.tumble.call('choose', body);
      this.panel.centre(this.tumble.parameters);
      this.showBody(body);
      this.begun('place');
    });
  }

  showBody(body) {
    const { mesh, rate, name } = BODIES[body];
    this.view.show(mesh(), this.tumble.calls.radius());
    this.view.target = [...this.position(), 6.4 * this.view.radius];
    this.view.zoom = 1;
    this.rate = rate;
    byId('rate').value = rate;
    byId('view').setAttribute(
      'aria-label',
      `${name} on a level floor, seen from the side. Drag the body and let go to throw it. ` +
        'The arrow keys turn the view.',
    );
    this.tosses.reset();
  }

  // Begins a run, by a call of the library if there is one.
  begun(call) {
    if (call) this.tumble.call(call);
    this.owed = 0;
    this.view.path = [];
    this.energy.clear();
    this.remember();
    this.panel.show();
    this.address = writtenAddress(this.tumble);
    showAddress(this.address);
    this.face = -1;
  }

  // Applies a parameter. If the library refuses it, the run goes on as before.
  change(index, value, starts) {
    const before = this.tumble.parameterBits[index];
    this.attempt(
      () => {
        this.tumble.parameters[index] = value;
        // An invalid scene must not replace the stored start of the run.
        this.tumble.call('check');
        this.begun(starts ? 'place' : 'restart_here');
        if (!starts && index !== PARAMETER.method) this.tosses.reset();
      },
      () => {
        this.tumble.parameterBits[index] = before;
        this.panel.show();
      },
    );
  }

  attempt(act, undo) {
    try {
      act();
      byId('error').hidden = true;
    } catch (error) {
      undo?.();
      this.refuse(error);
    }
  }

  // Shows why the library refuses an input, or why a step failed.
  refuse(error) {
    byId('error').textContent = error.message;
    byId('error').hidden = false;
    if (!(error instanceof Refusal)) throw error;
  }

  position(run = 0) {
    return [...this.tumble.runs[run].subarray(0, 3)];
  }

  pose(run) {
    return {
      position: this.position(run),
      rotate: rotation([...this.tumble.runs[run].subarray(6, 10)]),
    };
  }

  hasTwin() {
    return this.tumble.parameters[PARAMETER.method] !== 0;
  }

  grab() {
    this.held = true;
  }

  // Carries the body, which the library keeps above the floor.
  hold(point) {
    this.attempt(() => this.tumble.call('hold', ...point));
  }

  // Throws with the velocity of the hand as it is seen. In slow motion the body is faster by the
  // factor by which time is slower.
  letGo(velocity, arm) {
    this.held = false;
    const seen = scale(velocity, 1 / this.rate);
    this.attempt(() => {
      this.tumble.call('flick', ...seen, ...arm);
      this.begun();
      this.play(true);
    });
  }

  // A throw with random velocities, for the keyboard. The body keeps its orientation, x and y.
  // Speeds are in units of √(g R).
  throwAtRandom() {
    const random = () => crypto.getRandomValues(new Uint32Array(1))[0] / 2 ** 31 - 1;
    const { radius } = this.view,
      speed = Math.sqrt(Math.abs(this.tumble.parameters[PARAMETER.gravity]) * radius);
    const [x, y] = this.position();
    this.attempt(() => {
      this.tumble.call('hold', x, y, 1.5 * radius);
      const velocity = [
        1.2 * speed * random(),
        1.2 * speed * random(),
        speed * (2.2 + 0.5 * random()),
      ];
      this.tumble.call('flick', ...velocity, ...[0, 0, 0].map(() => 0.5 * radius * random()));
      this.begun();
      this.play(true);
    });
  }

  // The body is dropped, with steps a fifth longer than the library's limit of Rk4 when it has
  // landed. Beside it is the default with the same step.
  tooLong() {
    this.attempt(() => {
      const { parameters, calls } = this.tumble;
      this.tumble.call('choose', parameters[PARAMETER.body]);
      this.tosses.reset();
      parameters[PARAMETER.method] = METHODS.indexOf('Rk4');
      parameters[PARAMETER.start] = 2;
      this.tumble.call('place');
      let limit = Infinity;
      for (let steps = 0; steps < 20000 && limit === Infinity; steps += 10) {
        this.tumble.call('advance', 0, 10);
        limit = calls.stable_step();
      }
      if (limit < Infinity) parameters[PARAMETER.step] = Number((1.2 * limit).toPrecision(3));
      this.begun('place');
      this.play(true);
    });
  }

  play(running) {
    this.running = running;
    this.behind = false;
    byId('play').textContent = running ? 'Pause' : 'Play';
  }

  oneStep() {
    this.play(false);
    this.advance(1);
  }

  share() {
    navigator.clipboard?.writeText(location.href).then(
      () => {
        byId('spoken').textContent = byId('shared').textContent = 'copied';
      },
      () => {},
    );
    byId('shared').textContent = 'in the address bar';
  }

  key(event) {
    const typing = /^(INPUT|SELECT|TEXTAREA|BUTTON)$/.test(event.target.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey || (typing && event.target.type !== 'radio'))
      return;
    const { view } = this;
    const keys = {
      ' ': () => this.play(!this.running),
      '.': () => this.oneStep(),
      r: () => this.attempt(() => this.begun('restart')),
      t: () => this.throwAtRandom(),
      '+': () => {
        view.zoom *= 0.9;
      },
      '-': () => {
        view.zoom *= 1.1;
      },
    };
    const turns = {
      ArrowLeft: [-0.1, 0],
      ArrowRight: [0.1, 0],
      ArrowUp: [0, 0.06],
      ArrowDown: [0, -0.06],
    };
    const turn = event.target === byId('view') && turns[event.key];
    if (turn) {
      view.azimuth += turn[0];
      view.elevation = Math.min(1.4, Math.max(0.06, view.elevation + turn[1]));
    } else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  }

  // Takes steps in the run, and in that of the default method beside it.
  advance(steps) {
    try {
      this.tumble.call('advance', 0, steps);
      if (this.hasTwin()) this.tumble.call('advance', 1, steps);
      this.simulated += steps;
    } catch (error) {
      this.play(false);
      this.refuse(error);
    }
    this.remember();
  }

  // Keeps the samples of the path and of the energy.
  remember() {
    const [run, twin] = this.tumble.runs,
      samples = [];
    for (let i = 0; i < run[RUN.samples]; i += 1)
      samples.push([...run.subarray(RUN.path + 3 * i, RUN.path + 3 * i + 3)]);
    this.view.trace(samples);
    this.energy.record(
      run[RUN.steps] * this.tumble.parameters[PARAMETER.step],
      run[RUN.total],
      twin[RUN.total],
    );
  }

  // Steps for the time since the last picture. What does not fit is left out, and said.
  keepUp(milliseconds) {
    const step = this.tumble.parameters[PARAMETER.step];
    this.owed += (Math.min(milliseconds, 100) / 1000) * this.rate;
    const until = performance.now() + AT_MOST;
    const chunk = isAdaptive(this.tumble.parameters[PARAMETER.method]) ? 1 : CHUNK;
    while (this.running && this.owed >= step && performance.now() < until) {
      const steps = Math.min(chunk, Math.floor(this.owed / step));
      this.owed -= steps * step;
      this.advance(steps);
    }
    this.behind = this.running && this.owed > 2 * step;
    if (this.behind) this.owed = 0;
  }

  frame(now) {
    const elapsed = now - (this.last ?? now);
    this.last = now;
    if (this.running && !this.held) this.keepUp(elapsed);
    this.view.resize();
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (!this.held) this.view.aim(this.position(), still ? 1 : 1 - Math.exp(-elapsed / 250));
    const twin = this.hasTwin() && !this.held;
    this.view.render(this.pose(0), twin ? this.pose(1) : null);
    this.energy.show(
      this.tumble.runs[0],
      twin ? this.tumble.runs[1] : null,
      now,
      METHODS[this.tumble.parameters[PARAMETER.method]],
    );
    this.showState(now);
    requestAnimationFrame((next) => this.frame(next));
  }

  // Time and proven face, four times a second: a proof takes some thousand evaluations.
  showState(now) {
    if (now < (this.nextState ?? 0)) return;
    this.nextState = now + 250;
    const run = this.tumble.runs[0],
      seconds = run[RUN.steps] * this.tumble.parameters[PARAMETER.step];
    byId('clock').textContent =
      `${seconds.toFixed(2)} s${this.behind ? ', slower than the clock' : ''}`;
    byId('square').textContent = shown(this.view.square(), 'm');
    if (this.held) return;
    const face = this.tumble.calls.face(),
      { faces } = BODIES[this.tumble.parameters[PARAMETER.body]];
    const text = face < 0 ? '' : `${faces[face]}: proven`;
    byId('face').textContent = text;
    if (face >= 0 && face !== this.face)
      byId('spoken').textContent = `${faces[face]}, proven by the energy`;
    this.face = face;
  }
}

async function main() {
  const bytes = await part('module');
  const page = new Page(await loadTumble(bytes), bytes);
  window.page = page; // for the console and for tests
  page.open();
  if (matchMedia('(prefers-reduced-motion: reduce)').matches) page.play(false);
  checkBits(bytes);
  requestAnimationFrame((now) => page.frame(now));
}

main().catch(cannotStart);
