#pragma once
// Reads worlds from text in tests.

#include <string>

#include "base/error.h"
#include "world/stage/build_world.h"

namespace sf::world {

inline constexpr std::string_view kLaserKeys[] = {"fov", "samples", "range_min", "range_max", "laser_color"};
inline constexpr std::string_view kRangerKeys[] = {"scount", "sview", "spose[]"};
inline constexpr std::string_view kBlockKeys[] = {"range", "view", "fov", "samples"};
inline constexpr SensorKeyword kLaserWords[] = {{"laser", kLaserKeys}, {"ranger", kRangerKeys, kBlockKeys}};
inline const LoadOptions kWithLasers{.sensors = kLaserWords};

inline World read_world(const std::string& text, const LoadOptions& options = kWithLasers) {
  return build_world(SF_SOURCE_DIR "/worlds/test.world", text, options);
}

/// Returns the error without the path: "test.world:3: ...". Empty if the world loads.
inline std::string error_of(const std::string& text) {
  try {
    read_world(text);
  } catch (const base::InputError& error) {
    const std::string what = error.what();
    const auto at = what.find("test.world");
    return at == std::string::npos ? what : what.substr(at);
  }
  return {};
}

/// Returns all warnings, one per line: "3: ...".
inline std::string warnings_of(const World& world) {
  std::string all;
  for (const Warning& warning : world.warnings) all += std::to_string(warning.line) + ": " + warning.message + "\n";
  return all;
}

}  // namespace sf::world
