// The page: connects to the server and links the modules.

import { Camera } from './camera.js';
import { twistBytes } from './cdr.js';
import { Drawing, drawSignal } from './draw.js';
import { Fleet } from './fleet.js';
import { HeldReadings } from './held.js';
import { keyHelp, listenToKeys, listenToPointer, pressed } from './input.js';
import { Panel } from './panel.js';
import { Connection } from './protocol.js';
import { StaticLayer, loadScene } from './scene.js';
import { MapPicture } from './sensors.js';
import { fade, isDark, theme, useTheme } from './theme.js';

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get('token') ?? '';
const seconds = () => performance.now() / 1000;

let scene, camera, fleet, drawing, panel, connection;
let paused = false, speed = 1, following = false, driving = false, sliding = false, dirty = true, time = 0;
let third = null, over = null;  // the three-dimensional view and that over a camera's image, once they were opened
let mode = 'plan';  // or 'third', 'camera'
let runs = null, shapes = 0, range = [0, 0];
const readings = new HeldReadings();

function notice(text, lasts = 6) {
  $('notice').textContent = text;
  $('notice').hidden = !text;
  clearTimeout(notice.timer);
  if (text && lasts) notice.timer = setTimeout(() => { $('notice').hidden = true; }, 1000 * lasts);
}

function showStatus(state, text) {
  $('status').dataset.state = state;
  $('status').textContent = text;
}

// Time

function clockText(t) {
  const minutes = Math.floor(t / 60);
  return minutes > 0 ? `${minutes}:${(t - 60 * minutes).toFixed(1).padStart(4, '0')} min` : `${t.toFixed(1)} s`;
}

function showTime(t) {
  time = t;
  $('clock').textContent = clockText(t);
  $('at').textContent = clockText(t);
  if (!sliding) $('slider').value = t;
}

function showPaused() {
  $('pause-text').textContent = paused ? 'Continue' : 'Pause';
  $('pause-icon').setAttribute('d', paused ? 'M4 2.5l9 5.5-9 5.5z' : 'M4 3h3v10H4zM9 3h3v10H9z');
  showStatus(paused ? 'paused' : 'live', paused ? 'paused' : scene.mode === 'recording' ? 'playing' : 'live');
}

const isRecording = () => scene.mode === 'recording';
function setPaused(value) {
  if (scene.mode === 'service') return;
  if (isRecording()) connection.play({ paused: value, speed, time: !value && time >= range[1] - 1e-6 ? range[0] : undefined });
  else connection.set(['/paused', value]);
}
function setSpeed(value) {
  if (isRecording()) connection.play({ paused, speed: value, time: undefined });
  else connection.set(['/speed', value]);
}
function seek(t) { connection.play({ paused, speed, time: Math.min(range[1], Math.max(range[0], t)) }); }
function step() { connection.call('/step'); }
function reset() {
  connection.call('/reset');
  if (!isRecording()) setPaused(false);
}

function showParameters(values) {
  if ('/paused' in values) paused = values['/paused'];
  if ('/speed' in values) {
    speed = values['/speed'];
    const options = [...$('speed').options], known = options.find((option) => Number(option.value) === speed);
    if (!known) $('speed').append(new Option(`${Number(speed.toFixed(3))}×`, speed));
    $('speed').value = String(speed);
  }
  if ('/measured_speed' in values) $('pace').textContent = paused ? '' : `${values['/measured_speed'].toFixed(2)}× real`;
  if ('/runs' in values) {
    if (runs !== null && values['/runs'] !== runs) panel.clear();
    runs = values['/runs'];
  }
  if ('/shapes' in values && values['/shapes'] !== shapes) {
    shapes = values['/shapes'];
    loadShapes();
  }
  if (paused) $('pace').textContent = '';
  showPaused();
  dirty = true;
}

/** Objects have changed their shapes, colours or sizes: takes them from the new scene. */
async function loadShapes() {
  const known = shapes;
  try {
    const next = await loadScene(token);
    if (known !== shapes || next.movers.length !== scene.movers.length) return;
    scene.shapes = next.shapes;
    next.movers.forEach(({ shape, radius, color }, i) => Object.assign(scene.movers[i], { shape, radius, color }));
    fleet.measure(scene);
    drawing.restyle();
    third?.restyle();
    dirty = true;
  } catch { /* the connection is lost: the page loads the scene again */ }
}

// Robots

/** Of cameras, images are shown, which are far smaller than readings. */
function topicOf(sensor) { return sensor.camera?.image ?? sensor.topic; }
function topicsOf(row) { return row < 0 ? [] : scene.movers[row].sensors.map(topicOf); }

