// Tries the live page in a browser. Called by .ci/web.sh, with the page, the browser, the stored
// hashes and a folder for pictures.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import puppeteer from 'puppeteer-core';

const { CHROMIUM, PAGE, HASHES, PICTURES } = process.env;
const README_PICTURES = 290; // pictures of 16 steps
const STEPS = 13,
  LARGEST = 19;
const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

const html = readFileSync(PAGE);
const server = createServer((_, answer) =>
  answer.writeHead(200, { 'content-type': 'text/html; charset=utf-8' }).end(html),
);
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const fromServer = `http://127.0.0.1:${server.address().port}/`,
  fromDisk = pathToFileURL(PAGE).href;
// The page is the project's own file, and the checks often run as root.
const launched = () =>
  puppeteer.launch({
    executablePath: CHROMIUM,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run'],
  });

const DESKTOP = { width: 1280, height: 900 };
const SMALL = { width: 1280, height: 800, deviceScaleFactor: 0.75 };
const PHONE = { width: 390, height: 844, isMobile: true, hasTouch: true, deviceScaleFactor: 2 };

// Opens the page anew. An error in it or in its console fails the check that has opened it.
async function open(browser, address, { viewport = DESKTOP, dark = false, still = false } = {}) {
  const tab = await browser.newPage(),
    errors = [];
  tab.on('pageerror', (error) => errors.push(error.message));
  tab.on('console', (message) => {
    if (['error', 'warn'].includes(message.type())) errors.push(message.text());
  });
  tab.on('requestfailed', (request) => errors.push(`${request.url()} failed`));
  await tab.setViewport(viewport);
  await tab.emulateMediaFeatures([
    { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' },
    { name: 'prefers-reduced-motion', value: still ? 'reduce' : 'no-preference' },
  ]);
  await tab.goto(address);
  await tab.waitForFunction(() => window.page && window.page.last, { timeout: 15000 });
  tab.errors = errors;
  return tab;
}

// What a check waits for is a state of the page, not a time.
const until = (tab, condition, ...values) =>
  tab.waitForFunction(condition, { timeout: 30000 }, ...values);
const reached = (tab, count) =>
  until(tab, (least) => window.page.tumble.runs[0][13] >= least, count);

// Numbers of a run.
const run = (tab, number = 0) => tab.evaluate((n) => [...window.page.tumble.runs[n]], number);
const bits = (tab) => tab.evaluate(() => [...window.page.tumble.runBits[0]].map(String));
const text = (tab, id) => tab.$eval(`#${id}`, (element) => element.textContent);

// The same number of steps from the start of the run, as fast as they go.
const replayed = (tab, steps) =>
  tab.evaluate((count) => {
    window.page.play(false);
    window.page.begun('restart');
    window.page.advance(count);
  }, steps);

let passed = 0,
  failed = 0;
async function check(browser, [what, address, options, body]) {
  const began = performance.now(),
    tab = await open(browser, address, options);
  try {
    const said = await body(tab);
    assert.deepEqual(tab.errors, [], 'errors of the page');
    passed += 1;
    const seconds = ((performance.now() - began) / 1000).toFixed(1);
    console.log(`ok, ${seconds} s: ${what}${said ? `: ${said}` : ''}`);
  } catch (error) {
    await tab.screenshot({ path: join(PICTURES, 'failed.png') });
    failed += 1;
    console.log(`FAILED: ${what}: ${error.stack}`);
  } finally {
    await tab.close();
  }
}

async function bodyInPicture(tab) {
  return tab.evaluate(() => {
    const { view } = window.page,
      box = view.canvas.getBoundingClientRect();
    const [x, y] = view.project(window.page.position());
    return [box.left + x, box.top + y];
  });
}

async function bitsAreEqual(tab) {
  await until(tab, () => /^(equal|different)/.test(document.getElementById('bits').textContent));
  const [computed, stored] = [await text(tab, 'computed'), await text(tab, 'stored')];
  assert.match(computed, /^[0-9a-f]{16}$/);
  const row = `f64 live page ${computed}`;
  assert.ok(readFileSync(HASHES, 'utf8').split('\n').includes(row), row);
  assert.equal(stored, computed);
  assert.equal(await text(tab, 'bits'), 'equal');
  return row;
}

// A body that was thrown has another start, moves upwards, and comes down later.
async function wasThrown(tab, before) {
  const now = await run(tab),
    start = await tab.evaluate(() => [
      ...new Float64Array(new BigUint64Array(window.page.tumble.startBits).buffer),
    ]);
  assert.notEqual(await tab.evaluate(() => location.hash), before);
  assert.ok(start[5] > 0.2, `thrown upwards at ${start[5]} m/s`);
  assert.ok(Math.hypot(...start.slice(10)) > 0, 'with a spin');
  assert.ok(now[STEPS] > 0, 'and moves');
  return `${Math.hypot(...start.slice(3, 6)).toFixed(1)} m/s`;
}

// The path of a flick: 96 ms from beside the middle of the body up and to the right. The events say
// when they were, so that a busy machine makes no slower hand of them.
async function flick(tab, [dx, dy], send) {
  const [x, y] = await bodyInPicture(tab),
    began = Date.now() / 1000;
  for (let i = 0; i <= 8; i += 1) await send(x + 12 + dx * i, y + dy * i, i, began + 0.012 * i);
  await reached(tab, 20);
}

async function throwsByMouse(tab) {
  const before = await tab.evaluate(() => location.hash),
    session = await tab.createCDPSession();
  const mouse = (type, x, y, timestamp) =>
    session.send('Input.dispatchMouseEvent', {
      ...{ type, x, y, timestamp, button: 'left', clickCount: 1 },
      buttons: type === 'mouseReleased' ? 0 : 1,
    });
  await flick(tab, [10, -14], async (x, y, i, time) => {
    await mouse(i ? 'mouseMoved' : 'mousePressed', x, y, time);
    if (i === 8) await mouse('mouseReleased', x, y, time + 0.004);
  });
  return wasThrown(tab, before);
}

async function throwsByTouch(tab) {
  const before = await tab.evaluate(() => location.hash),
    session = await tab.createCDPSession();
  const touch = (type, touchPoints, timestamp) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints, timestamp });
  await flick(tab, [6, -10], async (x, y, i, time) => {
    await touch(i ? 'touchMove' : 'touchStart', [{ x, y }], time);
    if (i === 8) await touch('touchEnd', [], time + 0.004);
  });
  return wasThrown(tab, before);
}

