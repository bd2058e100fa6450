// Any text gives either a world or an InputError with a file and a line.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "tests/world/read_world.h"
#include "world/stage/build_world.h"

namespace sf::world {
namespace {

constexpr std::array<std::string_view, 16> kPieces{"(",
                                                   ")",
                                                   "[",
                                                   "]",
                                                   "\"",
                                                   "#",
                                                   "\n",
                                                   "-1 ",
                                                   "1e300 ",
                                                   "0 ",
                                                   "define a model(",
                                                   "include \"x\" ",
                                                   "block( points 2 ",
                                                   "laser( ",
                                                   "spose[0] [0 0 0] ",
                                                   "name \"tag1\" "};

/// Makes one to three changes: an insertion, a deletion, a duplication, or a flipped byte.
std::string mutated(std::string text, std::uint32_t k) {
  const auto count = 1 + base::random_words({3, base::RandomStream::placement, k, 0, 0}, 1000)[0] % 3;
  for (std::uint32_t change = 0; change < count; ++change) {
    const auto words = base::random_words({3, base::RandomStream::placement, k, 0, 0}, change);
    const std::size_t at = words[0] % (text.size() + 1);
    const std::size_t stretch = std::min<std::size_t>(words[1] % 60, text.size() - at);
    switch (words[2] % 4) {
      case 0:
        text.insert(at, kPieces[words[3] % kPieces.size()]);
        break;
      case 1:
        text.erase(at, stretch);
        break;
      case 2:
        text.insert(at, text.substr(at, stretch));
        break;
      default:
        if (at < text.size()) text[at] = static_cast<char>(words[3] & 0xFF);
    }
  }
  return text;
}

/// Checks the invariants of world.h that users of a world do not check.
void expect_sound(const World& world) {
  for (const Segment& wall : world.walls) {
    ASSERT_TRUE(wall.a.x != wall.b.x || wall.a.y != wall.b.y);
    ASSERT_LT(wall.model, world.models.size());
  }
  for (const Mover& mover : world.movers) {
    ASSERT_LT(mover.model, world.models.size());
    ASSERT_GT(mover.max_forward, 0.0);
    ASSERT_GT(mover.max_acceleration, 0.0);
    ASSERT_GT(mover.track, 0.0);
    for (const Sensor& sensor : mover.sensors)
      for (const Setting& setting : sensor.settings)
        for (const double number : setting.numbers) ASSERT_TRUE(std::isfinite(number));
  }
  for (const Path& path : world.paths) {
    ASSERT_FALSE(path.pieces.empty());
    for (const PathPiece& piece : path.pieces) ASSERT_GT(piece.length, 0.0);
  }
  for (const Light& light : world.lights) {
    ASSERT_LT(light.model, world.models.size());
    ASSERT_FALSE(light.phases.empty());
    for (const LightPhase& phase : light.phases) ASSERT_GT(phase.duration, 0.0);
  }
  for (const Emitter& emitter : world.emitters) {
    ASSERT_LT(emitter.model, world.models.size());
    ASSERT_GT(emitter.range, 0.0);
    ASSERT_GT(emitter.fov, 0.0);
  }
  for (const FloorHole& drop : world.floor_holes) {
    ASSERT_LT(drop.model, world.models.size());
    ASSERT_GE(drop.outline.size(), 3u);
  }
}

void run_text(const std::string& file, const std::string& text, std::uint32_t times) {
  std::uint32_t loaded = 0;
  for (std::uint32_t k = 0; k < times; ++k) {
    try {
      expect_sound(build_world(file, mutated(text, k), kWithLasers));
      ++loaded;
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(':'), std::string::npos);
    }
  }
  EXPECT_GT(loaded, times / 20) << "hardly any mutant gets past the grammar: too coarse to prove much";
  EXPECT_LT(loaded, times) << "no mutant is refused";
}

void run(const std::string& file, std::uint32_t times) { run_text(file, base::read_text(file), times); }

TEST(Mutation, StreetObjects) {
  run_text(SF_SOURCE_DIR "/worlds/test.world", R"(
light( name "l" pose [1 2 0 90] lamps 1 phases 2 phase[0] ["green" 8] phase[1] ["flashing red" 2.5] offset 3
  stop_lines "3.1.11 4.2.5" )
model( name "wall" pose [1 1 0 45] ir_emitter "virtual_wall" ir_range 2 ir_fov 20 ir_halo 0.4 )
model( name "dock" ir_emitter "dock" )
model( name "stairs" cliff_return 1 block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] ) )
path( pieces 2 straight[0] [1 0.5] arc[1] [0.9 -90 0.5] )
position( drive "skid" track 0.4 acceleration_bounds [-1 1 0 0 0 0 -90 90] command_law "player_create" )
)",
           2000);
}

TEST(Mutation, Rooms) { run(SF_SOURCE_DIR "/worlds/rooms.world", 2000); }

TEST(Mutation, Cave) { run(SF_SOURCE_DIR "/worlds/cave.world", 200); }

TEST(Mutation, StageFiles) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/stage/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  run(folder + "simple.world", 150);
  run(folder + "chatterbox.inc", 300);
}

}  // namespace
}  // namespace sf::world