function select(row) {
  if (row === drawing.selected) return;
  for (const topic of topicsOf(drawing.selected)) connection.unsubscribe(topic);
  stopDriving();
  drawing.selected = row;
  readings.clear();
  drawing.maps.clear();
  const actions = [];
  if (row >= 0 && scene.mode === 'run' && !scene.movers[row].tag) {
    const drive = Object.assign(document.createElement('button'), { id: 'drive', textContent: 'Drive', title: 'Drive with the arrow keys, instead of the controller (D)', onclick: toggleDriving });
    drive.setAttribute('aria-pressed', 'false');
    actions.push(drive);
  }
  panel.last = row >= 0 ? fleet.states[row] : null;
  panel.show(row, actions);
  for (const sensor of row < 0 ? [] : scene.movers[row].sensors) connection.subscribe(topicOf(sensor), (message) => hold(sensor, message));
  $('follow').disabled = row < 0;
  if (row < 0) setFollowing(false);
  dirty = true;
}

function hold(sensor, message) {
  const at = message.header ? message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec : fleet.time;
  if (sensor.map) drawing.maps.set(sensor.topic, new MapPicture(message, sensor.map));
  else if (!sensor.camera) readings.add(sensor, message, at);
  panel.reading(sensor.topic, message, at);
  dirty = true;
}

function nextRobot(by) {
  const present = scene.movers.map((_, i) => i).filter((i) => !fleet.absent[i]);
  if (present.length === 0) return;
  const at = present.indexOf(drawing.selected);
  select(present[(at < 0 ? (by > 0 ? 0 : present.length - 1) : at + by + present.length) % present.length]);
}

function setFollowing(value) {
  following = value && drawing.selected >= 0;
  $('follow').setAttribute('aria-pressed', String(following));
  if (following && fleet.radius[drawing.selected] * camera.scale < 8) camera.scale = 8 / fleet.radius[drawing.selected];
  dirty = true;
}

// Driving

function toggleDriving() {
  if (driving) return stopDriving();
  if (!$('drive')) return;
  driving = true;
  $('drive').setAttribute('aria-pressed', 'true');
  notice('Arrow keys drive the robot; D or Escape stops driving. Its controller takes over again only after a restart.');
  sendDrive();
}
function stopDriving() {
  if (!driving) return;
  pressed.clear();
  sendTwist();
  driving = false;
  clearTimeout(sendDrive.timer);
  $('drive')?.setAttribute('aria-pressed', 'false');
}
function sendTwist() {
  const { space, max } = scene.movers[drawing.selected];
  const ahead = (pressed.has('ArrowUp') ? 1 : 0) - (pressed.has('ArrowDown') ? 1 : 0), turn = (pressed.has('ArrowLeft') ? 1 : 0) - (pressed.has('ArrowRight') ? 1 : 0);
  connection.drive(`${space}/cmd_vel`, twistBytes(0.7 * ahead * max[0], 0, 0.6 * turn * max[1]));
}
function sendDrive() {
  if (!driving) return;
  sendTwist();
  sendDrive.timer = setTimeout(sendDrive, 100);
}

// View

const systemDark = matchMedia('(prefers-color-scheme: dark)'), themeKey = 'sensorfarm-theme';
let chosenTheme = null;  // 'dark' or 'light'; null: the system's theme
try { chosenTheme = localStorage.getItem(themeKey); } catch { /* storage is refused: a choice lasts as long as the page */ }

function restyle() {
  const name = chosenTheme ?? (systemDark.matches ? 'dark' : 'light');
  useTheme(name);
  document.documentElement.dataset.theme = name;
  $('theme').setAttribute('aria-pressed', String(name === 'dark'));
  if (!drawing) return;
  drawing.restyle();
  for (const [topic, { message, geometry }] of drawing.maps) drawing.maps.set(topic, new MapPicture(message, geometry));
  third?.restyle();
  panel.fill();
  panel.dirty = true;
  showLegend.key = null;
  dirty = true;
}

/** If the chosen theme is the system's current one, the page follows the system again. */
function toggleTheme() {
  const next = isDark() ? 'light' : 'dark';
  chosenTheme = (next === 'dark') === systemDark.matches ? null : next;
  try {
    if (chosenTheme) localStorage.setItem(themeKey, chosenTheme); else localStorage.removeItem(themeKey);
  } catch { /* as above */ }
  restyle();
}