async function throwsByKeyboard(tab) {
  const before = await tab.evaluate(() => location.hash);
  await tab.keyboard.press('t');
  await until(tab, (hash) => location.hash !== hash, before);
  await reached(tab, 20);
  await tab.keyboard.press('Space');
  const paused = (await run(tab))[STEPS];
  await wait(200);
  assert.equal((await run(tab))[STEPS], paused, 'paused');
  await tab.keyboard.press('.');
  assert.equal((await run(tab))[STEPS], paused + 1, 'one step');
}

// Takes 400 steps from the start of the run, with a body and with other values in its controls.
const ended = (tab, body, controls) =>
  tab.evaluate(
    (number, changes) => {
      const { page } = window;
      page.choose(number);
      page.play(false);
      for (const [id, value] of Object.entries(changes)) {
        const control = document.getElementById(id);
        control.value = value ?? (Number(control.value) + 1) % 3;
        control.dispatchEvent(new Event('change'));
      }
      page.begun('restart');
      page.advance(400);
      return {
        bits: page.tumble.runBits[0].join(),
        run: [...page.tumble.runs[0]],
        note: document.getElementById('method-note').textContent,
      };
    },
    body,
    controls,
  );

// With each parameter at another value, the same number of steps ends in another state.
async function eachParameterMatters(tab) {
  const ends = [];
  const changes = [
    {},
    { 'lean-number': 31 },
    { 'spin-number': 3.5 },
    { 'friction-number': 0.55 },
    { 'damping-number': 0.77 },
    { 'stiffness-number': 1234 },
    { 'step-number': 0.7 },
    { method: 3 },
    { start: null },
  ];
  for (const body of [0, 1, 2, 3, 4, 5, 6])
    for (const change of changes) ends.push((await ended(tab, body, change)).bits);
  // The lean of a homogeneous ball is the direction of its spin, which differs too.
  assert.equal(new Set(ends).size, ends.length, 'all ends differ');
  return `${ends.length} ends`;
}

// Every integrator of the list moves every body, each in its own way, and says what it is. Where
// each step keeps the tolerance of AdaptiveNystrom, its steps are those of Nystrom. A flight of a
// symmetric body is exact by AdaptiveNystrom and by Radau5.
async function eachIntegratorSteps(tab) {
  const [NYSTROM, RADAU_5, ADAPTIVE_NYSTROM] = [4, 10, 11];
  const ends = [];
  let same = 0;
  for (const body of [0, 1, 2, 3, 4, 5, 6]) {
    for (let method = 0; method < 12; method += 1) {
      const { bits: end, run: now, note } = await ended(tab, body, { start: 2, method });
      assert.equal(now[STEPS], 400, `body ${body}, integrator ${method}`);
      assert.ok(note.length > 20, note);
      if (/never increases/.test(note)) assert.equal(now[LARGEST], 0, `integrator ${method}`);
      const isAs = (other) => method === ADAPTIVE_NYSTROM && end === ends.at(other - method);
      if (isAs(NYSTROM) || isAs(RADAU_5)) same += 1;
      else {
        const name = `body ${body}, integrator ${method}`;
        assert.ok(!ends.includes(end), `${name} ends as integrator ${ends.indexOf(end)}`);
        ends.push(end);
      }
    }
  }
  assert.ok(same < 7, 'AdaptiveNystrom divides a step');
  assert.equal(await tab.$$eval('#method option', (options) => options.length), 12);
  return `${ends.length} ends`;
}

