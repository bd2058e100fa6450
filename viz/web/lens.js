// Images of points and lines of the world through a camera's lens, as in base/lens.h: {size, focal, center, distortion
// (k1 k2 p1 p2 k3 k4 k5 k6, or k1 k2 k3 k4 of a fisheye), fisheye}. Whole numbers of pixels are centres.

import { inverse, transform } from './rigid.js';

const nearest = 0.02;  // [m] along the optical axis: parts of lines that are nearer are cut off
const widestFisheye = 85 * Math.PI / 180, widestPinhole = 100;  // angle [rad]; tangent
const directions = 64, mostHalvings = 9, straight = 0.3;  // [px] of the image

function radial(k, r2) {
  const above = 1 + r2 * (k[0] + r2 * (k[1] + r2 * (k[4] ?? 0))), rise = k[0] + r2 * (2 * k[1] + 3 * r2 * (k[4] ?? 0));
  const below = 1 + r2 * ((k[5] ?? 0) + r2 * ((k[6] ?? 0) + r2 * (k[7] ?? 0))), fall = (k[5] ?? 0) + r2 * (2 * (k[6] ?? 0) + 3 * r2 * (k[7] ?? 0));
  return [above / below, (rise - above / below * fall) / below];
}

/** Normalised coordinates (x/z, y/z) as a pinhole with Brown's distortion images them. */
export function distorted(k, [x, y]) {
  const r2 = x * x + y * y, [factor] = radial(k, r2);
  return [x * factor + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x), y * factor + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y];
}

/** False where the distortion folds: more than one direction is imaged at a pixel. */
function isInvertible(k, [x, y]) {
  const [factor, rise] = radial(k, x * x + y * y), slope = 2 * rise;
  const xx = factor + x * x * slope + 2 * k[2] * y + 6 * k[3] * x, xy = x * y * slope + 2 * k[2] * x + 2 * k[3] * y, yy = factor + y * y * slope + 6 * k[2] * y + 2 * k[3] * x;
  return xx > 0 && xx * yy - xy * xy > 0;
}

const fisheyeRadius = (k, a, a2 = a * a) => a * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
const fisheyeGrows = (k, a, a2 = a * a) => 1 + a2 * (3 * k[0] + a2 * (5 * k[1] + a2 * (7 * k[2] + a2 * 9 * k[3]))) > 0;

export class Lens {
  #widest;  // tangents from the axis up to which the lens is invertible, by direction; of a fisheye one for all

  constructor({ size, focal, center, distortion, fisheye = false }) {
    Object.assign(this, { size, focal, center, distortion, fisheye, bends: fisheye || distortion.some((k) => k !== 0) });
    this.#widest = fisheye ? [this.#widestAngle()] : Array.from({ length: directions }, (_, i) => this.#widestTangent(2 * Math.PI * i / directions));
  }

  #widestAngle() {
    let widest = 0;
    for (let i = 1; i <= 4096 && fisheyeGrows(this.distortion, widestFisheye * i / 4096); ++i) widest = widestFisheye * i / 4096;
    return Math.tan(widest);
  }
  #widestTangent(angle) {
    const c = Math.cos(angle), s = Math.sin(angle);
    let widest = 0;
    for (let t = 0.01; t < widestPinhole && isInvertible(this.distortion, [t * c, t * s]); t *= 1.02) widest = t;
    return widest;
  }
  #sees(x, y, r) {
    if (this.#widest.length === 1) return r <= this.#widest[0];
    const turn = Math.atan2(y, x) / (2 * Math.PI), at = Math.floor((turn - Math.floor(turn)) * directions);
    return r <= Math.min(this.#widest[at % directions], this.#widest[(at + 1) % directions]);
  }

  /** Returns the pixel of a point [x, y, z] in the frame of the camera; null: it is behind, or the lens does not see it. */
  pixelOf([px, py, pz]) {
    if (!(pz > 0)) return null;
    const x = px / pz, y = py / pz, r = Math.hypot(x, y);
    if (!this.#sees(x, y, r)) return null;
    const { distortion: k, focal: [fx, fy], center: [cx, cy] } = this;
    if (!this.bends) return [cx + fx * x, cy + fy * y];
    const scale = this.fisheye && r > 0 ? fisheyeRadius(k, Math.atan(r)) / r : 1, [bx, by] = this.fisheye ? [scale * x, scale * y] : distorted(k, [x, y]);
    return [cx + fx * bx, cy + fy * by];
  }
}

/** Fraction of the way from a to b at which the depth is `nearest`. */
const cutAt = (a, b) => (nearest - a[2]) / (b[2] - a[2]);
const between = (a, b, share) => [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])];

