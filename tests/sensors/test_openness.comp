#version 450
#extension GL_GOOGLE_include_directive : require
// Kernel of a test: free distances all around.

#include "shaders/lib/own_sensor.glsl"

void main() {
  if (!begin_sample()) return;
  const double turn = own.yaw + 6.283185307179586LF * own_element / own.elements;
  set_value(0, nearest(dvec2(own.x, own.y), dvec2(cos(float(turn)), sin(float(turn))), own.parameters.x));
}
