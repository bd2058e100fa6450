// Libraries of the program: those for drawing are loaded by drawing commands alone.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/apps/program.h"

namespace sf {
namespace {

/// The dynamic linker's log of libraries loaded at start and later.
std::string loaded_by(const Words& arguments) {
  const Outcome outcome = run_program(arguments, {{"LD_DEBUG", "files"}});
  EXPECT_EQ(outcome.code, 0) << outcome.err.substr(0, 2000);
  EXPECT_NE(outcome.err.find("libvulkan.so"), std::string::npos) << "the linker says nothing";
  return outcome.err;
}

TEST(Loading, CommandsWithoutPicturesLoadNoDrawingLibrary) {
  const std::string world = our_world("rooms.world");
  for (const Words& arguments : {Words{"--version"}, Words{"check", world}, Words{"run", world, "--duration", "0.3"},
                                 Words{"sense", world}, Words{"explain", world}}) {
    const std::string said = loaded_by(arguments);
    for (const char* library : {"libvtk", "libcairo", "libfreetype", "libpng", "sensorfarm_cairo"})
      EXPECT_EQ(said.find(library), std::string::npos) << arguments[0] << " loads " << library;
  }
}

TEST(Loading, DrawingLoadsCairoAndNothingOfVtk) {
  const Folder folder;
  const std::string said = loaded_by({"draw", our_world("rooms.world"), "-o", folder.path("rooms.png")});
  EXPECT_NE(said.find("sensorfarm_cairo.so"), std::string::npos);
  EXPECT_NE(said.find("libcairo.so"), std::string::npos);
  EXPECT_EQ(said.find("libvtk"), std::string::npos);
}

/// A program without the drawing module beside it takes the one that the dynamic linker finds.
TEST(Loading, TheDrawingModuleMayBeWhereTheLinkerLooks) {
  const Folder folder;
  const char* const other = std::getenv("SENSORFARM_PROGRAM");
  const std::filesystem::path program = other != nullptr ? other : SF_PROGRAM;
  std::filesystem::copy_file(program, folder.path("moved"));
  setenv("SENSORFARM_PROGRAM", folder.path("moved").c_str(), 1);
  const Outcome outcome = run_program({"draw", our_world("rooms.world"), "-o", folder.path("rooms.png")},
                                      {{"LD_LIBRARY_PATH", program.parent_path().string()}});
  setenv("SENSORFARM_PROGRAM", program.c_str(), 1);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

}  // namespace
}  // namespace sf
