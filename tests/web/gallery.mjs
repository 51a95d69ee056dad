// Looks at each page of the gallery in a browser. Called by .ci/gallery.sh, with the browser, the
// folder of the gallery and a folder for pictures.
import assert from 'node:assert/strict';
import { readdirSync, statSync } from 'node:fs';
import { join, relative } from 'node:path';
import { pathToFileURL } from 'node:url';
import puppeteer from 'puppeteer-core';

const { CHROMIUM, FOLDER, PICTURES, CI } = process.env;
const MOST_BYTES = 20e6;
const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

const files = readdirSync(FOLDER, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.isFile())
  .map((entry) => join(entry.parentPath, entry.name));
const pages = files.filter((file) => file.endsWith('.html')).sort();

// The pages are the project's own files, and the checks often run as root.
const browser = await puppeteer.launch({
  executablePath: CHROMIUM,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run'],
});

const DESKTOP = { width: 1280, height: 900 };
const PHONE = { width: 390, height: 844, isMobile: true, hasTouch: true };
const MODES = [
  { name: 'desktop', viewport: DESKTOP },
  { name: 'phone', viewport: PHONE },
  { name: 'desktop-dark', viewport: DESKTOP, dark: true },
  { name: 'phone-dark', viewport: PHONE, dark: true },
];

// A canvas has its texts in pixels: so each text is noted with its box as it is drawn.
function noteTexts() {
  const draw = CanvasRenderingContext2D.prototype.fillText;
  window.noted = new Set();
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
    const { width, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } =
      this.measureText(text);
    const shifts = { left: 0, start: 0, center: width / 2, right: width, end: width };
    const left = x - shifts[this.textAlign];
    const wide = this.canvas.width / this.getTransform().a;
    this.canvas.texts ??= [];
    this.canvas.texts.push({ text, left, right: left + width, top: y - up, bottom: y + down, wide });
    window.noted.add(this.canvas);
    return draw.call(this, text, x, y, ...rest);
  };
}

