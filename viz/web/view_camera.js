// The view over a camera's image: of a robot's simulated camera, or of a real one with a calibration file.

import { CameraControls, element } from './camera_controls.js';
import { realImages, robotImages } from './camera_sources.js';
import { Lens, Sight } from './lens.js';
import { Overlay, colors, rangeColor, roundRange } from './overlay.js';
import { OverlayState } from './overlay_state.js';
import { composed, poseOf } from './rigid.js';

const cloudTopic = '/view_3d/clouds', intentTopic = '/view/intents', none = 0xffffffff;
const noticeable = 0.0005;  // [s]
const words = { robots: 'outlines of robots', scans: 'echoes, by range', map: 'occupancy map: occupied, free', tracks: 'tracks: moving, at rest', intent: 'commanded way in 2 s, next checkpoint or robot', walls: 'lower edges of walls, lane markings' };
const swatches = { robots: [colors.robots], scans: [rangeColor(0), rangeColor(0.5), rangeColor(1)], map: [colors.occupied, colors.free], tracks: [colors.moving, colors.resting], intent: [colors.intent], walls: [colors.walls] };

const span = (seconds) => (seconds < 1 ? `${Math.round(1000 * seconds)} ms` : `${seconds.toFixed(1)} s`);

export class ViewCamera {
  layers = { robots: true, scans: true, map: true, tracks: true, intent: true, walls: false };
  drawn = {}; sight = null; time = NaN; state;  // of the last frame, for tests, too
  #page; #canvas = element('canvas'); #picture = element('div', { className: 'picture' }); #note = element('p', { className: 'note' }); #legend = element('div', { className: 'keys' });
  #controls; #connection = null; #source = null; #camera = null; #lens = null; #most = 0; #intents = [];

