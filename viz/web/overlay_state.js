// The state of a run at the time of an image: poses in six degrees of freedom, and the scans nearest in time.

import { transformOf } from './rigid.js';

const kept = 16;  // messages

export class OverlayState {
  #tilts = []; #clouds = new Map();  // {time, tilts}; by sensor: {time, cloud, origin}, oldest first

  constructor(fleet) { this.fleet = fleet; }
  clear() { this.#tilts = []; this.#clouds.clear(); }

  /** @param message sensorfarm_msgs/msg/Clouds */
  take({ origin, stride, tilts, clouds }, time) {
    if (time < (this.#tilts.at(-1)?.time ?? -Infinity)) this.clear();  // the run was restarted
    this.stride = stride;
    this.#tilts.push({ time, tilts: new Map(tilts.map((tilt) => [tilt.mover, tilt])) });
    if (this.#tilts.length > kept) this.#tilts.shift();
    for (const cloud of clouds) {
      const key = `${cloud.mover} ${cloud.type} ${cloud.sensor}`, queue = this.#clouds.get(key) ?? [];
      queue.push({ time, origin, ...cloud });
      if (queue.length > kept) queue.shift();
      this.#clouds.set(key, queue);
    }
  }

  #tiltAt(row, time) {
    const after = this.#tilts.find((each) => each.time >= time - 1e-6) ?? this.#tilts.at(-1), before = this.#tilts[this.#tilts.indexOf(after) - 1];
    const of = (each) => each?.tilts.get(row) ?? { roll: 0, pitch: 0 }, a = of(after), b = of(before ?? after);
    const share = before && after.time > before.time ? Math.min(1, Math.max(0, (after.time - time) / (after.time - before.time))) : 0;
    return { roll: a.roll + share * (b.roll - a.roll), pitch: a.pitch + share * (b.pitch - a.pitch) };
  }

  /** Pose X_WM of a robot, interpolated between updates; null: absent. `late`: [s] from its state to `time`, if that is newer than all. */
  poseAt(row, time) {
    const { fleet } = this;
    if (fleet.absent[row] || !fleet.states[row]) return null;
    const pose = fleet.poseAt(row, time), at = pose ?? [fleet.x[row], fleet.y[row], fleet.yaw[row], fleet.states[row].pose.z];
    return { ...transformOf(at, this.#tiltAt(row, time)), late: pose ? 0 : time - fleet.time };
  }

  /** The cloud of each sensor of a robot, -1: of all robots, that is nearest in time. */
  cloudsAt(row, time) {
    const found = [];
    for (const queue of this.#clouds.values()) {
      if (row >= 0 && queue[0].mover !== row) continue;
      found.push(queue.reduce((best, each) => (Math.abs(each.time - time) <= Math.abs(best.time - time) ? each : best)));
    }
    return found.filter(({ mover }) => !this.fleet.absent[mover]);
  }
}
