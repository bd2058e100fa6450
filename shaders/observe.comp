#version 450
#extension GL_GOOGLE_include_directive : require
// Computes observations from states and ranges (robots/device/device_observer.h), with the operations of
// library/observations.cpp. An agent has an invocation per observed beam, and one for the rest.

#include "shaders/robots/device/records.glsl"
#include "shaders/robots/device/observer_records.glsl"

layout(local_size_x = 64) in;
#include "shaders/lib/planar64.glsl"

layout(binding = 0, rgba32ui) uniform readonly uimageBuffer tick;        // ObserveTick
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer agents;      // ObservedAgent
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer sensors;     // ObservedSensor, agent by agent
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer goals;       // ObservedGoal per agent
layout(binding = 4, r32ui) uniform readonly uimageBuffer fresh;          // per agent, 1: its goal is new; 2: its episode
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer poses;       // FleetPose per mover
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer motions;     // FleetMotion per mover
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer own_states;  // FleetOwn per mover
layout(binding = 8, rgba32ui) uniform uimageBuffer measures;             // ObservedMeasure per agent
layout(binding = 9) readonly buffer Ranges { double beam[]; } ranges;    // [m]
layout(binding = 10) buffer Values { float column[]; } values;           // NaN: the device failed

float in_unit(double value) { return value >= -1.0LF && value <= 1.0LF ? float(value) : value < 0.0LF ? -1.0 : 1.0; }

float ratio_in_unit(double value, double largest) {
  precise double ratio = value / largest;
  return in_unit(ratio);
}

ObservedMeasure measure(ObservedMeasure before, dvec2 goal, dvec2 p, bool moved) {
  ObservedMeasure now;
  now.x = goal.x;
  now.y = goal.y;
  now.distance = length64(minus(goal, p));
  precise double nearer = before.distance - now.distance;
  const bool counts = moved && goal.x == before.x && goal.y == before.y && is_finite(nearer);
  now.progress = counts ? nearer : 0.0LF;
  return now;
}

void observe_goal(uint at, ObservedMeasure goal, FleetPose X, double reach) {
  const bool known = is_finite(goal.distance);
  const dvec2 d = known ? minus(dvec2(goal.x, goal.y), dvec2(X.x, X.y)) : dvec2(0.0LF);
  precise double bearing = arc_tangent64(d.y, d.x) - X.yaw;
  const dvec2 s = sin_cos64(bearing);
  values.column[at] = known ? ratio_in_unit(goal.distance, reach) : 1.0;
  values.column[at + 1u] = known ? float(s.y) : 0.0;
  values.column[at + 2u] = known ? float(s.x) : 0.0;
}

void observe_beam(uint at, uint agent, uint column, ObserveTick now) {
  const uint sensor = agent * now.sensors + column / now.elements;
  const double range = ranges.beam[sensor * now.beams + column % now.elements * now.every];
  const float part = ratio_in_unit(range, load_ObservedSensor(sensors, int(sensor)).limit);
  values.column[at] = is_finite(range) ? part : uintBitsToFloat(0x7fc00000u);
}

/// Speeds and the goal. @param fresh_goal whether the goal or the episode is new
void observe_rest(uint at, int agent, ObserveTick now, bool fresh_goal) {
  const ObservedAgent who = load_ObservedAgent(agents, agent);
  const FleetPose X = load_FleetPose(poses, int(who.mover));
  const FleetMotion v = load_FleetMotion(motions, int(who.mover));
  ObservedMeasure known = load_ObservedMeasure(measures, agent);
  const ObservedGoal goal = load_ObservedGoal(goals, agent);
  if (now.again == 0u || fresh_goal)
    known = measure(known, dvec2(goal.x, goal.y), dvec2(X.x, X.y), now.again == 0u);
  if (load_FleetOwn(own_states, int(who.mover)).phase == SF_FLEET_FAILED)
    known.progress = double(uintBitsToFloat(0x7fc00000u));
  store_ObservedMeasure(measures, agent, known);
  if (now.speeds != 0u) {
    values.column[at] = ratio_in_unit(v.forward, who.forward);
    values.column[at + 1u] = ratio_in_unit(v.turn, who.turn);
    at += 2u;
  }
  if (now.reach > 0.0LF) observe_goal(at, known, X, now.reach);
}

/// Moves `count` columns of a stack on to older places before a step, or fills the stack with those of a start.
void stack_columns(uint at, uint count, uint columns, uint stack, bool fill) {
  for (uint k = stack - 1u; k > 0u; --k)
    for (uint i = at; i < at + count; ++i) values.column[i + k * columns] = values.column[fill ? i : i + (k - 1u) * columns];
}

void main() {
  const ObserveTick now = load_ObserveTick(tick, 0);
  const uint beams = now.sensors * now.elements;
  const uint agent = gl_GlobalInvocationID.x / (beams + 1u), column = gl_GlobalInvocationID.x % (beams + 1u);
  if (agent >= now.agents) return;
  const uint first = agent * now.columns * now.stack + column, count = column < beams ? 1u : now.columns - beams;
  const uint news = now.again == 0u ? 0u : imageLoad(fresh, int(agent)).x;
  if (now.again == 0u) stack_columns(first, count, now.columns, now.stack, false);
  if (column < beams)
    observe_beam(first, agent, column, now);
  else
    observe_rest(first, int(agent), now, news != 0u);
  if ((news & 2u) != 0u) stack_columns(first, count, now.columns, now.stack, true);
}