async function slidersMatter(tab) {
  for (const id of ['lean', 'spin', 'friction', 'damping', 'stiffness', 'step']) {
    const value = () => tab.$eval(`#${id}-number`, (input) => input.value);
    const before = await value();
    await tab.focus(`#${id}-range`);
    for (let i = 0; i < 4; i += 1) await tab.keyboard.press('ArrowRight');
    assert.notEqual(await value(), before, id);
  }
}

const scene = (tab) =>
  tab.evaluate(() => {
    const { parameterBits, startBits } = window.page.tumble;
    return [location.hash, parameterBits.join(), startBits.join()];
  });

// The run goes on with its own start, parameters and address.
async function refusesByName(tab) {
  await reached(tab, 100);
  const before = await scene(tab);
  await tab.$eval('#step-number', (input) => {
    input.value = -1;
    input.dispatchEvent(new Event('change'));
  });
  assert.equal(await text(tab, 'error'), 'time step must be above 0, got -0.001 s');
  await wait(300);
  assert.equal(await tab.$eval('#error', (shown) => shown.hidden), false, 'the error stays');
  assert.equal(await tab.$eval('#step-number', (input) => input.value), '1', 'last valid step');
  assert.deepEqual(await scene(tab), before, 'start, parameters and address');
  assert.ok((await run(tab))[STEPS] >= 100, 'the run is not restarted');
  await tab.evaluate(() => {
    location.hash = '#1.nonsense';
  });
  await until(tab, () => /names no throw/.test(document.getElementById('error').textContent));
}

// Live, not by a call of the library: the page's own loop takes the steps.
async function energyNeverIncreases(tab) {
  await tab.evaluate(() => window.page.throwAtRandom());
  await reached(tab, 10000);
  const [now, said] = [await run(tab), await text(tab, 'verdict')];
  assert.equal(now[LARGEST], 0);
  assert.match(said, /never increased/);
  return `${now[STEPS]} steps, largest increase ${now[LARGEST]} J`;
}

async function longExplicitStepsGainEnergy(tab) {
  await tab.evaluate(() => window.page.choose(3));
  await tab.click('#too-long');
  // A thousandth of the energy of the drop, far above rounding.
  await until(tab, (index) => window.page.tumble.runs[0][index] > 2e-6, LARGEST);
  await until(tab, () => /has gained/.test(document.getElementById('verdict').textContent));
  const [chosen, beside, said] = [await run(tab, 0), await run(tab, 1), await text(tab, 'verdict')];
  assert.ok(chosen[LARGEST] > 2e-6, `Rk4 gains ${chosen[LARGEST]} J`);
  assert.equal(beside[LARGEST], 0, 'the default gains nothing');
  assert.match(
    said,
    /Rk4 has gained energy.*EnergyMomentum, from the same start: largest increase 0 J/s,
  );
  await tab.screenshot({ path: join(PICTURES, 'gained.png') });
  return `Rk4 gains up to ${chosen[LARGEST].toExponential(1)} J a step, EnergyMomentum 0 J`;
}

// A throw by mouse, followed live, and as many steps in a page that is opened with its address.
async function replaysFromTheAddress(tab) {
  await throwsByMouse(tab);
  await reached(tab, 1000);
  await tab.evaluate(() => window.page.play(false));
  const [address, steps, end] = [
    await tab.evaluate(() => location.hash),
    (await run(tab))[STEPS],
    await bits(tab),
  ];
  for (const place of [fromServer, fromDisk]) {
    const other = await open(tab.browser(), place + address);
    await replayed(other, steps);
    assert.deepEqual(await bits(other), end);
    assert.equal(await other.evaluate(() => location.hash), address);
    await other.close();
  }
  return `${steps} steps`;
}

