// Tests the parts of the live view's page that need no browser: node page.mjs FOLDER, a copy of viz/web as ES modules.
// Prints nothing; exits with an error at the first violation.

import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const folder = process.argv[2];
const load = (name) => import(pathToFileURL(path.join(folder, name)));
const { contrast, distinct, headingOn, luminance, moverColors, onPaper, palettes, theme, useTheme } = await load('theme.js');
const { Fleet } = await load('fleet.js');
const { HeldReadings } = await load('held.js');
const { keyDown, pressed } = await load('input.js');
const { keyName } = await load('key_name.js');
const { Orbit, fov } = await load('orbit.js');
const { shadeDepths } = await load('picture.js');
const { prisms } = await load('solids_3d.js');
const near = (found, expected, within, what) => assert.ok(Math.abs(found - expected) <= within, `${what}: ${found}, not ${expected}`);

// The contrast formula, with the examples of WCAG: black on white, and the lightest grey that is valid for text on
// white.
near(contrast('#000000', '#ffffff'), 21, 1e-9, 'black on white');
near(contrast('#767676', '#ffffff'), 4.54, 0.005, 'grey on white');
near(luminance('#ff0000'), 0.2126, 1e-4, 'red');

// Texts of the style sheet in both themes (AA: 4.5), focus frames (3).
const css = fs.readFileSync(path.join(folder, 'style.css'), 'utf8');
const variables = (selector) => Object.fromEntries([...css.slice(css.indexOf(`${selector} {`)).split('}')[0].matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map(([, name, value]) => [name, value]));
const sheets = { light: variables(':root'), dark: variables(':root[data-theme="dark"]') };
const texts = [['ink', 'paper'], ['ink', 'ground'], ['ink', 'accent-soft'], ['quiet', 'paper'], ['quiet', 'ground'], ['off', 'ground'], ['on-accent', 'accent'], ['warn', 'paper'], ['warn', 'warn-soft'], ['good', 'good-soft'], ['on-warn', 'warn'], ['paper', 'ink']];
for (const [name, sheet] of Object.entries(sheets)) {
  assert.deepEqual(Object.keys(sheet).sort(), Object.keys(sheets.light).sort(), `colours of ${name}`);
  const least = name === 'light' || name === 'dark' ? 4.5 : 0;
  for (const [text, ground] of texts) {
    const wanted = text === 'off' ? 3 : least;  // WCAG has no requirement for disabled controls
    assert.ok(contrast(sheet[text], sheet[ground]) >= wanted, `${name}: ${text} on ${ground} ${contrast(sheet[text], sheet[ground])}`);
  }
  assert.ok(contrast(sheet.focus, sheet.paper) >= 3, `${name}: focus`);
}
assert.equal([...css.replace(/:root[^}]*}/g, '').matchAll(/#[0-9a-f]{3,8}\b(?=[;, ])/g)].length, 0, 'colours beside the variables');

// Colours of the map in both themes; lights have outlines of ink.
for (const name of Object.keys(palettes)) {
  useTheme(name);
  assert.equal(theme.paper, sheets[name].paper, `paper of ${name}`);
  for (const text of ['ink', 'quiet']) assert.ok(contrast(theme[text], theme.paper) >= 4.5, `${name}: ${text}`);
  for (const mark of ['wall', 'unseen', 'magnetUp', 'magnetDown', 'magnetometer', 'view', 'map', 'virtualWall', 'dock', 'selected', 'contact', 'lane', 'gps', 'trail', 'curve'])
    assert.ok(contrast(theme[mark], theme.paper) >= 3, `${name}: ${mark} ${contrast(theme[mark], theme.paper)}`);
  for (let value = 0; value < 0x1000000; value += 0x030507) {
    const color = '#' + value.toString(16).padStart(6, '0');
    assert.ok(contrast(onPaper(color), theme.paper) >= 3, `${name}: ${color} as a line`);
    assert.ok(contrast(headingOn(color), color) >= 4.4, `${name}: heading on ${color}`);
  }
  const own = Array.from({ length: 24 }, (_, i) => distinct(i));
  assert.equal(new Set(own).size, 24, 'colours of their own');
  for (const color of own) assert.ok(contrast(color, theme.paper) >= 2, `${name}: ${color} ${contrast(color, theme.paper)}`);
}
useTheme('light');

// Three or more robots that look alike get distinct colours; two, different ones and tags keep theirs.
const robots = (colors) => colors.map((color) => ({ color, tag: false }));
assert.deepEqual(moverColors(robots(['#111111', '#111111', '#222222']), true), ['#111111', '#111111', '#222222']);
assert.deepEqual(moverColors([...robots(['#111111', '#111111', '#111111', '#222222']), { color: '#111111', tag: true }], true), [distinct(0), distinct(1), distinct(2), '#222222', '#111111']);
assert.deepEqual(moverColors(robots(['#111111', '#111111', '#111111']), false), ['#111111', '#111111', '#111111']);

// Keys: caps lock alone, Shift alone, both.
for (const [key, shiftKey, name] of [['n', false, 'n'], ['N', false, 'n'], ['N', true, 'n'], ['n', true, 'n'], ['R', true, 'Shift r'], ['r', true, 'Shift r'], ['R', false, 'r'], ['r', false, 'r'], ['?', true, '?'], ['+', true, '+'], ['1', false, '1'], [' ', false, ' '], ['Escape', true, 'Escape'], ['ArrowUp', false, 'ArrowUp'], ['[', false, '[']])
  assert.equal(keyName({ key, shiftKey }), name, `${key} ${shiftKey}`);

// Keys call actions of the page, unless they belong to the browser or to a text field. Arrows pan, or drive.
function actionOf(key, { typing = false, driving = false, ...more } = {}) {
  let called = '';
  const page = new Proxy({ driving }, { get: (known, name) => name in known ? known[name] : (...values) => { called = `${name} ${values}`; } });
  keyDown({ key, shiftKey: false, target: { matches: () => typing, blur: () => { called = 'blur'; } }, getModifierState: () => false, preventDefault: () => {}, ...more }, page);
  return called;
}
for (const [key, more, action] of [['n', {}, 'step '], ['F', {}, 'toggleFollowing '], ['4', {}, 'setFastest '], ['r', {}, ''], ['n', { ctrlKey: true }, ''], ['n', { typing: true }, ''], ['Escape', { typing: true }, 'blur'], ['ArrowLeft', {}, 'pan 60,0'], ['v', {}, 'toggleThird '], ['ArrowUp', { driving: true }, '']])
  assert.equal(actionOf(key, more), action, `${key} ${JSON.stringify(more)}`);
assert.deepEqual([...pressed], ['ArrowUp']);

// A robot on an arc, with its forward beam to a wall at x = 5: the echo is drawn there regardless of the order of
// updates.
const movers = [{ radius: 0.2 }, { radius: 0.2 }, { radius: 0.2 }], extent = [-10, -10, 10, 10], origin = [0, 0];
const forward = 0.5, turn = 1.2;
const truth = (t) => [(forward / turn) * Math.sin(turn * t), (forward / turn) * (1 - Math.cos(turn * t)), turn * t];
const state = (mover, [x, y, yaw], more = {}) => ({ mover, pose: { x, y, yaw }, velocity: { forward, left: 0, turn }, command: { forward, left: 0, turn }, contact: false, ...more });
const sensor = { topic: '/scan', pose: [0.1, 0, 0] };
const rangeAt = (t) => { const [x, , yaw] = truth(t); return (5 - x) / Math.cos(yaw) - 0.1; };
function echo({ message, pose: [x, , yaw] }) { return x + message.range * Math.cos(yaw); }
{
  const fleet = new Fleet({ movers, extent, origin }), held = new HeldReadings();
  let worst = 0, apart = 0, compared = 0;
  // States every 50 ms and scans every 40 ms, which are newer than the states in three of five updates. Frames at 100
  // Hz.
  for (let ms = 0, lastFleet = -1, lastScan = -1; ms < 1000; ms += 10) {
    if (ms % 40 === 0) held.add(sensor, { range: rangeAt(ms / 1000) }, (lastScan = ms) / 1000);
    if (ms % 50 === 0) fleet.update({ tick: ms, states: [state(0, truth(ms / 1000))] }, (lastFleet = ms) / 1000, ms / 1000);
    fleet.animate(ms / 1000);
    held.update(fleet, 0, origin);
    const shown = held.shown.get('/scan');
    if (!shown || ms < 100) continue;
    worst = Math.max(worst, Math.abs(echo(shown) - 5));
    apart = Math.max(apart, Math.abs(shown.at - fleet.shownTime));
    ++compared;
  }
  assert.ok(compared > 80, `${compared}`);
  assert.ok(worst < 0.01, `an echo ${worst} m off its wall`);
  assert.ok(apart <= 0.02 + 1e-6, `a reading ${apart} s off the robots`);
}
{
  // Before the first known update, as when a page is opened while the run is paused.
  const fleet = new Fleet({ movers, extent, origin }), held = new HeldReadings();
  fleet.update({ tick: 1, states: [state(0, truth(0.5))] }, 0.5, 0);
  held.add(sensor, { range: rangeAt(0.3) }, 0.3);
  fleet.animate(0);
  held.update(fleet, 0, origin);
  near(echo(held.shown.get('/scan')), 5, 0.01, 'by the twist');
  // A restarted run: readings and states of the previous run are discarded.
  fleet.update({ tick: 0, states: [state(0, truth(0))] }, 0, 1);
  held.add(sensor, { range: rangeAt(0) }, 0);
  fleet.animate(1);
  held.update(fleet, 0, origin);
  near(echo(held.shown.get('/scan')), 5, 1e-9, 'after a restart');
}
{
  // The fleet's counts: stuck after 3 s without motion despite a command; a robot that is commanded to stop is not
  // stuck.
  const fleet = new Fleet({ movers, extent, origin });
  const still = { velocity: { forward: 0, left: 0, turn: 0 } }, rest = { ...still, command: { forward: 0, left: 0, turn: 0 } };
  const update = (t) => fleet.update({ tick: 0, states: [state(0, [0, 0, 0], { ...still, contact: true }), state(1, [11, 0, 0], rest), state(2, truth(t))] }, t, t);
  for (let t = 0; t < 2.95; t += 0.1) update(t);
  assert.deepEqual([0, 1, 2].map((i) => fleet.isStuck(i)), [false, false, false], 'too early');
  update(3.05);
  assert.deepEqual([0, 1, 2].map((i) => fleet.isStuck(i)), [true, false, false], 'stuck');
  assert.deepEqual([0, 1, 2].map((i) => fleet.isOutside(i)), [false, true, false], 'outside');
  assert.deepEqual([0, 1, 2].map((i) => fleet.inContact(i)), [true, false, false], 'in contact');
  fleet.update({ tick: 0, states: [state(0, [0, 0, 0])] }, 3.15, 3.15);
  assert.ok(!fleet.isStuck(0), 'it moves again');
  assert.ok(!fleet.isOutside(1), 'absent robots count nowhere');
}

// Depths as shades: none is black, and the nearer, the brighter, up to the largest.
{
  const data = new Uint8ClampedArray([0, 10, 100, 194, 255].flatMap((high) => [high, high, high, 255]));  // bytes of the high half of millimetres
  shadeDepths(data, 50);
  const shades = [0, 4, 8, 12, 16].map((i) => data[i]);
  assert.equal(shades[0], 0);
  assert.ok(shades[1] > shades[2] && shades[2] > shades[3] && shades[3] === 40 && shades[4] === 40, `${shades}`);
}

// The camera of the 3-D view: its distance and its side; it stays above the floor.
{
  const orbit = new Orbit(), length = ([x, y, z]) => Math.hypot(x, y, z);
  orbit.resize(600);
  orbit.fit([90, 40, 110, 60], [100, 50]);
  near(length(orbit.eye()), orbit.distance, 1e-9, 'distance');
  assert.ok(orbit.distance * Math.tan(fov / 2) > 10, 'all is in sight');
  orbit.azimuth = -Math.PI / 2;  // seen from the south
  orbit.turn(0, 1e6);
  near(orbit.eye()[2], orbit.distance, 1e-3, 'from above');
  orbit.pan(300, -600);
  near(orbit.target[0], -orbit.distance * Math.tan(fov / 2), 1e-3, 'half of the height to the right: the world follows');
  near(orbit.target[1], -2 * orbit.distance * Math.tan(fov / 2), 1e-3, 'and up');
  orbit.turn(0, -1e6);
  assert.ok(orbit.eye()[2] > 0, 'above the floor');
  for (const factor of [1e12, 1e-12]) { orbit.zoom(factor); assert.ok(orbit.distance > 0 && orbit.distance < 1e7, 'zoom'); }
}
{
  // Prisms: a square with a top and a bottom, an open line without, and an outline whose mesh is drawn instead.
  const THREE = { Vector2: class { constructor(x, y) { Object.assign(this, { x, y }); } equals(p) { return p.x === this.x && p.y === this.y; } }, ShapeUtils: { triangulateShape: (points) => { assert.equal(points.length, 4); return [[0, 1, 2], [0, 2, 3]]; } } };
  const square = [0, 0, 1, 0, 1, 1, 0, 1, 0, 0];
  const shape = { closed: [square, square], closed_z: [[0.1, 0.5, 0], [0, 2, 1]], open: [[0, 0, 1, 1]], open_z: [[0, 0.7, 0]] };
  const { vertices, top, isMesh } = prisms(THREE, shape, 1), triangles = vertices.length / 9;
  assert.deepEqual([triangles, top, isMesh], [2 * 4 + 2 * 2 + 2, 2, true]);
  assert.equal(Math.min(...vertices.filter((_, k) => k % 3 === 2)), 0);
  assert.deepEqual(prisms({ ...THREE, ShapeUtils: { triangulateShape: () => [] } }, { closed: [], closed_z: [], open: [], open_z: [] }, 0.5).top, 0.5, 'a body without outlines');
}