/** Part of a polygon in front of the camera (Sutherland and Hodgman). */
function clipped(points) {
  const kept = [];
  points.forEach((b, i) => {
    const a = points[(i + points.length - 1) % points.length];
    if ((a[2] < nearest) !== (b[2] < nearest)) kept.push(between(a, b, cutAt(a, b)));
    if (b[2] >= nearest) kept.push(b);
  });
  return kept;
}

/** The image of the world in a camera with a pose. */
export class Sight {
  #lens; #X_CW;
  /** @param X_WC pose of the optical frame: x to the right in the image, y down, z ahead */
  constructor(lens, X_WC) {
    this.#lens = lens;
    this.#X_CW = inverse(X_WC);
  }

  inCamera(p) { return transform(this.#X_CW, p); }
  /** Returns the pixel of a point in the world, within the image or not; null: the camera cannot see it. */
  pixelOf(p) {
    const at = this.inCamera(p);
    return at[2] < nearest ? null : this.#lens.pixelOf(at);
  }
  isInImage([u, v], margin = 0.5) {
    const [width, height] = this.#lens.size;
    return u >= -margin && v >= -margin && u <= width - 1 + margin && v <= height - 1 + margin;
  }

  /** Adds a line through points of the world to a path in pixels. It is bent by the lens and cut where it is not seen. */
  line(path, points) {
    let last = null;
    const ends = points.map((p) => this.inCamera(p));
    for (let i = 0; i + 1 < ends.length; ++i) {
      let a = ends[i], b = ends[i + 1];
      if (a[2] < nearest && b[2] < nearest) { last = null; continue; }
      if (a[2] < nearest) { a = between(a, b, cutAt(a, b)); last = null; }
      if (b[2] < nearest) b = between(a, b, cutAt(a, b));
      const from = this.#lens.pixelOf(a), pixels = [];
      this.#addPieces(pixels, a, from, b, this.#lens.pixelOf(b), 0);
      let at = last ?? from;
      if (!last && at) path.moveTo(...at);
      for (const pixel of pixels) {
        if (pixel) path[at ? 'lineTo' : 'moveTo'](...pixel);
        at = pixel;
      }
      last = ends[i + 1][2] < nearest ? null : at;
    }
  }

  /** Adds a polygon to a path, if the camera sees all of the part in front of it. @return whether it was added */
  polygon(path, points) {
    const corners = clipped(points.map((p) => this.inCamera(p))), pixels = [];
    if (corners.length < 3) return false;
    const images = corners.map((corner) => this.#lens.pixelOf(corner));
    if (images.includes(null)) return false;
    corners.forEach((a, i) => { const j = (i + 1) % corners.length; this.#addPieces(pixels, a, images[i], corners[j], images[j], 0); });
    if (pixels.includes(null) || !pixels.some((pixel) => this.isInImage(pixel, 200))) return false;
    pixels.forEach((pixel, i) => path[i === 0 ? 'moveTo' : 'lineTo'](...pixel));
    path.closePath();
    return true;
  }

  /** Adds the ends of straight pieces of the image of a line after its start; null: the piece up to here is not seen. */
  #addPieces(pixels, a, from, b, to, halvings) {
    const most = this.#lens.bends || !from || !to ? mostHalvings : 0;
    if (halvings < most) {
      const middle = between(a, b, 0.5), at = this.#lens.pixelOf(middle);
      if (!this.#isStraight(from, at, to) || (halvings < 1 && from)) {
        this.#addPieces(pixels, a, from, middle, at, halvings + 1);
        return this.#addPieces(pixels, middle, at, b, to, halvings + 1);
      }
    }
    pixels.push(from && to);
    if (!from && to) pixels.push(to);
  }
  /** Lines off the image on one side count as straight, unseen ones as well. */
  #isStraight(a, m, b) {
    if (!a && !m && !b) return true;
    if (!a || !m || !b) return false;
    const [width, height] = this.#lens.size, margin = 100;
    for (const [axis, size] of [[0, width], [1, height]])
      if (Math.max(a[axis], m[axis], b[axis]) < -margin || Math.min(a[axis], m[axis], b[axis]) > size + margin) return true;
    const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy);
    return Math.abs((m[0] - a[0]) * dy - (m[1] - a[1]) * dx) <= straight * length || length < straight;
  }
}
