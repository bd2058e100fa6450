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
const { readCalibration } = await load('calibration.js');
const { Lens, Sight } = await load('lens.js');
const { Connection } = await load('protocol.js');
const { arcOf, mapRuns, roundRange } = await load('overlay.js');
const { OverlayState } = await load('overlay_state.js');
const { composed, inverse, poseOf, transform, transformOf } = await load('rigid.js');
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
for (const [key, more, action] of [['n', {}, 'step '], ['F', {}, 'toggleFollowing '], ['4', {}, 'setFastest '], ['r', {}, ''], ['n', { ctrlKey: true }, ''], ['n', { typing: true }, ''], ['Escape', { typing: true }, 'blur'], ['ArrowLeft', {}, 'pan 60,0'], ['v', {}, 'toggleThird '], ['c', {}, 'toggleCamera '], ['ArrowUp', { driving: true }, '']])
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

// Images. Poses and lenses are those of base/, by tables of page_test.cpp.
const tables = JSON.parse(fs.readFileSync(path.join(folder, 'tables.json'), 'utf8'));
const nearAll = (found, expected, within, what) => expected.forEach((value, k) => near(found[k], value, within, `${what} [${k}]`));
for (const { pose, tilt, p, seen } of tables.transforms) {
  const X = transformOf(pose, tilt);
  nearAll(transform(X, p), seen, 1e-12, 'a point of the body');
  nearAll(transform(composed(inverse(X), X), p), p, 1e-12, 'there and back');
}
for (const { why, points, ...camera } of tables.lenses) {
  const lens = new Lens(camera);
  assert.ok(points.length > 30, `${why}: ${points.length} points`);
  for (const [x, y, z, u, v] of points) nearAll(lens.pixelOf([x, y, z]) ?? [], [u, v], 1e-9, why);
  assert.equal(lens.pixelOf([0.1, 0.2, -1]), null, `${why}: a point behind the camera`);
  assert.equal(lens.pixelOf([0.1, 0.2, 0]), null, `${why}: a point in the plane of the camera`);
}
{
  // A pinhole whose distortion folds outside of the image: points beyond the fold are not seen inside.
  const camera = { size: [640, 480], focal: [400, 400], center: [319.5, 239.5], distortion: [-0.3, 0, 0, 0, 0, 0, 0, 0] }, lens = new Lens(camera);
  const fold = Math.sqrt(1 / 0.9), bent = (r) => r * (1 - 0.3 * r * r);
  near(bent(1.6), bent(0.39), 0.005, 'both would be imaged nearly at one pixel');
  for (const angle of [0, 1, 2, 3, 4, 5]) {
    const at = (r) => lens.pixelOf([r * Math.cos(angle), r * Math.sin(angle), 1]);
    assert.ok(at(0.97 * fold) && !at(1.03 * fold) && !at(1.6), `fold at ${angle}`);
  }
  assert.equal(new Lens({ ...camera, distortion: [0, 0, 0, 0], fisheye: true }).pixelOf([Math.tan(86 * Math.PI / 180), 0, 1]), null, 'beyond the widest angle of a fisheye');
}

