// Libraries of the program: only drawing commands load those for drawing.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

/// Returns the dynamic linker's log of libraries loaded at start and later.
std::string loaded_by(const Words& arguments) {
  const Outcome outcome = run_successfully(arguments, {{"LD_DEBUG", "files"}});
  EXPECT_NE(outcome.err.find("libfmt.so"), std::string::npos) << "the linker prints no log";
  return outcome.err;
}

TEST(Loading, CommandsWithoutPicturesLoadNoDrawingLibrary) {
  const std::string world = our_world("rooms.world");
  for (const Words& arguments : {Words{"--version"}, Words{"check", world}, Words{"run", world, "--duration", "0.3"},
                                 Words{"sense", world}, Words{"explain", world}}) {
    const std::string message = loaded_by(arguments);
    for (const char* library : {"libvtk", "libcairo", "libfreetype", "libpng", "sensorfarm_cairo"})
      EXPECT_EQ(message.find(library), std::string::npos) << arguments[0] << " loads " << library;
  }
}

/// The program itself reads PNG and Netpbm; OpenCV takes 0.1 s to load.
TEST(Loading, OnlyPicturesOfOtherFormatsLoadOpenCv) {
  const Folder folder;
  folder.write("plan.gif", std::string("GIF87a\1\0\1\0\0\0\0;", 14));
  folder.write("plan.pgm", "P2 1 1 255\n0\n");
  const std::string pgm = folder.write("pgm.world", "model( size [1 1 1] bitmap \"plan.pgm\" )\n");
  const std::string gif = folder.write("gif.world", "model( size [1 1 1]\nbitmap \"plan.gif\" )\n");
  for (const std::string& world : {pgm, our_world("cave.world")}) {
    const std::string message = loaded_by({"check", world});
    for (const char* library : {"sensorfarm_pictures", "libopencv", "libgdal"})
      EXPECT_EQ(message.find(library), std::string::npos) << world << " loads " << library;
  }
  const Outcome outcome = run_program({"check", gif}, {{"LD_DEBUG", "files"}});
  EXPECT_NE(outcome.err.find("libopencv_imgcodecs"), std::string::npos);
  EXPECT_NE(outcome.err.find("gif.world:2: 'bitmap': "), std::string::npos) << "its only picture is missing";
}

/// A program without the plug-in reads all other worlds, and explains what to do.
TEST(Loading, APictureWithoutItsPlugInIsAnError) {
  const Folder folder;
  const std::string alone = folder.path("alone");
  std::filesystem::copy_file(SF_PROGRAM, alone);
  folder.write("plan.gif", std::string("GIF87a\1\0\1\0\0\0\0;", 14));
  const std::string world = folder.write("w.world", "model( size [1 1 1]\nbitmap \"plan.gif\" )\n");
  const Outcome outcome = Program({"check", world}, {}, "", "", alone).wait();
  EXPECT_NE(outcome.code, 0);
  expect_in("w.world:2: 'bitmap': sensorfarm_pictures.so: cannot be loaded, so only PNG and Netpbm", outcome.err);
  expect_in("install the Debian package of sensorfarm, or put the file into " +
                std::filesystem::path(alone).parent_path().string(),
            outcome.err);
  EXPECT_NE(outcome.err.find("Debian: libopencv-imgcodecs406"), std::string::npos) << outcome.err;
  EXPECT_EQ(Program({"check", our_world("cave.world")}, {}, "", "", alone).wait().code, 0);
}

/// The loader need not be installed if no device is opened.
TEST(Loading, OnlyDevicesLoadTheVulkanLoader) {
  const std::string world = our_world("rooms.world");
  for (const Words& arguments : {Words{"--version"}, Words{"check", world}, Words{"sense", world, "--device", "host"}})
    EXPECT_EQ(loaded_by(arguments).find("libvulkan"), std::string::npos) << arguments[0];
  EXPECT_NE(loaded_by({"devices"}).find("libvulkan.so.1"), std::string::npos);
}

TEST(Loading, DrawingLoadsCairoAndNothingOfVtk) {
  const Folder folder;
  const std::string message = loaded_by({"draw", our_world("rooms.world"), "-o", folder.path("rooms.png")});
  EXPECT_NE(message.find("sensorfarm_cairo.so"), std::string::npos);
  EXPECT_NE(message.find("libcairo.so"), std::string::npos);
  EXPECT_EQ(message.find("libvtk"), std::string::npos);
}

/// A program without the drawing module in its folder uses the one that the dynamic linker finds.
TEST(Loading, TheDrawingModuleMayBeInTheLinkerPath) {
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
