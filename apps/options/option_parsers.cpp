#include "apps/options/option_parsers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <string_view>

#include "apps/reports/text.h"
#include "base/shape_state.h"
#include "base/suggest.h"
#include "control/raw_text.h"
#include "viz/picture_file.h"
#include "viz/top_view.h"
#include "viz/video_file.h"

namespace sf::apps {

namespace {

/// Parses decimal digits. Rejects leading zeros, which CLI11 would read as octal.
std::optional<std::uint64_t> read_integer(const std::string& text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || (text.size() > 1 && text.front() == '0')) return std::nullopt;
  return value;
}

/// Returns the positive finite number at the start of `text`, and the rest of the text.
std::optional<std::pair<double, std::string_view>> read_positive(const std::string& text) {
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  if (stop == text.c_str() || !(value > 0.0) || !std::isfinite(value)) return std::nullopt;
  return std::pair{value, std::string_view(stop)};
}

/// Parses `count` numbers, each within the coordinate range of world files and packets.
std::optional<std::vector<double>> read_coordinates(const std::string& text, std::size_t count) {
  constexpr double kFarthest = 1e7;
  const auto values = control::read_numbers(text);
  const auto valid = [](double value) { return std::fabs(value) <= kFarthest; };
  if (!values || values->size() != count || !std::all_of(values->begin(), values->end(), valid)) return std::nullopt;
  return values;
}

/// A unit and its value in m or T.
struct Unit {
  std::string_view name;
  double value;
  bool is_tesla;
};
constexpr Unit kUnits[] = {{"m", 1.0, false},        {"cm", 1e-2, false},     {"mm", 1e-3, false}, {"um", 1e-6, false},
                           {"\u00b5m", 1e-6, false}, {"nm", 1e-9, false},     {"T", 1.0, true},    {"mT", 1e-3, true},
                           {"uT", 1e-6, true},       {"\u00b5T", 1e-6, true}, {"nT", 1e-9, true},  {"G", 1e-4, true},
                           {"mG", 1e-7, true}};

}  // namespace

Validator whole(std::uint64_t first, std::uint64_t last) {
  return [=](const std::string& text) {
    const auto value = read_integer(text);
    if (value && *value >= first && *value <= last) return std::string();
    return fmt::format("expected a whole number from {} to {}, got '{}'", first, last, text);
  };
}

Validator number(double first, double last) {
  return [=](const std::string& text) {
    char* stop = nullptr;
    const double value = std::strtod(text.c_str(), &stop);
    if (!text.empty() && *stop == '\0' && value >= first && value <= last) return std::string();
    return fmt::format("expected a number from {:g} to {:g}, got '{}'", first, last, text);
  };
}

Validator in_seconds(double first, double last) {
  return [=, is_number = number(first, last)](const std::string& text) {
    if (is_number(text).empty()) return std::string();
    return fmt::format("expected seconds from {:g} to {:g}, got '{}'", first, last, text);
  };
}

Validator recording() {
  return [](const std::string& text) {
    const std::string suffix = std::filesystem::path(text).extension().string();
    for (const char* world : {".world", ".yaml", ".yml", ".rndf", ".mdf", ".toml", ".csv"})
      if (suffix == world)
        return fmt::format("expected a recording, such as the folder that `run --record` writes, got '{}'", text);
    return std::string();
  };
}

Validator one_of(std::vector<std::string> words) {
  return [words = std::move(words)](const std::string& text) {
    const bool known = std::find(words.begin(), words.end(), text) != words.end();
    if (known) return std::string();
    const std::vector<std::string_view> candidates(words.begin(), words.end());
    return fmt::format("expected {}, got '{}'{}", join_or(words), text, base::suggest(text, candidates));
  };
}

Validator not_empty(const std::string& expected) {
  return [expected](const std::string& text) { return text.empty() ? "expected " + expected + ", got ''" : ""; };
}

Validator new_file(const std::string& example) {
  return [example](const std::string& text) {
    std::error_code ignored;
    if (text.empty()) return std::string("expected a file, got ''");
    if (text.back() != '/' && !std::filesystem::is_directory(text, ignored)) return std::string();
    return fmt::format("expected a file, but '{}' is a folder; write {}", text,
                       (std::filesystem::path(text) / example).string());
  };
}

Validator picture() {
  return [is_file = new_file("picture.png")](const std::string& text) {
    std::filesystem::path file(text);
    const std::string suffix = file.extension().string();
    if (const std::string problem = is_file(text); !problem.empty()) return problem;
    if (viz::format_of(text)) return std::string();
    return fmt::format("pictures are PNG, SVG or PDF files, but '{}' ends in {}; write {}", text, suffix,
                       file.replace_extension(".png").string());
  };
}

Validator replaced_picture() {
  return [is_picture = picture()](const std::string& text) {
    if (const std::string problem = is_picture(text); !problem.empty()) return problem;
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path file(text), folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) return fmt::format("there is no folder '{}'; create it", folder.string());
    const fs::file_status status = fs::symlink_status(file, ignored);
    if (!fs::exists(status) || fs::is_regular_file(status)) return std::string();
    return fmt::format("'{}' is not a regular file, and would be replaced; choose another name", text);
  };
}

