// The list of robots, and the readings of the selected one.

import { Picture } from './picture.js';
import { History, plotBars, plotHistory, short } from './plot.js';

const listed = 200;  // at a time; the search finds more
const units = [['_rad_s', 'rad/s'], ['_m', 'm'], ['_T', 'T'], ['_t', 'T'], ['_s', 's'], ['_counts', 'counts']];

/** 'distance_m' as ['distance', 'm']. */
function named(column) {
  for (const [end, unit] of units) if (column.endsWith(end)) return [column.slice(0, -end.length).replaceAll('_', ' '), unit];
  return [column.replaceAll('_', ' '), ''];
}

function element(tag, props = {}, ...children) {
  const made = Object.assign(document.createElement(tag), props);
  made.append(...children);
  return made;
}

/** A reading's quantities over time: the minimum of lists, the length of vectors. */
function quantities(type) {
  if (type.scan) return [{ label: 'nearest echo', unit: 'm', of: (m) => least(m.ranges) }, { label: 'beam ahead', unit: 'm', of: (m) => m.ranges[m.ranges.length >> 1] }];
  return type.columns.map(({ name, width }) => {
    const field = name.toLowerCase(), [label, unit] = named(name);
    if (type.list) return { label: width > 1 ? `${label}, longest` : `${label}, least`, unit, of: (m) => (width > 1 ? longest(m[field], width) : least(m[field])) };
    return { label, unit, of: (m) => (width > 1 ? longest(m[field], width) : Number(m[field])) };
  });
}
function least(list) {
  let found = Infinity;
  for (const value of list) if (value < found) found = value;
  return found;
}
function longest(list, width) {
  let found = 0;
  for (let i = 0; i + width <= list.length; i += width) found = Math.max(found, Math.hypot(...list.slice(i, i + width)));
  return found;
}

/**
 * Ranges without an echo are infinite in scans and `most` in other readings; ranges of surfaces that are too near are
 * -infinite (REP 117). @param most range_max of a range; undefined: the value is not a range
 */
function valueText(value, unit, most) {
  if (most !== undefined && value === -Infinity) return 'too near';
  return value >= most ? 'no echo' : `${short(value)} ${unit}`.trim();
}

class Card {
  constructor(sensor, type, waiting) {
    this.sensor = sensor;
    this.waiting = waiting;
    this.type = type;
    this.quantities = quantities({ ...type, columns: type.columns.slice(0, sensor.columns) });
    this.histories = this.quantities.map(() => new History());
    this.rows = element('dl');
    this.plot = element('canvas', { className: 'plot' });
    this.bars = type.scan || (type.list && sensor.type !== 'occupancy') ? element('canvas', { className: 'bars' }) : null;
    const choose = element('select', { ariaLabel: `Quantity of ${sensor.name} to plot` }, ...this.quantities.map(({ label }, i) => element('option', { value: i, textContent: label })));
    choose.onchange = () => { this.chosen = Number(choose.value); this.draw(); };
    this.chosen = 0;
    const title = element('h3', {}, element('span', { textContent: sensor.name }), element('small', { textContent: `${sensor.type}, ${short(sensor.rate).replace(/\.?0+$/, '')} Hz` }));
    this.root = element('div', { className: 'card' }, title, this.rows);
    if (this.bars) this.root.append(this.bars);
    if (sensor.type === 'occupancy') return;
    if (this.quantities.length > 1) this.root.append(element('div', { className: 'choose' }, element('span', { textContent: 'Plot' }), choose));
    this.root.append(this.plot);
  }
  update(message, time) {
    this.message = message;
    this.quantities.forEach(({ of }, i) => this.histories[i].add(time, of(message)));
  }
  draw(extra) {
    if (!this.message) { this.rows.replaceChildren(element('dt', { textContent: this.waiting })); return; }
    const isRange = this.type.scan || this.sensor.cones;
    const rows = extra ?? this.quantities.map(({ label, unit, of }) => [label, valueText(of(this.message), unit, isRange && unit === 'm' ? this.sensor.range_max : undefined)]);
    this.rows.replaceChildren(...rows.flatMap(([name, value]) => [element('dt', { textContent: name }), element('dd', { textContent: value })]));
    if (this.plot.isConnected) plotHistory(this.plot, this.histories[this.chosen], this.quantities[this.chosen].unit);
    if (!this.bars) return;
    const values = this.type.scan ? this.message.ranges : this.message[this.type.columns[0].name.toLowerCase()];
    if (values) plotBars(this.bars, Array.from(values), this.sensor.range_max);
  }
}

