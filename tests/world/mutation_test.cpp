// Whatever the text, the reader ends in a world or in an InputError with a file and a line.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "base/error.h"
#include "base/random.h"
#include "world/entities.h"
#include "world/stage.h"

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

/// One to three changes: a piece put in, a stretch left out, a stretch doubled, a byte turned.
std::string mutated(std::string text, std::uint32_t k) {
  const auto count = 1 + base::random_words({3, base::Stream::place, k, 0, 0}, 1000)[0] % 3;
  for (std::uint32_t change = 0; change < count; ++change) {
    const auto words = base::random_words({3, base::Stream::place, k, 0, 0}, change);
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

/// Rules of world.h that nobody who reads a world checks again.
void expect_sound(const World& world) {
  for (const Segment& wall : world.walls) {
    ASSERT_TRUE(wall.a.x != wall.b.x || wall.a.y != wall.b.y);
    ASSERT_LT(wall.model, world.models.size());
  }
  for (const Mover& mover : world.movers) {
    ASSERT_LT(mover.model, world.models.size());
    ASSERT_GT(mover.max_forward, 0.0);
    for (const Laser& laser : mover.lasers) {
      ASSERT_GE(laser.samples, 1u);
      ASSERT_GT(laser.range_max, 0.0);
      ASSERT_GT(laser.rate, 0.0);
    }
  }
}

void run(const std::string& file, std::uint32_t times) {
  const std::string text = read_text(file);
  std::uint32_t loaded = 0;
  for (std::uint32_t k = 0; k < times; ++k) {
    try {
      expect_sound(build_world(file, mutated(text, k)));
      ++loaded;
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(':'), std::string::npos);
    }
  }
  EXPECT_GT(loaded, times / 20) << "hardly any mutant gets past the grammar: too coarse to prove much";
  EXPECT_LT(loaded, times) << "no mutant is refused";
}

TEST(Mutation, OfOurRooms) { run(SF_SOURCE_DIR "/worlds/rooms.world", 2000); }

TEST(Mutation, OfOurCave) { run(SF_SOURCE_DIR "/worlds/cave.world", 200); }

TEST(Mutation, OfStagesFiles) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/stage/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data beside the sources";
  run(folder + "simple.world", 150);
  run(folder + "chatterbox.inc", 300);
}

}  // namespace
}  // namespace sf::world
