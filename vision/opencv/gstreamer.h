#pragma once
// Checks GStreamer pipelines. OpenCV 4.6 leaves out missing elements and then waits without limit for images.

#include <string>

namespace sf::vision {

/// Returns GStreamer's reason for refusing a pipeline, such as `no element "v4l2src"`; empty: none, or OpenCV does not
/// use the shared library.
std::string pipeline_problem(const std::string& pipeline);

}  // namespace sf::vision
