// The parts of the live view's page that need no browser (script/check_view tests the rest).

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/program.h"

namespace sf {
namespace {

TEST(Page, ColoursKeysAndTheTimesOfReadings) {
  if (!succeeds("node --version")) GTEST_SKIP() << "no Node.js on this machine (Debian: nodejs)";
  const Folder folder;
  for (const auto& entry : std::filesystem::directory_iterator(SF_SOURCE_DIR "/viz/web"))
    std::filesystem::copy_file(entry.path(), folder.path(entry.path().filename()));
  folder.write("package.json", R"({"type": "module"})");
  const std::string log = folder.path("log");
  EXPECT_TRUE(succeeds("(node '" SF_SOURCE_DIR "/tests/apps/page.mjs' '" + folder.path() + "' >'" + log + "' 2>&1)"))
      << read_file(log);
}

}  // namespace
}  // namespace sf
