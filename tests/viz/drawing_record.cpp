#include "tests/viz/drawing_record.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include "tests/golden.h"

namespace sf::scenes {
namespace {

constexpr std::size_t kListedPoints = 8;  // per path; longer paths are summarized
constexpr double kPixels = 0.021;         // [px] two steps of the numbers in an SVG file

/// Returns measures of a path that change with each of its points, however many it has.
std::string measures(const std::string& data) {
  std::vector<glm::dvec2> points;
  glm::dvec2 low{1e9}, high{-1e9}, sum{}, weighted{};
  double length = 0.0;
  int begun = 0;
  for (const char* at = data.c_str(); *at != '\0';) {
    const bool begins = *at == 'M';
    begun += begins ? 1 : 0;
    if (!begins && *at != 'L') {
      ++at;
      continue;
    }
    char* end = nullptr;
    const double x = std::strtod(at + 1, &end);
    const glm::dvec2 p{x, std::strtod(end, &end)};
    at = end;
    if (!begins) length += std::hypot(p.x - points.back().x, p.y - points.back().y);
    points.push_back(p);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    sum = sum + p;
    weighted = weighted + static_cast<double>(points.size() % 7) * p;
  }
  if (points.size() <= kListedPoints) return data;
  const double n = static_cast<double>(points.size());
  return fmt::format(
      "{} parts {} points, {:.2f} {:.2f} to {:.2f} {:.2f}, length {:.1f}, mean {:.2f} {:.2f} {:.2f} {:.2f}{}", begun,
      points.size(), low.x, low.y, high.x, high.y, length, sum.x / n, sum.y / n, weighted.x / n, weighted.y / n,
      data.back() == 'Z' ? ", closed" : "");
}

std::string decoded(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : base64.substr(0, base64.find('='))) {
    word = word << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits & 0xFFu);
  }
  return bytes;
}

/// Returns one number per block of 16 x 16 cells, which changes with each of its cells.
std::string blocks(const Picture& picture, const std::map<std::uint32_t, char>& letters) {
  std::map<std::pair<int, int>, int> sums;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      sums[{y / 16, x / 16}] += (letters.at(picture.at(x, y)) - 'a') * ((x + 3 * y) % 7 + 1);
  std::string text;
  for (const auto& [block, sum] : sums) text += fmt::format(" {}", sum);
  return text;
}

/// Returns the cells of an image: one letter per colour if there are few colours, else the colours; for a large image
/// its blocks.
std::string cells(const std::string& base64) {
  const std::string path = own_file("record_image.png");
  std::ofstream(path, std::ios::binary) << decoded(base64);
  const Picture picture = read_png(path);
  std::map<std::uint32_t, char> letters;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) letters.try_emplace(picture.at(x, y), '?');
  char next = 'a';
  std::string text = fmt::format("{} x {}", picture.width, picture.height);
  for (auto& [color, letter] : letters)
    if (letters.size() <= 26) text += fmt::format(" {}=#{:06x}", letter = next++, color & 0xFFFFFFu);
  if (picture.width * picture.height > 4000) return text + blocks(picture, letters);
  for (int y = 0; y < picture.height; ++y) {
    text += ' ';
    for (int x = 0; x < picture.width; ++x) {
      const std::uint32_t color = picture.at(x, y);
      text += letters.size() <= 26 ? std::string(1, letters[color]) : fmt::format("#{:06x}", color & 0xFFFFFFu);
    }
  }
  return text;
}

/// `line` with the value of an attribute replaced.
template <class Replace>
std::string replaced(const std::string& line, const std::string& before, Replace&& replace) {
  const std::size_t at = line.find(before);
  if (at == std::string::npos) return line;
  const std::size_t from = at + before.size(), to = line.find('"', from);
  return line.substr(0, from) + replace(line.substr(from, to - from)) + line.substr(to);
}

}  // namespace

std::string drawing_record(const std::string& svg) {
  std::string record, data, style;  // of the path so far
  const auto flush = [&] {
    if (!data.empty()) record += "<path d=\"" + measures(data) + style + "\n";
    data.clear();
  };
  const std::string path = "<path d=\"";
  for (const std::string& line : golden::lines_of(svg)) {
    const std::size_t end = line.find('"', path.size());
    const bool is_path = line.rfind(path, 0) == 0;
    if (!is_path || line.substr(end) != style) flush();
    if (is_path)
      data += line.substr(path.size(), end - path.size()), style = line.substr(end);
    else
      record += replaced(line, "data:image/png;base64,", cells) + "\n";
  }
  flush();
  return record;
}

void expect_recorded(const std::string& svg_file, const std::string& module, const std::string& name) {
  const std::string svg = golden::read(svg_file);
  if (const std::string shown = golden::shown_file(name + ".svg"); !shown.empty()) std::ofstream(shown) << svg;
  golden::expect(drawing_record(svg), module, name, kPixels);
}

}  // namespace sf::scenes