Validator video() {
  return [is_file = new_file(std::string("run") + viz::kVideoSuffix)](const std::string& text) {
    std::filesystem::path file(text);
    if (const std::string problem = is_file(text); !problem.empty()) return problem;
    if (file.extension() == viz::kVideoSuffix) return std::string();
    return fmt::format("videos are WebM files; write {}", file.replace_extension(viz::kVideoSuffix).string());
  };
}

std::optional<std::pair<std::string, std::string>> read_setting(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) return std::nullopt;
  return std::pair{text.substr(0, at), text.substr(at + 1)};
}

std::optional<base::Pose> read_pose(const std::string& text) {
  const auto v = read_coordinates(text, 3);
  if (!v) return std::nullopt;
  return base::Pose{(*v)[0], (*v)[1], 0.0, (*v)[2] * M_PI / 180.0};
}

std::optional<TiltedPose> read_tilted_pose(const std::string& text) {
  if (const auto planar = read_pose(text)) return TiltedPose{.X = *planar};
  const auto v = read_coordinates(text, 6);
  if (!v || std::abs((*v)[3]) > 180.0 || std::abs((*v)[4]) > 90.0) return std::nullopt;
  constexpr double kDegree = M_PI / 180.0;
  return TiltedPose{{(*v)[0], (*v)[1], (*v)[2], (*v)[5] * kDegree}, {(*v)[3] * kDegree, (*v)[4] * kDegree}, true};
}

std::optional<std::array<double, 3>> read_lengths(const std::string& text) {
  const auto v = read_coordinates(text, 3);
  return v && std::ranges::all_of(*v, base::is_shape_length) ? std::optional(std::array{(*v)[0], (*v)[1], (*v)[2]})
                                                             : std::nullopt;
}

std::optional<viz::Line> read_line(const std::string& text) {
  const auto v = read_coordinates(text, 4);
  if (!v || ((*v)[0] == (*v)[2] && (*v)[1] == (*v)[3])) return std::nullopt;
  return viz::Line{{(*v)[0], (*v)[1]}, {(*v)[2], (*v)[3]}};
}

std::optional<world::Extent> read_extent(const std::string& text) {
  const auto v = read_coordinates(text, 4);
  if (!v || (*v)[0] >= (*v)[2] || (*v)[1] >= (*v)[3]) return std::nullopt;
  return world::Extent{(*v)[0], (*v)[1], (*v)[2], (*v)[3]};
}

std::optional<glm::dvec2> read_size(const std::string& text) {
  const std::size_t x = text.find('x');
  const auto width = read_coordinates(text.substr(0, x), 1);
  const auto height =
      x == std::string::npos ? std::optional(std::vector{0.0}) : read_coordinates(text.substr(x + 1), 1);
  if (!width || !height || width->front() < 50.0 || width->front() > 1000.0) return std::nullopt;
  if (x != std::string::npos && (height->front() < 30.0 || height->front() > 1000.0)) return std::nullopt;
  return glm::dvec2{width->front(), height->front()};
}

std::optional<std::pair<int, int>> read_pixels(const std::string& text) {
  constexpr std::uint64_t kShortest = 16, kLongest = viz::TopViewOptions::kLongestSide;
  const std::size_t x = text.find('x');
  if (x == std::string::npos) return std::nullopt;
  const auto width = read_integer(text.substr(0, x)), height = read_integer(text.substr(x + 1));
  for (const auto& side : {width, height})
    if (!side || *side < kShortest || *side > kLongest || *side % 2 != 0) return std::nullopt;
  return std::pair{static_cast<int>(*width), static_cast<int>(*height)};
}

std::optional<std::vector<std::uint16_t>> read_ports(const std::string& text) {
  constexpr std::uint64_t kMostPorts = 1024;
  const std::size_t dash = text.find('-');
  const auto a = read_integer(text.substr(0, dash));
  const auto b = dash == std::string::npos ? a : read_integer(text.substr(dash + 1));
  if (!a || !b || *a < 1 || *b > 65535 || *b < *a || *b - *a >= kMostPorts) return std::nullopt;
  std::vector<std::uint16_t> ports(*b - *a + 1);
  std::iota(ports.begin(), ports.end(), static_cast<std::uint16_t>(*a));
  return ports;
}

std::optional<Quantity> read_quantity(const std::string& text) {
  const auto number = read_positive(text);
  if (!number) return std::nullopt;
  for (const Unit& unit : kUnits)
    if (unit.name == number->second) return Quantity{number->first * unit.value, unit.is_tesla};
  return std::nullopt;
}

std::optional<double> read_rate(const std::string& text) {
  const auto number = read_positive(text);
  if (!number || (!number->second.empty() && number->second != "Hz")) return std::nullopt;
  return number->first;
}

std::string suggest_option(const std::string& word, const std::vector<std::string>& names) {
  if (word.compare(0, 2, "--") != 0) return "";
  const std::string bare = word.substr(2);
  if (std::count(names.begin(), names.end(), bare) > 0) return "; options must follow the subcommand";
  std::string found = base::suggest(bare, std::vector<std::string_view>(names.begin(), names.end()));
  const std::size_t quote = found.find('\'');
  return quote == std::string::npos ? "" : found.insert(quote + 1, "--");
}

}  // namespace sf::apps
