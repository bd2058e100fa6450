#include "scenarios/junit.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::scenarios {

namespace {

std::string case_of(const ScenarioResult& result, const ExpectationResult& outcome) {
  std::string text = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\"", escaped(result.name),
                                 escaped(outcome.what), result.wall);
  if (outcome.met) return text + "/>\n";
  return text + fmt::format(">\n      <failure message=\"expected {}, got {}\">{}:{}</failure>\n    </testcase>\n",
                            escaped(outcome.expected), escaped(outcome.measured), escaped(result.file), outcome.line);
}

/// Returns a skipped case, so that a scenario without expectations appears in the results.
std::string suite_of_nothing(const ScenarioResult& result) {
  return fmt::format(
      "  <testsuite name=\"{0}\" tests=\"1\" failures=\"0\" skipped=\"1\" time=\"{1:.3f}\">\n"
      "    <testcase classname=\"{0}\" name=\"nothing expected\" time=\"{1:.3f}\">\n"
      "      <skipped message=\"{2} has no [expect]\"/>\n    </testcase>\n  </testsuite>\n",
      escaped(result.name), result.wall, escaped(result.file));
}

/// Returns an error: the scenario did not complete, so no expectation has a value.
std::string suite_of_failure(const ScenarioResult& result) {
  return fmt::format(
      "  <testsuite name=\"{0}\" tests=\"1\" failures=\"0\" errors=\"1\" time=\"{1:.3f}\">\n"
      "    <testcase classname=\"{0}\" name=\"run\" time=\"{1:.3f}\">\n"
      "      <error message=\"{2}\">{3}</error>\n    </testcase>\n  </testsuite>\n",
      escaped(result.name), result.wall, escaped(result.failure), escaped(result.file));
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&apos;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\t')
      out += c;
  }
  return out;
}

std::string junit_of(std::span<const ScenarioResult> results) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const ScenarioResult& result : results) {
    if (!result.failure.empty()) {
      text += suite_of_failure(result);
      continue;
    }
    if (result.status() == ScenarioStatus::no_expectations) {
      text += suite_of_nothing(result);
      continue;
    }
    const auto failed = std::count_if(result.outcomes.begin(), result.outcomes.end(),
                                      [](const ExpectationResult& o) { return !o.met; });
    text += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" time=\"{:.3f}\">\n",
                        escaped(result.name), result.outcomes.size(), failed, result.wall);
    for (const ExpectationResult& outcome : result.outcomes) text += case_of(result, outcome);
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

}  // namespace sf::scenarios
