#version 450
#extension GL_GOOGLE_include_directive : require
// The magnetometer array: the field of all magnets at every element of all due sensors, in one dispatch.

#include "shaders/lib/dipoles.glsl"
