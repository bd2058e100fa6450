// Geometry of the three-dimensional view: static surfaces, prisms of bodies, the floor.

import { theme } from './theme.js';

const opacities = { passable: 0.5, overhead: 0.5, unseen: 0.12 };

export function material(THREE, color, kind) {
  const opacity = opacities[kind] ?? 1;
  return new THREE.MeshPhongMaterial({ color, opacity, transparent: opacity < 1, depthWrite: opacity === 1, side: THREE.DoubleSide, flatShading: true, shininess: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });  // echoes and markings lie in front of their surfaces
}

export function geometryOf(THREE, vertices, corners) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(vertices), 3));
  if (corners) geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(corners), 1));
  return geometry;
}

/** Two triangles per side of a line [x, y, x, y, ...]. */
function addSides(vertices, line, low, high) {
  for (let k = 0; k + 3 < line.length; k += 2) {
    const [ax, ay, bx, by] = line.slice(k, k + 4);
    vertices.push(ax, ay, low, bx, by, low, bx, by, high, ax, ay, low, bx, by, high, ax, ay, high);
  }
}

/** The area of a closed line at a height, as triangles. */
function addArea(THREE, vertices, line, z) {
  const points = [];
  for (let k = 0; k + 1 < line.length; k += 2) points.push(new THREE.Vector2(line[k], line[k + 1]));
  if (points.length > 1 && points[0].equals(points[points.length - 1])) points.pop();
  if (points.length < 3) return;
  for (const corners of THREE.ShapeUtils.triangulateShape(points, [])) for (const i of corners) vertices.push(points[i].x, points[i].y, z);
}

/** The outlines of a body (`shapes` of /scene.json) as prisms, and their top; those of a mesh are left out. */
export function prisms(THREE, { closed, closed_z, open, open_z }, radius) {
  const vertices = [];
  let top = 0, isMesh = false;
  for (const [lines, heights, isClosed] of [[closed, closed_z, true], [open, open_z, false]]) {
    lines.forEach((line, i) => {
      const [low, high, mesh] = heights[i];
      top = Math.max(top, high);
      isMesh ||= mesh === 1;
      if (mesh) return;
      addSides(vertices, line, low, high);
      if (isClosed) for (const z of [low, high]) addArea(THREE, vertices, line, z);
    });
  }
  if (closed.length + open.length > 0) return { vertices, top, isMesh };
  const circle = [];
  for (let k = 0; k <= 16; ++k) circle.push(radius * Math.cos(k * Math.PI / 8), radius * Math.sin(k * Math.PI / 8));
  return prisms(THREE, { closed: [circle], closed_z: [[0, radius, 0]], open: [], open_z: [] });
}

/** Bands along lane markings by colour, just above the floor or their road. */
function addMarkings(THREE, root, { markings, origin: [ox, oy] }) {
  const byColor = new Map();
  for (const { line, width, color, z = 0 } of markings) {
    if (!byColor.has(color)) byColor.set(color, []);
    const vertices = byColor.get(color), high = z + 0.01;
    for (let k = 0; k + 3 < line.length; k += 2) {
      const ax = line[k] - ox, ay = line[k + 1] - oy, bx = line[k + 2] - ox, by = line[k + 3] - oy;
      const half = 0.5 * width / (Math.hypot(bx - ax, by - ay) || 1), nx = half * (ay - by), ny = half * (bx - ax);
      vertices.push(ax + nx, ay + ny, high, ax - nx, ay - ny, high, bx - nx, by - ny, high, ax + nx, ay + ny, high, bx - nx, by - ny, high, bx + nx, by + ny, high);
    }
  }
  for (const [color, vertices] of byColor) root.add(new THREE.Mesh(geometryOf(THREE, vertices), new THREE.MeshBasicMaterial({ color, side: THREE.DoubleSide })));
}

/** A grid on the floor in round steps, a little larger than the world, and the holes of the floor. */
export function addFloor(THREE, root, scene) {
  const [x0, y0, x1, y1] = scene.extent, [ox, oy] = scene.origin, size = Math.max(x1 - x0, y1 - y0, 1);
  const power = 10 ** Math.floor(Math.log10(size / 20)), step = power * [1, 2, 5, 10].find((digit) => digit * power >= size / 20);
  const low = (v, o) => Math.floor(v / step - 1) * step - o, high = (v, o) => Math.ceil(v / step + 1) * step - o;
  const left = low(x0, ox), right = high(x1, ox), bottom = low(y0, oy), top = high(y1, oy), lines = [];
  for (let x = left; x <= right + step / 2; x += step) lines.push(x, bottom, 0, x, top, 0);
  for (let y = bottom; y <= top + step / 2; y += step) lines.push(left, y, 0, right, y, 0);
  root.add(new THREE.LineSegments(geometryOf(THREE, lines), new THREE.LineBasicMaterial({ color: theme.quiet, transparent: true, opacity: 0.3 })));
  addMarkings(THREE, root, scene);
  const holes = [];
  for (const outline of scene.holes) addArea(THREE, holes, outline.map((v, k) => v - (k % 2 ? oy : ox)), 0.002);
  if (holes.length > 0) root.add(new THREE.Mesh(geometryOf(THREE, holes), new THREE.MeshBasicMaterial({ color: theme.hole, side: THREE.DoubleSide })));
}