/** On narrow screens the panel uses a part of the map's height. */
function showPanel(open) {
  document.body.dataset.panel = open ? 'open' : 'closed';
  $('show-panel').setAttribute('aria-expanded', String(open));
}

function fitAll() {
  setFollowing(false);
  camera.fit(scene.extent);
  third?.fit();
  dirty = true;
}

const inThird = () => mode === 'third', inCamera = () => mode === 'camera';

/** The plan view does not load the other ones, and the server sends it neither clouds nor images. */
async function setMode(next) {
  if (setMode.isLoading) return;
  setMode.isLoading = true;
  try {
    if (next === 'third' && !third) await openThird();
    if (next === 'camera' && !over) await openCamera();
    show(next);
  } catch (error) {
    notice(error.message);
  }
  setMode.isLoading = false;
}
const toggleThird = () => setMode(inThird() ? 'plan' : 'third'), toggleCamera = () => setMode(inCamera() ? 'plan' : 'camera');

async function openCamera() {
  const { ViewCamera } = await import('./view_camera.js');
  over = new ViewCamera($('view-camera'), { scene, fleet, drawing, readings, select, onChange: () => { dirty = true; } });
}

async function openThird() {
  const { View3D } = await import('./view_3d.js');
  third = await View3D.open($('view-3d'), { scene, fleet, drawing });
  listenToPointer($('view-3d'), Object.assign(Object.create(actions), { drag: (dx, dy, { shiftKey, buttons }) => (shiftKey || buttons & 2 ? pan(dx, dy) : turn(dx, dy)) }));
  $('view-3d').oncontextmenu = (event) => event.preventDefault();
  new ResizeObserver(() => { third.resize(); dirty = true; }).observe($('view-3d'));
}

function subscribeView() {
  if (inThird()) third.subscribe(connection, () => { dirty = true; });
  if (inCamera()) over.subscribe(connection);
}

function show(next) {
  if (inThird()) third.unsubscribe(connection);
  if (inCamera()) over.unsubscribe(connection);
  mode = next;
  for (const [id, shown] of [['view', 'plan'], ['legend', 'plan'], ['scale', 'plan'], ['view-3d', 'third'], ['notes', 'third'], ['view-camera', 'camera']]) $(id).hidden = shown !== mode;
  $('third').setAttribute('aria-pressed', String(inThird()));
  $('camera').setAttribute('aria-pressed', String(inCamera()));
  subscribeView();
  dirty = true;
}

function turn(dx, dy) {
  third.orbit.turn(dx, dy);
  dirty = true;
}

function showScale() {
  const length = camera.roundLength(140), bar = $('scale');
  bar.style.width = `${length * camera.scale}px`;
  bar.firstElementChild.textContent = length >= 1000 ? `${length / 1000} km` : length >= 1 ? `${length} m` : `${Number((length * 100).toPrecision(2))} cm`;
}

function showLegend() {
  const items = [];
  const swatch = (draw) => {
    const canvas = Object.assign(document.createElement('canvas'), { width: 44, height: 28 }), c = canvas.getContext('2d');
    c.scale(2, 2);
    draw(c);
    return canvas;
  };
  const states = [...new Set(Object.values(drawing.drawn.lights))].sort(), words = ['dark', 'red', 'yellow', 'green', 'flashing red', 'flashing yellow'];
  for (const state of states) items.push([swatch((c) => drawSignal(c, 11, 7, 4.5, state)), `light, ${words[state]}`]);
  const line = (color, width) => swatch((c) => { c.strokeStyle = color; c.lineWidth = width; c.moveTo(2, 7); c.lineTo(20, 7); c.stroke(); });
  if (drawing.drawn.hits > 0) items.push([swatch((c) => { c.fillStyle = theme.view; c.fillRect(9, 5, 4, 4); }), 'laser echo']);
  if (drawing.drawn.edges > 0) items.push([line(theme.lane, 3), 'sensed lane edge']);
  if (drawing.drawn.fields > 0) items.push([line(theme.magnetometer, 2), 'magnetic field']);
  if (drawing.drawn.maps > 0) items.push([swatch((c) => { c.fillStyle = theme.map; c.fillRect(4, 2, 7, 10); c.fillStyle = fade(theme.mapFree, 0.35); c.fillRect(11, 2, 7, 10); }), 'map: occupied, free']);
  if (drawing.drawn.contacts > 0) items.push([swatch((c) => { c.strokeStyle = theme.contact; c.lineWidth = 1.8; c.arc(11, 7, 5, 0, 7); c.moveTo(8.5, 4.5); c.lineTo(13.5, 9.5); c.moveTo(8.5, 9.5); c.lineTo(13.5, 4.5); c.stroke(); }), 'contact']);
  const key = items.map(([, text]) => text).join();
  if (key === showLegend.key) return;
  showLegend.key = key;
  $('legend').replaceChildren(...items.flatMap(([canvas, text]) => [canvas, Object.assign(document.createElement('span'), { textContent: text })]));
}

