// Lidars among meshes of files, compared with the same surfaces as solids.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "sensors/lidar.h"
#include "sensors/mover_trails.h"
#include "sensors/sensor_set.h"
#include "sensors/spatial_scene.h"
#include "tests/folder.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"
#include "world/copies.h"
#include "world/shapes.h"

namespace sf::trial {
namespace {

/// A box of 1 m, as a model's box of that size.
constexpr const char* kBox =
    "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nv -0.5 -0.5 1\nv 0.5 -0.5 1\nv 0.5 0.5 1\nv -0.5 0.5 1\n"
    "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\nf 1 2 3 4\n";

class LidarMeshes : public FolderTest {
 protected:
  LidarMeshes() { write("box.obj", kBox); }
  /// A scene of boxes, as meshes or as solids.
  world::World scene(bool meshes, const std::string& more = "") const {
    const std::string shape = meshes ? "mesh \"" + path("box.obj") + "\" " : "";
    return world_of("define box model( " + shape + ")\n" + "define robot position( size [0.4 0.3 0.2] " + shape +
                    "model( size [0.1 0.1 0.3] " + shape +
                    " ) lidar( channels 24 fov_v [-40 40] columns 120 range [0 20] size [0.1 0.1 0.1] ) )\n"
                    "box( pose [3 0.2 0 25] size [1 2 0.8] ) box( pose [-3 1 1.5 70] size [3 3 0.2] )\n"
                    "robot( name \"r1\" pose [0 0 0 10] ) robot( name \"r2\" pose [1.5 -1 0.2 50] )\n" +
                    more);
  }
};

base::ReadingBlock sense(farm::Farm& farm, const world::World& world, const base::Tilt& tilt = {}) {
  return farm.sense(0, sensors::kLidar, 0, world.movers[0].X_WM, tilt);
}

/// The same planes give the same ranges to rounding; models, robots and what they carry are named alike.
TEST_F(LidarMeshes, ABoxIsABox) {
  const world::World meshes = scene(true), solids = scene(false);
  EXPECT_EQ(meshes.meshes.size(), 4u) << "one per size";
  EXPECT_EQ(meshes.mesh_models.size(), 6u);
  for (const base::Tilt& tilt : {base::Tilt{}, base::Tilt{0.3, -0.2}}) {
    farm::Farm mine(meshes, host_device(), {.noise = false, .threads = 2});
    farm::Farm theirs(solids, host_device(), {.noise = false, .threads = 2});
    const base::ReadingBlock a = sense(mine, meshes, tilt), b = sense(theirs, solids, tilt);
    EXPECT_TRUE(std::ranges::equal(a.hits, b.hits));
    for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1e-13) << i;
    for (const char* name : {"box:0", "box:1", "r2", "r2.model:0"})
      EXPECT_TRUE(std::ranges::any_of(a.hits, [&](std::uint32_t hit) {
        return hit < meshes.models.size() && meshes.models[hit].name == name;
      })) << name;
    EXPECT_TRUE(std::ranges::none_of(a.hits, [&](std::uint32_t hit) {
      return hit < meshes.models.size() && meshes.models[hit].mover == 0;
    })) << "its own robot";
  }
}

/// So is a picture of a box, seen from above too: turned, on a robot, or as a ROS map.
TEST_F(LidarMeshes, APictureIsABox) {
  write("box.pbm", "P1\n4 4\n0000\n0110\n0110\n0000\n");
  write("box.pgm", "P2 2 2 255 0 0 0 0\n");
  write("map.yaml",
        "image: box.pgm\nresolution: 1.0\norigin: [3, -1, 0.3]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n");
  const base::Pose map = base::compose({3.0, -1.0, 0.0, 0.3}, {1.0, 1.0, 0.0, 0.0});
  const auto scene = [&](const std::string& picture, const std::string& third) {
    return world_of("model( pose [1 3 0.5 25] size [1 2 0.8] " + picture + " )\n" +
                    "define robot position( size [0.4 0.3 0.2] " + picture + " )\n" + third +
                    "position( name \"r1\" lidar( channels 40 fov_v [-85 5] columns 180 range [0 20] "
                    "pose [0 0 3 0] size [0 0 0] ) )\nrobot( pose [1.5 -1 0.2 50] )\n");
  };
  const world::World pictures = scene("bitmap \"" + path("box.pbm") + "\"", "include \"" + path("map.yaml") + "\"\n"),
                     solids = scene("", fmt::format("model( pose [{} {} 0 {}] size [2 2 2] )\n", map.x, map.y,
                                                    map.yaw * 180.0 / M_PI));
  farm::Farm mine(pictures, host_device(), {.noise = false, .threads = 1});
  farm::Farm theirs(solids, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock a = sense(mine, pictures), b = sense(theirs, solids);
  for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1e-12) << i;
}

/// Intensities are those of each face's material, where its model states no reflectance: in exact scans, by the
/// reference and among simplified meshes. Lidars without intensities build no table of materials.
TEST_F(LidarMeshes, MaterialsReflect) {
  write("m.mtl", "newmtl dark\nKd 0.1\nnewmtl light\nKd 0.9\n");
  write("wall.obj",
        "mtllib m.mtl\nv 0 -9 -9\nv 0 0 -9\nv 0 9 -9\nv 0 9 9\nv 0 0 9\nv 0 -9 9\n"
        "usemtl dark\nf 1 2 5 6\nusemtl light\nf 2 3 4 5\n");
  const auto intensities = [&](const std::string& model, const std::string& mode, bool reference = false) {
    const world::World world =
        world_of("model( pose [5 0 0 0] noblocks 1 mesh \"" + path("wall.obj") + "\" " + model +
                 " )\nposition( size [0.4 0.4 0.5] lidar( channels 3 fov_v [0 10] columns 41 fov 60 range [0 50] "
                 "intensity 1 " +
                 mode + " ) )");
    farm::FarmOptions options{.noise = false, .threads = 1};
    if (reference) options.scene.caster = raycast::caster_named("reference");
    farm::Farm farm(world, host_device(), options);
    const base::ReadingBlock r = farm.sense(0, sensors::kLidar, 0, {});
    return std::vector<double>(r.values.begin(), r.values.end());
  };
  const std::vector<double> found = intensities("", "");
  for (std::size_t i = 0; i < found.size(); i += 2) {
    if (i / 2 % 41 == 20) continue;  // the edge between the halves
    const bool left = i / 2 % 41 > 20;
    EXPECT_NEAR(found[i + 1], (left ? 0.9 : 0.1) * 5.0 / found[i], 1e-6) << i;
  }
  EXPECT_EQ(intensities("", "accuracy \"coarse1\""), found);
  const std::vector<double> slow = intensities("", "", true);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (i / 2 % 41 != 20) {
      EXPECT_NEAR(slow[i], found[i], 1e-6) << i;
    }
  EXPECT_NEAR(intensities("reflectance 0.3", "")[1], 0.3 * 5.0 / found[0], 1e-6) << "the model's own key wins";

  const world::World world = world_of("model( mesh \"" + path("wall.obj") + "\" )\n");
  EXPECT_TRUE(sensors::SpatialScene(world, 20.0).materials().empty());
  EXPECT_EQ(sensors::SpatialScene(world, 20.0, {.coarse = false, .materials = true}).materials().size(), 2u);
}

/// Every copy of a world sees its own robots' meshes.
TEST_F(LidarMeshes, CopiesOfAWorld) {
  world::World several = scene(true);
  world::copy_movers(several, 3);
  sensors::SpatialScene scene(several, 20.0);
  std::vector<base::Report> states;
  for (std::uint32_t m = 0; m < several.movers.size(); ++m) states.push_back({m, 0, several.movers[m].X_WM, {}});
  states[3].X_WM.x = 5.0;  // r2 of the second copy
  scene.place(states);
  sensors::SceneList list;
  const std::vector<scene::Instance>& out = list.instances;
  scene.list({.mover = 2, .range = 20.0}, list);
  ASSERT_EQ(out.size(), 2u + 2 + 2) << "walls, ground, two boxes, and the body and the load of one robot";
  EXPECT_EQ(out[4].X_WI.p.x, 5.0);
  EXPECT_EQ(several.models[out[4].owner].name, "r2");
  scene.list({.mover = 4, .range = 20.0}, list);
  EXPECT_EQ(out[4].X_WI.p.x, 1.5);
}

/// A rolling scan, at rest or moving itself, sees another robot, with its mesh and its load, where that one was at the
/// time of each beam: as still scans do of worlds with both at these poses.
TEST_F(LidarMeshes, RollingScansSeeOthersMove) {
  const auto with = [&](const std::string& keys) {
    world::World world = scene(true);
    for (world::Sensor& sensor : world.movers[0].sensors)
      if (!keys.empty()) sensor.settings.push_back({keys, {1.0}, "", 1, "trial.world"});
    world.interval = 0.01;
    return world;
  };
  const world::World rolling = with("rolling"), still = with("");
  const base::Twist other{2.0, 0.3, 3.0};
  for (const base::Twist& own : {base::Twist{}, base::Twist{-1.0, 0.2, 1.0}}) {
    farm::Farm farm(rolling, host_device(), {.noise = false, .threads = 2});
    farm.subscribe(0, base::only(sensors::kLidar));
    std::vector<base::Report> states{{0, 0, {0, 0, 0, 0.2}, own}, {1, 0, {1.2, -1.0, 0.2, 0.9}, other}};
    std::vector<double> values;
    for (int tick = 0; tick <= 20; ++tick) {
      for (const base::ReadingBlock& r : farm.tick(10'000'000 * tick, states))
        values.assign(r.values.begin(), r.values.end());
      for (base::Report& state : states)
        if (tick < 20) state.X_WM = robots::advance(state.X_WM, state.velocity, 0.01), state.time += 10'000'000;
    }
    farm::Farm reference(still, host_device(), {.noise = false, .threads = 1});
    reference.subscribe(0, base::only(sensors::kLidar));
    std::size_t seen = 0;
    for (std::size_t column = 0; column < 120; column += 2) {
      const double time = -0.1 * static_cast<double>(119 - column) / 120;
      std::vector<base::Report> then = states;
      for (base::Report& state : then) state.X_WM = robots::advance(state.X_WM, state.velocity, time);
      const base::ReadingBlock r = reference.tick(static_cast<std::int64_t>(1 + column) * 1'000'000'000, then)[0];
      for (std::size_t i = column; i < values.size(); i += 120) {
        EXPECT_NEAR(r.values[i], values[i], 1e-6) << i;
        seen += r.hits[i] < rolling.models.size() && rolling.models[r.hits[i]].mover == 1;
      }
    }
    EXPECT_GT(seen, 5u);
  }
}

/// The memory of trails is bounded before a run: 60 s at 100 000 ticks a second.
TEST_F(LidarMeshes, LongTrailsAreRefused) {
  world::World world = scene(false);
  world.interval = 1e-5;
  expect_in("rolling scans of 60 s need the poses of 2 movers in the last 6e+06 ticks; expected at most 5e+06 poses",
            refusal_of([&] { sensors::MoverTrails(world, {}, 60'000'000'000); }));
}

/// An object that takes on another shape is seen as that; with its own size again, as its mesh.
TEST_F(LidarMeshes, ChangedShapesAreSolids) {
  world::World world = scene(true, "shape( name \"crate\" size [1 1 1] )\nmodel( name \"tag1\" pose [2 2 0 0] mesh \"" +
                                       path("box.obj") + "\" )\n");
  sensors::SpatialScene scene(world, 20.0);
  std::vector<base::Report> states;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) states.push_back({m, 0, world.movers[m].X_WM, {}});
  const auto seen = [&] {
    scene.update_movers(world);
    scene.place(states);
    sensors::SceneList list;
    const std::vector<scene::Instance>& out = list.instances;
    scene.list({.range = 20.0}, list);
    EXPECT_EQ(out.size(), 7u);
    return out.back().owner == base::kNoHit ? "solid" : "mesh";
  };
  EXPECT_STREQ(seen(), "mesh");
  world::change_shape(world, 2, {.shape = "crate"});
  EXPECT_STREQ(seen(), "solid");
  world::change_shape(world, 2, {.shape = "original"});
  EXPECT_STREQ(seen(), "mesh");
}

/// An object that takes on another size is seen as its mesh in that size, as the file could have stated it; changed
/// again, and with its own size, too. Its outline alone, a box, would be seen otherwise.
TEST_F(LidarMeshes, ChangedSizesScaleMeshes) {
  write("tent.obj",
        "mtllib m.mtl\nusemtl dark\nv -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nv 0.1 0 1\n"
        "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 4 3 2\n");
  write("m.mtl", "newmtl dark\nKd 0.1\n");
  const auto world_with = [&](const std::string& size) {
    return world_of("model( name \"tag1\" stack_children 0 pose [2 0.3 0.1 20] origin [0.1 0.2 0 30] size " + size +
                    " mesh \"" + path("tent.obj") + "\" model( size [0.1 0.1 1.5] mesh \"" + path("tent.obj") +
                    "\" ) )\nposition( name \"r1\" lidar( channels 24 fov_v [-40 40] columns 240 range [0 20] "
                    "intensity 1 size [0 0 1] ) )\n");
  };
  const std::string file = "[1 1 1]";
  world::World world = world_with(file);
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const auto scan = [](farm::Farm& of) {
    const base::ReadingBlock r = of.sense(1, sensors::kLidar, 0, {});
    return std::vector<double>(r.values.begin(), r.values.end());
  };
  const auto as_written = [&](const std::string& size) {
    const world::World written = world_with(size);
    farm::Farm other(written, host_device(), {.noise = false, .threads = 1});
    return scan(other);
  };
  const std::vector<double> before = scan(farm);
  for (const auto& [size, text] :
       {std::pair{glm::dvec3{0.7, 1.3, 0.4}, "[0.7 1.3 0.4]"}, {glm::dvec3{2.0, 0.1, 0.9}, "[2 0.1 0.9]"}}) {
    world::change_shape(world, 0, {.size = size});
    farm.update_outlines();
    const std::vector<double> found = scan(farm), expected = as_written(text);
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-12) << text << i;
    EXPECT_NE(found, before);
  }
  world::change_shape(world, 0, {.shape = "original"});
  farm.update_outlines();
  EXPECT_EQ(scan(farm), before);

  world.meshes[0].corners.resize(3 * world::kMostChangedSides);
  expect_in("2000004 sides, and triangles of scaled meshes, together; expected at most 2000000",
            refusal_of([&] { world::change_shape(world, 0, {.size = glm::dvec3{2.0}}); }));
}

/// Triangles in all places are bounded where sensors are read, before anything is built from them: `check` refuses what
/// `sense` refuses. Worlds without spatial sensors may have more.
TEST_F(LidarMeshes, TrianglesInAllPlacesAreBounded) {
  world::World world = scene(true);
  world.meshes[0].corners.resize(3u << 20), world.mesh_models.resize(2047, world.mesh_models[0]);
  for (world::MeshModel& row : world.mesh_models) row = {0, 0, {}};
  EXPECT_NO_THROW(sensors::SensorSet{world});
  world.mesh_models.push_back({0, 0, {}});
  expect_in("has 2147483648 triangles of meshes in all their places; expected fewer than 2147483648",
            refusal_of([&] { sensors::SensorSet{world}; }));
  world.movers[0].sensors.clear(), world.movers[1].sensors.clear();
  EXPECT_NO_THROW(sensors::SensorSet{world});
}

/// Far from the origin, and beyond a lidar's range, where meshes are not listed.
TEST_F(LidarMeshes, PlacesFarAway) {
  world::World meshes = scene(true, "box( pose [500 0 0 0] size [1 1 1] )\n"), solids = scene(false);
  world::translate(meshes, 9e6, -5e6);
  world::translate(solids, 9e6, -5e6);
  farm::Farm mine(meshes, host_device(), {.noise = false, .threads = 1});
  farm::Farm theirs(solids, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock a = sense(mine, meshes), b = sense(theirs, solids);
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    if (!a.quality.empty() && a.quality[i] != base::QualityFlag::none) continue;
    ASSERT_NEAR(a.values[i], b.values[i], 1e-7) << "walls of solids are rounded to 2 nm here";
  }
  sensors::SpatialScene scene(meshes, 20.0);
  std::vector<base::Report> states;
  for (std::uint32_t m = 0; m < meshes.movers.size(); ++m) states.push_back({m, 0, meshes.movers[m].X_WM, {}});
  scene.place(states);
  sensors::SceneList list;
  const std::vector<scene::Instance>& out = list.instances;
  scene.list({.p = scene.X_WM(0).p, .range = 20.0}, list);
  EXPECT_EQ(out.size(), 6u);
}

/// A ball of 2 m, 20 m away, may be off by 4 mrad, 8 cm; without a bound, and with fewer triangles.
TEST_F(LidarMeshes, CoarseMeshesAreNear) {
  std::string ball;
  constexpr int kRings = 150, kColumns = 300;
  for (int i = 0; i <= kRings; ++i)
    for (int k = 0; k < kColumns; ++k) {
      const double a = M_PI * i / kRings, b = 2 * M_PI * k / kColumns;
      ball += fmt::format("v {} {} {}\n", std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    }
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kColumns; ++k) {
      const int a = 1 + i * kColumns + k, b = 1 + i * kColumns + (k + 1) % kColumns;
      if (i > 0) ball += fmt::format("f {} {} {}\n", a, a + kColumns, b);
      if (i + 1 < kRings) ball += fmt::format("f {} {} {}\n", b, a + kColumns, b + kColumns);
    }
  write("ball.obj", ball);
  const auto world = [&](const std::string& mode) {
    return world_of("model( pose [20 0 0 0] size [2 2 2] mesh \"" + path("ball.obj") +
                    "\" )\nposition( size [0.4 0.4 0.5] "
                    "lidar( pose [0 0 0.5 0] channels 21 fov_v [-2 2] columns 21 fov 4 range [0 50] " +
                    mode + " ) )");
  };
  const world::World fine = world(""), coarse = world("accuracy \"coarse4\"");
  farm::Farm exact(fine, host_device(), {.noise = false, .threads = 1});
  farm::Farm fast(coarse, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock a = exact.sense(0, sensors::kLidar, 0, {}), b = fast.sense(0, sensors::kLidar, 0, {});
  EXPECT_TRUE(std::isinf(b.bound_without_noise));
  double worst = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    EXPECT_EQ(a.hits[i], b.hits[i]);
    worst = std::max(worst, std::abs(a.values[i] - b.values[i]));
  }
  EXPECT_LT(worst, 0.08);
  EXPECT_GT(worst, 1e-6) << "nothing was simplified";
}

}  // namespace
}  // namespace sf::trial
