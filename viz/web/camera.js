// Converts between metres and pixels. `center` is shown in the middle of the canvas with `scale` pixels per metre; y is
// up.

export class Camera {
  x = 0; y = 0; scale = 40; width = 1; height = 1;

  resize(width, height) { this.width = width; this.height = height; }
  toScreen(x, y) { return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale]; }
  toWorld(px, py) { return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale]; }
  pan(dx, dy) { this.x -= dx / this.scale; this.y += dy / this.scale; }
  /** Zooms around the pixel: the point under it does not move. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toWorld(px, py);
    this.scale = Math.min(5000, Math.max(0.002, this.scale * factor));
    const [nx, ny] = this.toWorld(px, py);
    this.x += x - nx;
    this.y += y - ny;
  }
  fit([x0, y0, x1, y1], margin = Math.min(40, this.width / 20)) {
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2;
    const wide = Math.max(x1 - x0, 0.1), high = Math.max(y1 - y0, 0.1);
    this.scale = Math.min((this.width - 2 * margin) / wide, (this.height - 2 * margin) / high);
  }
  /** Returns the longest round length [m] of at most `pixels`: 1, 2 or 5 times a power of ten. */
  roundLength(pixels) {
    const metres = pixels / this.scale, power = 10 ** Math.floor(Math.log10(metres));
    return [5, 2, 1].find((digit) => digit * power <= metres) * power;
  }
}
