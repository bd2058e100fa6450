// `check` and `draw`: facts about a world, as numbers and as a picture.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"

namespace sf {

namespace {

// A box, a floor plan, a robot with two lasers, one of each dialect, a magnet and two mistakes.
const char* const kWorld = R"(name "small"
model( name "box" pose [3 0 0 0] size [1 2 1] )
model( name "plan" pose [0 5 0 0] size [4 4 1] bitmap "plan.pgm" )
position(
  name "roomba7"
  size [0.3 0.3 0.1]
  laser( samples 5 range_maxx 3 )
  ranger( sensor( range [0 2] fov 30 samples 3 ) )
)
model( name "magnet" pose [0 -3 0 0] size [0.1 0.1 0.1] magnetic_moment 10000 )
gearbox( pose [0 -4 0 0] )
)";

// Two cells that meet at a corner, and a pair that forms one wall: 4 + 4 + 4 runs, none of which is merged across the
// corner.
const char* const kPlan = "P2\n4 4\n255\n0 255 255 255\n255 0 255 255\n255 255 255 255\n255 255 0 0\n";

std::string small_world(const Folder& folder) {
  folder.write("plan.pgm", kPlan);
  return folder.write("small.world", kWorld);
}

}  // namespace

/// `check` lists each mesh, the triangles that leave it open, and the size of the terrain.
TEST(Check, MeshesAndTerrainAreExamined) {
  const Folder folder;
  folder.write("closed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  folder.write("fan.obj",
               "v 4 -1 0\nv 4 1 0\nv 4 0 2\nv 3 0 2\nv 5 0 2\nf 1 1 2\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 3\n");
  const std::string world = folder.write("w.world", "model( mesh \"closed.obj\" )\nmodel( mesh \"fan.obj\" )\n");
  const Outcome text = run_program({"check", world});
  expect_in("closed.obj: 4 triangles, closed: back faces are hidden", text.out);
  expect_in(
      "fan.obj: 4 triangles, not closed, seen from both sides: 4 edges of one triangle (first: triangle 2), 1 edge of "
      "three or more (first: triangle 1), 1 triangle with the corners of another (first: triangle 4)",
      text.out);
  expect_in("fan.obj are left out, since their area is 0; the first is number 1", text.out + text.err);
  const Json facts(run_program({"check", world, "--json"}).out);
  EXPECT_EQ(facts.number("/mesh_files/0/closed_bodies"), 1);
  EXPECT_EQ(facts.number("/mesh_files/1/closed_bodies"), 0);
  EXPECT_EQ(facts.number("/mesh_files/1/edges_of_one_triangle/count"), 4);
  EXPECT_EQ(facts.number("/mesh_files/1/edges_of_three_or_more/first_triangle"), 1);
  EXPECT_EQ(facts.size("/terrain"), 0u);
  const std::string hills = run_program({"check", SF_SOURCE_DIR "/worlds/terrain.world"}).out;
  expect_in("terrain/hills.png: 129 x 129 points, 128 x 128 m, heights from", hills);
}

/// A noisy sensor has no bound, but states the bound that it would have without noise.
TEST(Check, NoisySensorsHaveNoBound) {
  const Folder folder;
  const std::string world = folder.write("w.world",
                                         "position( name \"a\" laser( noise [0.2 0 0] ) laser( noise [0 0 1] ) "
                                         "laser( samples 3 ) )\nmodel( pose [5 0 0 0] size [1 1 1] )\n");
  const Outcome outcome = run_program({"check", world, "--json"});
  const Json facts(outcome.out);
  ASSERT_EQ(facts.size("/accuracy"), 3u) << outcome.out;
  for (const std::string row : {"/accuracy/0", "/accuracy/1"}) {
    EXPECT_TRUE(facts.is_null(row + "/bound"));
    EXPECT_LT(facts.number(row + "/bound_without_noise"), 2e-9);
  }
  EXPECT_EQ(facts.number("/accuracy/0/sigma"), 0.2);
  EXPECT_TRUE(facts.is_null("/accuracy/1/sigma")) << "a beam that turns may meet another surface";
  EXPECT_LT(facts.number("/accuracy/2/bound"), 2e-9);
  EXPECT_FALSE(facts.has("/accuracy/2/sigma"));
  const std::string text = run_program({"check", world}).out;
  for (const std::string message :
       {"1 laser exact, no bound, noise of sigma 200 mm; without noise within 1.0",
        "1 laser exact, no bound, noise; without noise within 1.0", "1 laser exact, within 1.0"})
    EXPECT_NE(text.find(message), std::string::npos) << message << " is not in\n" << text;
  const Json reading(run_program({"sense", world, "--json"}).out);
  EXPECT_TRUE(reading.is_null("/bound"));
  EXPECT_LT(reading.number("/bound_without_noise"), 2e-9);
  EXPECT_EQ(reading.number("/sigma"), 0.2);
}

