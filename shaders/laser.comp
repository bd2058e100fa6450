#version 450
#extension GL_GOOGLE_include_directive : require
// Fans of beams, measured in 64 bits.

#include "shaders/lib/cast.glsl"
