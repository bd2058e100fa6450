// Readings of the selected robot, each until the robots that are shown have come to its time.

import { compose } from './sensors.js';

const longest = 32;  // readings of one sensor that wait

/**
 * Of each sensor the reading is shown that is nearest to the time of the shown robots, from where its sensor was when it
 * measured: robots are drawn on their way to the newest update, and an update may have readings newer than its states.
 */
export class HeldReadings {
  #waiting = new Map();  // by topic: {sensor, message, at}, the shown one first
  shown = new Map();     // by topic: {message, at, pose}, the sensor's pose from the scene's origin

  clear() {
    this.#waiting.clear();
    this.shown.clear();
  }

  /** @param at [s] simulated time of the measurement */
  add(sensor, message, at) {
    const queue = this.#waiting.get(sensor.topic) ?? [];
    if (queue.length > 0 && at < queue[queue.length - 1].at) queue.length = 0;  // the run began again
    queue.push({ sensor, message, at });
    if (queue.length > longest) queue.shift();
    this.#waiting.set(sensor.topic, queue);
  }

  /** @return true where other readings are shown than before */
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
