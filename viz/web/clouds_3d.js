// Echoes of lidars and lasers in the three-dimensional view, as the newest message of each sensor has them.

import { isDark, theme } from './theme.js';

// Viridis, approximated by polynomials; on white paper without its light end. Heights, or intensities of 0 to 1.
const vertexShader = `
  attribute float strength;
  uniform float low, high, byIntensity, brightest, size;
  varying vec3 tone;
  vec3 viridis(float t) {
    const vec3 c0 = vec3(.278, .005, .334), c1 = vec3(.105, 1.405, 1.385), c2 = vec3(-.331, .215, .095), c3 = vec3(-4.634, -5.799, -19.332), c4 = vec3(6.228, 14.180, 56.691), c5 = vec3(4.776, -13.745, -65.353), c6 = vec3(-5.435, 4.646, 26.312);
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
  }
  void main() {
    float share = byIntensity > 0.5 ? strength : (position.z - low) / (high - low);
    tone = strength < 0.0 && byIntensity > 0.5 ? vec3(.5) : viridis(brightest * clamp(share, 0.0, 1.0));
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
  }`;
const fragmentShader = 'varying vec3 tone; void main() { gl_FragColor = vec4(tone, 1.0); }';
const mostRays = 180;  // drawn per laser

export class Clouds {
  #THREE; #root; #bySensor = new Map(); #look; #rays; #time = -Infinity; #share = 1;
  stride = 1; counts = { updates: 0, points: 0 };  // of all messages; of those shown

  constructor(THREE, root) {
    this.#THREE = THREE;
    this.#root = root;
    this.#look = new THREE.ShaderMaterial({ vertexShader, fragmentShader, uniforms: { low: { value: 0 }, high: { value: 1 }, byIntensity: { value: 0 }, brightest: { value: 1 }, size: { value: 2.5 } } });
    this.#rays = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.3 });
  }

  /** @param size of points [px of the device] */
  style({ byIntensity, size }) {
    this.#look.uniforms.size.value = size;
    this.#look.uniforms.byIntensity.value = byIntensity ? 1 : 0;
    this.#look.uniforms.brightest.value = isDark() ? 1 : 0.82;
    this.#rays.color.set(theme.view);
  }
  /** [m] of the colours' ends. */
  heights() { return [this.#look.uniforms.low.value, this.#look.uniforms.high.value]; }

  clear() {
    for (const { points, rays } of this.#bySensor.values()) this.#drop(points, rays);
    this.#bySensor.clear();
    this.#time = -Infinity;
  }
  #drop(...objects) {
    for (const object of objects) {
      this.#root.remove(object);
      object?.geometry.dispose();
    }
  }

  /** @param message sensorfarm_msgs/msg/Clouds */
  take(message, time, [ox, oy]) {
    if (time < this.#time) this.clear();
    this.#time = time;
    this.stride = message.stride;
    this.#root.position.set(message.origin[0] - ox, message.origin[1] - oy, message.origin[2]);
    for (const cloud of message.clouds) this.#show(cloud);
    if (message.clouds.length > 0) this.#colorHeights();
    ++this.counts.updates;
    this.counts.points = 0;
    for (const { count } of this.#bySensor.values()) this.counts.points += count;
  }

  #show({ mover, type, sensor, planar, position, points }) {
    const key = `${mover} ${type} ${sensor}`;
    let shown = this.#bySensor.get(key);
    if (!shown || shown.buffer.array.length < points.length) {
      if (shown) this.#drop(shown.points, shown.rays);
      this.#bySensor.set(key, (shown = this.#make(Math.max(64, 1.25 * points.length), planar)));
    }
    const count = points.length / 4, drawn = Math.ceil(this.#share * count);
    Object.assign(shown, { mover, count, drawn });
    shown.buffer.array.set(points);
    if (drawn > 0) shown.buffer.updateRange.count = 4 * drawn;  // numbers that are sent to the GPU
    shown.buffer.needsUpdate = true;
    if (shown.rays) this.#showRays(shown, position, points);
  }

  #make(numbers, planar) {
    const THREE = this.#THREE, geometry = new THREE.BufferGeometry();
    const buffer = new THREE.InterleavedBuffer(new Float32Array(4 * Math.ceil(numbers / 4)), 4).setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute('position', new THREE.InterleavedBufferAttribute(buffer, 3, 0));
    geometry.setAttribute('strength', new THREE.InterleavedBufferAttribute(buffer, 1, 3));
    const points = new THREE.Points(geometry, this.#look);
    let rays = null;
    if (planar) {
      const lines = new THREE.BufferGeometry();
      lines.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6 * mostRays), 3).setUsage(THREE.DynamicDrawUsage));
      rays = new THREE.LineSegments(lines, this.#rays);
    }
    for (const object of [points, rays]) if (object) this.#root.add(Object.assign(object, { frustumCulled: false }));
    return { points, rays, buffer };
  }

  #showRays({ rays, count }, position, points) {
    const { position: ends } = rays.geometry.attributes, used = Math.min(count, mostRays);
    for (let i = 0; i < used; ++i) ends.array.set([...position, points[4 * i], points[4 * i + 1], points[4 * i + 2]], 6 * i);
    ends.needsUpdate = true;
    rays.geometry.setDrawRange(0, 2 * used);
  }

  /** The colours follow the heights of the points slowly, so that they do not flicker. */
  #colorHeights() {
    let least = Infinity, most = -Infinity;
    for (const { buffer, count } of this.#bySensor.values()) {
      for (let i = 0; i < count; i += 7) { least = Math.min(least, buffer.array[4 * i + 2]); most = Math.max(most, buffer.array[4 * i + 2]); }
    }
    if (least > most) return;
    const { low, high } = this.#look.uniforms, share = this.counts.updates === 0 ? 1 : 0.1;
    low.value += share * (least - low.value);
    high.value += share * (Math.max(most, least + 0.1) - high.value);
  }

  /**
   * Shows the clouds of robots that are present.
   * @param share of the points of later messages, in (0, 1]: the first ones are spread over the scan
   */
  update(fleet, isOn, share) {
    this.#share = share;
    for (const { mover, points, rays, drawn } of this.#bySensor.values()) {
      for (const object of [points, rays]) if (object) object.visible = isOn && !fleet.absent[mover];
      points.geometry.setDrawRange(0, drawn);
    }
  }
}
