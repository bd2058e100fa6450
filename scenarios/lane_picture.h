#pragma once
// Draws the lane that `lane-camera` detects: over the camera's image on the left, over the rectified ground on the
// right.

#include <string>

#include "gpu/device.h"
#include "scenarios/lane_camera_runs.h"

namespace sf::scenarios {

/// Draws one image and its ground, with the painted points and the estimated lane, before the bend of the course.
/// @param file PNG @throws base::InputError if it cannot be written
void draw_lane_view(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device, const std::string& file);

}  // namespace sf::scenarios
