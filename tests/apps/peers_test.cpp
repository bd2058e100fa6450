// `--peers`: tables that commands refuse or warn about. tests/netio tests their effect.

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/program.h"

namespace sf::apps {
namespace {

constexpr const char* kWorld = SF_SOURCE_DIR "/worlds/rooms.world";

std::string peer(const std::string& what) { return "[[peer]]\n" + what + "\nkey = \"" + std::string(64, 'a') + "\"\n"; }

/// Writes a table that only its owner may read, about which there is no warning.
std::string write_private(const Folder& folder, const std::string& name, const std::string& text) {
  const std::string file = folder.write(name, text);
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  return file;
}

TEST(Peers, AStartSignalNeedsTheKeyOfItsTable) {
  const Folder folder;
  const std::string file = write_private(folder, "peers.toml", peer("robot = 1"));
  expect_refused({"start", "--peers", file},
                 file + ": has no key for START; expected a [[peer]] section with start = true");
  EXPECT_EQ(run_program({"start", "--peers", folder.write("start.toml", peer("start = true"))}).code, 0);
}

TEST(Peers, WarnsOfAReadableKeyFile) {
  const Folder folder;
  const std::string file = folder.write("peers.toml", peer("start = true"));
  using std::filesystem::perms;
  for (const perms others : {perms::none, perms::group_read}) {
    std::filesystem::permissions(file, perms::owner_read | perms::owner_write | others);
    const Outcome outcome = run_successfully({"start", "--peers", file});
    EXPECT_EQ(outcome.err.find("warning: " + file + " contains keys, and other users") != std::string::npos,
              others != perms::none)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("aaaa"), std::string::npos) << "keys are never printed";
  }
}

TEST(Peers, AServiceRejectsUnknownIdsAndUnsignedReadings) {
  const Folder folder;
  expect_refused({"serve", kWorld, "--peers", folder.write("a.toml", peer("robot = 77"))},
                 "a.toml:2: the world has no robot with the id 77; it has 1, 2");
  expect_refused({"serve", kWorld, "--wire", "thesis", "--peers", write_private(folder, "b.toml", peer("robot = 1"))},
                 "readings of --wire thesis cannot be signed");
}

}  // namespace
}  // namespace sf::apps
