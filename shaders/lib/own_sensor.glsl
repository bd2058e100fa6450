// Tables of users' own kernels (sensorfarm/sensor.h). A kernel must not declare other tables:
//
//   #version 450
//   #extension GL_GOOGLE_include_directive : require
//   #include "shaders/lib/own_sensor.glsl"
//   void main() {
//     if (!begin_sample()) return;
//     set_value(0, nearest(dvec2(own.x, own.y), dvec2(cos(float(own.yaw)), sin(float(own.yaw))), 8.0LF));
//   }
//
// One invocation computes one element of one sensor.

#include "shaders/sensors/own_sensor_records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer samples;   // OwnSample of each due sensor
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer surfaces;  // OwnSurface
layout(binding = 2) writeonly buffer Values { double values[]; };

OwnSample own;    // this invocation's sensor
int own_element;  // this invocation's element
int own_first;    // index of its first value

/// Reads the invocation's sensor. Returns false if the invocation has no work.
bool begin_sample() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  own = load_OwnSample(samples, 0);
  const int lanes = int(own.lanes);
  own = load_OwnSample(samples, lane / lanes);
  own_element = lane % lanes;
  own_first = lane * int(own.columns);
  return own_element < int(own.elements);
}

void set_value(int column, double value) { values[own_first + column] = value; }

/// Returns the range [m] of the nearest surface at the sensor's height along `direction`, a unit vector; `range` if
/// there is none.
double nearest(dvec2 origin, dvec2 direction, double range) {
  double best = range;
  for (int i = 0; i < int(own.surfaces); ++i) {
    const OwnSurface s = load_OwnSurface(surfaces, i);
    const dvec2 a = dvec2(s.ax, s.ay) - origin, b = dvec2(s.bx, s.by) - origin;
    const double side_a = direction.x * a.y - direction.y * a.x, side_b = direction.x * b.y - direction.y * b.x;
    const dvec2 e = b - a;
    const double across = e.x * direction.y - e.y * direction.x;
    const double t = across == 0.0LF ? range : (e.x * a.y - e.y * a.x) / across;
    const bool seen = s.mover != own.mover && s.z_min <= own.z && own.z < s.z_max;
    if (seen && side_a * side_b <= 0.0LF && t >= 0.0LF && t < best) best = t;
  }
  return best;
}