function drawPlan() {
  drawing.frame();
  showScale();
  showLegend();
}

function drawThird() {
  if (following) third.follow(drawing.selected);
  third.frame();
  const notes = third.notes();
  if (notes !== $('notes').textContent) $('notes').textContent = notes;
}

function animate() {
  requestAnimationFrame(animate);
  const now = seconds(), moving = fleet.animate(now);
  dirty = readings.update(fleet, drawing.selected, scene.origin) || dirty;
  if (following && drawing.selected >= 0 && !fleet.absent[drawing.selected]) {
    camera.x = fleet.shownX[drawing.selected];
    camera.y = fleet.shownY[drawing.selected];
  }
  const blinking = drawing.lights.some(({ state }) => state >= 4);
  const waiting = inThird() && third.isWaiting;
  if ((dirty || moving || blinking || waiting) && (!inThird() || third.isDue())) {
    dirty = false;
    if (inThird()) drawThird(); else if (inCamera()) over.frame(); else drawPlan();
    ++counters.frames;
  }
  panel.draw(now, drawing.maps);
  panel.summary(now, fleet);
}

function openPopup(id, open = $(`${id}-list`).hidden) {
  for (const other of ['layers', 'help']) {
    const shown = other === id && open;
    $(`${other}-list`).hidden = !shown;
    $(other).setAttribute('aria-expanded', String(shown));
  }
  if (open) $(`${id}-list`).querySelector('input')?.focus();
}

function fillPopups() {
  const words = { trails: 'Trails', beams: 'Beams and fields of the selected robot', maps: 'Its occupancy map', names: 'Names', lights: 'Traffic lights', contacts: 'Contacts', colors: 'Own colours of robots that look alike', lasers: 'Own colours of lasers (laser_color)', clouds: 'Clouds and scans of all robots (3-D)', intensity: 'Clouds in colours of the intensity instead of the height (3-D)' };
  $('layers-list').replaceChildren(...Object.entries(words).map(([key, text]) => {
    const box = Object.assign(document.createElement('input'), { type: 'checkbox', checked: drawing.layers[key], onchange: () => { drawing.layers[key] = box.checked; if (key === 'colors') restyle(); dirty = true; } });
    const label = document.createElement('label');
    label.append(box, text);
    return label;
  }));
  const table = document.createElement('table');
  for (const [key, text] of keyHelp) {
    const row = table.insertRow();
    row.insertCell().append(Object.assign(document.createElement('kbd'), { textContent: key }));
    row.insertCell().textContent = text;
  }
  $('help-list').replaceChildren(Object.assign(document.createElement('h2'), { textContent: 'Keys' }), table);
}

// Input

function escape() {
  if (!$('help-list').hidden || !$('layers-list').hidden) openPopup('', false);
  else if (driving) stopDriving();
  else select(-1);
}

function search() { $('search').focus(); }
function seekBy(by) { if (isRecording()) seek(time + by); }
function setFastest() { if (!isRecording()) setSpeed(0); }
function togglePaused() { setPaused(!paused); }
function toggleFollowing() { setFollowing(!following); }

function zoom(factor, x, y) {
  if (inThird()) third.orbit.zoom(factor); else camera.zoom(factor, following ? undefined : x, following ? undefined : y);
  dirty = true;
}

function pan(dx, dy) {
  setFollowing(false);
  (inThird() ? third.orbit : camera).pan(dx, dy);
  dirty = true;
}

function selectAt(px, py) {
  if (inThird()) return select(third.pick(px, py));
  const [x, y] = camera.toWorld(px, py);
  select(fleet.pick(x, y, 10 / camera.scale));
}

/** The effects of keys and pointer (input.js). */
const actions = {
  get driving() { return driving; }, get following() { return following; },
  drag: pan, escape, fitAll, nextRobot, openPopup, pan, reset, search, seekBy, selectAt, setFastest, setSpeed, step, toggleDriving, toggleFollowing, togglePaused, toggleCamera, toggleTheme, toggleThird, zoom,
};

