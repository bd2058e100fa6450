// The three-dimensional view. It needs three.js, which the server has if the program was built with it, and WebGL.

import { Bodies, poseMatrix } from './bodies_3d.js';
import { Clouds } from './clouds_3d.js';
import { Orbit, fov } from './orbit.js';
import { addFloor, geometryOf, material } from './solids_3d.js';
import { theme } from './theme.js';

const cloudTopic = '/view_3d/clouds', solidTopic = '/view_3d/solids', nobody = 0xffffffff;

function loadThree() {
  return new Promise((resolve, reject) => {
    const script = document.createElement('script');
    script.src = 'three.js';
    script.onload = () => resolve(window.THREE);
    script.onerror = () => reject(new Error('This program was built without three.js (Debian: libjs-three): it has the plan view only.'));
    document.head.append(script);
  });
}

/** Without a GPU, smooth edges take two thirds of a frame's time, and half of the pixels most of the rest. */
function isSoftware() {
  const gl = document.createElement('canvas').getContext('webgl'), named = gl?.getExtension('WEBGL_debug_renderer_info');
  return /swiftshader|llvmpipe|software/i.test(named ? gl.getParameter(named.UNMASKED_RENDERER_WEBGL) : '');
}

function rendererOn(THREE, canvas) {
  try {
    const isSlow = isSoftware(), renderer = new THREE.WebGLRenderer({ canvas, antialias: !isSlow });
    renderer.setPixelRatio(isSlow ? 0.75 : Math.min(2, window.devicePixelRatio || 1));
    return Object.assign(renderer, { isSlow });
  } catch {
    throw new Error('This browser offers no WebGL: only the plan view is available.');
  }
}

const metres = (height) => (Math.round(10 * height) / 10).toFixed(1).replace('-', '−');
const colorOf = (argb) => (argb === 0 ? theme.wall : '#' + (argb & 0xffffff).toString(16).padStart(6, '0'));

export class View3D {
  orbit = new Orbit();
  drawn = { walls: 0, frames: 0 };
  share = 1;  // of the points received, those drawn
  #THREE; #page; #camera; #root = null; #clouds; #cloudRoot; #bodies; #solids = null; #tilts = new Map(); #last = 0; #waiting = [];

  /** @param page {scene, fleet, drawing}  @throws Error for users if three.js or WebGL is missing */
  static async open(canvas, page) {
    const THREE = await loadThree();
    return new View3D(THREE, rendererOn(THREE, canvas), canvas, page);
  }
  constructor(THREE, renderer, canvas, page) {
    Object.assign(this, { renderer, canvas });
    this.#THREE = THREE;
    this.#page = page;
    this.#camera = new THREE.PerspectiveCamera(fov * 180 / Math.PI, 1, 0.1, 1000);
    this.#camera.up.set(0, 0, 1);
    this.#cloudRoot = new THREE.Group();
    this.#clouds = new Clouds(THREE, this.#cloudRoot);
    this.fit();
    this.restyle();
  }

