#pragma once
// The Earth's magnetic field, given as a vector or by a place on the Earth.

#include "world/stage/build_state.h"

namespace sf::world {

/// Returns the field [T] of the Earth's dipole on its surface: x east, y north, z up.
///
/// The field is -grad V of V = a (a/r)^2 (g10 cos t + (g11 cos p + h11 sin p) sin t) at r = a, with the colatitude t,
/// the longitude p and the three coefficients of degree 1 of IGRF-13 for 2020 (Alken et al., Earth, Planets and Space
/// 73:49, 2021). The other degrees are left out: the error is 11.5 uT RMS over the Earth, at most 25 uT.
/// @param latitude [deg] in [-90, 90], north positive  @param longitude [deg] in [-180, 180], east positive
glm::dvec3 dipole_field(double latitude, double longitude);

/// Reads `World::earth_field` from `earth_field [x y z]` (Gauss, world frame) or `earth_location`: [latitude longitude
/// heading] in degrees, heading being the direction of east in the world, or "road" for the sidecar of the world's
/// first road network. Call it after all roads are read.
/// @throws base::InputError with file and line
void read_earth_field(BuildState& b, const Entity& root);

}  // namespace sf::world
