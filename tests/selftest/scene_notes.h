#pragma once
// Scenes of the cases: worlds, ticks and points, noted where farms are made and ticked and fields are sampled. The
// linker leads those calls to scene_notes.cpp (--wrap in tests/CMakeLists.txt).

#include <string>

namespace sf::selftest {

void forget_scenes();
/// Scenes since the last call of `forget_scenes`: counts, and one hash of worlds, seeds, times, reports and points in
/// their order.
std::string measured_scenes();

}  // namespace sf::selftest