  get counts() { return this.#clouds.counts; }
  fit() { this.orbit.fit(this.#page.scene.extent, this.#page.scene.origin); }

  /** @param onChange called when something is to be drawn */
  subscribe(connection, onChange) {
    connection.subscribe(cloudTopic, (message, time) => {
      if (time < this.#waiting.at(-1)?.time) this.#waiting = [];  // the run was restarted
      this.#waiting.push({ message, time });
      onChange();
    });
    if (this.#solids) return;
    connection.subscribe(solidTopic, (message) => {
      connection.unsubscribe(solidTopic);  // it comes once
      this.#solids = message;
      this.restyle();
      onChange();
    });
  }
  unsubscribe(connection) {
    connection.unsubscribe(cloudTopic);
    connection.unsubscribe(solidTopic);
    this.#clouds.clear();
    this.#waiting = [];
  }

  /** True if clouds wait for the robots, which are shown on their way to the newest states. */
  get isWaiting() { return this.#waiting.length > 0; }
  #takeWaiting() {
    const { fleet, scene } = this.#page, most = 4;
    while (this.isWaiting && (this.#waiting[0].time <= fleet.shownTime + 1e-6 || this.#waiting.length > most)) {
      const { message, time } = this.#waiting.shift();
      this.#tilts = new Map(message.tilts.map((tilt) => [tilt.mover, tilt]));
      this.#clouds.take(message, time, scene.origin);
    }
  }

  /** Builds everything that has colours or shapes again. */
  restyle() {
    const THREE = this.#THREE, { scene, fleet, drawing } = this.#page, solids = this.#solids?.solids ?? [];
    this.#root?.remove(this.#cloudRoot);
    this.#root?.traverse((object) => { object.geometry?.dispose(); object.material?.dispose(); });
    this.#root = new THREE.Scene();
    this.#root.background = new THREE.Color(theme.paper);
    const sun = new THREE.DirectionalLight(0xffffff, 0.6);
    sun.position.set(0.4, -0.7, 1);
    this.#root.add(sun, new THREE.HemisphereLight(0xffffff, 0x999999, 0.65), this.#cloudRoot);
    addFloor(THREE, this.#root, scene);
    this.#bodies = new Bodies(THREE, this.#root, { scene, fleet, colors: drawing.colors, solids });
    this.drawn.walls = 0;
    for (const solid of solids) this.#addStatic(solid);
  }

  #addStatic({ kind, vertices, corners, places }) {
    const [ox, oy] = this.#page.scene.origin, geometry = geometryOf(this.#THREE, vertices, corners);
    for (const { mover, pose, color } of places) {
      if (mover !== nobody) continue;
      const mesh = new this.#THREE.Mesh(geometry, material(this.#THREE, colorOf(color), kind));
      mesh.applyMatrix(poseMatrix(this.#THREE, { ...pose, x: pose.x - ox, y: pose.y - oy }));
      this.#root.add(mesh);
      this.drawn.walls += corners.length / 3;
    }
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.#camera.aspect = clientWidth / clientHeight;
    this.orbit.resize(clientHeight);
  }

  follow(row) {
    const { fleet, scene: { origin } } = this.#page;
    this.orbit.target = [fleet.shownX[row] - origin[0], fleet.shownY[row] - origin[1], fleet.states[row]?.pose.z ?? 0];
  }

  frame() {
    const { fleet, drawing } = this.#page;
    this.#takeWaiting();
    this.#bodies.update(fleet, this.#tilts, drawing.selected);
    this.#clouds.style({ byIntensity: drawing.layers.intensity, size: 2.2 * this.renderer.getPixelRatio() });
    this.#adapt(performance.now());
    this.#clouds.update(fleet, drawing.layers.clouds, this.share);
    Object.assign(this.#camera, { near: this.orbit.distance / 200, far: 50 * this.orbit.distance + 1000 });
    this.#camera.position.set(...this.orbit.eye());
    this.#camera.lookAt(...this.orbit.target);
    this.#camera.updateProjectionMatrix();
    this.renderer.render(this.#root, this.#camera);
    ++this.drawn.frames;
  }

  /** A renderer without a GPU gets 30 frames/s to draw: more would leave no time for messages. */
  isDue() { return !this.renderer.isSlow || performance.now() - this.#last > 31; }

  /** Draws fewer points where frames take more than a thirtieth of a second, and all where they take less. */
  #adapt(now) {
    const took = now - this.#last;
    this.#last = now;
    if (took < 500) this.share = Math.min(1, Math.max(0.1, this.share * (took > 40 ? 0.93 : took < 30 ? 1.03 : 1)));
  }

  /** Returns the present robot nearest to a pixel, within 24 px of its middle; -1: none. */
  pick(px, py) {
    const { fleet, scene: { origin } } = this.#page, { clientWidth, clientHeight } = this.canvas;
    let best = -1, least = 24;
    for (let row = 0; row < fleet.count; ++row) {
      if (fleet.absent[row]) continue;
      const at = new this.#THREE.Vector3(fleet.shownX[row] - origin[0], fleet.shownY[row] - origin[1], fleet.states[row]?.pose.z ?? 0).project(this.#camera);
      const distance = at.z > 1 ? Infinity : Math.hypot((at.x + 1) / 2 * clientWidth - px, (1 - at.y) / 2 * clientHeight - py);
      if (distance < least) { least = distance; best = row; }
    }
    return best;
  }

  /** What the colours mean, and what is left out. */
  notes() {
    const { layers } = this.#page.drawing, [low, high] = this.#clouds.heights(), { points } = this.counts, notes = [];
    if (layers.clouds && points > 0) {
      notes.push(layers.intensity ? 'Points: intensity, dark 0 to light 1; grey: not reported' : `Points: height, dark ${metres(low)} to light ${metres(high)} m`);
      if (this.#clouds.stride > 1) notes.push(`Sent: one in ${this.#clouds.stride} beams`);
      if (this.share < 0.95) notes.push(`Drawn: ${Math.round(100 * this.share)} % of them, as fast as this browser can`);
    }
    if (this.#solids?.note) notes.push(`Shown: ${this.#solids.note}`);
    return notes.join('. ');
  }
}
