// Readings of the selected robot, each held until the shown robots have reached its time.

import { compose } from './sensors.js';

const longest = 32;  // pending readings per sensor

/**
 * Shows, for each sensor, the reading nearest in time to the shown robots, at the sensor's pose at the measurement.
 * Robots are interpolated towards the newest update, and an update may contain readings newer than its states.
 */
export class HeldReadings {
  #waiting = new Map();  // by topic: {sensor, message, at}, starting with the shown reading
  shown = new Map();  // by topic: {message, at, pose}, the sensor's pose relative to the scene's origin

  clear() {
    this.#waiting.clear();
    this.shown.clear();
  }

  /** @param at [s] simulated time of the measurement */
  add(sensor, message, at) {
    const queue = this.#waiting.get(sensor.topic) ?? [];
    if (queue.length > 0 && at < queue[queue.length - 1].at) queue.length = 0;  // the run was restarted
    queue.push({ sensor, message, at });
    if (queue.length > longest) queue.shift();
    this.#waiting.set(sensor.topic, queue);
  }

  /** @return true if the shown readings changed */
  update(fleet, robot, [ox, oy]) {
    const apart = ({ at }) => Math.abs(at - fleet.shownTime);
    let changed = false;
    for (const [topic, queue] of this.#waiting) {
      while (queue.length > 1 && queue[1].at <= fleet.time + 1e-6 && apart(queue[1]) <= apart(queue[0])) queue.shift();
      const [{ sensor, message, at }] = queue;
      if (this.shown.get(topic)?.message === message) continue;
      const pose = fleet.poseAt(robot, at);
      if (!pose) continue;
      this.shown.set(topic, { message, at, pose: compose([pose[0] - ox, pose[1] - oy, pose[2]], sensor.pose) });
      changed = true;
    }
    return changed;
  }
}
