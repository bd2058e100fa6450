// Controllers of robots and models that a world file names (`ctrl`), from a plug-in next to it.

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

const std::string kStraight = "./mine.so:test-straight";

class Ctrl : public ::testing::Test {
 protected:
  Ctrl() { std::filesystem::create_symlink(SF_BINARY_DIR "/test_plugin.so", folder_.path("mine.so")); }

  /// Robot `a` with this `ctrl`; `b` is at rest and sees it.
  std::string write(const std::string& name, const std::string& ctrl) const {
    return folder_.write(name,
                         "position( name \"a\" size [0.3 0.3 0.5]\n " + ctrl +
                             ")\nposition( name \"b\" pose [2 1 0 180] size [0.3 0.3 0.1] ctrl \"none\" laser( ) )");
  }

  const Folder folder_;
};

TEST_F(Ctrl, PluginsAndSettingsGiveTheReadingsOfTheCommandLine) {
  const std::string named = write("named.world", "ctrl \"" + kStraight + " speed=0.5\"");
  const std::string bare = write("bare.world", "");
  const auto hash = [](const Words& words) {
    return Json(run_successfully(with(words, {"--duration", "2", "--json"})).out).text("/hash");
  };
  const std::string plugin = folder_.path(kStraight);
  const std::string expected = hash({"run", bare, "--controller", plugin, "--set", "speed=0.5", "--drive", "a"});
  EXPECT_EQ(hash({"run", named}), expected);
  EXPECT_EQ(hash({"run", named, "--in-process"}), expected);
  const std::string scenario = folder_.write("named.toml", "world = \"named.world\"\nduration = 2\n");
  EXPECT_EQ(hash({"run", scenario}), expected);
  EXPECT_NE(hash({"run", write("slow.world", "ctrl \"" + kStraight + "\"")}), expected);
}

TEST_F(Ctrl, MistakesNameTheLineOfTheWorld) {
  const std::pair<std::string, std::string> kCorpus[] = {
      {kStraight + " speeed=1", "a.world:2: controller '"},        {kStraight + " speed=fast", "a.world:2: 'speed'"},
      {"./mine.so:strait", "mine.so: has no controller 'strait'"}, {"./yours.so", "yours.so: cannot be opened"},
      {"./mine.so:test-picky", "robot a is not good enough"},
  };
  const std::string scenario = folder_.write("a.toml", "world = \"a.world\"\nduration = 1\n[expect]\ncontacts = 9\n");
  for (const auto& [ctrl, message] : kCorpus) {
    const std::string world = write("a.world", "ctrl \"" + ctrl + "\"");
    for (const Words& words : {Words{"run", world, "--duration", "1"}, Words{"test", scenario}}) {
      const Outcome outcome = run_program(words);
      EXPECT_NE(outcome.code, 0) << ctrl;
      expect_in("a.world:2: ", outcome.err + outcome.out);
      expect_in(message, outcome.err + outcome.out);
    }
  }
}

/// A crash of code that only an included file names is reported by the parent process.
TEST_F(Ctrl, CodeOfIncludedFilesRunsInAChildProcess) {
  write("robots.inc", "ctrl \"./mine.so:test-ends how=abort\"");
  const Outcome outcome =
      run_program({"run", folder_.write("outer.world", "include \"robots.inc\"\n"), "--duration", "2"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  expect_in("of robot 'a'", outcome.err);
}

/// Returns a world with a robot that sees an object with this `ctrl`.
std::string world_of_slide(const std::string& ctrl) {
  return "model( name \"shelf\" pose [2 0 0 0] size [0.3 0.3 0.5]\n ctrl \"" + ctrl +
         "\" )\nposition( name \"b\" size [0.3 0.3 0.1] ctrl \"none\" laser( ) )";
}

TEST_F(Ctrl, ModelsMoveInRunsAndTheirRecordingsVerify) {
  const std::string world = folder_.write("slide.world", world_of_slide("./mine.so:test-slide way=0.3"));
  const auto hash = [&](const Words& more) {
    return Json(run_successfully(with({"run", world, "--duration", "3", "--json"}, more)).out).text("/hash");
  };
  const std::string expected = hash({});
  EXPECT_EQ(hash({"--threads", "1", "--in-process"}), expected);
  EXPECT_EQ(hash({"--device", "host", "--record", folder_.path("run")}), expected);
  run_successfully({"verify", folder_.path("run")});
  folder_.write("slide.world", world_of_slide("./mine.so:test-slide way=0.4"));
  EXPECT_NE(hash({}), expected);
  folder_.write("slide.world", world_of_slide("none"));
  EXPECT_NE(hash({}), expected);
}

TEST_F(Ctrl, FailuresOfModelsNameThem) {
  const std::string world = folder_.write("slide.world", world_of_slide("./mine.so:test-slide how=number"));
  const Words kCommands[] = {{"run", world, "--duration", "2"}, {"serve", world, "--port", "0"}};
  for (const Words& words : kCommands) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    expect_in("controller 'test-slide' of model 'shelf' failed at ", outcome.err);
    expect_in("not a std::exception", outcome.err);
  }
  folder_.write("slide.world", world_of_slide("./mine.so:test-slide how=abort"));
  for (const Words& words : kCommands) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    expect_in("controller 'test-slide' of model 'shelf' ended the process", outcome.err);
  }
  folder_.write("slide.world", world_of_slide("./mine.so:test-straight"));
  const Outcome outcome = run_program(kCommands[0]);
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  expect_in("slide.world:2: ", outcome.err);
  expect_in("has no model controller 'test-straight'", outcome.err);
}

}  // namespace
}  // namespace sf
