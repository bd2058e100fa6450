// What robots sense and intend, drawn over the image of a camera (T. Collett and B. MacDonald, "Augmented Reality
// Visualisation for Player", 2006). Coordinates of paths are pixels of the image.

import { transform } from './rigid.js';

export const rangeColors = 12;
const mapReach = 8, longestRun = 1;  // [m] from the robot; along a row of cells
const wallReach = 30;  // [m] from the camera
const arcTime = 2, arcSteps = 20, arrowTime = 1;  // [s], pieces, [s]
const mostEdges = 16;  // of an outline with vertical edges

// Bright colours with dark borders, so that they are visible on any image; distinct for colour-blind readers (Okabe, Ito).
export const colors = { robots: '#56b4e9', selected: '#ffffff', occupied: '#d55e00', free: '#56b4e9', moving: '#ff8a3c', resting: '#f0a6d0', intent: '#f0e442', goal: '#f0e442', walls: '#dddddd' };

/** Near to far: light to dark of viridis, approximated as in clouds_3d.js. */
export function rangeColor(share) {
  const t = 1 - Math.min(1, Math.max(0, share)), c = [[.278, .005, .334], [.105, 1.405, 1.385], [-.331, .215, .095], [-4.634, -5.799, -19.332], [6.228, 14.18, 56.691], [4.776, -13.745, -65.353], [-5.435, 4.646, 26.312]];
  const rgb = [0, 1, 2].map((k) => Math.round(255 * Math.min(1, Math.max(0, c.reduceRight((sum, row) => sum * t + row[k], 0)))));
  return `rgb(${rgb})`;
}

/** Returns the smallest of 1, 2, 5 times a power of ten that is at least `metres`. */
export function roundRange(metres) {
  const power = 10 ** Math.floor(Math.log10(Math.max(metres, 0.1)));
  return [1, 2, 5, 10].map((digit) => digit * power).find((round) => round >= metres * (1 - 1e-9));
}

/** Points [x, y, 0] of the way at a constant twist, in the frame of its start. */
export function arcOf({ forward, left, turn }, seconds = arcTime) {
  return Array.from({ length: arcSteps + 1 }, (_, i) => {
    const t = seconds * i / arcSteps, a = turn * t, s = Math.abs(a) < 1e-6 ? t : Math.sin(a) / turn, c = Math.abs(a) < 1e-6 ? 0.5 * a * t : (1 - Math.cos(a)) / turn;
    return [forward * s - left * c, forward * c + left * s, 0];
  });
}

/** Runs of equal cells of a map around [x, y]: {state: 1 occupied, 2 free, left, right, top, bottom} [m]. */
export function* mapRuns({ message: { word }, geometry: { left, top, cell, words } }, [x, y], reach = mapReach) {
  const columns = 4 * words, rows = 4 * Math.ceil(word.length / words), first = (at, count) => Math.min(count, Math.max(0, Math.floor(at)));
  const c0 = first((x - reach - left) / cell, columns), c1 = first((x + reach - left) / cell + 1, columns), most = Math.max(1, Math.round(longestRun / cell));
  for (let row = first((top - y - reach) / cell, rows); row < first((top - y + reach) / cell + 1, rows); ++row) {
    const stateAt = (column) => (word[(row >> 2) * words + (column >> 2)] >>> (2 * (4 * (row & 3) + (column & 3)))) & 3;
    for (let begin = c0, end; begin < c1; begin = end) {
      const state = stateAt(begin);
      for (end = begin + 1; end < c1 && end - begin < most && stateAt(end) === state;) ++end;
      if (state === 1 || state === 2) yield { state, left: left + begin * cell, right: left + end * cell, top: top - row * cell, bottom: top - (row + 1) * cell };
    }
  }
}

export class Overlay {
  /** @param px length of a pixel of the screen, in pixels of the image */
  constructor(context, sight, px) { Object.assign(this, { c: context, sight, px, drawn: { robots: 0, points: 0, cells: 0, tracks: 0, arcs: 0, goals: 0, walls: 0 } }); }

