#include "tests/apps/golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <regex>

#include "tests/golden.h"

namespace sf {

namespace {

struct Rule {
  std::regex from;
  const char* to;
};

/// Lines of text and JSON members with numbers that are measured on the machine.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = [] {
    const auto rule = [](const char* from, const char* to) { return Rule{std::regex(from), to}; };
    return std::vector<Rule>{
        rule(R"x((  (?:device|caster) {10,})[^\n]*)x", "$1#"),
        rule(R"x(("(?:device|caster|driver|api|software_device|software)": )("[^"\n]*"|[-+.\w]+))x", "$1#"),
        rule(R"x(("tables": \[)[^\]]*)x", "$1#"),
        rule(R"x((  tables +)[^\n]*)x", "$1#"),
        rule(R"x((program=\()[^\n]*)x", "$1#"),
        rule(R"x(( time=)"[\d.]+")x", "$1#"),
        rule(
            R"x(("\w*(?:wall_s|real_time_factor|per_s|seconds|_tick_s|tick_s|build_s|bytes|resident_bytes)": )[-+.\de]+)x",
            "$1#"),
        rule(
            R"x(("(?:move|place|lists|device|collect|out|beams_in_doubt|doubts|cells_built|processing_\w+)": )[-+.\de]+)x",
            "$1#"),
        rule(R"x(( passed on )[^\n:]*)x", "$1#"),
        rule(R"x(in -?[\d.]+ s\b)x", "in # s"),
        rule(R"x(-?[\d.]+ x real time)x", "# x real time"),
        rule(R"x( +-?[\d.]+ ms)x", " # ms"),
        rule(R"x([\d.]+(?: million)?/s )x", "#/s "),
        rule(R"x([\d.]+ (?:B|KiB|MiB|MB)\b)x", "# B"),
        rule(R"x((hash(?: of readings)?"?:? +"?)[0-9a-f]{16}\b)x", "$1HASH"),
    };
  }();
  return all;
}

/// Rounds each number with more than six digits.
std::string rounded(const std::string& text) {
  static const std::regex number(R"(-?\b\d+\.\d+(?:e[-+]\d+)?)");
  std::string out;
  auto at = text.cbegin();
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
    out.append(at, (*it)[0].first);
    at = (*it)[0].second;
    const std::string word = it->str();
    const double value = std::strtod(word.c_str(), nullptr);
    if (value != 0.0 && std::abs(value) < 1e-12)
      out += "0.0";
    else
      out += word.size() > 7 ? fmt::format("{:.6g}", value) : word;
  }
  return out.append(at, text.cend());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; !from.empty() && (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace

std::string without_machine(std::string text, const std::string& folder) {
  text = replaced(replaced(std::move(text), folder, "FOLDER/"), SF_SOURCE_DIR, "SOURCES");
  for (const Rule& rule : rules()) text = std::regex_replace(text, rule.from, rule.to);
  return rounded(text);
}

void expect_golden(std::string_view name, const std::string& text) {
  // The rest of a row, or of an object's member, stays on its line.
  golden::expect(std::regex_replace(text, std::regex("\n {4,}"), " "), "apps", std::string(name), 1e-6);
}

}  // namespace sf
