// The camera of the three-dimensional view: on a sphere around a target, z up. Lengths in metres, relative to the scene's
// origin; angles in radians.

export const fov = 0.8;  // vertical

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

export class Orbit {
  target = [0, 0, 0]; distance = 10; azimuth = -2.2; elevation = 0.75; height = 1;  // `height` of the canvas [px]

  resize(height) { this.height = Math.max(1, height); }
  eye() {
    const { target: [x, y, z], distance, azimuth, elevation } = this, across = distance * Math.cos(elevation);
    return [x + across * Math.cos(azimuth), y + across * Math.sin(azimuth), z + distance * Math.sin(elevation)];
  }
  /** Turns by a drag of the pointer [px]. The camera stays above the floor and does not tip over. */
  turn(dx, dy) {
    this.azimuth -= 0.006 * dx;
    this.elevation = clamp(this.elevation + 0.006 * dy, 0.02, Math.PI / 2 - 0.001);
  }
  /** Moves the target over the floor, so that the world follows the pointer. */
  pan(dx, dy) {
    const metres = 2 * this.distance * Math.tan(fov / 2) / this.height, ahead = dy * metres / Math.max(0.25, Math.sin(this.elevation));
    const c = Math.cos(this.azimuth), s = Math.sin(this.azimuth);
    this.target[0] += s * dx * metres - c * ahead;
    this.target[1] -= c * dx * metres + s * ahead;
  }
  zoom(factor) { this.distance = clamp(this.distance / factor, 0.05, 1e6); }
  /** Shows all of an area [x0, y0, x1, y1] of the world. */
  fit([x0, y0, x1, y1], [ox, oy]) {
    this.target = [(x0 + x1) / 2 - ox, (y0 + y1) / 2 - oy, 0];
    this.distance = Math.max(0.5, 0.55 * Math.hypot(x1 - x0, y1 - y0) / Math.tan(fov / 2));
  }
}
