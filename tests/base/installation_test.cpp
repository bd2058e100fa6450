#include "base/installation.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace sf::base {
namespace {

namespace fs = std::filesystem;

TEST(Installation, ExistingFilesTakePrecedence) {
  const fs::path data = fs::temp_directory_path() / "sensorfarm_installation_test";
  fs::create_directories(data / "tests");
  std::ofstream(data / "tests" / "units.h") << "another";
  std::ofstream(data / "there.world") << "x";
  setenv("SENSORFARM_DATA", data.c_str(), 1);
  const fs::path before = fs::current_path();
  fs::current_path(SF_SOURCE_DIR);
  EXPECT_EQ(installed_file("tests/units.h"), "tests/units.h");  // exists here, although it is installed as well
  EXPECT_EQ(installed_file("there.world"), (data / "there.world").string());
  EXPECT_EQ(installed_file("nowhere.world"), "nowhere.world");  // the message then contains the name that the user
                                                                // wrote
  EXPECT_EQ(installed_file("/there.world"), "/there.world");
  setenv("SENSORFARM_DATA", "relative", 1);  // would depend on the current folder
  EXPECT_EQ(installed_file("there.world"), "there.world");
  unsetenv("SENSORFARM_DATA");
  EXPECT_EQ(installed_file("there.world"), "there.world");
  fs::current_path(before);
  fs::remove_all(data);
}

// Users of a build folder work in their own folders.
TEST(Installation, BuildFolderLinksWorldsAndExperiments) {
  const fs::path before = fs::current_path();
  fs::current_path(fs::temp_directory_path());
  for (const char* file : {"worlds/robots.inc", "worlds/cave.world", "experiments/simville.toml"})
    EXPECT_TRUE(fs::equivalent(installed_file(file), fs::path(SF_SOURCE_DIR) / file)) << file;
  fs::current_path(before);
}

TEST(Installation, PluginsAreNextToTheProgram) {
  const fs::path plugin = SF_BINARY_DIR "/sensorfarm_of_a_test.so";
  std::ofstream{plugin} << "";
  EXPECT_EQ(plugin_file("sensorfarm_of_a_test"), plugin.string());
  fs::remove(plugin);
  EXPECT_EQ(plugin_file("sensorfarm_nothing"), "sensorfarm_nothing.so");
}

}  // namespace
}  // namespace sf::base