  #stroke(path, color, width = 2, dashes = []) {
    const { c, px } = this;
    c.lineJoin = c.lineCap = 'round';
    c.setLineDash(dashes.map((length) => length * px));
    for (const [style, more] of [['rgba(0,0,0,.6)', 2], [color, 0]]) {
      c.strokeStyle = style;
      c.lineWidth = (width + more) * px;
      c.stroke(path);
    }
    c.setLineDash([]);
  }
  #label(text, p, color) {
    const at = this.sight.pixelOf(p), { c, px } = this;
    if (!at || !this.sight.isInImage(at)) return;
    c.font = `600 ${12 * px}px system-ui, "DejaVu Sans", sans-serif`;
    c.textAlign = 'center';
    c.lineWidth = 3 * px;
    c.strokeStyle = 'rgba(0,0,0,.7)';
    c.strokeText(text, at[0], at[1] - 5 * px);
    c.fillStyle = color;
    c.fillText(text, at[0], at[1] - 5 * px);
  }
  /** Adds an arrow from p by [dx, dy, dz], in the plane. */
  #arrow(path, p, [dx, dy, dz = 0]) {
    const length = Math.hypot(dx, dy), end = [p[0] + dx, p[1] + dy, p[2] + dz], head = Math.min(0.15, 0.3 * length) / (length || 1);
    this.sight.line(path, [p, end]);
    for (const side of [0.5, -0.5]) this.sight.line(path, [end, [end[0] - head * (dx + side * dy), end[1] - head * (dy - side * dx), end[2]]]);
  }
  #ring(path, [x, y, z], radius) {
    this.sight.line(path, Array.from({ length: 25 }, (_, i) => [x + radius * Math.cos(i * Math.PI / 12), y + radius * Math.sin(i * Math.PI / 12), z]));
  }

  /** @param robots {name, X, shape, radius, selected} */
  robots(robots) {
    for (const { name, X, shape, radius, selected } of robots) {
      if (this.sight.inCamera(X.p)[2] < -radius) continue;
      const path = new Path2D(), { closed, open, closed_z, open_z } = shape;
      let top = 0;
      closed.concat(open).forEach((line, i) => {
        const [low, high] = closed_z.concat(open_z)[i];
        top = Math.max(top, high);
        const ring = (z) => Array.from({ length: line.length / 2 }, (_, k) => transform(X, [line[2 * k], line[2 * k + 1], z]));
        const below = ring(low), above = ring(high);
        for (const points of [below, above]) this.sight.line(path, points);
        if (below.length <= mostEdges) below.forEach((point, k) => this.sight.line(path, [point, above[k]]));
      });
      if (closed.length + open.length === 0) this.#ring(path, X.p, radius);
      this.#stroke(path, selected ? colors.selected : colors.robots, selected ? 2 : 1.5);
      this.#label(name, transform(X, [0, 0, top]), selected ? colors.selected : colors.robots);
      ++this.drawn.robots;
    }
  }

  /** @param clouds {origin, position, points (x y z intensity)}, relative to `origin`  @param most [m] range of the darkest colour */
  scans(clouds, most) {
    const { c, px } = this, bins = Array.from({ length: rangeColors }, () => []);
    for (const { origin: [ox, oy, oz], position: [sx, sy, sz], points } of clouds) {
      for (let i = 0; i + 3 < points.length; i += 4) {
        const at = this.sight.pixelOf([points[i] + ox, points[i + 1] + oy, points[i + 2] + oz]);
        if (!at || !this.sight.isInImage(at)) continue;
        const range = Math.hypot(points[i] - sx, points[i + 1] - sy, points[i + 2] - sz);
        bins[Math.min(rangeColors - 1, Math.floor(range / most * rangeColors))].push(...at);
        ++this.drawn.points;
      }
    }
    for (const [half, colorOf] of [[2.6, () => 'rgba(0,0,0,.55)'], [1.7, (k) => rangeColor((k + 0.5) / rangeColors)]]) {
      bins.forEach((bin, k) => {
        c.fillStyle = colorOf(k);
        for (let i = 0; i < bin.length; i += 2) c.fillRect(bin[i] - half * px, bin[i + 1] - half * px, 2 * half * px, 2 * half * px);
      });
    }
  }

  /** @param place [x, y, z] of the robot, at whose height the cells lie */
  map(map, place) {
    const paths = [null, new Path2D(), new Path2D()], { c } = this;
    for (const { state, left, right, top, bottom } of mapRuns(map, place))
      this.drawn.cells += this.sight.polygon(paths[state], [[left, bottom, place[2]], [right, bottom, place[2]], [right, top, place[2]], [left, top, place[2]]]);
    for (const [state, color, alpha] of [[2, colors.free, 0.22], [1, colors.occupied, 0.6]]) {
      c.globalAlpha = alpha;
      c.fillStyle = color;
      c.fill(paths[state]);
    }
    c.globalAlpha = 1;
  }

  /** Rings of two standard deviations, arrows of the way in a second. @param message of a sensor `tracks`  @param z [m] */
  tracks(message, z) {
    const { x_m, y_m, vx_m_s, vy_m_s, valid, xx_m2, yy_m2, identity, kind } = message;
    for (let i = 0; i < valid.length; ++i) {
      if (!valid[i]) continue;
      const path = new Path2D(), color = kind[i] === 2 ? colors.moving : colors.resting, p = [x_m[i], y_m[i], z + 0.05];
      this.#ring(path, p, Math.min(2, Math.max(0.05, 2 * Math.sqrt(0.5 * (xx_m2[i] + yy_m2[i])))));
      if (kind[i] === 2) this.#arrow(path, p, [arrowTime * vx_m_s[i], arrowTime * vy_m_s[i]]);
      this.#stroke(path, color);
      this.#label(String(identity[i]), p, color);
      ++this.drawn.tracks;
    }
  }

  /** The way that the commanded twists lead in two seconds. @param robots {X, command} */
  arcs(robots) {
    const path = new Path2D();
    for (const { X, command } of robots) {
      if (!command || Math.hypot(command.forward, command.left) < 0.01) continue;
      const points = arcOf(command).map((p) => transform(X, [p[0], p[1], 0.02]));
      this.sight.line(path, points);
      const [a, b] = points.slice(-2), length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      this.#arrow(path, a, [0.15 * (b[0] - a[0]) / length, 0.15 * (b[1] - a[1]) / length]);
      ++this.drawn.arcs;
    }
    this.#stroke(path, colors.intent, 2.5);
  }

  /** Flags at the goals of robots, and lines to them. @param goals {from, to [x, y, z], name} */
  goals(goals) {
    const path = new Path2D(), pole = new Path2D();
    for (const { from, to: [x, y, z], name } of goals) {
      this.sight.line(path, [from, [x, y, z]]);
      this.sight.line(pole, [[x, y, z], [x, y, z + 0.5]]);
      this.#label(name, [x, y, z + 0.5], colors.goal);
      ++this.drawn.goals;
    }
    this.#stroke(path, colors.goal, 1.5, [6, 6]);
    this.#stroke(pole, colors.goal, 3);
  }

  /** Lower edges of walls and lane markings near the camera. @param lines of [x, y, x, y, ...]  @param place of the camera */
  walls(lines, [cx, cy]) {
    const path = new Path2D();
    for (const line of lines) {
      for (let k = 0; k + 3 < line.length; k += 2) {
        const [ax, ay, bx, by] = line.slice(k, k + 4), share = Math.min(1, Math.max(0, ((cx - ax) * (bx - ax) + (cy - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2 || 1)));
        if (Math.hypot(ax + share * (bx - ax) - cx, ay + share * (by - ay) - cy) > wallReach) continue;
        this.sight.line(path, [[ax, ay, 0], [bx, by, 0]]);
        ++this.drawn.walls;
      }
    }
    this.#stroke(path, colors.walls, 1.2);
  }
}
