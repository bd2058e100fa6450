// Draws the selected robot's readings over the map. Each reading is drawn from the robot's pose at the measurement, so
// that beams end on walls.

import { theme, fade, onPaper } from './theme.js';
import { sectorPath } from './scene.js';

/** Composes the pose of B in A with that of C in B: [x, y, yaw]. */
export function compose([x, y, yaw], [bx, by, byaw]) {
  const c = Math.cos(yaw), s = Math.sin(yaw);
  return [x + c * bx - s * by, y + s * bx + c * by, yaw + byaw];
}

/** Interprets a range with limits [least, most) as in REP 117: below `least`, the surface is too near. */
function echoOf(range, least, most) {
  const near = range < least;
  return { near, echo: !near && range < most, drawn: near ? least : Math.min(range, most) };
}

/** The field of view and the beams have the colour of the world file (`laser_color`); echoes have that of the theme. */
function drawScan(c, px, pose, color, scan, drawn) {
  const { ranges, angle_min, angle_increment, range_min, range_max } = scan, [x, y, yaw] = pose;
  const outline = new Path2D(), rays = new Path2D(), ends = new Path2D();
  const full = angle_increment * (ranges.length - 1) > 2 * Math.PI - 0.05;
  if (!full) outline.moveTo(x, y);
  const every = Math.max(1, Math.round(ranges.length / 90)), dot = 2 * px;
  let hits = 0;
  for (let i = 0; i < ranges.length; ++i) {
    const { echo, drawn: range } = echoOf(ranges[i], range_min, range_max);
    const angle = yaw + angle_min + i * angle_increment;
    const ex = x + range * Math.cos(angle), ey = y + range * Math.sin(angle);
    if (i === 0 && full) outline.moveTo(ex, ey); else outline.lineTo(ex, ey);
    if (i % every === 0) { rays.moveTo(x, y); rays.lineTo(ex, ey); }
    if (echo) { ++hits; ends.rect(ex - dot, ey - dot, 2 * dot, 2 * dot); }
  }
  outline.closePath();
  c.fillStyle = fade(color, 0.12);
  c.fill(outline);
  c.strokeStyle = fade(color, 0.28);
  c.lineWidth = px;
  c.stroke(rays);
  c.fillStyle = theme.view;
  c.fill(ends);
  drawn.beams += ranges.length;
  drawn.hits += hits;
}

/** Draws cones of sonar and infrared sensors up to their range. */
function drawCones(c, px, pose, sensor, message, drawn) {
  const ranges = message.range_m;
  sensor.cones.forEach((cone, i) => {
    const range = ranges[i];
    if (range === undefined || Number.isNaN(range)) return;
    const [x, y, yaw] = compose(pose, cone), { near, echo, drawn: radius } = echoOf(range, sensor.range_min, sensor.range_max);
    const path = sectorPath(x, y, yaw, sensor.cone_fov, radius);
    c.fillStyle = fade(theme.view, near || echo ? 0.2 : 0.07);
    c.fill(path);
    c.lineWidth = px;
    c.strokeStyle = fade(theme.view, near || echo ? 0.8 : 0.25);
    c.stroke(path);
    ++drawn.cones;
  });
}

/** Draws the distance to a lane's edge as a line from the sensor, and the edge across its end. */
function drawLaneEdge(c, px, pose, sensor, message, drawn) {
  const [x, y, yaw] = pose, sector = sectorPath(x, y, yaw, sensor.fan_fov, sensor.range_max);
  c.fillStyle = fade(theme.lane, 0.1);
  c.fill(sector);
  c.strokeStyle = fade(theme.lane, 0.5);
  c.lineWidth = px;
  c.stroke(sector);
  const distance = message.distance_m;
  if (!Number.isFinite(distance)) return;
  const [ux, uy] = sensor.perpendicular;
  const dx = Math.cos(yaw) * ux - Math.sin(yaw) * uy, dy = Math.sin(yaw) * ux + Math.cos(yaw) * uy;
  const ex = x + distance * dx, ey = y + distance * dy, half = 0.3 * sensor.range_max;
  c.strokeStyle = theme.lane;
  c.lineWidth = 2.5 * px;
  c.beginPath();
  c.moveTo(x, y); c.lineTo(ex, ey);
  c.stroke();
  c.lineWidth = 4 * px;
  c.beginPath();
  c.moveTo(ex - half * dy, ey + half * dx); c.lineTo(ex + half * dy, ey - half * dx);
  c.stroke();
  ++drawn.edges;
}

