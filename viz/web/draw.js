// Draws a frame: the static scene, then trails, robots, lights, and the selected robot's readings.

import { theme, fade, edgeOf, headingOn, moverColors, onPaper } from './theme.js';
import { drawReadingAbove, drawReadingBelow } from './sensors.js';

const smallest = 3;  // [px] radius below which a robot is a dot
const namedRobots = 30;
const paths = 60;  // robots drawn as paths; more are drawn as pictures with hairline trails, at a tenth of the cost
const headings = 64;  // of these pictures

export class Drawing {
  /** @param held by topic: {message, pose} */
  constructor(canvas, camera, scene, layer, fleet, held) {
    Object.assign(this, { canvas, camera, scene, layer, fleet, held });
    this.context = canvas.getContext('2d', { alpha: false });
    this.layers = { trails: true, beams: true, maps: true, names: true, lights: true, contacts: true, colors: true, lasers: true, clouds: true, intensity: false };
    this.lights = [];
    this.selected = -1;
    this.maps = new Map();  // by topic: MapPicture
    /** Contents of the last frame, for tests. */
    this.drawn = {};
    this.restyle();
  }

  /** Applies the colours of the active theme. */
  restyle() {
    this.sprites = new Map();
    this.byColor = new Map();
    this.colors = moverColors(this.scene.movers, this.layers.colors);
    this.colors.forEach((color, i) => {
      if (!this.byColor.has(color)) this.byColor.set(color, []);
      this.byColor.get(color).push(i);
    });
    this.layer.restyle();
  }

  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1), { clientWidth, clientHeight } = this.canvas;
    this.ratio = ratio;
    this.camera.resize(clientWidth, clientHeight);
    this.canvas.width = Math.round(clientWidth * ratio);
    this.canvas.height = Math.round(clientHeight * ratio);
  }

  frame() {
    const c = this.context, { camera, ratio, scene } = this;
    this.drawn = { robots: 0, walls: this.layer.segments, markings: this.layer.markings.length, trails: 0, beams: 0, hits: 0, cones: 0, edges: 0, fields: 0, maps: 0, contacts: 0, names: 0, lights: {}, selected: this.selected };
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.fillStyle = theme.paper;
    c.fillRect(0, 0, this.canvas.width, this.canvas.height);
    this.layer.draw(c, camera, ratio);
    const s = camera.scale * ratio, [ox, oy] = scene.origin, px = 1 / camera.scale;
    const toMetres = () => c.setTransform(s, 0, 0, -s, ratio * (camera.width / 2 + (ox - camera.x) * camera.scale), ratio * (camera.height / 2 - (oy - camera.y) * camera.scale));
    toMetres();
    if (this.layers.maps) for (const map of this.maps.values()) { map.draw(c, scene.origin, px); ++this.drawn.maps; }
    if (this.layers.trails) this.#trails(c, px);
    if (this.layers.beams) this.#readings((sensor, held) => drawReadingBelow(c, px, sensor, held, this.drawn, this.layers.lasers));
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.#robots(c);
    toMetres();
    if (this.layers.beams) this.#readings((sensor, held) => drawReadingAbove(c, px, scene.origin, sensor, held, this.drawn));
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (this.layers.contacts) this.#contacts(c);
    if (this.layers.lights) this.#lights(c);
    this.#selection(c);
    if (this.layers.names) this.#names(c);
  }

  #visible(i) {
    const { camera, fleet } = this, reach = fleet.radius[i] + 30 / camera.scale;
    return !fleet.absent[i] && Math.abs(fleet.shownX[i] - camera.x) < camera.width / 2 / camera.scale + reach && Math.abs(fleet.shownY[i] - camera.y) < camera.height / 2 / camera.scale + reach;
  }

  #trails(c, px) {
    const { fleet } = this;
    const stroke = (robots, color, width) => {
      c.beginPath();
      for (const i of robots) {
        if (fleet.trailCount[i] < 1 || fleet.absent[i]) continue;
        fleet.eachTrailPoint(i, (x, y, first) => c[first ? 'moveTo' : 'lineTo'](x, y));
        c.lineTo(fleet.shownX[i] - this.scene.origin[0], fleet.shownY[i] - this.scene.origin[1]);
        ++this.drawn.trails;
      }
      c.strokeStyle = color;
      c.lineWidth = width * px;
      c.stroke();
    };
    c.lineJoin = 'round';
    const width = fleet.count > paths ? 1 / this.ratio : 1.3;
    for (const [color, robots] of this.byColor) stroke(robots.filter((i) => i !== this.selected), fade(onPaper(color), 0.5), width);
    if (this.selected >= 0) stroke([this.selected], fade(theme.trail, 0.85), 2.2);
  }

  #readings(drawOne) {
    if (this.selected < 0 || this.fleet.absent[this.selected]) return;
    for (const sensor of this.scene.movers[this.selected].sensors) {
      const held = this.held.get(sensor.topic);
      if (held) drawOne(sensor, held);
    }
  }

  #robots(c) {
    const all = [...this.byColor].map(([color, robots]) => [color, robots.filter((i) => this.#visible(i))]);
    for (const [, seen] of all) this.drawn.robots += seen.length;
    for (const [color, seen] of all) if (seen.length > 0) (this.drawn.robots > paths ? this.#pictures : this.#bodies).call(this, c, color, seen);
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }

  #bodies(c, color, robots) {
    c.beginPath();
    for (const i of robots) this.#outline(c, i, this.camera.toScreen(this.fleet.shownX[i], this.fleet.shownY[i]), this.fleet.shownYaw[i]);
    c.fillStyle = fade(color, 0.85);
    c.fill();
    c.strokeStyle = edgeOf(color, 0.55);
    c.lineWidth = 1.2;
    c.stroke();
    c.beginPath();
    for (const i of robots) this.#heading(c, i, this.camera.toScreen(this.fleet.shownX[i], this.fleet.shownY[i]), this.fleet.shownYaw[i]);
    this.#styleHeading(c, color, robots[0]);
    c.stroke();
  }

  /** Draws one picture for all robots of a shape, colour and heading: unrotated and on whole pixels, copying is fast. */
  #pictures(c, color, robots) {
    const { fleet, camera, ratio } = this;
    if (this.spriteScale !== camera.scale * ratio) this.sprites.clear();
    this.spriteScale = camera.scale * ratio;
    c.setTransform(1, 0, 0, 1, 0, 0);
    for (const i of robots) {
      const turns = fleet.shownYaw[i] / (2 * Math.PI), step = Math.round((turns - Math.floor(turns)) * headings) % headings;
      const key = `${step} ${this.scene.movers[i].shape} ${color} ${fleet.radius[i]}`;
      if (!this.sprites.has(key)) this.sprites.set(key, this.#picture(color, i, (step / headings) * 2 * Math.PI));
      const { canvas, half } = this.sprites.get(key), [x, y] = camera.toScreen(fleet.shownX[i], fleet.shownY[i]);
      c.drawImage(canvas, Math.round(ratio * x) - half, Math.round(ratio * y) - half);
    }
  }

  #picture(color, i, yaw) {
    const half = Math.ceil(this.ratio * (Math.max(8, this.fleet.radius[i] * this.camera.scale) + 3));
    const canvas = document.createElement('canvas'), size = 2 * half;
    canvas.width = canvas.height = size;
    const c = canvas.getContext('2d');
    c.setTransform(this.ratio, 0, 0, this.ratio, half, half);
    c.beginPath();
    this.#outline(c, i, [0, 0], yaw);
    c.fillStyle = fade(color, 0.85);
    c.fill();
    c.strokeStyle = edgeOf(color, 0.55);
    c.lineWidth = 1.2;
    c.stroke();
    c.beginPath();
    this.#heading(c, i, [0, 0], yaw);
    this.#styleHeading(c, color, i);
    c.stroke();
    return { canvas, half };
  }

  #outline(c, i, [x, y], yaw) {
    const { fleet, camera, scene } = this, radius = fleet.radius[i] * camera.scale;
    const { closed, open } = scene.shapes[scene.movers[i].shape];
    if (radius < smallest || closed.length + open.length === 0) {
      c.moveTo(x + Math.max(radius, 2.4), y);
      c.arc(x, y, Math.max(radius, 2.4), 0, 2 * Math.PI);
      return;
    }
    const cos = Math.cos(yaw) * camera.scale, sin = Math.sin(yaw) * camera.scale;
    for (const line of closed.concat(open))
      for (let k = 0; k < line.length; k += 2)
        c[k === 0 ? 'moveTo' : 'lineTo'](x + cos * line[k] - sin * line[k + 1], y - sin * line[k] - cos * line[k + 1]);
  }

  /** For dots, draws the heading outside of the body. */
  #styleHeading(c, color, i) {
    const radius = this.fleet.radius[i] * this.camera.scale;
    c.lineWidth = radius < 6 ? 1.2 : 2;
    c.strokeStyle = radius < smallest ? edgeOf(color, 0.55) : headingOn(color);
  }

  #heading(c, i, [x, y], yaw) {
    const radius = this.fleet.radius[i] * this.camera.scale, reach = radius < smallest ? Math.max(2.2 * radius, 6) : radius;
    c.moveTo(x, y);
    c.lineTo(x + reach * Math.cos(yaw), y - reach * Math.sin(yaw));
  }

  /** A ring and a cross, so that contact is visible without its colour. */
  #contacts(c) {
    const { fleet, camera } = this;
    c.beginPath();
    for (let i = 0; i < fleet.count; ++i) {
      if (!fleet.contact[i] || !this.#visible(i)) continue;
      const [x, y] = camera.toScreen(fleet.shownX[i], fleet.shownY[i]), r = Math.max(6, fleet.radius[i] * camera.scale + 3);
      c.moveTo(x + r, y);
      c.arc(x, y, r, 0, 2 * Math.PI);
      const d = 0.5 * r;
      c.moveTo(x - d, y - d); c.lineTo(x + d, y + d);
      c.moveTo(x - d, y + d); c.lineTo(x + d, y - d);
      ++this.drawn.contacts;
    }
    c.strokeStyle = theme.contact;
    c.lineWidth = 2.5;
    c.stroke();
  }

  #lights(c) {
    const blink = performance.now() % 1000 < 500;
    const { fleet } = this;
    this.scene.lights.forEach(({ name, pose: fixed, mover }, i) => {
      const status = this.lights[i], joins = mover !== undefined;
      if (!status || (joins && fleet.absent[mover])) return;
      const pose = joins ? [fleet.shownX[mover], fleet.shownY[mover], fleet.shownYaw[mover]] : fixed;
      const [x, y] = this.camera.toScreen(pose[0], pose[1]);
      c.strokeStyle = theme.ink;
      c.lineWidth = 2.5;
      c.beginPath();
      c.moveTo(x, y); c.lineTo(x + 15 * Math.cos(pose[2]), y - 15 * Math.sin(pose[2]));
      c.stroke();
      drawSignal(c, x, y, 7, status.state, blink);
      this.drawn.lights[name] = status.state;
      if (this.camera.scale > 25 && Number.isFinite(status.left)) label(c, `${Math.ceil(status.left)} s`, x + 10, y - 9, 'left');
    });
  }

  #selection(c) {
    const i = this.selected;
    if (i < 0 || this.fleet.absent[i]) return;
    const [x, y] = this.camera.toScreen(this.fleet.shownX[i], this.fleet.shownY[i]), r = Math.max(8, this.fleet.radius[i] * this.camera.scale + 5);
    for (const [color, width] of [[theme.paper, 5], [theme.selected, 2.5]]) {
      c.strokeStyle = color;
      c.lineWidth = width;
      c.beginPath();
      c.arc(x, y, r, 0, 2 * Math.PI);
      c.stroke();
    }
  }

  /** Draws names below the robots, unless they would cover each other or a neighbouring robot. */
  #names(c) {
    const { fleet, camera, scene } = this, taken = [];
    const seen = [];
    for (let i = 0; i < fleet.count; ++i) if (this.#visible(i)) seen.push(i);
    if (this.selected >= 0 && this.#visible(this.selected)) seen.unshift(...seen.splice(seen.indexOf(this.selected), 1));
    const shown = seen.length <= namedRobots ? seen : seen.slice(0, this.selected >= 0 ? 1 : 0);
    for (const i of shown) {
      const [x, y] = camera.toScreen(fleet.shownX[i], fleet.shownY[i]);
      const below = y + Math.max(smallest, fleet.radius[i] * camera.scale) + 12;
      const half = 3.4 * scene.movers[i].name.length + 4;
      if (taken.some(([tx, ty, th]) => Math.abs(tx - x) < th + half && Math.abs(ty - below) < 15)) continue;
      taken.push([x, below, half]);
      label(c, scene.movers[i].name, x, below, 'center', i === this.selected);
      ++this.drawn.names;
    }
  }
}

