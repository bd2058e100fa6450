#pragma once
// Sums the field of a world with the kernel and with the host's code, and compares the bytes.

#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <vector>

#include "sensors/magnetic_field/sampling.h"
#include "tests/device.h"

namespace sf::trial {

inline std::vector<sensors::FieldSum> sample_on_both(const world::World& world,
                                                     std::span<const sensors::FieldPoint> points,
                                                     const sensors::FieldSampleOptions& options = {}) {
  auto sums = sensors::sample_field(world, device(), points, options);
  const auto on_host = sensors::sample_field(world, host_device(), points, options);
  EXPECT_EQ(on_host.size(), sums.size());
  EXPECT_EQ(std::memcmp(on_host.data(), sums.data(), sums.size() * sizeof sums[0]), 0) << "the host's bytes differ";
  return sums;
}

/// The field at one point, with the sum of magnitudes.
inline sensors::FieldSum field_at(const world::World& world, const sensors::FieldPoint& point) {
  return sample_on_both(world, {&point, 1}, {.magnitudes = true})[0];
}

}  // namespace sf::trial
