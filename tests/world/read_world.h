#pragma once
// Reads worlds from text in tests.

#include <string>

#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::world {

inline constexpr std::string_view kLaserKeys[] = {"fov",         "samples", "range_min", "range_max",
                                                  "laser_color", "noise",   "resolution"};
inline constexpr std::string_view kRangerKeys[] = {"scount", "sview", "spose[]", "noise", "resolution"};
inline constexpr std::string_view kBlockKeys[] = {"range", "view", "fov", "samples", "noise", "resolution"};
inline constexpr SensorKeyword kLaserWords[] = {{"laser", kLaserKeys}, {"ranger", kRangerKeys, kBlockKeys}};
inline const LoadOptions kWithLasers{.sensors = kLaserWords};

inline World read_world(const std::string& text, const LoadOptions& options = kWithLasers) {
  return build_world(SF_SOURCE_DIR "/worlds/test.world", text, options);
}

/// Returns the error without the path: "test.world:3: ...". Empty if the world loads.
inline std::string error_of(const std::string& text) {
  const std::string error = sf::refusal_of([&] { read_world(text); });
  const auto at = error.find("test.world");
  return at == std::string::npos ? error : error.substr(at);
}

/// Returns all warnings, one per line: "3: ...".
inline std::string warnings_of(const World& world) {
  std::string all;
  for (const Warning& warning : world.warnings) all += std::to_string(warning.line) + ": " + warning.message + "\n";
  return all;
}

}  // namespace sf::world
