// The calibration file of real cameras: the sections [[camera]] of a testbed file (docs/vps.md), as `calibrate` prints
// them. Other sections and keys are those of `vps` and skipped.

import { axesOf } from './rigid.js';

const mostCameras = 64;

/** Number of values of each key that is read; those of `optional` may be missing. */
const counts = { size: [2], focal: [2], center: [2], distortion: [1, 2, 3, 4, 5], position: [3], orientation: [4] };
const optional = { center: ({ size: [w, h] }) => [(w - 1) / 2, (h - 1) / 2], distortion: () => [], orientation: () => [1, 0, 0, 0] };

/** [text of line, its number], with arrays that continue on the next lines joined, without comments. */
function* statements(text) {
  let open = '', from = 0, number = 0;
  for (const raw of text.split(/\r?\n/)) {
    ++number;
    const line = raw.replace(/#.*$/, '').trim();
    if (!open) from = number;
    open = `${open} ${line}`.trim();
    if (/=\s*\[[^\]]*$/.test(open)) continue;
    if (open) yield [open, from];
    open = '';
  }
  if (open) yield [open, from];
}

function numbersOf(text, key, fail) {
  const list = /^\[([^\]]*)\]$/.exec(text), values = list ? list[1].split(',').map((part) => part.trim()).filter((part, i, all) => part || i + 1 < all.length).map((part) => (part ? Number(part.replaceAll('_', '')) : NaN)) : [];
  if (!list || !counts[key].includes(values.length) || !values.every(Number.isFinite)) fail(`'${key}' expects ${counts[key].at(-1)} numbers in brackets, such as ${key} = [${Array(counts[key].at(-1)).fill(1).join(', ')}]`);
  return values;
}

function check({ size, focal, orientation }, fail) {
  if (!size.every((n) => Number.isInteger(n) && n >= 16 && n <= 16384)) fail("'size' expects whole numbers of pixels from 16 to 16384");
  if (!focal.every((n) => n >= 1 && n <= 1e6)) fail("'focal' expects pixels from 1 to 1e6");
  if (Math.abs(Math.hypot(...orientation) - 1) > 1e-3) fail("'orientation' expects a unit quaternion [x, y, z, w]");
}

function cameraOf(section, fail) {
  for (const key of ['name', 'size', 'focal', 'position']) if (!(key in section)) fail(`'${key}' is missing in [[camera]]`);
  for (const [key, fallback] of Object.entries(optional)) section[key] ??= fallback(section);
  check(section, fail);
  const { name, size, focal, center, distortion, position, orientation } = section, norm = Math.hypot(...orientation);
  return { name, size, focal, center, distortion: [...distortion, 0, 0, 0, 0, 0, 0, 0, 0].slice(0, 8), fisheye: false, p: position, axes: axesOf(orientation.map((v) => v / norm)) };
}

/**
 * Returns the cameras of a file in the form of /scene.json: {name, size, focal, center, distortion, fisheye, p,
 * axes}. @param file its name, for errors  @throws Error for users, with the line
 */
export function readCalibration(file, text) {
  const cameras = [];
  let section = null, begin = 0;
  const failAt = (line) => (what) => { throw new Error(`${file}:${line}: ${what} (docs/vps.md describes the file)`); };
  const close = () => { if (section) cameras.push(cameraOf(section, failAt(begin))); section = null; };
  for (const [line, number] of statements(text)) {
    const fail = failAt(number), pair = /^([\w-]+)\s*=\s*(.+)$/.exec(line);
    if (line.startsWith('[')) {
      close();
      if (line === '[[camera]]') [section, begin] = [{}, number];
      if (cameras.length >= mostCameras) fail(`has more than ${mostCameras} cameras`);
    } else if (!pair) {
      fail(`'${line.slice(0, 40)}' is neither KEY = VALUE nor a section`);
    } else if (section && pair[1] === 'name') {
      section.name = /^"([\w-]{1,64})"$/.exec(pair[2])?.[1] ?? fail("'name' expects letters, digits, '_' and '-' in quotes");
    } else if (section && pair[1] in counts) {
      section[pair[1]] = numbersOf(pair[2], pair[1], fail);
    }
  }
  close();
  if (cameras.length === 0) failAt(1)('has no camera; expected a [[camera]] section for each');
  return cameras;
}
