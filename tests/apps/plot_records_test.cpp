// The files of `plot`, compared with a golden record.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/apps/program.h"
#include "tests/golden.h"

namespace sf {
namespace {

/// Two robots with most kinds of sensors, lights and magnets.
constexpr const char* kWorld = R"(
define block model( size [1 1 1] obstacle_return 1 )
define magnet model( size [0.025 0.025 0.1] magnetic_moment 10000 )
model( name "room" size [8 8 1] boundary 1 obstacle_return 1 )
block( pose [2 2 0 0] )
magnet( pose [-1 -2 0 0] ) magnet( pose [-0.5 -2 0 0] ) magnet( pose [1.5 -1 0 0] )
position( name "one" pose [-2 -2 0 10]
  laser( samples 31 fov 180 range_max 3 rate 5 ) sonar( scount 2 spose[0] [0.1 0 0] spose[1] [0 0.1 90] )
  encoder( ) gps( ) occupancy( cell 0.5 words [2 1] )
  magnetometer( name "array" pose [0.3 0 -0.1 0] size [0.02 0.3 0.1] scount 2 spose[0] [0 0.1 0] spose[1] [0 -0.1 0] ) )
position( name "two" pose [1 -2 0 90] laser( samples 16 rate 2 ) laneedge( ) occupancy( cell 0.5 words [2 1] )
  magnetometer( name "array" pose [0.3 0 -0.1 0] size [0.02 0.3 0.1] scount 2 spose[0] [0 0.1 0] spose[1] [0 -0.1 0] ) )
light( name "lamp" pose [0 3 0 0] phases 2 phase[0] ["green" 2] phase[1] ["red" 2] )
light( name "late" pose [1 3 0 0] phases 2 phase[0] ["yellow" 1] phase[1] ["flashing red" 0.5] )
)";

/// Returns the sorted names of a folder's files.
std::vector<std::string> files_of(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(PlotRecord, DrawsARecordedRun) {
  const Folder folder;
  run_successfully(
      {"run", folder.write("w.world", kWorld), "--duration", "3", "--record", folder.path("r"), "--record-readings"});
  run_successfully({"plot", folder.path("r"), "-o", folder.path("p"), "--format", "svg", "--csv"});
  std::string names;
  for (const std::string& name : files_of(folder.path("p"))) {
    const bool is_table = name.ends_with(".csv");
    names +=
        is_table ? fmt::format("{}, {} lines\n", name, count_lines(read_file(folder.path("p/" + name)))) : name + "\n";
    EXPECT_EQ(read_file(folder.path("p/" + name)).find("<text") == std::string::npos, is_table) << name;
  }
  golden::expect(names, "apps", "plot_files", 0.0);
}

}  // namespace
}  // namespace sf
