// Fleet::advance_mover in kernels, as one loop over the poses that it tests, since kernels contain a copy of each called
// function. Needs fleet_contacts.glsl.

#define SF_STOP_NONE 0
#define SF_STOP_WAITING 1
#define SF_STOP_REFUSED 2

// The pose that is tested next:
#define SF_TEST_STEP 0      // the end of a substep
#define SF_TEST_PART 1      // a part of a refused substep
#define SF_TEST_PUSH 2      // a turn with a push-off
#define SF_TEST_FREE 3      // a place on a path without obstacles, against rivals only
#define SF_TEST_PROPOSED 4  // the proposed place, against rivals only
#define SF_TEST_END 5

/// Returns whether a near mover has a smaller rank and a different place after this round, within reach.
bool is_rival(Path path, int other) {
  if (other < 0) return false;
  const FleetBody own = load_FleetBody(bodies, own_row), its = load_FleetBody(bodies, other);
  return its.rank < own.rank && has_moved(other) &&
         comes_near(path.outline, path.from, path.reach, footprint_at(other), load_FleetPose(proposed_poses, other));
}

bool no_nearer(double after, double before) {
  precise double least_distance = before - 1e-10LF;
  return after >= least_distance;
}

bool is_stopped(Path path, Placed now, Placed next, int other, FleetPose X_WO) {
  const FleetFootprint its = footprint_at(other);
  const dvec2 d = minus(origin_of(X_WO), next.origin);
  precise double apart = next.radius + its.radius;
  precise double square = apart * apart * (1.0LF + 1e-12LF);
  if (dot64(d, d) > square) return false;
  const double after = length64(minus(next.origin, origin_of(X_WO)));
  const double before = length64(minus(now.origin, origin_of(X_WO)));
  const bool nearer = !no_nearer(after, before);
  precise double lift = X_WO.z - now.z;
  if (surely_overlap(path.outline, its, nearer ? after : before, lift)) return nearer;
  const Placed placed = place_footprint(its, X_WO);
  bool touch_next = false, touch_now = false;
  for (int k = 0; may_turn(12u) && k < 2; ++k) {
    if (k == 1 && (nearer || !touch_next)) continue;
    const bool touch = touches(k == 0 ? next : now, placed);
    touch_next = k == 0 ? touch : touch_next;
    touch_now = k == 1 ? touch : false;
  }
  return touch_next && (nearer || !touch_now);
}

/// Returns whether a wall near the whole path refuses the step.
bool meets_wall(Path path, Placed now, Placed next) {
  if (path.outline.count == 0u) return false;
  precise double near_path = path.outline.radius + path.reach;
  precise double near_step = path.outline.radius * (1.0LF + 1e-9LF) + 1e-6LF;
  precise double top = now.z + path.outline.z_max;
  precise double bottom = now.z + path.outline.z_min;
  const dvec4 path_box = box_around(origin_of(path.from), near_path), box = box_around(next.origin, near_step);
  WallWalk walk = WallWalk(0, 0, 0);
  bool refused = false;
  while (may_turn(6u) && !refused && find_wall(walk, box)) {
    const FleetWall wall = load_FleetWall(walls, walk.at);
    const dvec2 a = dvec2(wall.ax, wall.ay), b = dvec2(wall.bx, wall.by);
    const bool counts = boxes_meet(path_box, box_of(wall)) && wall.z_min < top && bottom < wall.z_max;
    if (counts && touches_wall(next, wall))
      refused = !(touches_wall(now, wall) && no_nearer(distance64(next.origin, a, b), distance64(now.origin, a, b)));
    ++walk.at;
  }
  return refused;
}