  /** @param page {scene, fleet, drawing, readings, select, onChange} */
  constructor(root, page) {
    this.#page = page;
    this.state = new OverlayState(page.fleet);
    this.#canvas.setAttribute('role', 'img');
    this.#canvas.setAttribute('aria-label', 'What robots sense and intend, over the image of a camera');
    this.#controls = new CameraControls(page.scene, () => this.#choose(), page.onChange);
    this.#fillLegend();
    root.replaceChildren(this.#controls.root, this.#legend, element('div', { className: 'middle' }, this.#picture), this.#note);
    new ResizeObserver(() => this.#layout()).observe(root.querySelector('.middle'));
  }
  #fillLegend() {
    this.#legend.append(...Object.entries(words).map(([key, text]) => {
      const box = element('input', { type: 'checkbox', checked: this.layers[key], onchange: () => { this.layers[key] = box.checked; this.#page.onChange(); } });
      return element('label', {}, box, ...swatches[key].map((color) => { const mark = element('i'); mark.style.background = color; return mark; }), element('span', { textContent: text, id: `camera-${key}` }));
    }));
  }

  // Images

  #choose() {
    const { scene, drawing, select, onChange } = this.#page, { isRobot, robot: [row, i], real } = this.#controls;
    this.#drop();
    if (isRobot) {
      const { camera } = scene.movers[row].sensors[i];
      this.#use(camera, row, robotImages(camera, onChange));
      if (drawing.selected < 0) select(row);
    } else if (real) {
      this.#use(real.camera, real.row, realImages(real, real.camera.name, onChange));
    }
    onChange();
  }
  /** @param row of the robot that carries the camera; -1: it is fixed in the world */
  #use({ p, axes, ...camera }, row, source) {
    this.#camera = { ...camera, row, mount: poseOf(axes, p) };
    this.#lens = new Lens(camera);
    this.#source = source;
    this.#picture.replaceChildren(source.element, this.#canvas);
    source.start(this.#connection);
    this.#layout();
  }
  #drop() {
    this.#source?.stop(this.#connection);
    this.#source = this.#camera = this.sight = null;
    this.#picture.replaceChildren();
  }

  subscribe(connection) {
    this.#connection = connection;
    this.state.clear();
    connection.subscribe(cloudTopic, (message, time) => { this.state.take(message, time); this.#page.onChange(); });
    connection.subscribe(intentTopic, ({ intents }) => { this.#intents = intents; this.#page.onChange(); });
    this.#choose();
  }
  unsubscribe(connection) {
    for (const topic of [cloudTopic, intentTopic]) connection.unsubscribe(topic);
    this.#drop();
  }

  // Drawing

  /** The largest rectangle of the image's shape in the middle of the view. */
  #layout() {
    if (!this.#camera) return;
    const { clientWidth, clientHeight } = this.#picture.parentElement, [width, height] = this.#camera.size, ratio = Math.min(2, window.devicePixelRatio || 1);
    const scale = Math.max(0.01, Math.min(clientWidth / width, clientHeight / height));
    Object.assign(this.#picture.style, { width: `${scale * width}px`, height: `${scale * height}px` });
    Object.assign(this.#canvas, { width: Math.max(1, Math.round(ratio * scale * width)), height: Math.max(1, Math.round(ratio * scale * height)) });
    this.#page.onChange();
  }

  /** The time for which the overlay is drawn: the image's, or that of the shown states less the stated delay. */
  #timeOf() {
    const { fleet } = this.#page;
    if (Number.isFinite(this.#source.time)) return this.#source.time;
    return fleet.shownTime - this.#controls.delay;
  }

  frame() {
    this.#canvas.hidden = !this.#source?.size;
    if (!this.#source?.size) return this.#say([this.#controls.error || this.#source?.error || this.#lacks()]);
    const { width } = this.#canvas, c = this.#canvas.getContext('2d'), camera = this.#camera, late = {};
    this.time = this.#timeOf();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, width, this.#canvas.height);
    const X_WM = camera.row < 0 ? null : this.state.poseAt(camera.row, this.time);
    if (camera.row >= 0 && !X_WM) return this.#say(['The robot that carries the camera is absent.']);
    const X_WC = X_WM ? composed(X_WM, camera.mount) : camera.mount, scale = width / camera.size[0];
    this.sight = new Sight(this.#lens, X_WC);
    c.setTransform(scale, 0, 0, scale, 0.5 * scale, 0.5 * scale);
    const overlay = new Overlay(c, this.sight, Math.min(2, window.devicePixelRatio || 1) / scale);
    this.#draw(overlay, X_WC, late);
    this.drawn = overlay.drawn;
    this.#say(this.#remarks(late, X_WM));
  }

  #draw(overlay, X_WC, late) {
    const { scene, fleet, drawing, readings } = this.#page, { layers, time } = this, row = drawing.selected;
    const poses = scene.movers.map((_, i) => this.state.poseAt(i, time)), height = row < 0 ? 0 : poses[row]?.p[2] ?? 0;
    if (layers.walls) overlay.walls([...scene.walls.flatMap(({ lines }) => lines), ...scene.markings.map(({ line }) => line)], X_WC.p);
    const { sensors = [] } = scene.movers[row] ?? {};
    for (const { topic, map, type } of sensors) {
      const picture = map && drawing.maps.get(topic), held = type === 'tracks' && readings.shown.get(topic);
      if (picture && layers.map && poses[row]) { overlay.map(picture, poses[row].p); late.map = time - stampOf(picture.message); }
      if (held && layers.tracks) { overlay.tracks(held.message, height); late.tracks = time - held.at; }
    }
    const present = scene.movers.map(({ name, shape }, i) => ({ name, X: poses[i], shape: scene.shapes[shape], radius: fleet.radius[i], selected: i === row, command: fleet.states[i]?.command, isCarrier: i === this.#camera.row, mover: i })).filter(({ X }) => X);
    if (layers.robots) overlay.robots(present.filter(({ isCarrier }) => !isCarrier));
    if (layers.scans) this.#drawScans(overlay, this.state.cloudsAt(row, time), late);
    if (!layers.intent) return;
    overlay.arcs(present);
    overlay.goals(this.#intents.filter(({ mover }) => row < 0 || mover === row).flatMap((intent) => this.#goalsOf(intent, poses)));
  }
  /** Where a robot is heading: a checkpoint, or the robot that it follows. */
  #goalsOf({ mover, follows, checkpoint, x, y }, poses) {
    const { movers } = this.#page.scene, from = poses[mover]?.p, goals = [], leader = follows === none ? -1 : movers.findIndex(({ id }) => id === follows);
    if (Number.isFinite(x) && from) goals.push({ to: [x, y, from[2]], name: `checkpoint ${checkpoint}` });
    if (poses[leader]) goals.push({ to: poses[leader].p, name: movers[leader].name });
    return from ? goals.map((goal) => ({ from, ...goal })) : [];
  }
  #drawScans(overlay, clouds, late) {
    let most = 0;
    for (const { points, position: [x, y, z], time } of clouds) {
      if (!(Math.abs(this.time - time) <= Math.abs(late.scans))) late.scans = this.time - time;
      for (let i = 0; i + 3 < points.length; i += 28) most = Math.max(most, Math.hypot(points[i] - x, points[i + 1] - y, points[i + 2] - z));
    }
    if (most > this.#most || most < 0.3 * this.#most) this.#most = roundRange(most);
    if (clouds.length > 0) overlay.scans(clouds, this.#most);
    const text = this.#most > 0 ? `echoes, 0 to ${this.#most} m` : words.scans, shown = document.getElementById('camera-scans');
    if (shown.textContent !== text) shown.textContent = text;
  }

  // Remarks

  #lacks() {
    if (!this.#controls.isRobot) return 'Choose the calibration file of the camera (sections [[camera]], docs/vps.md) and the address of its images.';
    return 'Waiting for an image.';
  }
  /** Differences in time between the image and what is drawn over it, and what does not fit. */
  #remarks(late, X_WM) {
    const { fleet, drawing } = this.#page, { size, time } = this.#source, [width, height] = this.#camera.size, remarks = [];
    if (this.#source.error) remarks.push(this.#source.error);
    if (Number.isFinite(time)) {
      const behind = X_WM?.late ?? time - fleet.time, age = fleet.time - time;
      remarks.push(`Image of ${time.toFixed(2)} s${age > noticeable ? `, ${span(age)} before the newest states` : ''}`, behind > noticeable ? `robots ${span(behind)} older` : 'robots at its time');
    } else {
      remarks.push(`The image states no time: drawn with the states of ${this.time.toFixed(2)} s, those of its arrival less the delay`);
    }
    for (const [key, name] of [['scans', 'echoes'], ['map', 'map'], ['tracks', 'tracks']]) if (Math.abs(late[key]) > noticeable) remarks.push(`${name} ${span(Math.abs(late[key]))} ${late[key] > 0 ? 'older' : 'newer'}`);
    if (Math.abs(size[0] / size[1] - width / height) > 0.01) remarks.push(`The image has ${size.join(' × ')} pixels, the calibration ${width} × ${height}: the overlay does not fit`);
    else if (size[0] !== width) remarks.push(`Image of ${size.join(' × ')} pixels, scaled to the calibration's ${width} × ${height}`);
    if (drawing.selected < 0) remarks.push('Select a robot to see its map and its tracks');
    if (this.state.stride > 1) remarks.push(`one in ${this.state.stride} beams`);
    return remarks;
  }
  #say(remarks) {
    const text = remarks.join('; ');
    if (this.#note.textContent !== text) this.#note.textContent = text;
  }
}

const stampOf = ({ header: { stamp } }) => stamp.sec + 1e-9 * stamp.nanosec;
