// Movers in the three-dimensional view: prisms or meshes at their poses with roll and pitch, one draw call per shape and
// colour.

import { headingOn, theme } from './theme.js';
import { geometryOf, material, prisms } from './solids_3d.js';

const level = { roll: 0, pitch: 0 };

/** Rz(yaw) Ry(pitch) Rx(roll), then the translation. */
export function poseMatrix(THREE, { x, y, z, yaw }, { roll, pitch } = level, matrix = new THREE.Matrix4()) {
  return matrix.makeRotationFromEuler(new THREE.Euler(roll, pitch, yaw, 'ZYX')).setPosition(x, y, z);
}

export class Bodies {
  #THREE; #scene; #groups = []; #ring; #pose; #place; #nowhere;

  /** @param colors of the movers  @param solids of /view_3d/solids; may be empty */
  constructor(THREE, root, { scene, fleet, colors, solids }) {
    this.#THREE = THREE;
    this.#scene = scene;
    this.#pose = scene.movers.map(() => new THREE.Matrix4());
    this.#place = new THREE.Matrix4();
    this.#nowhere = new THREE.Matrix4().makeScale(0, 0, 0);
    const made = new Map();  // by shape
    const groups = new Map();  // by shape and color: rows of movers
    scene.movers.forEach(({ shape }, row) => {
      if (!made.has(shape)) made.set(shape, prisms(THREE, scene.shapes[shape], fleet.radius[row]));
      const key = `${shape} ${colors[row]}`;
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(row);
    });
    for (const rows of groups.values()) {
      const { shape } = scene.movers[rows[0]], { vertices, top } = made.get(shape), color = colors[rows[0]], r = fleet.radius[rows[0]];
      if (vertices.length > 0) this.#add(root, geometryOf(THREE, vertices), material(THREE, color), rows);
      const arrow = [0.9 * r, 0, -0.2 * r, 0.45 * r, -0.2 * r, -0.45 * r].flatMap((v, k) => (k % 2 ? [v, top + 0.02 * r] : [v]));
      if (!scene.movers[rows[0]].tag) this.#add(root, geometryOf(THREE, arrow), new THREE.MeshBasicMaterial({ color: headingOn(color), side: THREE.DoubleSide }), rows);
    }
    for (const { vertices, corners, places } of solids) {
      const carried = places.filter(({ mover }) => mover < scene.movers.length && made.get(scene.movers[mover].shape).isMesh);
      for (const color of new Set(carried.map(({ mover }) => colors[mover]))) {
        const same = carried.filter(({ mover }) => colors[mover] === color);
        this.#add(root, geometryOf(THREE, vertices, corners), material(THREE, color), same.map(({ mover }) => mover), same.map(({ pose }) => poseMatrix(THREE, pose)));
      }
    }
    this.#ring = new THREE.Mesh(new THREE.RingBufferGeometry(1.15, 1.35, 48), new THREE.MeshBasicMaterial({ color: theme.selected, side: THREE.DoubleSide }));
    root.add(this.#ring);
  }

  #add(root, geometry, look, rows, places = null) {
    const mesh = new this.#THREE.InstancedMesh(geometry, look, rows.length);
    mesh.frustumCulled = false;  // its bounds would be those of one instance at the origin
    root.add(mesh);
    this.#groups.push({ mesh, rows, places });
  }

  /** @param tilts by mover */
  update(fleet, tilts, selected) {
    const [ox, oy] = this.#scene.origin, heightOf = (row) => fleet.states[row]?.pose.z ?? 0;
    this.#pose.forEach((matrix, row) => poseMatrix(this.#THREE, { x: fleet.shownX[row] - ox, y: fleet.shownY[row] - oy, z: heightOf(row), yaw: fleet.shownYaw[row] }, tilts.get(row), matrix));
    for (const { mesh, rows, places } of this.#groups) {
      rows.forEach((row, k) => {
        const pose = this.#pose[row];
        mesh.setMatrixAt(k, fleet.absent[row] ? this.#nowhere : places ? this.#place.multiplyMatrices(pose, places[k]) : pose);
      });
      mesh.instanceMatrix.needsUpdate = true;
    }
    this.#ring.visible = selected >= 0 && !fleet.absent[selected];
    if (!this.#ring.visible) return;
    this.#ring.position.set(fleet.shownX[selected] - ox, fleet.shownY[selected] - oy, heightOf(selected) + 0.01);
    this.#ring.scale.setScalar(fleet.radius[selected]);
  }
}
