// A thousand tosses in a worker, counted by proven face, and the battery of scenes.

const TOSSES = 1000;

function startWorker(message, receive) {
  const source = new Blob([byId('worker').textContent], { type: 'text/javascript' });
  const worker = new Worker(URL.createObjectURL(source));
  worker.onmessage = ({ data }) => receive(data);
  worker.onerror = (event) => receive({ failed: true, text: event.message });
  worker.postMessage(message);
  return worker;
}

class Tosses {
  constructor(tumble, bytes) {
    Object.assign(this, { tumble, bytes, worker: null, seed: 1 });
    byId('toss').addEventListener('click', () => (this.worker ? this.stop('stopped') : this.run()));
    this.reset();
  }

  // Clears the counts: they belong to one scene.
  reset() {
    this.stop('');
    const { faces } = BODIES[this.tumble.parameters[PARAMETER.body]];
    byId('toss').disabled = faces.length === 0;
    byId('bars').innerHTML = '';
    byId('toss-state').textContent =
      faces.length === 0
        ? 'Choose a coin or the die: the other bodies have no faces to count.'
        : 'Random heights, orientations and spins, on the ground set above, by EnergyMomentum.';
  }

  stop(text) {
    this.worker?.terminate();
    this.worker = null;
    byId('toss').textContent = `Throw ${TOSSES.toLocaleString('en')} times`;
    if (text) byId('toss-state').textContent += ` ${text}`;
  }

  run() {
    byId('toss').textContent = 'Stop';
    const message = {
      task: 'toss',
      bytes: this.bytes,
      parameters: [...this.tumble.parameterBits],
      seed: this.seed,
      tosses: TOSSES,
      places: FACES + 2,
    };
    this.seed += 1;
    this.worker = startWorker(message, (answer) => this.receive(answer));
  }

  receive({ failed, text, counts, done }) {
    if (failed) {
      byId('toss-state').textContent = text;
      return this.stop('');
    }
    this.show(counts, done);
    if (done === TOSSES) this.stop('');
  }

  show(counts, done) {
    const { faces } = BODIES[this.tumble.parameters[PARAMETER.body]];
    const [undecided, failed] = counts.slice(FACES);
    const rows = [...faces.map((name, i) => [name, counts[i]]), ['undecided', undecided]];
    if (failed > 0) rows.push(['failed', failed]);
    // The widest line ends at the end of its column. All bars have one scale, from 0.
    const most = Math.max(...rows.map(([, count]) => this.tumble.wilson(count, done)[1]));
    const bars = rows.map(([name, count]) => this.bar(name, count, done, most));
    byId('bars').innerHTML = bars.join('');
    byId('toss-state').textContent =
      `${done} of ${TOSSES} throws, seed ${this.seed - 1}. Each face is proven by the energy. ` +
      'Undecided throws are counted. Lines: 95 % intervals of Wilson.';
    if (done === TOSSES)
      byId('spoken').textContent =
        `${TOSSES} throws: ${rows.map(([name, count]) => `${name} ${count}`).join(', ')}`;
  }

  bar(name, count, done, most) {
    const [low, high] = this.tumble.wilson(count, done).map((end) => 100 * end);
    const percent = (100 * count) / done;
    const [width, left, span] = [percent, low, high - low].map((part) => part / most);
    return `<tr><th scope="row">${name}</th><td class="count">${count}</td>
      <td class="graph"><div class="bar" style="width:${width}%"></div>
        <div class="whisker" style="left:${left}%;width:${span}%"></div></td>
      <td class="interval">${percent.toFixed(1)} %
        <span>[${low.toFixed(1)}, ${high.toFixed(1)}]</span></td></tr>`;
  }
}

// Compares the hash of the battery, computed here, with the stored one.
function checkBits(bytes) {
  const shownIn = byId('bits'),
    stored = byId('stored').textContent;
  shownIn.textContent = 'computing …';
  byId('computed').textContent = '';
  startWorker({ task: 'bits', bytes }, ({ failed, text }) => {
    const equal = !failed && text === stored;
    byId('computed').textContent = text;
    shownIn.textContent = equal ? 'equal' : 'different';
    shownIn.className = equal ? 'kept' : 'gained';
  });
}
