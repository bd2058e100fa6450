// States of all robots: the newest, the interpolated ones that are shown, and trails.

const snapDistance = 2;  // [m] between two updates: larger steps are teleports
const longestGap = 0.6;  // [s] of real time between updates that are interpolated
const longestStep = 0.25;  // [s] simulated: no interpolation between states that are farther apart
const past = 16;  // updates kept for readings measured at their times
const stuckAfter = 3;    // [s] simulated

/** True if the robot is commanded to move but hardly does: below a tenth of its command, 1 cm/s and 0.02 rad/s. */
function isHeld({ velocity, command }) {
  const drives = Math.hypot(command.forward, command.left), turns = Math.abs(command.turn);
  if (drives < 0.02 && turns < 0.05) return false;
  return Math.hypot(velocity.forward, velocity.left) < Math.max(0.01, 0.1 * drives) && Math.abs(velocity.turn) < Math.max(0.02, 0.1 * turns);
}

const shortestTurn = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

export class Fleet {
  constructor(scene) {
    this.count = scene.movers.length;
    const make = () => new Float64Array(this.count);
    this.x = make(); this.y = make(); this.yaw = make();           // newest
    this.fromX = make(); this.fromY = make(); this.fromYaw = make();
    this.shownX = make(); this.shownY = make(); this.shownYaw = make();
    this.absent = new Uint8Array(this.count).fill(1);
    this.contact = new Uint8Array(this.count);
    this.states = new Array(this.count);
    this.heldSince = new Float64Array(this.count).fill(NaN);  // [s] simulated; NaN: it moves, or is at rest as commanded
    this.past = [];       // {time, states} of the last updates, the newest at the end
    this.fromTime = 0;  // [s] simulated, start of the interpolation
    this.shownTime = 0;  // [s] simulated, of the poses shown
    this.extent = scene.extent;
    this.tick = -1;
    this.time = 0;
    this.updates = 0;
    this.length = Math.round(Math.min(400, Math.max(24, 24000 / Math.max(1, this.count))));
    this.trail = new Float32Array(2 * this.length * this.count);
    this.trailCount = new Uint32Array(this.count);
    this.measure(scene);
    this.origin = scene.origin;
  }

  /** Takes the sizes of all movers. */
  measure(scene) { this.radius = scene.movers.map((mover) => Math.max(0.02, mover.radius)); }

  /** @param message sensorfarm_msgs/msg/Fleet  @param now [s] of real time */
  update(message, time, now) {
    const back = time < this.time;
    if (back) {
      this.trailCount.fill(0);
      this.heldSince.fill(NaN);
      this.past = [];
    }
    const gap = this.updates > 0 && !back ? now - this.arrived : longestGap;
    this.duration = gap < longestGap && time - this.time <= longestStep ? gap : 0;
    this.arrived = now;
    this.fromTime = this.duration > 0 ? this.shownTime : time;
    this.time = time;
    this.tick = message.tick;
    ++this.updates;
    const seen = new Uint8Array(this.count);
    for (const state of message.states) this.#take(state, seen);
    for (let i = 0; i < this.count; ++i) if (!seen[i]) this.absent[i] = 1;
    const states = new Array(this.count);
    for (const state of message.states) if (!Number.isNaN(state.pose.x)) states[state.mover] = state;
    this.past.push({ time, states });
    if (this.past.length > past) this.past.shift();
  }

  /** Drops updates before a jump in time, since they cannot be interpolated with those after it. */
  forget() {
    this.past = [];
    this.trailCount.fill(0);
    this.heldSince.fill(NaN);
  }

  /**
   * Returns [x, y, yaw, z] of a robot at a time [s]: interpolated between updates, extrapolated by the twist before the
   * first stored one; null if the time is after the last update.
   */
  poseAt(i, time) {
    const after = this.past.findIndex((update) => update.time >= time - 1e-6), next = this.past[after]?.states[i];
    if (!next) return null;
    const { x, y, yaw, z = 0 } = next.pose, late = Math.max(0, this.past[after].time - time);
    const before = this.past[after - 1], last = before?.states[i]?.pose;
    if (last) {
      const share = late / (this.past[after].time - before.time);
      return [x + share * (last.x - x), y + share * (last.y - y), yaw + share * shortestTurn(last.yaw - yaw), z + share * ((last.z ?? z) - z)];
    }
    const { forward, left, turn } = next.velocity, middle = yaw - 0.5 * late * turn;
    return [x - late * (forward * Math.cos(middle) - left * Math.sin(middle)), y - late * (forward * Math.sin(middle) + left * Math.cos(middle)), yaw - late * turn, z];
  }

