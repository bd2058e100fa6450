#version 450
#extension GL_GOOGLE_include_directive : require
// The magnetometer array when some sensor sums magnitudes. magnetometer.comp is the faster version without them.

#define SF_MAGNITUDES
#include "shaders/lib/dipoles.glsl"