async function countsTosses(tab) {
  await tab.evaluate(() => window.page.choose(3));
  await tab.click('#toss');
  await tab.waitForFunction(
    () => document.getElementById('toss-state').textContent.startsWith('1000 of'),
    { timeout: 60000 },
  );
  const counts = await tab.$$eval('#bars .count', (cells) =>
    cells.map((cell) => Number(cell.textContent)),
  );
  assert.equal(
    counts.reduce((sum, count) => sum + count),
    1000,
  );
  assert.equal(counts.length, 7, 'six faces and the undecided');
  // A count around 1000/6 has a standard deviation of 11.8; beyond five of them it is no fair die.
  for (const count of counts.slice(0, 6)) assert.ok(Math.abs(count - 1000 / 6) < 59, `${counts}`);
  await tab.click('#too-long');
  assert.equal(await tab.$$eval('#bars .count', (cells) => cells.length), 0, 'another scene');
  return counts.join(', ');
}

async function fitsThePhone(tab) {
  for (let body = 0; body < 7; body += 1) {
    await tab.evaluate((number) => window.page.choose(number), body);
    const [width, widest] = await tab.evaluate(() => {
      const right = [...document.querySelectorAll('body *')].map(
        (element) => element.getBoundingClientRect().right,
      );
      return [innerWidth, Math.max(document.documentElement.scrollWidth, ...right)];
    });
    assert.ok(width === 390 && widest <= 390, `${widest} px of ${width} px`);
  }
  await tab.evaluate(() => window.page.choose(0));
  await reached(tab, 1000);
  await tab.screenshot({ path: join(PICTURES, 'phone.png'), fullPage: true });
}

// Contrast of texts with their background, by WCAG 2.1: at least 4.5.
async function isReadable(tab) {
  const worst = await tab.evaluate(() => {
    const style = getComputedStyle(document.documentElement),
      canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const light = (name) => {
      canvas.fillStyle = style.getPropertyValue(name).trim();
      canvas.fillRect(0, 0, 1, 1);
      const [r, g, b] = [...canvas.getImageData(0, 0, 1, 1).data].map((c) =>
        c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4,
      );
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const pairs = [
      ['--ink', '--page'],
      ['--ink', '--card'],
      ['--soft', '--page'],
      ['--soft', '--card'],
      ['--soft', '--sky'],
      ['--soft', '--floor'],
      ['--good', '--card'],
      ['--good', '--sky'],
      ['--bad', '--card'],
      ['--on-accent', '--accent'],
    ];
    const ratios = pairs.map((pair) => {
      const [a, b] = pair.map(light).sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), pair.join(' on ')];
    });
    return ratios.sort((a, b) => a[0] - b[0])[0];
  });
  assert.ok(worst[0] >= 4.5, worst.join(' '));
  return `least contrast ${worst[0].toFixed(1)}, ${worst[1]}`;
}

async function isDark(tab) {
  const light = await tab.evaluate(() =>
    getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number),
  );
  assert.ok(Math.max(...light) < 60, light.join());
  await tab.evaluate(() => window.page.choose(3));
  await reached(tab, 300);
  await tab.screenshot({ path: join(PICTURES, 'dark.png') });
  return isReadable(tab);
}

// Every control has a name, the energy is announced, and the keyboard reaches all of it.
async function isAccessible(tab) {
  const tree = await tab.accessibility.snapshot({ interestingOnly: true });
  const nodes = (node) => [node, ...(node.children ?? []).flatMap(nodes)];
  const controls = nodes(tree).filter(({ role }) =>
    ['button', 'slider', 'spinbutton', 'combobox', 'radio'].includes(role),
  );
  assert.ok(controls.length > 25, `${controls.length} controls`);
  assert.deepEqual(
    controls.filter(({ name }) => !name),
    [],
    'controls without a name',
  );
  await until(tab, () =>
    /energy never increased|proven/.test(document.getElementById('spoken').textContent),
  );
  const order = [];
  for (let i = 0; i < 40; i += 1) {
    await tab.keyboard.press('Tab');
    order.push(await tab.evaluate(() => document.activeElement.id || document.activeElement.name));
  }
  for (const id of [
    'body',
    'view',
    'throw',
    'play',
    'rate',
    'start',
    'method',
    'lean-range',
    'step-number',
    'toss',
    'bits-again',
  ])
    assert.ok(order.includes(id), `${id} in ${order}`);
  assert.ok(
    order.indexOf('view') < order.indexOf('throw') &&
      order.indexOf('throw') < order.indexOf('method'),
    'order of the focus',
  );
  return `${controls.length} controls`;
}

async function keepsStill(tab) {
  const before = (await run(tab))[STEPS];
  await wait(500);
  assert.equal((await run(tab))[STEPS], before, 'nothing moves by itself');
  assert.equal(await text(tab, 'play'), 'Play');
}

