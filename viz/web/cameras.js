// The page of `vps --view`, with the newest image of each camera and the tags that the cameras see, and of `robot --view`
// and `map --view`, with maps as pictures.

import { Picture } from './picture.js';
import { Connection } from './protocol.js';

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get('token') ?? '';
const imageTopic = /^\/([\w-]+)\/image\/compressed$/;
const remembered = 2;  // [s] after which a tag that is no longer seen leaves the table

const cameras = new Map();  // by name
const tags = new Map();     // by id: {tag, at}, the time of its last sighting [s]
let newest = 0;             // [s] time of the newest tags

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function showStatus(state, text) {
  $('status').dataset.state = state;
  $('status').textContent = text;
}

class CameraImage {
  constructor(name) {
    const canvas = element('canvas', { width: 4, height: 3 });
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `Image of ${name}`);
    const rate = element('small', { textContent: 'waiting for an image' });
    const enlarge = element('button', { textContent: 'Enlarge', onclick: () => enlarge.setAttribute('aria-pressed', String(this.root.classList.toggle('large'))) });
    enlarge.setAttribute('aria-pressed', 'false');
    this.root = element('figure', {}, canvas, element('figcaption', {}, element('b', { textContent: name }), rate, enlarge));
    this.picture = new Picture(canvas);
    this.picture.onDrawn = () => { rate.textContent = this.picture.text(); };
  }
  get drawn() { return this.picture.drawn; }
  get canvas() { return this.picture.canvas; }
}

function addCameras(connection, channels) {
  for (const { topic } of channels) {
    const name = imageTopic.exec(topic)?.[1];
    if (!name) continue;
    if (!cameras.has(name)) cameras.set(name, new CameraImage(name));
    connection.subscribe(topic, (message) => cameras.get(name).picture.show(message));
  }
  $('panel').hidden = !channels.some(({ topic }) => topic === '/tags');
  $('cameras').replaceChildren(...[...cameras.values()].map(({ root }) => root));
}

const minus = (text) => text.replace('-', '−');

function showTags(message, time) {
  newest = time;
  for (const tag of message.tags) tags.set(tag.id, { tag, at: time });
  for (const [id, { at }] of tags) if (time - at > remembered || at > time) tags.delete(id);
  const rows = [...tags.values()].sort((a, b) => a.tag.id - b.tag.id).map(({ tag: { id, pose, velocity, cameras: seenBy }, at }) => {
    const cells = [id, `${minus(pose.x.toFixed(2))}, ${minus(pose.y.toFixed(2))}`, `${minus((pose.yaw * 180 / Math.PI).toFixed(0))}°`, Math.hypot(velocity.forward, velocity.left).toFixed(2), at === time ? seenBy : 0];
    const row = element('tr', {}, ...cells.map((text) => element('td', { textContent: text })));
    row.classList.toggle('lost', at !== time);
    return row;
  });
  $('tags').tBodies[0].replaceChildren(...rows);
  $('clock').textContent = new Date(1000 * time).toLocaleTimeString([], { hour12: false });
}

function connect() {
  const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/${token ? `?token=${encodeURIComponent(token)}` : ''}`;
  const connection = new Connection(url);
  connection.addEventListener('open', () => { $('notice').hidden = true; showStatus('live', 'live'); });
  connection.addEventListener('info', ({ detail }) => {
    $('name').textContent = detail.name.replace(/^sensorfarm: /, '');
    document.title = `${$('name').textContent} – sensor farm`;
  });
  connection.addEventListener('channels', ({ detail }) => addCameras(connection, detail));
  connection.addEventListener('close', () => {
    showStatus('lost', 'not connected');
    $('notice').textContent = 'The program has ended, or the connection was lost. Reconnecting.';
    $('notice').hidden = false;
    setTimeout(connect, 1500);
  });
  connection.subscribe('/tags', showTags);
}

/** The theme that was chosen in the live view of a run, or else the system's. */
function restyle() {
  let chosen = null;
  try { chosen = localStorage.getItem('sensorfarm-theme'); } catch { /* storage is refused */ }
  document.documentElement.dataset.theme = chosen ?? (systemDark.matches ? 'dark' : 'light');
}
const systemDark = matchMedia('(prefers-color-scheme: dark)');
systemDark.onchange = restyle;
restyle();
connect();
window.view = { cameras, tags, get time() { return newest; } };  // for tests
