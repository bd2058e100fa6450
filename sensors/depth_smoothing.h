#pragma once
// Smooths the noise of a depth image and keeps its edges: a bilateral mean (C. Tomasi, R. Manduchi, Bilateral filtering
// for gray and color images, 1998) with weights of 1 within a window and within the noise, and 0 elsewhere.

#include <cstdint>
#include <vector>

namespace sf::sensors {

inline constexpr int kDepthWindow = 2;       ///< [px] to each side
inline constexpr double kDepthSigmas = 3.0;  ///< depths on one surface differ by less
// [-] Noise that is left in a pixel, of nine or more on its surface; and in a column, which shares its pixels with
// others.
inline constexpr double kSmoothedNoise = 1.0 / 3.0, kColumnNoise = 0.5;

/// Replaces depths by the mean of those around them that are on the same surface. NaN: there is none.
/// @param depths [m] row by row  @param noise [1/m] as CameraSettings::depth_noise  @param before scratch memory
void smooth_depths(std::uint32_t width, double noise, std::vector<double>& depths, std::vector<double>& before);

}  // namespace sf::sensors