// Simulated time over time on the clock, and pictures a second, on a processor of a quarter of the
// speed.
async function keepsUp(tab) {
  const session = await tab.createCDPSession();
  await session.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  const found = [];
  for (const body of [0, 3]) {
    await tab.evaluate((number) => {
      window.page.choose(number);
      document.getElementById('rate').value = '1';
      document.getElementById('rate').dispatchEvent(new Event('change'));
      window.page.throwAtRandom();
      window.from = [window.page.simulated, performance.now()];
      window.pictures = 0;
      const count = () => {
        window.pictures += 1;
        requestAnimationFrame(count);
      };
      if (!window.counts) requestAnimationFrame(count);
      window.counts = true;
    }, body);
    await wait(3000);
    found.push(
      await tab.evaluate(() => {
        const clock = performance.now() - window.from[1];
        const steps = window.page.simulated - window.from[0];
        const simulated = steps * window.page.tumble.parameters[2] * 1000;
        return { ratio: simulated / clock, pictures: (1000 * window.pictures) / clock };
      }),
    );
  }
  // Half of the pace is slow motion, not a picture that stands. The machine may be busy.
  assert.ok(
    found.every(({ ratio }) => ratio > 0.5),
    JSON.stringify(found),
  );
  const told = found.map(
    ({ ratio, pictures }) => `${ratio.toFixed(2)} at ${pictures.toFixed(0)} pictures a second`,
  );
  return `simulated over real time: coin ${told[0]}, die ${told[1]}`;
}

async function desktopPicture(tab) {
  await reached(tab, 1500);
  await tab.screenshot({ path: join(PICTURES, 'desktop.png') });
  return isReadable(tab);
}

// Picture of the README: the same steps of the same scene each time.
async function readmePicture(tab) {
  await bitsAreEqual(tab);
  await tab.evaluate((pictures) => {
    const { page } = window;
    page.choose(0);
    page.play(false);
    for (let i = 0; i < pictures; i += 1) page.advance(16);
    page.view.aim(page.position(), 1);
  }, README_PICTURES);
  await until(tab, () => /^\d/.test(document.getElementById('square').textContent));
  await wait(300); // for what the page shows a few times a second
  await tab.screenshot({ path: join(PICTURES, 'readme.png') });
}

const CHECKS = [
  ['the energy never increases', fromDisk, {}, energyNeverIncreases],
  ['opens from disk', fromDisk, {}, bitsAreEqual],
  ['opens from a server', fromServer, {}, bitsAreEqual],
  ['a desktop', fromDisk, {}, desktopPicture],
  ['the picture of the README', fromDisk, { viewport: SMALL }, readmePicture],
  ['a mouse throws the coin', fromDisk, {}, throwsByMouse],
  ['a finger throws the coin', fromDisk, { viewport: PHONE }, throwsByTouch],
  ['keys throw, pause and step', fromDisk, {}, throwsByKeyboard],
  ['each parameter changes the motion', fromDisk, {}, eachParameterMatters],
  ['each integrator moves each body', fromDisk, {}, eachIntegratorSteps],
  ['each slider moves its parameter', fromDisk, {}, slidersMatter],
  ['invalid input is refused by name', fromDisk, {}, refusesByName],
  ['a step too long gains energy, the default none', fromDisk, {}, longExplicitStepsGainEnergy],
  ['a replay from the address has the same bits', fromDisk, {}, replaysFromTheAddress],
  ['a thousand tosses are counted', fromDisk, {}, countsTosses],
  ['390 px: nothing overflows', fromDisk, { viewport: PHONE }, fitsThePhone],
  ['dark mode', fromDisk, { dark: true }, isDark],
  ['names, focus and announcements', fromDisk, {}, isAccessible],
  ['reduced motion', fromDisk, { still: true }, keepsStill],
];

// Two browsers take the checks in turn. A page in the background would stand still, so each has one
// page at a time. The pace of the page is measured when nothing else runs.
async function inTurn(checks) {
  const browser = await launched();
  try {
    for (let next = checks.shift(); next; next = checks.shift()) await check(browser, next);
  } finally {
    await browser.close();
  }
}
try {
  await Promise.all([inTurn(CHECKS), inTurn(CHECKS)]);
  await inTurn([['keeps up on a slow processor', fromDisk, {}, keepsUp]]);
  const seconds = (performance.now() / 1000).toFixed(0);
  console.log(
    `the live page: ${passed} checks passed, ${failed} failed, ${seconds} s, ${html.length} bytes`,
  );
} finally {
  server.close();
}
process.exitCode = failed === 0 ? 0 : 1;
