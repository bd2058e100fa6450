// `explain` as a user runs it.

#include <gtest/gtest.h>

#include "tests/apps/program.h"

namespace sf {
namespace {

TEST(Explain, SaysWhatIsBuiltAndWhatIsNot) {
  const Outcome outcome = run_program({"explain", our_world("simville/simville.world")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* text : {"laser: 6 sensors on 6 robots", "magnets summed", "sector lists", "heard alone",
                           "none: it is read on the host", "not built", "wall segments"})
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
}

TEST(Explain, AsJson) {
  const Outcome outcome = run_program({"explain", our_world("rooms.world"), "--robots", "3", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\"absent\""), std::string::npos);
  EXPECT_NE(outcome.out.find("\"sensors\": 3"), std::string::npos) << outcome.out;
}

TEST(Explain, WrongUsage) {
  EXPECT_EQ(run_program({"explain"}).code, 2);
  EXPECT_EQ(run_program({"explain", "/nowhere.world"}).code, 2);
  EXPECT_EQ(run_program({"explain", our_world("rooms.world")}, no_device()).code, 3);
}

}  // namespace
}  // namespace sf
