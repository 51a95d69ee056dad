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
  LARGEST = 19,
  TOTAL = 18;
const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

const html = readFileSync(PAGE);
const server = createServer((_, answer) =>
  answer.writeHead(200, { 'content-type': 'text/html; charset=utf-8' }).end(html),
);
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const fromServer = `http://127.0.0.1:${server.address().port}/`,
  fromDisk = pathToFileURL(PAGE).href;
// The page is the project's own file, and the checks often run as root.
const browser = await puppeteer.launch({
  executablePath: CHROMIUM,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run'],
});

const DESKTOP = { width: 1280, height: 900 };
const SMALL = { width: 1280, height: 800, deviceScaleFactor: 0.75 };
const PHONE = { width: 390, height: 844, isMobile: true, hasTouch: true, deviceScaleFactor: 2 };

// Opens the page anew. An error in it or in its console fails the check that has opened it.
async function open(address, { viewport = DESKTOP, dark = false, still = false } = {}) {
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
async function check(what, address, options, body) {
  const tab = await open(address, options);
  try {
    const said = await body(tab);
    assert.deepEqual(tab.errors, [], 'errors of the page');
    passed += 1;
    console.log(`ok: ${what}${said ? `: ${said}` : ''}`);
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
  await tab.waitForFunction(
    () => /^(equal|different)/.test(document.getElementById('bits').textContent),
    { timeout: 60000 },
  );
  const [, row] = (await text(tab, 'bits')).split(/: /);
  assert.ok(readFileSync(HASHES, 'utf8').split('\n').includes(row), row);
  assert.match(await text(tab, 'bits'), /^equal/);
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

async function throwsByMouse(tab) {
  const before = await tab.evaluate(() => location.hash);
  const [x, y] = await bodyInPicture(tab);
  await tab.mouse.move(x + 12, y);
  await tab.mouse.down();
  for (let i = 1; i <= 8; i += 1) {
    await tab.mouse.move(x + 12 + 10 * i, y - 14 * i);
    await wait(12);
  }
  await tab.mouse.up();
  await wait(300);
  return wasThrown(tab, before);
}

async function throwsByTouch(tab) {
  const before = await tab.evaluate(() => location.hash);
  const [x, y] = await bodyInPicture(tab);
  const finger = await tab.touchscreen.touchStart(x + 8, y);
  for (let i = 1; i <= 8; i += 1) {
    await finger.move(x + 8 + 6 * i, y - 10 * i);
    await wait(12);
  }
  await finger.end();
  await wait(300);
  return wasThrown(tab, before);
}

async function throwsByKeyboard(tab) {
  const before = await tab.evaluate(() => location.hash);
  await tab.keyboard.press('t');
  await wait(300);
  assert.notEqual(await tab.evaluate(() => location.hash), before);
  await tab.keyboard.press('Space');
  const paused = (await run(tab))[STEPS];
  await wait(200);
  assert.equal((await run(tab))[STEPS], paused, 'paused');
  await tab.keyboard.press('.');
  assert.equal((await run(tab))[STEPS], paused + 1, 'one step');
}

// With each parameter at another value, the same number of steps ends in another state.
async function eachParameterMatters(tab) {
  const ends = new Map();
  for (const body of [0, 1, 2, 3, 4, 5, 6]) {
    await tab.evaluate((number) => {
      window.page.choose(number);
      window.page.play(false);
    }, body);
    const changes = {
      none: [null],
      lean: ['lean', 31],
      spin: ['spin', 3.5],
      friction: ['friction', 0.55],
      damping: ['damping', 0.77],
      stiffness: ['stiffness', 1234],
      step: ['step', 0.7],
      method: ['method', '3'],
      start: ['start', null],
    };
    for (const [name, [id, value]] of Object.entries(changes)) {
      await tab.evaluate((number) => {
        window.page.choose(number);
        window.page.play(false);
      }, body);
      if (id === 'method') await tab.select('#method', value);
      else if (id === 'start')
        await tab.select(
          '#start',
          await tab.$eval('#start', (input) => String((Number(input.value) + 1) % 3)),
        );
      else if (id)
        await tab.$eval(
          `#${id}-number`,
          (input, to) => {
            input.value = to;
            input.dispatchEvent(new Event('change'));
          },
          value,
        );
      await replayed(tab, 400);
      ends.set(`${body} ${name}`, (await bits(tab)).join());
    }
  }
  // The lean of a homogeneous ball is the direction of its spin, which differs too.
  assert.equal(new Set(ends.values()).size, ends.size, 'all ends differ');
  return `${ends.size} ends`;
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

async function refusesByName(tab) {
  await tab.$eval('#step-number', (input) => {
    input.value = -1;
    input.dispatchEvent(new Event('change'));
  });
  assert.equal(await text(tab, 'error'), 'time step must be above 0, got -0.001 s');
  await wait(300);
  assert.equal(await tab.$eval('#error', (shown) => shown.hidden), false, 'the error stays');
  assert.equal(
    await tab.evaluate(() => window.page.tumble.parameters[2]),
    1e-3,
    'the last valid step size',
  );
  await tab.evaluate(() => {
    location.hash = '#1.nonsense';
  });
  await wait(200);
  assert.match(await text(tab, 'error'), /names no throw/);
}

// Live, not by a call of the library: the page's own loop takes the steps.
async function energyNeverIncreases(tab) {
  await tab.evaluate(() => window.page.throwAtRandom());
  await tab.waitForFunction(() => window.page.tumble.runs[0][13] >= 10000, { timeout: 30000 });
  const [now, said] = [await run(tab), await text(tab, 'verdict')];
  assert.equal(now[LARGEST], 0);
  assert.match(said, /never increased/);
  return `${now[STEPS]} steps, largest increase ${now[LARGEST]} J`;
}

async function longExplicitStepsGainEnergy(tab) {
  await tab.evaluate(() => window.page.choose(3));
  await tab.click('#too-long');
  await wait(2500);
  const [chosen, beside, said] = [await run(tab, 0), await run(tab, 1), await text(tab, 'verdict')];
  assert.ok(chosen[LARGEST] > 0, `Rk4 gains ${chosen[LARGEST]} J`);
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
  await wait(1200);
  await tab.evaluate(() => window.page.play(false));
  const [address, steps, end] = [
    await tab.evaluate(() => location.hash),
    (await run(tab))[STEPS],
    await bits(tab),
  ];
  for (const place of [fromServer, fromDisk]) {
    const other = await open(place + address);
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
  await wait(1500);
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
  await wait(1500);
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
  await wait(600);
  assert.match(await text(tab, 'spoken'), /energy never increased|proven/);
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

// Simulated time over time on the clock, on a processor of a quarter of the speed.
async function keepsUp(tab) {
  const session = await tab.createCDPSession();
  await session.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  const ratios = [];
  for (const body of [0, 3]) {
    await tab.evaluate((number) => {
      window.page.choose(number);
      document.getElementById('rate').value = '1';
      document.getElementById('rate').dispatchEvent(new Event('change'));
      window.page.throwAtRandom();
      window.from = [window.page.simulated, performance.now()];
    }, body);
    await wait(3000);
    ratios.push(
      await tab.evaluate(
        () =>
          ((window.page.simulated - window.from[0]) * window.page.tumble.parameters[2] * 1000) /
          (performance.now() - window.from[1]),
      ),
    );
  }
  // Half of the pace is slow motion, not a picture that stands. The machine may be busy.
  assert.ok(
    ratios.every((ratio) => ratio > 0.5),
    ratios.join(),
  );
  return `simulated over real time: coin ${ratios[0].toFixed(2)}, die ${ratios[1].toFixed(2)}`;
}

async function desktopPicture(tab) {
  await wait(1600);
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
  await wait(600);
  await tab.screenshot({ path: join(PICTURES, 'readme.png') });
}

try {
  await check('opens from disk', fromDisk, {}, bitsAreEqual);
  await check('opens from a server', fromServer, {}, bitsAreEqual);
  await check('a desktop', fromDisk, {}, desktopPicture);
  await check('the picture of the README', fromDisk, { viewport: SMALL }, readmePicture);
  await check('a mouse throws the coin', fromDisk, {}, throwsByMouse);
  await check('a finger throws the coin', fromDisk, { viewport: PHONE }, throwsByTouch);
  await check('keys throw, pause and step', fromDisk, {}, throwsByKeyboard);
  await check('each parameter changes the motion', fromDisk, {}, eachParameterMatters);
  await check('each slider moves its parameter', fromDisk, {}, slidersMatter);
  await check('invalid input is refused by name', fromDisk, {}, refusesByName);
  await check('the energy never increases', fromDisk, {}, energyNeverIncreases);
  await check(
    'a step too long gains energy, the default none',
    fromDisk,
    {},
    longExplicitStepsGainEnergy,
  );
  await check(
    'a replay from the address bar has the same bits',
    fromDisk,
    {},
    replaysFromTheAddress,
  );
  await check('a thousand tosses are counted', fromDisk, {}, countsTosses);
  await check('390 px: nothing overflows', fromDisk, { viewport: PHONE }, fitsThePhone);
  await check('dark mode', fromDisk, { dark: true }, isDark);
  await check('names, focus and announcements', fromDisk, {}, isAccessible);
  await check('reduced motion', fromDisk, { still: true }, keepsStill);
  await check('keeps up on a slow processor', fromDisk, {}, keepsUp);
  console.log(`the live page: ${passed} checks passed, ${failed} failed, ${html.length} bytes`);
} finally {
  await browser.close();
  server.close();
}
process.exitCode = failed === 0 ? 0 : 1;