/// Returns SF_STOP_...; sets `yields` if the pose meets a rival.
int stop_at(Path path, FleetPose from, FleetPose to, bool last, bool obstacles, bool rivals, inout bool yields) {
  const Placed now = place_footprint(path.outline, from), next = place_footprint(path.outline, to);
  int stop = obstacles && meets_wall(path, now, next) ? SF_STOP_REFUSED : SF_STOP_NONE;
  // Near movers at their places at the start of the round, then rivals at their proposed places.
  bool is_later = !obstacles, at_end = is_later && !rivals;
  NearWalk walk = near_movers(path);
  while (may_turn(16u) && !at_end && stop != SF_STOP_REFUSED && !yields) {
    const int other = next_near(path, walk);
    if (other < 0) {
      at_end = is_later || !rivals || stop != SF_STOP_NONE;
      is_later = true;
      walk = near_movers(path);
      continue;
    }
    if (is_later && !is_rival(path, other)) continue;
    FleetPose X_WO = load_FleetPose(poses, other);
    if (is_later) X_WO = load_FleetPose(proposed_poses, other);
    if (!is_stopped(path, now, next, other, X_WO)) continue;
    if (is_later) yields = true;
    else stop = last || load_FleetShared(shared_states, other).waiting == 0u ? SF_STOP_REFUSED : SF_STOP_WAITING;
  }
  return yields ? SF_STOP_REFUSED : stop;
}

/// Returns whether no obstacle is within `sweep` of the mover.
bool is_path_free(Path path, double sweep) {
  bool free = true;
  NearWalk near = near_movers(path);
  int other = 0;
  while (may_turn(4u) && other >= 0 && free) {
    other = next_near(path, near);
    if (other >= 0) free = !comes_near(path.outline, path.from, sweep, footprint_at(other), load_FleetPose(poses, other));
  }
  if (path.outline.count == 0u) return free;
  const dvec2 p = origin_of(path.from);
  precise double near_path = path.outline.radius + path.reach;
  precise double top = path.from.z + path.outline.z_max;
  precise double bottom = path.from.z + path.outline.z_min;
  const dvec4 box = box_around(p, near_path);
  WallWalk walk = WallWalk(0, 0, 0);
  while (may_turn(2u) && free && find_wall(walk, box)) {
    const FleetWall wall = load_FleetWall(walls, walk.at);
    precise double gap = distance64(p, dvec2(wall.ax, wall.ay), dvec2(wall.bx, wall.by)) - path.outline.radius;
    free = !(wall.z_min < top && bottom < wall.z_max) || gap > sweep;
    ++walk.at;
  }
  return free;
}

