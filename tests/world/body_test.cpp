// Bodies as Stage builds them from the default box, a bitmap, a boundary and blocks (libstage/model.cc, blockgroup.cc).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/files.h"
#include "tests/folder.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

/// Pictures: `full` is solid to its edges, `pad` has a solid part of 4 x 2 pixels in the middle of 8 x 8, `light` has
/// none.
class Bodies : public FolderTest {
 protected:
  Bodies() {
    write("full.pgm", "P2 4 2 255\n0 0 0 0 0 255 255 0\n");
    std::string pad = "P2 8 8 255\n";
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) pad += (x >= 1 && x < 5 && y >= 4 && y < 6) ? "0 " : "255 ";
    write("pad.pgm", pad);
    write("light.pgm", "P2 2 2 255\n255 128 200 130\n");
  }
  World read(const std::string& text) const { return build_world(path("w.world"), text, kWithLasers); }
};

std::string extent_of(const World& world) {
  const Extent& e = world.extent;
  return fmt::format("{:g} {:g} {:g} {:g}", e.x_min, e.y_min, e.x_max, e.y_max);
}

constexpr const char* kSquare = "block( points 4 z [0 1] point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] )";

TEST_F(Bodies, NoblocksRemovesOnlyTheDefaultBox) {
  EXPECT_TRUE(read("model( noblocks 1 )").walls.empty());
  EXPECT_EQ(warnings_of(read("model( noblocks 1 )")), "");
  for (const std::string part : {"boundary 1", "bitmap \"full.pgm\"", kSquare}) {
    const World with = read("model( size [6 4 1]\n noblocks 1 " + part + " )");
    EXPECT_EQ(with.hash, read("model( size [6 4 1] " + part + " )").hash) << part;
    EXPECT_NE(warnings_of(with).find("2: 'noblocks' removes only the default box, as in Stage"), std::string::npos);
    const World old = read("old_shapes 1 model( size [6 4 1] noblocks 1 " + part + " )");
    EXPECT_TRUE(old.walls.empty()) << part;
    EXPECT_EQ(warnings_of(old), "") << part;
  }
}

/// Drawing programs write corners two and three times.
TEST_F(Bodies, RepeatedCornersMakeNoWall) {
  const World world = read(
      "model( size [2 2 1] block( points 7 z [0 1] point[0] [0 0] point[1] [0 0] point[2] [1 0] "
      "point[3] [1 1] point[4] [1 1] point[5] [1 1] point[6] [0 1] ) )");
  EXPECT_EQ(world.walls.size(), 4u);
  for (const Segment& s : world.walls) EXPECT_EQ(glm::length(s.b - s.a), 2.0);
}

TEST_F(Bodies, DenormalsAreNumbers) {
  for (const std::string x : {"5e-324", "-5e-324", "1e-310", "-0", "2.3e-308"})
    EXPECT_EQ(extent_of(read("model( pose [" + x + " 0 0 0] size [1 1 1] )")), "-0.5 -0.5 0.5 0.5") << x;
}

TEST_F(Bodies, SolidPartOfAPictureFillsTheSize) {
  const World world = read("model( size [20 10 1]\n bitmap \"pad.pgm\" )");
  EXPECT_EQ(extent_of(world), "-10 -5 10 5");
  EXPECT_EQ(world.walls.size(), 4u);
  EXPECT_EQ(world.models[0].pixel, 5.0);
  EXPECT_EQ(warnings_of(world),
            "2: the picture's solid part is scaled to 'size', as in Stage: its margins of 1 (left), 3 (right), 2 "
            "(below) and 4 (above) of 8 x 8 pixels are left out; the world key old_shapes 1 includes them\n");
  const World old = read("old_shapes 1\nmodel( size [20 10 1] bitmap \"pad.pgm\" )");
  EXPECT_EQ(extent_of(old), "-7.5 -2.5 2.5 0");
  EXPECT_EQ(old.models[0].pixel, 2.5);
  EXPECT_EQ(warnings_of(old), "");
}

TEST_F(Bodies, PictureWithoutMarginsIsReadAsBefore) {
  const World world = read("model( size [20 10 1] bitmap \"full.pgm\" )");
  EXPECT_EQ(world.hash, read("old_shapes 1 model( size [20 10 1] bitmap \"full.pgm\" )").hash);
  EXPECT_EQ(warnings_of(world), "");
}

TEST_F(Bodies, PictureWithoutWallsIsAWarning) {
  const World world = read("model( size [2 2 1] bitmap \"light.pgm\" )");
  EXPECT_TRUE(world.walls.empty());
  EXPECT_EQ(warnings_of(world), "1: the picture has no dark pixel, so it has no walls\n");
}