async function open(file, { viewport, dark = false, still = false }) {
  const tab = await browser.newPage();
  tab.errors = [];
  tab.on('pageerror', (error) => tab.errors.push(error.message));
  tab.on('console', (message) => {
    if (['error', 'warn'].includes(message.type())) tab.errors.push(message.text());
  });
  tab.on('requestfailed', (request) => tab.errors.push(`${request.url()} failed`));
  await tab.setViewport(viewport);
  await tab.emulateMediaFeatures([
    { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' },
    { name: 'prefers-reduced-motion', value: still ? 'reduce' : 'no-preference' },
  ]);
  await tab.evaluateOnNewDocument(noteTexts);
  await tab.goto(pathToFileURL(file).href);
  await wait(200);
  return tab;
}

// What is wrong in a document: texts that overlap, are cut or are too small, empty pictures,
// controls without a name, a page that is wider than the screen.
function faults() {
  const SMALLEST = 8; // px
  const found = [];
  const seen = (element) =>
    element.checkVisibility() && getComputedStyle(element).clipPath !== 'inset(50%)';
  const hidden = (element) => {
    for (let e = element; e; e = e.parentElement) if (!seen(e)) return true;
    return element.closest('option, script, style, title') !== null;
  };
  const inner = ({ left, right, top, bottom, text }) => {
    // A box is higher than its letters.
    const margin = 0.2 * (bottom - top);
    return { left: left + 1, right: right - 1, top: top + margin, bottom: bottom - margin, text };
  };
  const overlapping = (boxes) => {
    boxes = boxes.map(inner);
    boxes.forEach((a, i) =>
      boxes.slice(i + 1).forEach((b) => {
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 1 && high > 1) found.push(`"${a.text}" and "${b.text}" overlap`);
      }),
    );
  };
  // A legend is drawn over the curves, which are clipped to their frame.
  const hiddenCurves = (svg) => {
    const [frame, legend] = ['clipPath rect', 'rect[fill="none"][stroke="#cccccc"]'].map((name) => {
      const rect = svg.querySelector(name);
      return rect && ['x', 'y', 'width', 'height'].map((side) => rect[side].baseVal.value);
    });
    if (!frame || !legend) return;
    const isIn = ([left, top, wide, high], { x, y }) =>
      x > left && x < left + wide && y > top && y < top + high;
    const isUnder = (point) => isIn(frame, point) && isIn(legend, point);
    const hides = (curve) => {
      const part = curve.getTotalLength() / 400;
      return Array.from({ length: 401 }, (_, k) => curve.getPointAtLength(k * part)).some(isUnder);
    };
    const curves = [...svg.querySelectorAll('[clip-path] :is(path, circle, line)')];
    const start = svg.textContent.trim().slice(0, 40);
    if (curves.some(hides)) found.push(`a legend hides a curve in ${start}`);
  };
  const boxes = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const text = node.textContent.trim();
    if (!text || hidden(node.parentElement)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const rects = [...range.getClientRects()];
    for (const { left, right, top, bottom } of rects)
      boxes.push({ left, right, top, bottom, text });
    const svg = node.parentElement.closest('svg');
    if (!svg) continue;
    const frame = svg.getBoundingClientRect();
    const size = parseFloat(getComputedStyle(node.parentElement).fontSize) * svg.getScreenCTM().a;
    if (size < SMALLEST) found.push(`"${text}" is ${size.toFixed(1)} px high`);
    for (const { left, right, top, bottom } of rects)
      if (
        Math.min(left - frame.left, frame.right - right) < -1 ||
        Math.min(top - frame.top, frame.bottom - bottom) < -1
      )
        found.push(`"${text}" is cut by the edge of its picture`);
  }
  overlapping(boxes);
  for (const svg of document.querySelectorAll('svg')) if (!hidden(svg)) hiddenCurves(svg);
  for (const canvas of window.noted) {
    // The curves of a thumbnail are hidden, on a canvas of no width.
    if (canvas.width <= 1) continue;
    overlapping(canvas.texts);
    for (const { text, left, right, wide } of canvas.texts)
      if (left < -1 || right > wide + 1) found.push(`"${text}" is cut by the edge of its canvas`);
  }
  for (const canvas of document.querySelectorAll('canvas')) {
    if (hidden(canvas)) continue;
    const { width, height } = canvas;
    if (!width || !height) {
      found.push(`canvas ${canvas.id} has no size`);
      continue;
    }
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    const colours = new Set(new Uint32Array(data.buffer));
    if (colours.size < 20) found.push(`canvas ${canvas.id} is empty: ${colours.size} colours`);
  }
  for (const svg of document.querySelectorAll('svg'))
    if (svg.querySelectorAll('*').length < 10) found.push('an empty drawing');
  for (const image of document.images)
    if (image.complete && !image.naturalWidth) found.push(`${image.src} is empty`);
  for (const control of document.querySelectorAll('button, input, select, a')) {
    const name = control.ariaLabel || control.closest('label')?.textContent || control.textContent;
    if (!name.trim()) found.push(`a ${control.tagName} without a name`);
  }
  if (document.documentElement.scrollWidth > innerWidth + 1)
    found.push(`${document.documentElement.scrollWidth} px wide on a screen of ${innerWidth} px`);
  return found;
}

const time = (frame) => frame.$eval('#value-time', (element) => element.textContent);
// Fails if the time of a film does not change. A busy machine may take some seconds.
async function plays(film) {
  // A browser draws no film that is off the screen.
  const element = film.parentFrame() && (await film.frameElement());
  await element?.evaluate((frame) => frame.scrollIntoView({ block: 'center' }));
  const before = await time(film);
  const changed = (t) => document.getElementById('value-time').textContent !== t;
  await film.waitForFunction(changed, { timeout: 10000 }, before).catch(() => {
    throw new Error(`${film.url()} does not play`);
  });
}
const isFilm = async (frame) => (await frame.$('#value-time')) !== null;

let passed = 0,
  failed = 0;
async function check(what, file, mode, body) {
  const tab = await open(file, mode);
  try {
    const said = await body(tab);
    assert.deepEqual(tab.errors, [], 'errors of the page');
    passed += 1;
    if (said) console.log(`ok: ${what}: ${said}`);
  } catch (error) {
    await tab.screenshot({ path: join(PICTURES, `failed-${failed}.png`) });
    failed += 1;
    console.log(`FAILED: ${what}: ${error.message}`);
  } finally {
    await tab.close();
  }
}

async function hasNoFault(tab, isPlaying) {
  for (const frame of tab.frames()) {
    const found = await frame.evaluate(faults);
    assert.deepEqual(found, [], `faults of ${relative(FOLDER, frame.url())}`);
    if (!isPlaying || !(await isFilm(frame))) continue;
    await plays(frame);
  }
}

// The films of the gallery, brought on the screen one by one.
async function thumbnails(tab, act) {
  const frames = await tab.$$('iframe');
  for (const frame of frames) {
    await frame.evaluate((element) => element.scrollIntoView({ block: 'center' }));
    const film = await frame.contentFrame();
    await film.waitForSelector('#value-time', { timeout: 5000 });
    await wait(150);
    await act(film);
  }
  return frames.length;
}

