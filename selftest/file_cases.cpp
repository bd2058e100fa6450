// NaN, infinity and denormals in world files, road networks and recordings.

#include <fmt/format.h>

#include "selftest/fixture.h"
#include "selftest/suite.h"
#include "world/roads/rndf.h"
#include "world/stage/stage.h"

namespace sf::selftest {

namespace {

void world_files(Fixture& fixture, Checks& checks) {
  const auto world_with = [](const std::string& x) {
    return "model( name \"post\" pose [" + x +
           " 0 0 0]\n size [1 1 1] block( points 4 point[0] [0 0] point[1] [1 0] "
           "point[2] [1 1] point[3] [0 1] z [0 1] ) )";
  };
  for (const char* word : {"nan", "-nan", "inf", "-inf", "infinity", "1e999", "-1e999", "1e309", "0x10"})
    checks.refused([&] { world::build_world("bad.world", world_with(word)); }, "bad.world:1:", word);
  for (const char* word : {"1e300", "1e8"})
    checks.refused([&] { world::build_world("bad.world", world_with(word)); }, "too large", word);
  for (const char* word : {"5e-324", "-5e-324", "1e-310", "-0", "2.3e-308"}) {
    world::World world = world::build_world("small.world", world_with(word));
    add_laser_mover(world, {-2.0, 0.0, 0.0, 0.0}, laser(1, 0.0, 8.0));
    checks.same(fixture.measure(world).readings[0].values[0], 1.5, word);
  }
}

constexpr std::string_view kRoads = R"(RNDF_name small
num_segments 1
num_zones 0
format_version 1.0
creation_date 1-Jan-07
segment 1
num_lanes 1
segment_name Main
lane 1.1
num_waypoints 2
lane_width 12
1.1.1 40.000000 -83.000000
1.1.2 LATITUDE -82.999000
end_lane
end_segment
end_file
)";

void road_files(Fixture&, Checks& checks) {
  const auto roads_with = [](const std::string& latitude) {
    std::string text(kRoads);
    return text.replace(text.find("LATITUDE"), 8, latitude);
  };
  for (const char* word : {"nan", "inf", "-inf", "1e999", "90.0001", "-90.0001"})
    checks.refused([&] { world::parse_rndf("bad.rndf", roads_with(word)); }, "bad.rndf:13:", word);
  for (const char* word : {"40.0", "90", "-90", "0"})
    checks.equal(count(world::parse_rndf("good.rndf", roads_with(word))).lanes, 1, word);
}

/// World snapshots in recordings. The hash is computed from the bytes, so only the numbers are wrong.
void snapshots(Fixture&, Checks& checks) {
  world::World good;
  add_wall(good, {1.0, -1.0}, {1.0, 1.0});
  add_laser_mover(good, {}, laser(5, 1.0, 8.0));
  good.magnets.push_back({{1.0, 2.0}, 0.0, 1.0, 0.01, 0});
  good.lane_markings.push_back({{{0.0, 0.0}, {1.0, 0.0}}, 0.1});
  const auto keep = [](world::World world) {
    world::update_extent_and_hash(world);
    return world::from_snapshot(world::snapshot(world));
  };
  checks.equal(keep(good).walls.size(), 1u, "a good one");
  for (const double bad : {kNan, kInfinity, -kInfinity})
    for (int where = 0; where < 8; ++where) {
      world::World world = good;
      double* const places[] = {&world.walls[0].a.x,
                                &world.walls[0].b.y,
                                &world.movers[0].X_WM.yaw,
                                &world.movers[0].sensors[0].X_MS.z,
                                &world.movers[0].sensors[0].settings[0].numbers[0],
                                &world.magnets[0].moment,
                                &world.lane_markings[0].width,
                                &world.lane_markings[0].line[1].x};
      *places[where] = bad;
      checks.refused([&] { keep(world); }, "broken world snapshot", fmt::format("{:g} in place {}", bad, where));
    }
}

constexpr Case kFileCases[] = {
    {"files", "in-world-files", "m", "NaN and infinity refused with file and line; denormals are numbers", world_files},
    {"files", "in-road-files", "", "NaN, infinity and degrees beyond 90 refused with file and line", road_files},
    {"files", "in-recordings", "", "NaN and infinity in a recording's world are refused", snapshots},
};

}  // namespace

std::span<const Case> file_cases() { return kFileCases; }

}  // namespace sf::selftest
