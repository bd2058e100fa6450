#pragma once
// Speed and error of the laser's accuracy modes, and of cheaper methods that did not become modes. Methods take turns;
// walls do not move.

#include "bench/report.h"
#include "gpu/device.h"

namespace sf::bench {

/// Returns a Markdown table as text. Errors are relative to mode exact, over all beams of the last turn.
Report compare_accuracy_modes(gpu::Device& device, std::uint32_t robots, double range, std::size_t repeats);

}  // namespace sf::bench