/** Draws the field at each element as an arrow in the plane; its length grows with the logarithm. */
function drawField(c, px, pose, sensor, message, drawn) {
  const field = message.vector_t ?? [];
  sensor.elements.forEach((element, i) => {
    const [x, y, yaw] = compose(pose, element);
    c.fillStyle = theme.magnetometer;
    c.beginPath();
    c.arc(x, y, 3 * px, 0, 2 * Math.PI);
    c.fill();
    const bx = field[3 * i], by = field[3 * i + 1], plane = Math.hypot(bx, by);
    ++drawn.fields;
    if (!(plane > 1e-9)) return;
    const length = (6 + 9 * Math.log10(plane / 1e-9)) * px, direction = yaw + Math.atan2(by, bx);
    const ex = x + length * Math.cos(direction), ey = y + length * Math.sin(direction);
    c.strokeStyle = theme.magnetometer;
    c.lineWidth = 2 * px;
    c.beginPath();
    c.moveTo(x, y); c.lineTo(ex, ey);
    for (const side of [2.6, -2.6]) { c.moveTo(ex, ey); c.lineTo(ex + 7 * px * Math.cos(direction + side), ey + 7 * px * Math.sin(direction + side)); }
    c.stroke();
  });
}

function drawFix(c, px, origin, message) {
  const x = message.x_m - origin[0], y = message.y_m - origin[1];
  if (!Number.isFinite(x)) return;
  c.strokeStyle = theme.gps;
  c.lineWidth = 2.5 * px;
  c.beginPath();
  for (const [dx, dy] of [[7, 7], [7, -7]]) { c.moveTo(x - dx * px, y - dy * px); c.lineTo(x + dx * px, y + dy * px); }
  c.stroke();
}

/** An occupancy map as a picture, redrawn when a reading arrives. */
export class MapPicture {
  #canvas = document.createElement('canvas');
  cells = { occupied: 0, free: 0 };

  constructor(message, geometry) {
    Object.assign(this, { message, geometry });
    const { left, top, cell, words } = geometry;
    const data = message.word, columns = 4 * words, rows = 4 * Math.ceil(data.length / words);
    Object.assign(this, { left, top, width: columns * cell, height: rows * cell });
    this.#canvas.width = columns;
    this.#canvas.height = rows;
    const rgb = (color, alpha) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16)).concat(alpha);
    const occupied = rgb(theme.map, 235), free = rgb(theme.mapFree, 70);
    const context = this.#canvas.getContext('2d'), image = context.createImageData(columns, rows);
    for (let word = 0; word < data.length; ++word) {
      const bits = data[word], column = 4 * (word % words), row = 4 * Math.floor(word / words);
      for (let k = 0; k < 16; ++k) {
        const state = (bits >>> (2 * k)) & 3;
        if (state === 0) continue;
        const at = 4 * ((row + (k >> 2)) * columns + column + (k & 3));
        const [r, g, b, a] = state === 1 ? occupied : free;
        image.data[at] = r; image.data[at + 1] = g; image.data[at + 2] = b; image.data[at + 3] = a;
        ++this.cells[state === 1 ? 'occupied' : 'free'];
      }
    }
    context.putImageData(image, 0, 0);
  }

  draw(c, origin, px) {
    c.save();
    c.translate(this.left - origin[0], this.top - origin[1]);
    c.scale(1, -1);
    c.imageSmoothingEnabled = false;
    c.drawImage(this.#canvas, 0, 0, this.width, this.height);
    c.strokeStyle = fade(theme.map, 0.5);
    c.lineWidth = px;
    c.strokeRect(0, 0, this.width, this.height);
    c.restore();
  }
}

/**
 * Draws the newest reading's parts below the robots.
 * @param held {message, pose}, relative to the scene's origin  @param own whether lasers have their own colours
 */
export function drawReadingBelow(c, px, sensor, { message, pose }, drawn, own) {
  if (message.ranges) drawScan(c, px, pose, own && sensor.color ? onPaper(sensor.color) : theme.view, message, drawn);
  else if (sensor.cones && message.range_m) drawCones(c, px, pose, sensor, message, drawn);
}

/** Draws the parts above the robots. */
export function drawReadingAbove(c, px, origin, sensor, { message, pose }, drawn) {
  if (sensor.perpendicular) drawLaneEdge(c, px, pose, sensor, message, drawn);
  else if (sensor.elements) drawField(c, px, pose, sensor, message, drawn);
  else if (sensor.type === 'gps') drawFix(c, px, origin, message);
}