function label(c, text, x, y, align, strong = false) {
  c.font = `${strong ? '600 ' : ''}12px system-ui, "DejaVu Sans", sans-serif`;
  c.textAlign = align;
  c.textBaseline = 'middle';
  c.lineJoin = 'round';
  c.lineWidth = 3.5;
  c.strokeStyle = theme.halo;
  c.strokeText(text, x, y);
  c.fillStyle = theme.ink;
  c.fillText(text, x, y);
}

/** Draws a light's state by colour and shape, as in figures: red square, yellow diamond, green disc; hollow if flashing. */
export function drawSignal(c, x, y, r, state, blink = true) {
  const color = [theme.lightOff, theme.lightRed, theme.lightYellow, theme.lightGreen, theme.lightRed, theme.lightYellow][state] ?? theme.lightOff;
  c.beginPath();
  if (state === 1 || state === 4) c.rect(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
  else if (state === 2 || state === 5) { c.moveTo(x, y - 1.25 * r); c.lineTo(x + 1.25 * r, y); c.lineTo(x, y + 1.25 * r); c.lineTo(x - 1.25 * r, y); c.closePath(); }
  else c.arc(x, y, r, 0, 2 * Math.PI);
  c.fillStyle = state >= 4 && !blink ? theme.paper : color;
  c.fill();
  c.lineWidth = 1.8;
  c.strokeStyle = theme.ink;
  c.stroke();
  if (state !== 0) return;
  const d = 0.7 * r;
  c.beginPath();
  c.moveTo(x - d, y - d); c.lineTo(x + d, y + d);
  c.moveTo(x - d, y + d); c.lineTo(x + d, y - d);
  c.strokeStyle = theme.paper;
  c.stroke();
}
