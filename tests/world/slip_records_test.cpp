// Omits, duplicates, or changes the last word of each line of a road network, a mission, a sidecar and a plan of
// lights. Compares a hash of the reader's messages with a golden record. With SENSORFARM_RECORDS=FOLDER set, also
// writes the messages there.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "base/hash.h"
#include "tests/golden.h"
#include "tests/world/rndf_text.h"
#include "world/light_plan.h"
#include "world/roads/mdf.h"
#include "world/roads/sidecar.h"

namespace sf::world::slips {
namespace {

using Read = std::function<std::vector<Warning>(const std::string&)>;

std::string said_of(const Read& read, const std::vector<std::string>& lines) {
  std::string text, said;
  for (const std::string& line : lines) text += line + "\n";
  try {
    for (const Warning& w : read(text)) said += fmt::format("  {}: {}\n", w.line, w.message);
  } catch (const base::InputError& error) {
    for (const std::string& line : golden::lines_of(error.what())) {
      const auto library = line.find("not TOML:");  // the library's words follow
      said += "  refused: " + (library == std::string::npos ? line : line.substr(0, library + 8)) + "\n";
    }
  }
  return said;
}

/// Returns the line with another last word.
std::string with_last(const std::string& line, const char* word) {
  const auto at = line.find_last_of(" \t");
  return at == std::string::npos ? word : line.substr(0, at + 1) + word;
}

/// Returns the reader's messages about the changed variants of line `i`.
std::string slips_of(const std::vector<std::string>& lines, std::size_t i, const Read& read) {
  const auto at = static_cast<std::ptrdiff_t>(i);
  std::vector<std::string> changed = lines;
  changed.erase(changed.begin() + at);
  std::string all = fmt::format("without {}: {}\n", i + 1, lines[i]) + said_of(read, changed);
  changed.insert(changed.begin() + at, 2, lines[i]);
  all += fmt::format("twice {}: {}\n", i + 1, lines[i]) + said_of(read, changed);
  for (const char* word : {"0", "-1", "32769", "x"}) {
    changed = lines;
    changed[i] = with_last(lines[i], word);
    all += fmt::format("{}: {}\n", i + 1, changed[i]) + said_of(read, changed);
  }
  return all;
}

void expect_slips(const std::string& name, const std::string& text, const Read& read) {
  const std::vector<std::string> lines = golden::lines_of(text);
  std::string said = said_of(read, lines), hashes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string slips = slips_of(lines, i, read);
    hashes += fmt::format("{}: x{:016x}\n", lines[i], base::hash_bytes(slips.data(), slips.size()));
    said += slips;
  }
  if (const std::string shown = golden::shown_file(name + "_said.txt"); !shown.empty()) std::ofstream(shown) << said;
  EXPECT_EQ(hashes, golden::read(SF_SOURCE_DIR "/tests/world/golden/" + name + ".txt"));
  if (const std::string shown = golden::shown_file(name + ".txt"); !shown.empty()) std::ofstream(shown) << hashes;
}

const std::string kFolder = SF_SOURCE_DIR "/tests/world/golden/";

TEST(SlipRecords, RoadNetwork) {
  expect_slips("rndf_slips", std::string(kSmallRndf),
               [](const std::string& text) { return parse_rndf("r", text).warnings; });
}

TEST(SlipRecords, Mission) {
  expect_slips("mdf_slips",
               "MDF_name tour\nRNDF small\nformat_version 1.0\ncreation_date 1-Jan-07\ncheckpoints\nnum_checkpoints 2\n"
               "1\n2\nend_checkpoints\nspeed_limits\nnum_speed_limits 2\n1 5 25\n3 0 10\nend_speed_limits\nend_file\n",
               [](const std::string& text) {
                 const Mdf mdf = parse_mdf("m", text);
                 std::vector<Warning> all = mdf.warnings;
                 for (const Warning& w : check_against(mdf, small_rndf())) all.push_back(w);
                 return all;
               });
}

TEST(SlipRecords, Sidecar) {
  expect_slips("sidecar_slips", golden::read(kFolder + "small.toml"), [](const std::string& text) {
    std::vector<Warning> warnings;
    check_against(parse_sidecar("s", text, warnings), small_rndf());
    return warnings;
  });
}

TEST(SlipRecords, PlanOfLights) {
  expect_slips("lights_slips", golden::read(kFolder + "lights.toml"), [](const std::string& text) {
    World world;
    for (const char* name : {"a", "b", "c", "d"})
      world.lights.push_back({.name = name, .phases = {{LightState::green, 1.0}}});
    parse_light_plan("l", text, world);
    return std::vector<Warning>{};
  });
}

}  // namespace
}  // namespace sf::world::slips