/// How often sensors are read, which of them between ticks, and for which ones a tick rate would be too low.
TEST(Check, RatesAreReported) {
  const Folder folder;
  const std::string world = folder.write("w.world",
                                         "interval_sim 100\nposition( name \"roomba1\" laser( rate 5 ) "
                                         "laser( rate 13 ) gps( rate 1 ) gyro( rate 10 phase 0.05 ) )\n");
  const Outcome outcome = run_program({"check", world, "--json"});
  const Json facts(outcome.out);
  EXPECT_TRUE(outcome.err.empty()) << outcome.err;
  EXPECT_EQ(facts.number("/rates_hz/laser/0"), 5);
  EXPECT_EQ(facts.number("/rates_hz/laser/1"), 13);
  EXPECT_EQ(facts.number("/rates_hz/gps/1"), 1);
  ASSERT_EQ(facts.size("/between_ticks"), 2u) << "5 Hz and 1 Hz divide the ticks' 10";
  EXPECT_EQ(facts.text("/between_ticks/0"), "laser");
  EXPECT_EQ(facts.text("/between_ticks/1"), "gyro") << "by its phase";

  const Outcome text = run_program({"check", world, "--rate", "10"});
  EXPECT_NE(text.out.find("laser 5 to 13 Hz"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("also read between ticks: laser, gyro"), std::string::npos) << text.out;
  EXPECT_NE(text.err.find("--rate 10 is too low for 1 sensor (laser 5 to 13 Hz)"), std::string::npos) << text.err;
  EXPECT_TRUE(run_program({"check", world, "--rate", "13"}).err.empty());
}

/// Boundary: more than a thousand batches per second are reported.
TEST(Check, ManySamplingTimesAreReported) {
  const Folder folder;
  const std::string laser = "position( name \"roomba1\" laser( rate ";
  EXPECT_TRUE(run_program({"check", folder.write("w.world", laser + "1000 ) )\n")}).err.empty());
  const std::string world = folder.write("w.world", laser + "1001 ) )\n");
  for (const Words& words : {Words{"check", world}, Words{"run", world, "--duration", "0.1"}}) {
    const Outcome outcome = run_program(words);
    EXPECT_NE(outcome.err.find("1001 different times per second"), std::string::npos) << outcome.err;
  }
}

TEST(Check, WarningsNameFileAndLineAndSuggest) {
  const Folder folder;
  const std::string world = small_world(folder);
  const Json facts(run_program({"check", world, "--json"}).out);
  ASSERT_EQ(facts.size("/warnings"), 2u);
  EXPECT_EQ(facts.text("/warnings/0/file"), world);
  EXPECT_EQ(facts.number("/warnings/0/line"), 7);
  EXPECT_NE(facts.text("/warnings/0/message").find("did you mean 'range_max'?"), std::string::npos);
  EXPECT_EQ(facts.number("/warnings/1/line"), 11);
  const Outcome text = run_successfully({"check", world});
  EXPECT_NE(text.out.find(world + ":7: "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(world + ":11: "), std::string::npos) << text.out;
}

/// Cars read their settings when a fleet is made, which `check` does.
TEST(Check, RefusesSettingsOfCars) {
  const Folder folder;
  const std::string world =
      folder.write("car.world", "position( name \"c\" size [1 1 1] drive \"car\"\n dynamics \"car mass=-3\" )\n");
  const Outcome outcome = run_program({"check", world});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find(world + ":2: 'dynamics': 'mass' is '-3'; expected a number"), std::string::npos)
      << outcome.err;
}

TEST(Check, NamesWithInvalidUtf8GiveValidJson) {
  const Folder folder;
  const std::string world = folder.write("latin.world",
                                         "name \"K\xfc"
                                         "che\"\nmodel( name \"T\xfcr\" size [1 1 1] )\n");
  const Outcome outcome = run_successfully({"check", world, "--json"});
  EXPECT_EQ(Json(outcome.out).number("/segments"), 4);
}

TEST(Check, RosMapsLoadAsWorlds) {
  const Folder folder;
  folder.write("plan.pgm", kPlan);
  const std::string map = folder.write("map.yaml",
                                       "image: plan.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
                                       "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const Json facts(run_program({"check", map, "--json"}).out);
  EXPECT_EQ(facts.number("/robots"), 0);
  EXPECT_EQ(facts.number("/segments"), 12);
}

TEST(Check, EveryWorldOfStageAndRosLoads) {
  const std::string data = SF_SOURCE_DIR "/../shared/data/";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no shared data here";
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
    const std::string ending = entry.path().extension().string();
    if (ending != ".world" && ending != ".yaml") continue;
    if (entry.path().string().find("/reports/") != std::string::npos) continue;  // files with mistakes
    ++seen;
    const Json facts = run_json({"check", entry.path().string(), "--json"});
    EXPECT_GT(facts.number("/segments"), 100) << entry.path();
    EXPECT_LE(facts.size("/warnings"), 3u) << entry.path() << ": a file that works is not complained about";
    if (entry.path().filename() == "hospital.world") {
      EXPECT_EQ(facts.number("/robots"), 1000);
    }
  }
  EXPECT_GE(seen, 5u);
}

/// Files from users' reports, each with the expected message.
TEST(Check, FilesFromReportsAreReadOrRejected) {
  const std::string reports = SF_SOURCE_DIR "/../shared/data/reports/";
  if (!std::filesystem::exists(reports)) GTEST_SKIP() << "no shared data here";
  struct Report {
    const char* file;
    int code;
    const char* says;
  };
  for (const auto& [file, code, says] :
       std::vector<Report>{{"world/gazebo.world", 2, "is a file of Gazebo (SDFormat)"},
                           {"world/x.argos", 2, "is a file of ARGoS"},
                           {"world/flatland.yaml", 2, "flatland.yaml:4: is a file of flatland"},
                           {"world/jpg.world", 2, "cannot find the bitmap \"maps/jpg.jpg\""},
                           {"world/pad.png", 2, "is a picture; expected a world"},
                           {"world/noblocks_bitmap.world", 0, "removes only the default box"},
                           {"world/boundary_noblocks.world", 0, "removes only the default box"},
                           {"world/pad.world", 0, "its margins of 20 (left), 20 (right), 10 (below) and 10 (above)"},
                           {"world/overlap.world", 0, "4 robots overlap others at the start"},
                           {"maps/alpha.yaml", 0, "alpha affects 130 cells"},
                           {"maps/neg_float.yaml", 0, "'negate: 1.0' is read as true"},
                           {"maps/neg_true.yaml", 0, "warnings           0"},
                           {"maps/negv.yaml", 0, "warnings           0"}}) {
    const Outcome outcome = run_program({"check", reports + file});
    EXPECT_EQ(outcome.code, code) << file;
    expect_in(says, outcome.out + outcome.err);
  }
}

TEST(Draw, WritesAPictureWithoutADisplay) {
  const Folder folder;
  run_successfully({"draw", small_world(folder), "-o", folder.path("small.png")});
  const scenes::Picture picture = scenes::read_png(folder.path("small.png"));
  EXPECT_GE(std::min(picture.width, picture.height), 400);
  EXPECT_GT(picture.count(0xFFFFFFFFu), picture.width * picture.height / 2) << "ground";
  EXPECT_GT(picture.count(0xFF404040u), picture.width) << "the frame";
  std::set<std::uint32_t> colours;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) colours.insert(picture.at(x, y));
  EXPECT_GT(colours.size(), 100u) << "walls, a robot and its view, a magnet, letters";
}

}  // namespace sf
