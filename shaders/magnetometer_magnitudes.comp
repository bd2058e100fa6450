#version 450
#extension GL_GOOGLE_include_directive : require
// The magnetometer array where some sensor adds up magnitudes: as magnetometer.comp, which is faster.

#define SF_MAGNITUDES
#include "shaders/lib/dipoles.glsl"
