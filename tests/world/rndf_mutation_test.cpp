// Any bytes give either a network, a mission or a sidecar, or an InputError.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "base/files.h"
#include "base/random.h"
#include "tests/world/rndf_text.h"
#include "tests/world/successors.h"
#include "world/roads/mdf.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

using base::RandomStream;

std::vector<std::string> lines_of_text(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

/// Makes one to three changes: flips a byte, drops, duplicates or swaps lines, or changes a number.
std::string mutated_rndf(const std::string& text, std::uint32_t k) {
  constexpr std::array<std::string_view, 10> kStatements{"/*",    "*/",  "1.1.1",      "32769", "-0",
                                                         "1e308", "nan", "end_lane\n", "\r",    "\xFF"};
  std::string changed = text;
  const auto count = 1 + base::random_words({9, RandomStream::placement, k, 0, 0}, 999)[0] % 3;
  for (std::uint32_t change = 0; change < count && !changed.empty(); ++change) {
    const auto words = base::random_words({9, RandomStream::placement, k, 0, 0}, change);
    const std::size_t at = words[0] % changed.size();
    if (words[1] % 5 == 0) {
      changed[at] = static_cast<char>(words[2] & 0xFF);
      continue;
    }
    if (words[1] % 5 == 1) {
      changed.insert(at, kStatements[words[2] % kStatements.size()]);
      continue;
    }
    auto lines = lines_of_text(changed);
    const std::size_t i = words[2] % lines.size();
    const std::size_t j = words[3] % lines.size();
    if (words[1] % 5 == 2) lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
    if (words[1] % 5 == 3) lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(j), lines[i]);
    if (words[1] % 5 == 4) std::swap(lines[i], lines[j]);
    changed.clear();
    for (const std::string& line : lines) changed += line + "\n";
  }
  return changed;
}

/// Checks the invariants that users of a network do not check.
void expect_sound(const RoadNetwork& network) {
  for (const RoadLane& lane : network.lanes) {
    ASSERT_GT(lane.width, 0.0);
    ASSERT_FALSE(lane.points.empty());
    ASSERT_EQ(lane.centre.points.size(), lane.centre.s.size());
    for (const glm::dvec2& p : lane.centre.points) ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
  }
  for (const RoadExit& exit : network.exits) ASSERT_TRUE(std::isfinite(exit.length));
  for (const auto& [id, ref] : network.index) successors(network, ref);
}

template <class Read>
void run(const std::string& text, std::uint32_t times, Read&& read) {
  std::uint32_t fine = 0;
  for (std::uint32_t k = 0; k < times; ++k) {
    try {
      read(mutated_rndf(text, k));
      ++fine;
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(':'), std::string::npos);
    }
  }
  EXPECT_GT(fine, times / 50) << "hardly any mutant gets past the grammar: too coarse to prove much";
  EXPECT_LT(fine, times) << "no mutant is refused";
}

void read_all(const std::string& text) {
  std::vector<Warning> warnings;
  const RoadNetwork network = build_network(parse_rndf("x.rndf", text), {}, warnings);
  expect_sound(network);
  lane_markings_of(network);
}

TEST(RndfMutation, SmallNetwork) { run(std::string(kSmallRndf), 4000, read_all); }

TEST(RndfMutation, PublicNetworks) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/rndf/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  for (const char* file :
       {"darpa_sample/Sample_RNDF_Rev_1.5.rndf", "utexas/swri_site_visit_with_zones.rndf", "utexas/prc_large.rndf"})
    run(base::read_text(folder + file), 200, read_all);
  run(base::read_text(folder + "darpa_sample/uce_rndf_1_final_event.rndf"), 40, read_all);
}

TEST(RndfMutation, Mission) {
  run("MDF_name go\nRNDF small\ncheckpoints\nnum_checkpoints 2\n1\n2\nend_checkpoints\nspeed_limits\nnum_speed_limits "
      "1\n1 0 "
      "15\nend_speed_limits\nend_file\n",
      3000, [](const std::string& text) { check_against(parse_mdf("go.mdf", text), small_rndf()); });
}

TEST(RndfMutation, Sidecar) {
  run("origin = [40, -83]\nscale = 0.5\nlane_width_m = 0.5\nposition = [1, 2]\n[lanes.\"1.2\"]\nwidth_m = 0.4\nleft = "
      "\"solid_white\"\n[points.\"1.1.2\"]\nposition = [3, 4]\n",
      3000, [](const std::string& text) {
        std::vector<Warning> warnings;
        expect_sound(build_network(small_rndf(), parse_sidecar("x.toml", text, warnings), warnings));
      });
}

// Coordinates all over the Earth give lanes of thousands of kilometres, which are rejected within bounded time and
// memory.
TEST(RndfMutation, PlacesAllOverTheEarth) {
  for (const std::string boundary : {"", "left_boundary broken_white\n"})
    for (std::uint32_t k = 0; k < 5; ++k) {
      std::string text =
          "RNDF_name far\nnum_segments 1\nnum_zones 0\nsegment 1\nnum_lanes 1\nlane 1.1\nnum_waypoints 500\n" +
          boundary;
      for (std::uint32_t i = 1; i <= 500; ++i) {
        const auto u = base::random_uniform({4, RandomStream::placement, k, i, 0}, 0);
        text += "1.1." + std::to_string(i) + " " + std::to_string(180 * u[0] - 90) + " " +
                std::to_string(360 * u[1] - 180) + "\n";
      }
      try {
        read_all(text + "end_lane\nend_segment\nend_file\n");
        ADD_FAILURE() << "a lane around the Earth was smoothed to a millimetre";
      } catch (const base::InputError& error) {
        EXPECT_NE(std::string(error.what()).find("points; check the coordinates"), std::string::npos);
      }
    }
}

}  // namespace
}  // namespace sf::world