  isStuck(i) { return !this.absent[i] && this.time - this.heldSince[i] >= stuckAfter; }
  /** True if the robot is outside of the world's bounding box. */
  isOutside(i) {
    const [x0, y0, x1, y1] = this.extent;
    return !this.absent[i] && (this.x[i] < x0 || this.x[i] > x1 || this.y[i] < y0 || this.y[i] > y1);
  }
  inContact(i) { return !this.absent[i] && this.contact[i] === 1; }

  #take(state, seen) {
    const i = state.mover, { x, y, yaw } = state.pose;
    if (i >= this.count || Number.isNaN(x)) return;
    seen[i] = 1;
    const snap = this.absent[i] || this.duration === 0 || Math.hypot(x - this.x[i], y - this.y[i]) > snapDistance + this.radius[i];
    this.fromX[i] = snap ? x : this.shownX[i];
    this.fromY[i] = snap ? y : this.shownY[i];
    this.fromYaw[i] = snap ? yaw : this.shownYaw[i];
    this.x[i] = x; this.y[i] = y; this.yaw[i] = yaw;
    this.absent[i] = 0;
    this.contact[i] = state.contact ? 1 : 0;
    this.states[i] = state;
    if (!isHeld(state)) this.heldSince[i] = NaN;
    else if (Number.isNaN(this.heldSince[i])) this.heldSince[i] = this.time;
    this.#extendTrail(i, x - this.origin[0], y - this.origin[1]);
  }

  #extendTrail(i, x, y) {
    const base = 2 * this.length * i, count = this.trailCount[i];
    if (count > 0) {
      const last = base + 2 * ((count - 1) % this.length);
      const moved = Math.hypot(this.trail[last] - x, this.trail[last + 1] - y);
      if (moved < 0.4 * this.radius[i]) return;
      if (moved > snapDistance + this.radius[i]) this.trailCount[i] = 0;
    }
    const at = base + 2 * (this.trailCount[i] % this.length);
    this.trail[at] = x;
    this.trail[at + 1] = y;
    ++this.trailCount[i];
  }

  /** Calls `add(x, y, first)` from the oldest point on; coordinates are relative to the scene's origin. */
  eachTrailPoint(i, add) {
    const count = this.trailCount[i], kept = Math.min(count, this.length), base = 2 * this.length * i;
    for (let k = count - kept; k < count; ++k) {
      const at = base + 2 * (k % this.length);
      add(this.trail[at], this.trail[at + 1], k === count - kept);
    }
  }

  /** Advances the shown poses. @return true while they move */
  animate(now) {
    const share = this.duration > 0 ? Math.min(1, (now - this.arrived) / this.duration) : 1;
    this.shownTime = this.fromTime + share * (this.time - this.fromTime);
    for (let i = 0; i < this.count; ++i) {
      this.shownX[i] = this.fromX[i] + share * (this.x[i] - this.fromX[i]);
      this.shownY[i] = this.fromY[i] + share * (this.y[i] - this.fromY[i]);
      this.shownYaw[i] = this.fromYaw[i] + share * shortestTurn(this.yaw[i] - this.fromYaw[i]);
    }
    return share < 1;
  }

  /** Returns the robot nearest to a point, within `reach` [m] of its bounding circle; -1: none. */
  pick(x, y, reach) {
    let best = -1, least = Infinity;
    for (let i = 0; i < this.count; ++i) {
      if (this.absent[i]) continue;
      const distance = Math.hypot(x - this.shownX[i], y - this.shownY[i]) - this.radius[i];
      if (distance < reach && distance < least) { least = distance; best = i; }
    }
    return best;
  }
}
