// The choice of a camera for the view over its image: a robot's, or a real one with a calibration file.

import { readCalibration } from './calibration.js';
import { offersDevice } from './camera_sources.js';

const longestDelay = 0.4;  // [s]: states of the last half second are kept (fleet.js)

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}
const labelled = (text, control) => element('label', {}, text, control);

export class CameraControls {
  error = '';
  #choice; #real; #url; #urlLabel; #file; #named; #mount; #delay; #reload; #cameras = []; #onChoice;

  /** @param onChoice called when another image or pose is chosen  @param onChange when the delay changes */
  constructor({ movers }, onChoice, onChange) {
    this.#onChoice = () => { this.#showReal(); onChoice(); };
    const options = [];
    movers.forEach(({ name, sensors }, row) => sensors.forEach((sensor, i) => { if (sensor.camera) options.push(new Option(`${name}: ${sensor.name}`, `${row} ${i}`)); }));
    options.push(new Option('A real camera: picture or video by its address', 'url'));
    if (offersDevice()) options.push(new Option('A real camera: this device’s', 'device'));
    this.#choice = element('select', { onchange: this.#onChoice }, ...options);
    this.#makeReal(movers, onChange);
    this.root = element('div', { className: 'choices' }, labelled('Camera ', this.#choice), this.#real);
    this.#showReal();
  }
  #makeReal(movers, onChange) {
    const onchange = this.#onChoice;
    this.#url = element('input', { type: 'url', placeholder: 'http://… or ws://…, of vps --view', size: 32, onchange });
    this.#urlLabel = labelled('Address ', this.#url);
    this.#file = element('input', { type: 'file', accept: '.toml', onchange: () => this.#calibrate() });
    this.#named = element('select', { ariaLabel: 'Camera of the calibration file', onchange });
    this.#mount = element('select', { id: 'camera-mount', onchange }, new Option('in the world', '-1'), ...movers.map(({ name }, row) => new Option(`on ${name}`, row)));
    this.#delay = element('input', { type: 'number', min: 0, max: 1000 * longestDelay, value: 0, onchange: onChange });
    this.#reload = element('input', { type: 'number', min: 0, max: 3600, step: 0.1, value: 0, onchange });
    this.#real = element('span', {}, this.#urlLabel, labelled('Calibration ', this.#file), this.#named, labelled('Mounted ', this.#mount), labelled('Delay [ms] ', this.#delay), labelled('Reload [s] ', this.#reload));
  }
  #showReal() {
    this.#real.hidden = this.isRobot;
    this.#urlLabel.hidden = this.#choice.value === 'device';
    this.#named.hidden = this.#cameras.length < 2;
  }
  async #calibrate() {
    const [file] = this.#file.files;
    this.#cameras = [];
    this.error = '';
    try {
      if (file) this.#cameras = readCalibration(file.name, await file.text());
    } catch (error) {
      this.error = error.message;
    }
    this.#named.replaceChildren(...this.#cameras.map(({ name }, i) => new Option(name, i)));
    this.#onChoice();
  }

  get isRobot() { return /^\d/.test(this.#choice.value); }
  /** [row, number of the sensor] of the chosen camera of a robot. */
  get robot() { return this.#choice.value.split(' ').map(Number); }
  /** {camera, row of the robot that carries it or -1, kind, url, reload [s]} of a real camera; null: not all is given. */
  get real() {
    const camera = this.#cameras[this.#named.value], kind = this.#choice.value, url = this.#url.value;
    return camera && (kind === 'device' || url) ? { camera, row: Number(this.#mount.value), kind, url, reload: Number(this.#reload.value) } : null;
  }
  /** [s] by which images are older than their arrival, as the user states. */
  get delay() { return Math.min(longestDelay, Math.max(0, 0.001 * Number(this.#delay.value) || 0)); }
}
