// `field`: a picture of a world's magnets, and numbers.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>

#include "tests/apps/program.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"

namespace sf {
namespace {

std::string magnets(const Folder& folder) {
  return folder.write("magnets.world",
                      "define magnet model( size [0.025 0.025 0.1] magnetic_moment 10000 )\n"
                      "magnet( pose [0 0 -0.1 0] ) magnet( pose [0.071 0 -0.1 0] )\n");
}

TEST(Field, WritesAPicture) {
  const Folder folder;
  const Outcome outcome =
      run_successfully({"field", our_world("six_magnets.world"), "--height", "0.075", "-o", folder.path("six.png")});
  EXPECT_NE(outcome.err.find("wrote"), std::string::npos);
  const scenes::Picture picture = scenes::read_png(folder.path("six.png"));
  std::set<std::uint32_t> colours;
  for (int x = 0; x < picture.width; ++x) colours.insert(picture.at(x, picture.height / 3));
  EXPECT_GT(colours.size(), 50u) << "the map ranges from zero to the field above the magnets";
}

/// Directly above a magnet of 1 A m^2, 12.5 cm from its centre, next to another: more than a Gauss.
TEST(Field, WritesNumbersAlongALine) {
  const Folder folder;
  run_successfully({"field", magnets(folder), "--height", "0.075", "-o", folder.path("x.png"), "--line", "0,-1,0,1",
                    "--extent", "-1,-1,1,1", "--csv", folder.path("x.csv")});
  std::istringstream csv(read_file(folder.path("x.csv")));
  std::string line, middle;
  std::getline(csv, line);
  EXPECT_EQ(line, "along_m,x_m,y_m,z_m,field_gauss,x_gauss,y_gauss,z_gauss,magnitudes_gauss");
  std::size_t rows = 0;
  while (std::getline(csv, line)) {
    if (rows == 600) middle = line;
    ++rows;
  }
  EXPECT_EQ(rows, 1201u);
  double along, x, y, z, field;
  char comma;
  std::istringstream(middle) >> along >> comma >> x >> comma >> y >> comma >> z >> comma >> field;
  EXPECT_EQ(along, 1.0);
  EXPECT_NEAR(y, 0.0, 1e-12);
  EXPECT_EQ(z, 0.075);
  EXPECT_NEAR(field, 1.5143, 1e-4) << "1.024 upwards, plus the other magnet's 0.427 upwards and 0.434 sideways";
}

TEST(Field, RejectsInvalidArguments) {
  const Folder folder;
  const std::string world = magnets(folder), png = folder.path("x.png");
  const std::string bare = folder.write("bare.world", "model( size [1 1 1] )\n");
  const std::pair<Words, std::string> refusals[] = {
      {{"field", bare, "--height", "1", "-o", png}, "has no magnets"},
      {{"field", world, "-o", png}, "--height is required"},
      {{"field", world, "--height", "1"}, "--out is required"},
      {{"field", world, "--height", "high", "-o", png}, "--height"},
      {{"field", world, "--height", "nan", "-o", png}, "--height"},
      {{"field", world, "--height", "1", "-o", png, "--line", "1,2,1,2"}, "X0,Y0,X1,Y1"},
      {{"field", world, "--height", "1", "-o", png, "--extent", "1,2,0,4"}, "XMIN,YMIN,XMAX,YMAX"},
      {{"field", world, "--height", "1", "-o", folder.path("none/x.png")}, "none/x.png"},
      {{"field", folder.path("none.world"), "--height", "1", "-o", png}, "none.world"},
  };
  for (const auto& [arguments, message] : refusals) expect_refused(arguments, message);
  const std::string csv = folder.path("none/x.csv");
  const Outcome outcome = run_program({"field", world, "--height", "1", "-o", png, "--csv", csv});
  EXPECT_EQ(outcome.code, 2);
  expect_in(csv, outcome.err);
  EXPECT_FALSE(std::filesystem::exists(png)) << "nothing is written if a part cannot be";
}

TEST(Field, NeedsADevice) {
  const Folder folder;
  EXPECT_EQ(run_program({"field", magnets(folder), "--height", "1", "-o", folder.path("x.png"), "--require-vulkan"},
                        no_device())
                .code,
            3);
}

}  // namespace
}  // namespace sf