function listen() {
  $('pause').onclick = togglePaused;
  $('step').onclick = step;
  $('reset').onclick = reset;
  $('speed').onchange = () => setSpeed(Number($('speed').value));
  $('fit').onclick = fitAll;
  $('third').onclick = toggleThird;
  $('camera').onclick = toggleCamera;
  $('follow').onclick = toggleFollowing;
  $('layers').onclick = () => openPopup('layers');
  $('help').onclick = () => openPopup('help');
  $('theme').onclick = toggleTheme;
  $('show-panel').onclick = () => showPanel(document.body.dataset.panel === 'closed');
  systemDark.onchange = restyle;
  $('zoom-in').onclick = () => zoom(1.4);
  $('zoom-out').onclick = () => zoom(1 / 1.4);
  $('slider').oninput = () => { sliding = true; $('at').textContent = clockText(Number($('slider').value)); seek(Number($('slider').value)); };
  $('slider').onchange = () => { sliding = false; };
  listenToKeys(actions);
  listenToPointer($('view'), actions);
  new ResizeObserver(() => { if (mode !== 'plan') return; drawing.resize(); dirty = true; }).observe($('view'));
}

// Connection

function connect() {
  const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/${token ? `?token=${encodeURIComponent(token)}` : ''}`;
  connection = new Connection(url);
  let opened = false;
  connection.addEventListener('open', () => {
    opened = true;
    notice('');
    if (!isRecording()) connection.watchParameters();
  });
  connection.addEventListener('close', () => {
    stopDriving();
    showStatus('lost', 'not connected');
    notice(opened ? 'The run has ended, or the connection was lost. Reconnecting.' : 'No connection. Retrying.', 0);
    setTimeout(reconnect, 1500);
  });
  connection.addEventListener('info', ({ detail }) => {
    counters.info = detail;
    showPaused();
    const nanos = (t) => t.sec + 1e-9 * t.nsec;
    if (!detail.dataStartTime) return;
    range = [nanos(detail.dataStartTime), nanos(detail.dataEndTime)];
    Object.assign($('slider'), { min: range[0], max: range[1] });
    $('end').textContent = clockText(range[1]);
    $('timeline').hidden = false;
  });
  connection.addEventListener('time', ({ detail }) => showTime(detail));
  connection.addEventListener('parameters', ({ detail }) => showParameters(detail));
  connection.addEventListener('playback', ({ detail }) => {
    paused = detail.status !== 'playing';
    speed = detail.speed;
    $('speed').value = String(speed);
    showPaused();
    if (paused) showTime(detail.time);
    if (detail.sought) { panel.clear(); fleet.forget(); }
  });
  connection.addEventListener('status', ({ detail }) => notice(detail.message));
  connection.subscribe('/fleet', (message, t) => {
    fleet.update(message, t, seconds());
    ++counters.updates;
    if (drawing.selected >= 0) panel.moved(fleet.states[drawing.selected], t);
    dirty = true;
  });
  connection.subscribe('/lights', (message) => { drawing.lights = message.lights; dirty = true; });
  subscribeView();
  const row = drawing.selected;
  drawing.selected = -1;
  select(row);
}

/** Another run may now listen on the same address. */
async function reconnect() {
  try {
    const next = await loadScene(token);
    if (JSON.stringify(next.movers.map(({ name }) => name)) !== JSON.stringify(scene.movers.map(({ name }) => name)) || next.world !== scene.world) return location.reload();
    connect();
  } catch {
    setTimeout(reconnect, 1500);
  }
}

const counters = { updates: 0, frames: 0, info: null };

async function start() {
  restyle();
  try {
    scene = await loadScene(token);
  } catch (error) {
    showStatus('lost', 'not connected');
    return notice(`The world could not be loaded: ${error.message}`, 0);
  }
  document.title = `${scene.world} – sensor farm`;
  $('world').textContent = scene.world;
  $('world').title = scene.world;
  camera = new Camera();
  fleet = new Fleet(scene);
  drawing = new Drawing($('view'), camera, scene, new StaticLayer(scene), fleet, readings.shown);
  panel = new Panel(scene, select, (row) => drawing.colors[row]);
  drawing.resize();
  camera.fit(scene.extent);
  fillPopups();
  listen();
  for (const id of ['pause', 'step', 'reset', 'speed']) $(id).disabled = scene.mode === 'service';
  if (isRecording()) for (const option of [...$('speed').options]) if (option.value === '0') option.remove();
  $('follow').disabled = true;
  connect();
  // For tests, and for the browser's console.
  window.view = { scene, camera, fleet, drawing, panel, counters, select, get paused() { return paused; }, get time() { return time; }, get connection() { return connection; }, get third() { return third; }, get over() { return over; } };
  requestAnimationFrame(animate);
}

start();
