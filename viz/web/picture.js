// Images of cameras: sensor_msgs/msg/CompressedImage, decoded by the browser.

const depthFormat = /^16UC1; compressedDepth png/, depthHeader = 12;  // [byte] before the file, as of ROS's plug-in

/** Shades of depths, the nearer the brighter; none: black. @param data RGBA whose red is 1/257 of the depth in mm */
export function shadeDepths(data, rangeMax) {
  for (let i = 0; i < data.length; i += 4) {
    const depth = 0.257 * data[i], shade = depth > 0 ? 240 - 200 * Math.sqrt(Math.min(1, depth / rangeMax)) : 0;
    data[i] = data[i + 1] = data[i + 2] = shade;
  }
}

/**
 * Draws the newest image on a canvas of the image's size. Those that arrive while one is being decoded replace each
 * other.
 */
export class Picture {
  #waiting = null; #busy = false; #times = [];
  drawn = 0;       // number of images so far
  message = null;  // of the image on the canvas
  onDrawn = () => {};

  /** @param rangeMax [m] of depths */
  constructor(canvas, rangeMax = 50) {
    this.canvas = canvas;
    this.rangeMax = rangeMax;
  }
  show(message) {
    this.#waiting = message;
    if (!this.#busy) this.#draw();
  }
  /** "640 × 480, 9.8 images/s" */
  text() {
    const times = this.#times, rate = times.length > 1 ? (times.length - 1) / (times.at(-1) - times[0]) : 0;
    return `${this.canvas.width} × ${this.canvas.height}${rate > 0 ? `, ${rate.toFixed(1)} images/s` : ''}`;
  }
  async #draw() {
    this.#busy = true;
    while (this.#waiting) {
      const message = this.#waiting, isDepth = depthFormat.test(message.format);
      this.#waiting = null;
      try {
        const type = /\b(png|jpeg)\b/.exec(message.format)?.[1] ?? 'png';
        const image = await createImageBitmap(new Blob([isDepth ? message.data.subarray(depthHeader) : message.data], { type: `image/${type}` }));
        this.#paint(image, isDepth);
        image.close();
      } catch { continue; }  // an image that cannot be decoded is left out
      this.message = message;
      ++this.drawn;
      this.#count(performance.now() / 1000);
      this.onDrawn(this);
    }
    this.#busy = false;
  }
  #paint(image, isDepth) {
    const { canvas } = this, { width, height } = image;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    if (!isDepth) return;
    const pixels = context.getImageData(0, 0, width, height);
    shadeDepths(pixels.data, this.rangeMax);
    context.putImageData(pixels, 0, 0);
  }
  #count(now) {
    this.#times.push(now);
    while (now - this.#times[0] > 2) this.#times.shift();
  }
}