async function galleryMoves(tab) {
  const count = await thumbnails(tab, async (film) => {
    assert.deepEqual(await film.evaluate(faults), [], film.url());
    await plays(film);
  });
  await tab.click('#motion');
  await thumbnails(tab, stands);
  return `${count} films play on the screen, and none after "Pause motion"`;
}

async function stands(film) {
  const before = await time(film);
  await wait(120);
  assert.equal(await time(film), before, `${film.url()} stands still`);
}

// The keyboard reaches the button and each card, in their order, and nothing inside a film.
async function keyboardReachesAll(tab) {
  const cards = await tab.$$eval('h2 a', (links) => links.map((link) => link.textContent));
  const focused = () => tab.evaluate(() => document.activeElement.textContent);
  await tab.keyboard.press('Tab');
  assert.equal(await focused(), 'Play motion');
  for (const card of cards) {
    await tab.keyboard.press('Tab');
    assert.equal(await focused(), card);
  }
  return `${cards.length} cards`;
}

// A page with one fault of each kind.
const FAULTY = `<body style="margin: 0; width: 900px">
  <p style="height: 0; margin: 0">over</p><p style="margin: 0">under</p>
  <svg viewBox="0 0 200 50" width="200"><text x="195" y="20" font-size="7">cut</text></svg>
  <svg viewBox="0 0 200 50" width="200">
    <clipPath id="frame"><rect width="99" height="50" /></clipPath>
    <g clip-path="url(#frame)"><path d="M0 9H99" stroke="red" /></g>
    <rect width="50" height="20" fill="none" stroke="#cccccc" /></svg>
  <canvas id="blank" width="50" height="50"></canvas><button></button>
  <canvas id="doubled" width="50" height="50"></canvas>
  <script>
    const pen = document.getElementById('doubled').getContext('2d');
    pen.fillText('first', 4, 20);
    pen.fillText('second', 8, 20);
    pen.fillText('beyond', 40, 40);
  </script>`;

async function findsEachFault(tab) {
  await tab.setContent(FAULTY);
  const found = (await tab.evaluate(faults)).join('; ');
  for (const fault of [
    /"over" and "under" overlap/,
    /"cut" is cut/,
    /"cut" is 7.0 px high/,
    /"first" and "second" overlap/,
    /"beyond" is cut/,
    /canvas blank is empty/,
    /an empty drawing/,
    /a legend hides a curve/,
    /a BUTTON without a name/,
    /900 px wide on a screen of 390 px/,
  ])
    assert.match(found, fault);
  return 'overlap, cut and small text, hidden curve, empty canvas, drawing, no name, too wide';
}

const index = join(FOLDER, 'index.html');
const narrow = { viewport: { ...PHONE, isMobile: false } };
// In the place of a page without a script.
const still = join(FOLDER, 'round_rim/round_rim.html');
await check('a page with faults is found', still, narrow, findsEachFault);
await check('the gallery moves', index, { viewport: DESKTOP }, galleryMoves);
await check('it stands still for who asks for it', index, { viewport: PHONE, still: true }, (tab) =>
  thumbnails(tab, stands).then((count) => `${count} films`),
);
await check('keyboard', index, { viewport: DESKTOP, still: true }, keyboardReachesAll);
for (const mode of MODES) {
  for (const file of pages) {
    const name = relative(FOLDER, file);
    const picture = `${name.replaceAll(/\W/g, '-')}-${mode.name}.png`;
    await check(`${name}, ${mode.name}`, file, mode, async (tab) => {
      await hasNoFault(tab, file !== index && mode.name === 'desktop');
      // For who looks, which nobody does there.
      if (!CI) await tab.screenshot({ path: join(PICTURES, picture), fullPage: true });
    });
  }
  const tab = await open(index, mode);
  await wait(1000);
  await tab.screenshot({ path: join(PICTURES, `gallery-${mode.name}.png`) });
  await tab.close();
}
await browser.close();

const bytes = files.reduce((sum, file) => sum + statSync(file).size, 0);
console.log(`${pages.length} pages, ${(bytes / 1e6).toFixed(1)} MB`);
if (bytes > MOST_BYTES) {
  failed += 1;
  console.log(`FAILED: more than ${MOST_BYTES / 1e6} MB`);
}
console.log(`gallery: ${passed} checks passed, ${failed} failed`);
process.exitCode = failed ? 1 : 0;
