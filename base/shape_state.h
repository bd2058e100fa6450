#pragma once
// The shape of a mover after a change at run time.

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string_view>

#include "base/pose.h"

namespace sf::base {

inline constexpr std::size_t kMostShapeName = 64;  ///< characters

/// Returns whether a shape may have that name: 1 to kMostShapeName ASCII letters, digits, '_', '-' and '.'.
inline bool is_shape_name(std::string_view name) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
  return !name.empty() && name.size() <= kMostShapeName && name.find_first_not_of(kPlain) == std::string_view::npos;
}

inline constexpr double kMostShapeSize = 1'000.0;  ///< [m] along each axis

/// Returns whether a shape may extend that far along an axis [m]: in (0, kMostShapeSize].
inline bool is_shape_length(double length) { return length > 0.0 && length <= kMostShapeSize; }

struct ShapeState {
  std::uint32_t mover = 0;
  std::uint32_t shape = 0xFFFFFFFFu;  ///< row in `world::World::shapes`; 0xFFFFFFFF: its own
  std::uint32_t color = 0;            ///< 0xAARRGGBB
  glm::dvec3 size{};                  ///< [m]
  Pose X_MB;                          ///< `world::Mover::X_MB`
};

}  // namespace sf::base
