// libFuzzer target: any bytes as a road network, a mission or a sidecar. Accepted input becomes lanes and paint.
//
// The first byte selects the reader, from 0x80 on a strict one; the rest is the file.

#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/roads/mdf.h"
#include "world/roads/roads.h"

namespace {

using namespace sf;

void check_network(std::string_view text, bool strict) {
  const world::Rndf rndf = world::parse_rndf("fuzz.rndf", text, strict);
  std::vector<world::Warning> warnings;
  const world::RoadNetwork roads = world::build_network(rndf, {}, warnings);
  require(roads.counts.lanes == roads.lanes.size() && roads.counts.exits == roads.exits.size());
  for (const world::RoadLane& lane : roads.lanes) require(!lane.points.empty() && lane.width > 0.0);
  for (const world::LaneMarking& stripe : world::lane_markings_of(roads)) {
    require(stripe.line.size() >= 2 && stripe.width > 0.0);
    for (const glm::dvec2& p : stripe.line) require(std::isfinite(p.x) && std::isfinite(p.y));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    std::vector<world::Warning> warnings;
    const bool strict = data[0] >= 0x80;
    if (data[0] % 3 == 0) check_network(text, strict);
    if (data[0] % 3 == 1) world::parse_mdf("fuzz.mdf", text, strict);
    if (data[0] % 3 == 2) world::parse_sidecar("fuzz.toml", text, warnings);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).substr(0, 4) == "fuzz");
  }
  return 0;
}