/// @param yielding tests the path against rivals as well, and returns whether it meets one
/// @param was_free the proposed path had no obstacles
/// @param X_WM at the start and, except if yielding, at the end
bool advance_mover(Path path, bool last, bool yielding, bool was_free, inout FleetPose X_WM, inout FleetMotion motion) {
  const FleetFootprint outline = path.outline;
  const bool is_car = load_FleetBody(bodies, own_row).drive == SF_DRIVE_CAR;
  const double sweep = sweep_of(motion, outline.radius);
  precise double ratio = sweep / outline.step;
  const double all_steps = yielding && was_free ? ceil64(ratio) : most(1.0LF, ceil64(ratio));
  dvec3 v = velocity_of(motion);
  if (!yielding && is_path_free(path, sweep)) {
    X_WM = advance(X_WM, v, motion.remaining);
    motion.remaining = 0.0LF;
    motion.free = 1u;
    return false;
  }
  motion.free = 0u;

  double steps = all_steps;
  precise double dt = motion.remaining / steps;
  double step_time = dt;          // [s] left of this step
  int test = yielding && was_free ? SF_TEST_FREE : SF_TEST_STEP;
  double k = 1.0LF;               // SF_TEST_FREE: place on the path
  bool turns = false;             // SF_TEST_PART: the step is a turn in place
  int halving = -1;               // SF_TEST_PART
  double part = 0.0LF, free_part = 0.0LF, blocked_part = 0.0LF;
  FleetPose reached = X_WM;       // SF_TEST_PART: at free_part
  double push_time = 0.0LF;       // SF_TEST_PUSH
  bool is_second_push = false;
  int attempt = 0;
  dvec2 away = dvec2(0.0LF);
  double remaining = 0.0LF;
  bool yields = false;
  while (may_turn(42u) && test != SF_TEST_END && !yields) {
    if (test == SF_TEST_FREE && !(k < steps)) test = SF_TEST_PROPOSED;
    if (test == SF_TEST_PUSH && attempt == 0) away = unit64(body_contact(X_WM, false).away);
    const bool can_push = away.x != 0.0LF || away.y != 0.0LF;

    // The tested pose.
    precise double fraction = k / steps;
    precise double free_time = fraction * motion.remaining;
    precise double part_time = part * step_time;
    const double time = test == SF_TEST_STEP   ? step_time
                        : test == SF_TEST_PART ? part_time
                        : test == SF_TEST_PUSH ? push_time
                                               : free_time;
    FleetPose to = advance(X_WM, v, time);
    if (test == SF_TEST_PROPOSED) to = load_FleetPose(proposed_poses, own_row);
    if (test == SF_TEST_PUSH) {
      const double yield = attempt == 0 ? 0.25LF * SF_MAX_YIELD : attempt == 1 ? 0.5LF * SF_MAX_YIELD : SF_MAX_YIELD;
      precise double x = to.x + yield * away.x;
      precise double y = to.y + yield * away.y;
      to.x = x;
      to.y = y;
    }
    const bool rivals_only = test == SF_TEST_FREE || test == SF_TEST_PROPOSED;
    FleetPose from = X_WM;
    if (test == SF_TEST_PROPOSED) from = path.from;
    int stop = SF_STOP_REFUSED;
    if (test != SF_TEST_PUSH || can_push) stop = stop_at(path, from, to, last, !rivals_only, yielding, yields);

    // Chooses the next test.
    bool ends = false;  // the mover stops here
    bool parts = false;  // bisects the step
    if (test == SF_TEST_PROPOSED) {
      test = SF_TEST_END;
    } else if (test == SF_TEST_FREE) {
      precise double next = k + 1.0LF;
      k = next;
    } else if (stop == SF_STOP_NONE && test != SF_TEST_PART) {  // a substep is done
      X_WM = to;
      precise double left = steps - 1.0LF;
      steps = left;
      step_time = dt;
      test = steps > 0.0LF ? SF_TEST_STEP : SF_TEST_END;
    } else if (test == SF_TEST_STEP) {
      if (stop == SF_STOP_WAITING) {
        precise double whole = steps * dt;
        precise double done = dt - step_time;
        precise double left = whole - done;
        remaining = left;
        test = SF_TEST_END;
      } else {
        motion.refused = 1u;
        turns = v.x == 0.0LF && v.y == 0.0LF;
        parts = !turns;
        if (turns) {
          test = SF_TEST_PUSH;
          push_time = step_time;
          is_second_push = false;
          attempt = 0;
        }
      }
    } else if (test == SF_TEST_PUSH) {
      if (can_push && attempt < 2) {
        ++attempt;
      } else {
        ends = is_second_push;
        parts = !is_second_push;
      }
    } else {
      const bool is_clear = stop == SF_STOP_NONE;
      bool is_done = false;
      if (halving < 0 && !is_clear) {
        is_done = true;
        free_part = 0.0LF;
      } else {
        free_part = is_clear ? part : free_part;
        blocked_part = is_clear ? blocked_part : part;
        if (is_clear) reached = to;
        ++halving;
        precise double middle = 0.5LF * (free_part + blocked_part);
        part = middle;
        is_done = halving == int(outline.halvings);
        if (is_done) X_WM = reached;
      }
      if (is_done && !turns) {
        precise double done = free_part * step_time;
        precise double left = step_time - done;
        step_time = left;
        ends = v.z == 0.0LF || is_car;
        v = dvec3(0.0LF, 0.0LF, v.z);
        test = SF_TEST_STEP;
      } else if (is_done) {
        precise double done = free_part * step_time;
        precise double left = step_time - done;
        ends = !(done > 0.0LF);
        test = SF_TEST_PUSH;
        push_time = left;
        is_second_push = true;
        attempt = 0;
      }
    }
    if (parts) {
      test = SF_TEST_PART;
      halving = -1;
      part = outline.smallest_part;
      blocked_part = 1.0LF;
      reached = X_WM;
    }
    if (ends) {
      v = dvec3(0.0LF);
      test = SF_TEST_END;
    }
    if (test == SF_TEST_END && yielding && !rivals_only) test = SF_TEST_PROPOSED;
  }
  motion.forward = v.x;
  motion.left = v.y;
  motion.turn = v.z;
  motion.remaining = remaining;
  return yields;
}
