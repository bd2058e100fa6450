#version 450
#extension GL_GOOGLE_include_directive : require
// The magnetometer array: the field of all magnets at every element that is due, in one dispatch.

#include "shaders/lib/dipoles.glsl"