/// Stage adds the blocks to a picture that fills `size`, then scales everything to `size`.
TEST_F(Bodies, BlocksWithAPictureAreInMetres) {
  const World inside = read("model( size [20 10 1] bitmap \"full.pgm\"\n " + std::string(kSquare) + " )");
  EXPECT_EQ(extent_of(inside), "-10 -5 10 5");
  const Segment& block = inside.walls.back();
  EXPECT_NEAR(block.a.x, 0.0, 1e-12);
  EXPECT_NEAR(block.a.y, 1.0, 1e-12) << "the square's upper left corner";
  EXPECT_NE(warnings_of(inside).find("'model' also has blocks: their points are in metres"), std::string::npos);

  // A block from -10 to 30 m shrinks everything to half its width.
  const World outside = read(
      "model( size [20 10 1] bitmap \"full.pgm\" block( points 3 z [0 2] point[0] [0 0] point[1] [30 0] point[2] [0 1] "
      ") )");
  EXPECT_EQ(extent_of(outside), "-10 -5 10 5");
  EXPECT_EQ(outside.walls.front().z_max, 0.5) << "the block is twice as high as the picture";
  double picture = -10.0;
  for (std::size_t i = 0; i + 3 < outside.walls.size(); ++i) picture = std::max(picture, outside.walls[i].a.x);
  EXPECT_NEAR(picture, 0.0, 1e-12);

  const World old = read("old_shapes 1 model( size [20 10 1] bitmap \"full.pgm\" " + std::string(kSquare) + " )");
  EXPECT_EQ(old.walls.back().a.y, 5.0) << "the square was scaled to all of 'size'";
}

TEST_F(Bodies, BoundaryAndBlocksAreKeptWithAWarning) {
  const World world = read("model( size [2 2 1]\n boundary 1 " + std::string(kSquare) + " )");
  EXPECT_EQ(world.walls.size(), 12u);
  EXPECT_EQ(warnings_of(world),
            "2: 'model' has a boundary and blocks: Stage omits the boundary, the farm keeps both\n");
}

TEST_F(Bodies, RaisedBlocksAreAWarning) {
  const auto block = [](const char* z) {
    return fmt::format("model( size [1 1 1] block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1]{} ) )", z);
  };
  const World world = read(block(" z [0.5 1]"));
  EXPECT_EQ(world.walls[0].z_min, 0.5);
  EXPECT_EQ(warnings_of(world),
            "1: the blocks of 'model' do not begin at z 0: they reach from 0.5 to 1 m, in Stage 4 from 1 to 2 m\n");
  EXPECT_EQ(warnings_of(read(block(" z [0 0.5]"))), "");
  EXPECT_EQ(warnings_of(read(block(""))),
            "1: this block has no 'z': it is read as [0 1]; Stage 4 gives it no height\n");
}

/// Keys with an effect in Stage: one warning each, however many robots have them.
TEST_F(Bodies, KeysWithoutAnEffectAreNamedOnce) {
  const World world = read(
      "\nposition( velocity [1 0 0 0] localization \"odom\" )\n"
      "position( pose [2 0 0 0] velocity [1 0 0 0] )\n");
  EXPECT_EQ(warnings_of(world),
            "2: 'velocity' has no effect here: robots stay at rest until they are commanded\n"
            "2: 'localization' has no effect here: robots have their true poses, without drift\n");
  EXPECT_EQ(warnings_of(read("position( velocity [0 0 0 0] localization \"gps\" )")), "");
}

TEST_F(Bodies, TransparentDarkPixelsAreFreeWithAWarning) {
  write("clear.png", base::read_text(SF_SOURCE_DIR "/tests/fuzz/picture/two_colours.png"));
  EXPECT_EQ(warnings_of(read("model( size [2 1 1] bitmap \"clear.png\" )")),
            "1: 1 dark pixels of the picture are transparent and therefore free; Stage ignores transparency and treats "
            "them as walls\n1: the picture has no dark pixel, so it has no walls\n");
}

/// Stage searches the folder of the world file, even for files that an include refers to.
TEST_F(Bodies, FileThatStageFindsElsewhereIsAWarning) {
  std::filesystem::create_directories(folder_ / "inc");
  std::filesystem::copy(folder_ / "pad.pgm", folder_ / "inc" / "full.pgm");
  write("inc/other.inc", "");
  write("inc/plan.inc", "# a plan\ndefine plan model( size [4 2 1] bitmap \"full.pgm\" )\n");
  const World world = read("include \"inc/plan.inc\"\nplan( )");
  EXPECT_EQ(world.walls.size(), 4u) << "the one next to the include";
  const std::string warnings = warnings_of(world);
  EXPECT_EQ(warnings.substr(0, 18), "2: the picture is ") << warnings;
  EXPECT_NE(warnings.find("inc/full.pgm; Stage uses "), std::string::npos) << warnings;
  EXPECT_EQ(warnings_of(read("include \"inc/plan.inc\"\nplan( bitmap \"full.pgm\" )")), "") << "written in the world";
}

/// Input from users' reports.
TEST(BodyReports, AreReadAsInStage) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/reports/world/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const auto load = [&](const char* name) { return load_world(folder + name, kWithLasers); };
  EXPECT_EQ(extent_of(load("boundary_noblocks.world")), "-3 -2 3 2");
  EXPECT_EQ(extent_of(load("noblocks_bitmap.world")), "-10 -5 10 5");
  EXPECT_EQ(extent_of(load("pad.world")), "-10 -5 10 5");
  EXPECT_NE(warnings_of(load("overlap.world")).find("4 robots overlap others at the start"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
