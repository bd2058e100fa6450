#pragma once
// Commands that are refused: exit code 2 and a one-line reason.

#include <gtest/gtest.h>

#include <string>

#include "tests/apps/program.h"

namespace sf {

/// @param said text in the line
inline void expect_refused(const Words& arguments, const std::string& said) {
  const Outcome outcome = run_program(arguments);
  EXPECT_EQ(outcome.code, 2) << said << "\n" << outcome.err;
  EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  EXPECT_NE(outcome.err.find(said), std::string::npos) << "'" << said << "' is not in: " << outcome.err;
  EXPECT_EQ(outcome.err.rfind("sensorfarm: ", 0), 0u) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

}  // namespace sf
