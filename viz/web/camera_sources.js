// Images under an overlay: `element` shows the newest one, `size` is its [width, height] in pixels or null, `time` its
// time [s] in the run or NaN if it states none, `error` a text for users or ''.

import { Picture } from './picture.js';
import { Connection } from './protocol.js';

const made = (tag, properties) => Object.assign(document.createElement(tag), properties);

/** Images of a topic (sensor_msgs/CompressedImage). */
class TopicImages {
  element = made('canvas', {}); size = null; time = NaN; error = '';
  #picture;

  constructor(topic, onChange, { rangeMax = 50, isDated = true } = {}) {
    this.topic = topic;
    this.#picture = new Picture(this.element, rangeMax);
    this.#picture.onDrawn = ({ message: { header: { stamp } } }) => {
      this.size = [this.element.width, this.element.height];
      if (isDated) this.time = stamp.sec + 1e-9 * stamp.nanosec;
      onChange();
    };
  }
  start(connection) { connection.subscribe(this.topic, (message) => this.#picture.show(message), { owner: 'camera' }); }
  stop(connection) { connection.unsubscribe(this.topic, 'camera'); }
}

/** The camera of a simulated robot (`camera` of /scene.json). */
export const robotImages = ({ image, range_max }, onChange) => new TopicImages(image, onChange, { rangeMax: range_max });

/** A camera of `vps --view`, whose clock is not that of the run. */
class ViewImages {
  #images; #connection;
  constructor(url, name, onChange) {
    this.#images = new TopicImages(`/${name}/image/compressed`, onChange, { isDated: false });
    Object.assign(this, { url, name, onChange, error: `Waiting for ${url}.` });
  }
  get element() { return this.#images.element; }
  get size() { return this.#images.size; }
  get time() { return this.#images.time; }
  start() {
    try {
      this.#connection = new Connection(this.url);
    } catch (error) {
      this.error = error.message;
      return;
    }
    this.#connection.addEventListener('channels', () => { this.error = this.#connection.topics().includes(this.#images.topic) ? '' : `${this.url} has no camera '${this.name}'; its name is that of the calibration file.`; this.onChange(); });
    this.#connection.addEventListener('close', () => { this.error = `No connection to ${this.url}.`; this.onChange(); });
    this.#images.start(this.#connection);
  }
  stop() { this.#connection?.close(); }
}

/** A picture, also MJPEG, or a video by its address. @param reload [s] of pictures; 0: never */
class UrlImages {
  time = NaN; error = ''; #timer = 0;
  constructor(url, onChange, reload = 0) {
    const isVideo = /\.(mp4|webm|ogv|mov)($|[?#])/i.test(url);
    this.element = made(isVideo ? 'video' : 'img', isVideo ? { muted: true, loop: true, playsInline: true, controls: true } : { alt: 'Image of the camera' });
    this.element.onload = this.element.onloadeddata = () => { this.error = ''; onChange(); this.#again(); };
    this.element.onerror = () => { this.error = `${url} cannot be shown; expected the address of a picture, an MJPEG stream, or a video.`; onChange(); this.#again(); };
    Object.assign(this, { url, reload: isVideo ? 0 : reload });
  }
  get size() {
    const { naturalWidth, naturalHeight, videoWidth, videoHeight } = this.element, size = [naturalWidth ?? videoWidth, naturalHeight ?? videoHeight];
    return size[0] > 0 ? size : null;
  }
  start() { this.element.src = this.url; this.element.play?.().catch(() => {}); }
  stop() { clearTimeout(this.#timer); this.reload = 0; this.element.src = ''; }
  #again() {
    if (!(this.reload > 0) || this.url.startsWith('data:')) return;
    this.#timer = setTimeout(() => { this.element.src = `${this.url}${this.url.includes('?') ? '&' : '?'}t=${Date.now()}`; }, 1000 * this.reload);
  }
}

/** A camera of the device on which the browser runs. */
class DeviceImages {
  element = made('video', { muted: true, playsInline: true }); time = NaN; error = 'Waiting for permission to use the camera.'; #stream = null; #stopped = false;
  constructor(onChange) { this.onChange = onChange; }
  get size() { return this.element.videoWidth > 0 ? [this.element.videoWidth, this.element.videoHeight] : null; }
  async start() {
    this.element.onloadeddata = () => { this.error = ''; this.onChange(); };
    try {
      const stream = await navigator.mediaDevices.getUserMedia({ video: true });
      if (this.#stopped) return stream.getTracks().forEach((track) => track.stop());
      this.#stream = this.element.srcObject = stream;
      await this.element.play();
    } catch (error) {
      this.error = `The camera cannot be used: ${error.message}`;
      this.onChange();
    }
  }
  stop() { this.#stopped = true; this.#stream?.getTracks().forEach((track) => track.stop()); }
}

export const offersDevice = () => Boolean(navigator.mediaDevices?.getUserMedia);

/** @param source {kind: 'url' or 'device', url, reload}  @param name of the camera in the calibration file */
export function realImages({ kind, url, reload }, name, onChange) {
  if (kind === 'device') return new DeviceImages(onChange);
  return /^wss?:/.test(url) ? new ViewImages(url, name, onChange) : new UrlImages(url, onChange, reload);
}