/** The lines of a path as lists of points. */
function pathRecord() {
  const lines = [];
  return { lines, moveTo: (...p) => lines.push([p]), lineTo: (...p) => lines.at(-1).push(p), closePath: () => {} };
}
{
  const camera = { size: [640, 480], focal: [400, 400], center: [319.5, 239.5], distortion: [0, 0, 0, 0, 0, 0, 0, 0] }, ahead = { R: [1, 0, 0, 0, 1, 0, 0, 0, 1], p: [0, 0, 0] };
  const draw = (lens, points) => { const path = pathRecord(); new Sight(new Lens({ ...camera, ...lens }), ahead).line(path, points); return path.lines; };
  assert.deepEqual(draw({}, [[0, 0, 1], [1, 0, 2]]), [[[319.5, 239.5], [519.5, 239.5]]], 'a pinhole images lines as lines');
  assert.deepEqual(draw({}, [[0, 0, -1], [0, 1, -2]]), [], 'a line behind the camera');
  assert.deepEqual(draw({}, [[0, 0, 0.02], [0, 0, 0.02]]).length, 1, 'just at the near plane');
  // Through the near plane: the seen part ends at its image, (0.01, 0, 0.02).
  const [[first, last]] = draw({}, [[0.01, 0, -1], [0.01, 0, 1]]);
  nearAll(first, [319.5 + 400 * 0.01 / 0.02, 239.5], 1e-9, 'start');
  nearAll(last, [319.5 + 4, 239.5], 1e-9, 'end');
  assert.deepEqual(draw({}, [[0, 0, 1], [0, 0, -1], [0.5, 0, 1]]).length, 2, 'two parts of a corner behind');
  // A bent line: all of its points are within a pixel of the true curve, which is 20 px off the chord.
  const lens = new Lens({ ...camera, distortion: [-0.2, 0, 0, 0, 0, 0, 0, 0] }), [curve] = draw({ distortion: [-0.2, 0, 0, 0, 0, 0, 0, 0] }, [[-0.7, 0.5, 1], [0.7, 0.5, 1]]);
  const chord = curve[0][1], middle = lens.pixelOf([0, 0.5, 1])[1];
  assert.ok(Math.abs(middle - chord) > 15 && curve.length > 8 && curve.length < 60, `${curve.length} pieces`);
  for (let i = 1; i < curve.length; ++i) {
    const [[u0, v0], [u1, v1]] = curve.slice(i - 1, i + 1), u = (u0 + u1) / 2;
    let low = -0.7, high = 0.7;
    for (let k = 0; k < 50; ++k) { const x = (low + high) / 2; if (lens.pixelOf([x, 0.5, 1])[0] < u) low = x; else high = x; }
    near((v0 + v1) / 2, lens.pixelOf([low, 0.5, 1])[1], 0.5, 'a piece of the curve');
  }
  // Polygons: one half behind the camera is cut; one that is entirely behind, or off the image, is left out.
  const fill = (points) => { const path = pathRecord(); return [new Sight(new Lens(camera), ahead).polygon(path, points), path.lines]; };
  const floor = (z0, z1, x = 0) => [[x - 1, 1, z0], [x + 1, 1, z0], [x + 1, 1, z1], [x - 1, 1, z1]];
  assert.equal(fill(floor(1, 3))[0], true);
  const [isDrawn, [cut]] = fill(floor(-1, 3));
  assert.ok(isDrawn && Math.max(...cut.map(([, v]) => v)) > 1e4 && cut.every((p) => p.every(Number.isFinite)), 'cut at the near plane');
  assert.deepEqual(fill(floor(-3, -1)), [false, []], 'behind');
  assert.deepEqual(fill(floor(1, 3, 50)), [false, []], 'to the right of the image');
}
{
  // Calibration files: the cameras of vision/, and errors with their lines.
  const text = fs.readFileSync(tables.calibration.file, 'utf8'), cameras = readCalibration('lab.toml', text);
  assert.deepEqual(cameras.map(({ name }) => name), tables.calibration.cameras.map(({ name }) => name));
  cameras.forEach((camera, i) => {
    const sight = new Sight(new Lens(camera), poseOf(camera.axes, camera.p));
    for (const [x, y, z, u, v] of tables.calibration.cameras[i].points) nearAll(sight.pixelOf([x, y, z]) ?? [], [u, v], 1e-6, camera.name);
  });
  const plain = '[[camera]]\nname = "a"\nsize = [640, 480]\nfocal = [500,\n  500]  # px\nposition = [0, 0, 3]\n';
  const [found] = readCalibration('f', plain);
  assert.deepEqual([found.center, found.focal, found.distortion, found.axes], [[319.5, 239.5], [500, 500], [0, 0, 0, 0, 0, 0, 0, 0], [[1, 0, 0], [0, -1, 0], [0, 0, -1]]], 'defaults as in testbed files');
  for (const [bad, message] of [
    ['', /^f:1: has no camera/], [plain.replace('position = [0, 0, 3]', ''), /^f:1: 'position' is missing/], [plain.replace('640', '6.5'), /^f:1: 'size'/],
    [plain.replace('[640, 480]', '[640]'), /^f:3: 'size' expects 2 numbers/], [plain.replace('640,', '640, x,'), /^f:3: 'size'/], [plain.replace('[0, 0, 3]', '[0, 0, nan]'), /^f:6: 'position'/],
    [plain.replace('"a"', '"a b"'), /^f:2: 'name'/], [plain.replace('name = "a"', 'name'), /^f:2: 'name' is neither/], [`${plain}orientation = [1, 1, 0, 0]`, /^f:1: 'orientation' expects a unit/], [plain.repeat(65), /more than 64 cameras/]])
    assert.throws(() => readCalibration('f', bad), ({ message: text2 }) => message.test(text2), `${message}`);
}
{
  // The commanded way: a quarter of a circle of 1 m, straight ahead, sideways.
  const end = (twist, seconds) => arcOf(twist, seconds).at(-1);
  nearAll(end({ forward: 1, left: 0, turn: Math.PI / 2 }, 1), [2 / Math.PI, 2 / Math.PI, 0], 1e-12, 'arc');
  nearAll(end({ forward: 1, left: 0, turn: 0 }, 2), [2, 0, 0], 1e-12, 'straight');
  nearAll(end({ forward: 0, left: 0.5, turn: 0 }, 2), [0, 1, 0], 1e-12, 'sideways');
  for (const [metres, round] of [[0.9, 1], [1, 1], [1.01, 2], [3, 5], [7, 10], [12, 20]]) assert.equal(roundRange(metres), round);
  // Cells of a map: runs of one state, each cell once, within reach. Two words of 4 x 4 cells; the first row is `free free occupied unknown`, twice.
  const map = { message: { word: Uint32Array.from([0b00011010, 0b00011010]) }, geometry: { left: 10, top: 5, cell: 0.5, words: 2 } };
  assert.deepEqual([...mapRuns(map, [12, 4], 50)].map(({ state, left, right, top, bottom }) => [state, left, right, top, bottom]), [[2, 10, 11, 5, 4.5], [1, 11, 11.5, 5, 4.5], [2, 12, 13, 5, 4.5], [1, 13, 13.5, 5, 4.5]]);
  assert.deepEqual([...mapRuns(map, [50, 50])], [], 'out of reach');
}
{
  // Poses at an image's time lie between updates, with height and tilt; without a state of that time, its age is stated.
  const fleet = new Fleet({ movers, extent, origin }), overlay = new OverlayState(fleet), none = { origin: [0, 0, 0], stride: 1 };
  const cloud = (mover) => ({ mover, type: 1, sensor: 0, planar: true, position: [0, 0, 0], points: [] });
  for (const [time, x, z, roll] of [[1, 0, 0, 0], [1.1, 0.2, 0.1, 0.4]]) {
    fleet.update({ tick: 0, states: [state(0, [x, 0, 0], { pose: { x, y: 0, yaw: 0, z } })] }, time, time);
    overlay.take({ ...none, tilts: [{ mover: 0, roll, pitch: 0 }], clouds: [cloud(0)] }, time);
  }
  nearAll(overlay.poseAt(0, 1.05).p, [0.1, 0, 0.05], 1e-9, 'between');
  nearAll(overlay.poseAt(0, 1.05).R, transformOf([0, 0, 0, 0], { roll: 0.2, pitch: 0 }).R, 1e-9, 'its tilt');
  assert.equal(overlay.poseAt(1, 1.05), null, 'absent');
  near(overlay.poseAt(0, 1.3).late, 0.2, 1e-9, 'no state of that time');
  for (const [time, nearest] of [[0.9, 1], [1.04, 1], [1.06, 1.1], [2, 1.1]]) assert.equal(overlay.cloudsAt(0, time)[0].time, nearest, `cloud at ${time}`);
  assert.deepEqual([overlay.cloudsAt(-1, 1).length, overlay.cloudsAt(1, 1).length], [1, 0], 'of all robots, of another one');
  overlay.take({ ...none, tilts: [], clouds: [] }, 0);
  assert.equal(overlay.cloudsAt(0, 1).length, 0, 'a restarted run');
}
{
  // Two owners of a subscription: one request, messages for both, the newest at once for the later one; it ends with the last owner.
  const sent = [];
  globalThis.WebSocket = class { static OPEN = 1; readyState = 1; constructor() { WebSocket.last = this; } send(text) { sent.push(JSON.parse(text)); } close() {} };
  globalThis.CustomEvent ??= class extends Event {};
  const connection = new Connection('ws://host'), got = { page: [], camera: [] };
  WebSocket.last.onmessage({ data: JSON.stringify({ op: 'advertise', channels: [{ id: 5, topic: '/n', schema: 'uint32 n' }] }) });
  connection.subscribe('/n', ({ n }) => got.page.push(n));
  const deliver = (n) => {
    const view = new DataView(new ArrayBuffer(21));
    view.setUint8(0, 1);
    view.setUint32(1, sent[0].subscriptions[0].id, true);
    view.setUint8(14, 1);
    view.setUint32(17, n, true);
    WebSocket.last.onmessage({ data: view.buffer });
  };
  deliver(1);
  connection.subscribe('/n', ({ n }) => got.camera.push(n), { owner: 'camera' });
  deliver(2);
  connection.unsubscribe('/n');
  deliver(3);
  connection.unsubscribe('/n', 'nobody');
  assert.deepEqual([got, sent.map(({ op }) => op)], [{ page: [1, 2], camera: [1, 2, 3] }, ['subscribe']]);
  connection.unsubscribe('/n', 'camera');
  deliver(4);
  assert.deepEqual([got.camera.length, sent.map(({ op }) => op)], [3, ['subscribe', 'unsubscribe']]);
}
