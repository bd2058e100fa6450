#pragma once
// A picture of `lane-camera` at work: the camera's image with the lane drawn over it, beside the rectified ground.

#include <string>

#include "gpu/device.h"
#include "scenarios/lane_camera_runs.h"

namespace sf::scenarios {

/// Draws one image and its ground, with the painted points and the estimated lane, before the bend of the course.
/// @param file PNG @throws base::InputError if it cannot be written
void draw_lane_view(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device, const std::string& file);

}  // namespace sf::scenarios
