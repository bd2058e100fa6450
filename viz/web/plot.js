// Small plots: a quantity over the last minute, and the elements of a reading.

import { theme, fade } from './theme.js';

const span = 60;  // [s] simulated
const kept = 2000;

/** Samples of one quantity. */
export class History {
  times = []; values = [];
  add(time, value) {
    if (this.times.length > 0 && time < this.times[this.times.length - 1]) this.clear();
    this.times.push(time);
    this.values.push(value);
    if (this.times.length > kept) { this.times.splice(0, kept / 4); this.values.splice(0, kept / 4); }
  }
  clear() { this.times = []; this.values = []; }
}

function prepare(canvas) {
  const ratio = Math.min(2, window.devicePixelRatio || 1), width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
  const c = canvas.getContext('2d');
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  return { c, width, height };
}

export function short(value) {
  if (!Number.isFinite(value)) return value > 0 ? '∞' : value < 0 ? '−∞' : '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2).replace('-', '−').replace('e+', 'e');
  return (size >= 1000 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : value.toFixed(3)).replace('-', '−');
}

export function plotHistory(canvas, history, unit) {
  const { c, width, height } = prepare(canvas);
  if (width === 0) return;
  const { times, values } = history, end = times.length ? times[times.length - 1] : 0, begin = Math.max(times.length ? times[0] : 0, end - span);
  let low = Infinity, high = -Infinity, whole = true;
  for (let i = times.length - 1; i >= 0 && times[i] >= begin; --i) {
    if (!Number.isFinite(values[i])) continue;
    low = Math.min(low, values[i]); high = Math.max(high, values[i]);
    whole = whole && Number.isInteger(values[i]);
  }
  c.font = '11px system-ui, "DejaVu Sans", sans-serif';
  c.fillStyle = theme.quiet;
  c.textBaseline = 'middle';
  if (low > high) { c.textAlign = 'center'; c.fillText('no value yet', width / 2, height / 2); return; }
  const flat = high - low < 1e-9 * Math.max(1, Math.abs(high));
  if (flat) { const half = whole ? 1 : Math.max(Math.abs(high) * 0.05, 1e-3); low -= half; high += half; }
  const label = (v) => whole && Math.abs(v) < 1e6 ? String(v).replace('-', '−') : short(v);
  const left = 50, right = width - 4, top = 7, bottom = height - 14;
  const x = (t) => left + (right - left) * (end > begin ? (t - begin) / (end - begin) : 1), y = (v) => bottom - (bottom - top) * (v - low) / (high - low);
  c.strokeStyle = theme.grid;
  c.lineWidth = 1;
  c.beginPath();
  for (const at of [top, (top + bottom) / 2, bottom]) { c.moveTo(left, Math.round(at) + 0.5); c.lineTo(right, Math.round(at) + 0.5); }
  c.stroke();
  c.textAlign = 'right';
  c.fillText(label(high), left - 5, top);
  c.fillText(label(low), left - 5, bottom);
  c.textAlign = 'left';
  c.fillText(`−${(end - begin).toFixed(0)} s`, left, height - 5);
  c.textAlign = 'right';
  c.fillText(unit ? `now, ${unit}` : 'now', right, height - 5);
  c.strokeStyle = theme.curve;
  c.lineWidth = 1.6;
  c.lineJoin = 'round';
  c.beginPath();
  let open = false, last = 0;
  for (let i = 0; i < times.length; ++i) {
    if (times[i] < begin) continue;
    if (!Number.isFinite(values[i])) { open = false; continue; }
    if (open && whole) c.lineTo(x(times[i]), y(last));  // an integer lasts until the next one
    c[open ? 'lineTo' : 'moveTo'](x(times[i]), y(values[i]));
    open = true;
    last = values[i];
  }
  c.stroke();
}

/** Draws one bar per element, with its index if there is room. */
export function plotBars(canvas, values, most) {
  const { c, width, height } = prepare(canvas);
  const count = values.length, room = width / count, gap = room > 6 ? 2 : 0;
  const limit = most || Math.max(1e-12, ...values.filter(Number.isFinite).map(Math.abs));
  const floor = room > 14 ? height - 12 : height;
  c.fillStyle = fade(theme.bar, 0.16);
  c.fillRect(0, 0, width, floor);
  c.fillStyle = theme.view;
  for (let i = 0; i < count; ++i) {
    if (!Number.isFinite(values[i])) continue;
    const tall = Math.max(1, floor * Math.min(1, Math.abs(values[i]) / limit));
    c.fillRect(i * room + gap / 2, floor - tall, Math.max(0.6, room - gap), tall);
  }
  if (floor === height) return;
  c.font = '10px system-ui, "DejaVu Sans", sans-serif';
  c.fillStyle = theme.quiet;
  c.textAlign = 'center';
  c.textBaseline = 'bottom';
  for (let i = 0; i < count; ++i) c.fillText(String(i), (i + 0.5) * room, height);
}
