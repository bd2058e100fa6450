#version 450
#extension GL_GOOGLE_include_directive : require
// Fans of beams, measured in 32 bits where these say how far they are off.

#define SF_SINGLE
#include "shaders/lib/cast.glsl"