/** The newest image of a camera. */
class CameraCard {
  constructor(sensor, waiting) {
    const canvas = element('canvas', { className: 'picture', width: 4, height: 3 });
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `Image of ${sensor.name}`);
    this.histories = [];
    this.picture = new Picture(canvas, sensor.camera.range_max);
    this.text = element('small', { textContent: waiting });
    this.root = element('div', { className: 'card' }, element('h3', {}, element('span', { textContent: sensor.name }), this.text), canvas);
  }
  update(message) { this.picture.show(message); }
  draw() { if (this.picture.drawn > 0) this.text.textContent = this.picture.text(); }
}

export class Panel {
  #cards = new Map();
  #rows = [];
  #drawnAt = 0;

  /** @param choose called with the row of a robot, -1: none  @param colorOf returns the colour of a row */
  constructor(scene, choose, colorOf) {
    this.scene = scene;
    this.colorOf = colorOf;
    this.list = document.getElementById('robots');
    this.search = document.getElementById('search');
    this.section = document.getElementById('selected');
    this.choose = choose;
    this.search.oninput = () => this.fill();
    this.search.onkeydown = (event) => { if (event.key === 'Enter' && this.#rows.length > 0) choose(this.#rows[0]); };
    this.list.onkeydown = (event) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (!by || this.#rows.length === 0) return;
      event.preventDefault();
      event.stopPropagation();
      const at = this.#rows.indexOf(this.selected);
      choose(this.#rows[Math.min(this.#rows.length - 1, Math.max(0, at < 0 ? 0 : at + by))]);
    };
    this.selected = -1;
    this.#makeSummary();
    this.fill();
    this.show(-1);
  }

  fill() {
    const wanted = this.search.value.trim().toLowerCase();
    const found = [];
    this.scene.movers.forEach(({ name, id }, row) => { if (!wanted || name.toLowerCase().includes(wanted) || String(id) === wanted) found.push(row); });
    this.#rows = found.slice(0, listed);
    this.list.replaceChildren(...this.#rows.map((row) => this.#item(row)));
    if (found.length > listed) this.list.append(element('li', { className: 'more', textContent: `${found.length - listed} more: type part of the name` }));
    const count = this.scene.movers.length;
    document.getElementById('count').textContent = wanted ? `${found.length} of ${count}` : `${count} ${count === 1 ? 'robot' : 'robots'}`;
  }

  /** Counts of the fleet; a click selects the next counted robot. Commands of robots in other processes are unknown. */
  #makeSummary() {
    const rows = [['contact', 'in contact', (fleet, i) => fleet.inContact(i), 'Robots now stopped by a wall or a robot'], ['outside', 'outside', (fleet, i) => fleet.isOutside(i), 'Robots outside the bounding box of the world']];
    if (this.scene.mode !== 'service') rows.splice(1, 0, ['stuck', 'stuck', (fleet, i) => fleet.isStuck(i), 'Robots commanded to move that have hardly moved for 3 s of simulated time']);
    this.counts = rows.map(([id, text, counts, title]) => {
      const button = element('button', { title, disabled: true, onclick: () => {
        if (button.rows.length > 0) this.choose(button.rows.find((row) => row > this.selected) ?? button.rows[0]);
      } });
      button.dataset.count = id;
      button.rows = [];
      return { button, text, counts };
    });
    document.getElementById('fleet').replaceChildren(...this.counts.map(({ button }) => button));
  }

  summary(now, fleet) {
    if (now - (this.summedAt ?? -1) < 0.25) return;
    this.summedAt = now;
    for (const { button, text, counts } of this.counts) {
      button.rows = [];
      for (let i = 0; i < fleet.count; ++i) if (!this.scene.movers[i].tag && counts(fleet, i)) button.rows.push(i);
      const label = `${button.rows.length} ${text}`;
      if (button.textContent === label) continue;
      button.textContent = label;
      button.disabled = button.rows.length === 0;
    }
  }

  #item(row) {
    const { name, tag } = this.scene.movers[row];
    const mark = element('span', { className: 'mark' });
    mark.style.background = this.colorOf(row);
    const item = element('li', { onclick: () => this.choose(row) }, mark, element('span', { textContent: name }));
    item.setAttribute('role', 'option');
    item.setAttribute('aria-selected', String(row === this.selected));
    item.dataset.row = row;
    if (tag) item.append(element('span', { className: 'more', textContent: 'tag' }));
    return item;
  }

  /** @param row of the robot, -1: none */
  show(row, actions = []) {
    this.selected = row;
    for (const item of this.list.children) {
      if (item.dataset.row === undefined) continue;
      const is = Number(item.dataset.row) === row;
      item.setAttribute('aria-selected', String(is));
      if (is) item.scrollIntoView({ block: 'nearest' });
    }
    this.#cards.clear();
    if (row < 0) {
      this.section.replaceChildren(element('p', { className: 'hint', textContent: 'Click a robot, on the map or in the list, to see its readings.' }));
      return;
    }
    const mover = this.scene.movers[row];
    this.badge = element('span', { className: 'badge', textContent: '✕ contact', hidden: true });
    this.state = element('dl');
    this.speed = new History();
    this.speedPlot = element('canvas', { className: 'plot' });
    this.section.replaceChildren(
      element('div', { className: 'head' }, element('h2', { textContent: mover.name }), this.badge, ...actions),
      element('div', { className: 'card' }, element('h3', {}, element('span', { textContent: 'State' }), element('small', { textContent: `id ${mover.id}` })), this.state, this.speedPlot));
    for (const sensor of mover.sensors) {
      const waiting = this.scene.readings ? 'waiting for a reading' : 'not recorded (run --record-readings)';
      const card = sensor.camera ? new CameraCard(sensor, waiting) : new Card(sensor, this.scene.types[sensor.type] ?? { columns: [], list: '' }, waiting);
      this.#cards.set(sensor.topic, card);
      this.section.append(card.root);
    }
    this.dirty = true;
  }

  /** The image of a camera of the selected robot; undefined: the sensor is no camera. @param topic of the sensor */
  picture(topic) { return this.#cards.get(topic)?.picture; }

  reading(topic, message, time) {
    this.#cards.get(topic)?.update(message, time);
    this.dirty = true;
  }

  moved(state, time) {
    if (!state) return;
    this.last = state;
    this.speed?.add(time, state.velocity.forward);
    this.dirty = true;
  }

  clear() {
    this.speed?.clear();
    for (const card of this.#cards.values()) card.histories.forEach((history) => history.clear());
  }

  /** Updates at most ten times a second, since people do not read faster. @param maps by topic */
  draw(now, maps) {
    if (!this.dirty || this.selected < 0 || now - this.#drawnAt < 0.1) return;
    this.#drawnAt = now;
    this.dirty = false;
    if (this.last) {
      const { pose, velocity, command, contact } = this.last, degrees = (180 / Math.PI) * pose.yaw;
      this.badge.hidden = !contact;
      const rows = [['position', `${short(pose.x)}, ${short(pose.y)} m`], ['heading', `${(degrees - 360 * Math.round(degrees / 360)).toFixed(1).replace('-', '−')}°`], ['speed', `${short(velocity.forward)} m/s`], ['turn', `${short(velocity.turn)} rad/s`], ['commanded', `${short(command.forward)} m/s, ${short(command.turn)} rad/s`]];
      this.state.replaceChildren(...rows.flatMap(([name, value]) => [element('dt', { textContent: name }), element('dd', { textContent: value })]));
      plotHistory(this.speedPlot, this.speed, 'm/s');
    }
    for (const [topic, card] of this.#cards) {
      const map = maps.get(topic);
      card.draw(map && [['cells occupied', String(map.cells.occupied)], ['cells free', String(map.cells.free)]]);
    }
  }
}
