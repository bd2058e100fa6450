#pragma once
// Golden records: texts in tests/MODULE/golden/NAME.txt that a test's results are compared with, line by line. Numbers
// may differ by a tolerance, so that another mathematical library passes; colours (#rrggbb) and words may not.
//
// With SENSORFARM_RECORDS=FOLDER set, results are also written to FOLDER/NAME.txt.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace sf::golden {

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

inline std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Length of the number at the start of `text`; 0: none.
inline std::size_t number_length(std::string_view text) {
  const std::size_t sign = !text.empty() && text[0] == '-' ? 1 : 0;
  std::size_t end = text.find_first_not_of("0123456789.", sign);
  if (end == std::string_view::npos) end = text.size();
  return end > sign && text[sign] != '.' ? end : 0;
}

/// True if both are equal except for close numbers. The content of an SVG element is text, which must be equal.
inline bool alike(std::string_view a, std::string_view b, double tolerance) {
  bool numbers = true;
  while (!a.empty() && !b.empty()) {
    const std::size_t n = number_length(a), m = number_length(b);
    if (numbers && n > 0 && m > 0) {
      const double u = std::stod(std::string(a.substr(0, n))), v = std::stod(std::string(b.substr(0, m)));
      if (!(std::abs(u - v) <= tolerance + 1e-5 * std::abs(u))) return false;
      a.remove_prefix(n), b.remove_prefix(m);
      continue;
    }
    const std::size_t length = a[0] == '#' ? 7 : 1;
    if (a.substr(0, length) != b.substr(0, length)) return false;
    if (a[0] == '>') numbers = false;
    if (a[0] == '<') numbers = true;
    a.remove_prefix(std::min(length, a.size())), b.remove_prefix(std::min(length, b.size()));
  }
  return a.empty() && b.empty();
}

/// Returns the path of a file to inspect; empty without SENSORFARM_RECORDS.
inline std::string shown_file(const std::string& name) {
  const char* const folder = std::getenv("SENSORFARM_RECORDS");
  return folder == nullptr ? "" : fmt::format("{}/{}", folder, name);
}

/// Fails with the first lines that differ.
inline void expect(const std::string& found, const std::string& module, const std::string& name, double tolerance) {
  if (const std::string shown = shown_file(name + ".txt"); !shown.empty()) std::ofstream(shown) << found;
  const std::string file = fmt::format("{}/tests/{}/golden/{}.txt", SF_SOURCE_DIR, module, name);
  const std::vector<std::string> a = lines_of(read(file)), b = lines_of(found);
  int failures = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()) && failures < 5; ++i) {
    const std::string expected = i < a.size() ? a[i] : "(nothing)", line = i < b.size() ? b[i] : "(nothing)";
    if (alike(expected, line, tolerance)) continue;
    ++failures;
    ADD_FAILURE() << file << ":" << i + 1 << "\n  expected " << expected << "\n  found    " << line;
  }
}

}  // namespace sf::golden
