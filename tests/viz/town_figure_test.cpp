#include "viz/town_figure.h"

#include <gtest/gtest.h>

#include "tests/viz/png.h"
#include "world/world.h"

namespace sf::viz {
namespace {

constexpr std::uint32_t kGreen = 0xFF43A047u, kRed = 0xFFE53935u, kYellow = 0xFFFDD835u;

const world::World& town() {
  static const world::World world = world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world");
  return world;
}

/// Two cars that drive east along the south straight road, and a pedestrian.
struct Scene {
  Scene() {
    for (const std::uint32_t row : {0u, 1u, 6u}) {
      Track track{.name = town().movers[row].name};
      for (int i = 0; i <= 10; ++i) track.poses.push_back({town().movers[row].X_WM.x + 0.1 * i, 0.75, 0.0, 0.0});
      tracks.push_back(track);
      end.movers.push_back(row);
      end.follows.push_back(world::kNone);
    }
  }
  scenes::Picture draw(const char* name) const {
    draw_town(town(), tracks, end, scenes::own_file(name));
    return scenes::read_png(scenes::own_file(name));
  }
  std::vector<Track> tracks;
  TownFinalState end;
};

int pixels(const scenes::Picture& picture, std::uint32_t color) {
  return picture.count(color, 0, 0, picture.width, picture.height);
}

/// At 9 s of SimVille's plan, two of the seven lights are yellow; at 5 s, none.
TEST(TownFigure, LightsHaveTheirFinalState) {
  Scene scene;
  scene.end.time = 5.0;
  const scenes::Picture before = scene.draw("town5.png");
  scene.end.time = 9.0;
  const scenes::Picture after = scene.draw("town9.png");
  EXPECT_EQ(pixels(before, kYellow), 0);
  EXPECT_GT(pixels(after, kYellow), 50);
  EXPECT_GT(pixels(before, kGreen), pixels(after, kGreen));
  EXPECT_GT(pixels(before, kRed), 50);
}

/// The connections of followers are dark, and absent in a picture without a convoy.
TEST(TownFigure, FollowersAreConnectedToTheRobotAhead) {
  Scene scene;
  scene.end.time = 5.0;
  const int without = pixels(scene.draw("town-alone.png"), 0xFF202020u);
  scene.end.follows[0] = 1;
  EXPECT_GT(pixels(scene.draw("town-convoy.png"), 0xFF202020u), without + 100);
}

TEST(TownFigure, TracksWithoutPosesAreOmitted) {
  Scene scene;
  scene.tracks[0].poses.clear();
  scene.end.follows[0] = 1;
  const scenes::Picture without = scene.draw("town-empty.png");
  scene.end.follows[0] = world::kNone;
  EXPECT_LT(pixels(without, 0xFF202020u), pixels(scene.draw("town-untied.png"), 0xFF202020u) + 100)
      << "a word in the legend, no tie to nowhere";
  EXPECT_GT(pixels(without, kRed), 50) << "the town is there";
}

}  // namespace
}  // namespace sf::viz
