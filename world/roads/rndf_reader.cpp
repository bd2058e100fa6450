#include "world/roads/rndf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::world {

namespace {

// Keywords of the format's extension for traffic lights and crosswalks ("RNDF 1.1", Stanford VLR). They are not
// modelled and do not change the meaning of other lines.
constexpr std::array<std::string_view, 20> kExtension{"num_intersections",
                                                      "num_crosswalks",
                                                      "speed_limit",
                                                      "offroad",
                                                      "lane_type",
                                                      "cross",
                                                      "light",
                                                      "crosswalk",
                                                      "crosswalk_width",
                                                      "crosswalk_p1",
                                                      "crosswalk_p2",
                                                      "end_crosswalk",
                                                      "intersection",
                                                      "num_trafficlights",
                                                      "trafficlight",
                                                      "group_id",
                                                      "position",
                                                      "orientation",
                                                      "end_trafficlight",
                                                      "end_intersection"};

// A text with more unknown keywords than this is not an RNDF.
constexpr std::size_t kMaxUnknown = 50;

bool is_extension(std::string_view keyword) {
  return std::find(kExtension.begin(), kExtension.end(), keyword) != kExtension.end();
}

bool is_word(std::string_view keyword) {
  return std::all_of(keyword.begin(), keyword.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

constexpr int kInner = 2;

/// Returns the nesting level of a keyword that starts or ends a block: 0 in the file, 1 in a segment or zone; else
/// `kInner`.
int level_of(std::string_view keyword) {
  if (keyword == "segment" || keyword == "zone" || keyword == "end_file") return 0;
  constexpr std::array<std::string_view, 5> kSecond{"lane", "perimeter", "spot", "end_segment", "end_zone"};
  return std::find(kSecond.begin(), kSecond.end(), keyword) != kSecond.end() ? 1 : kInner;
}

std::string counted(std::size_t have) { return have == 1 ? "1 is" : fmt::format("{} are", have); }

std::string_view rndf_block_name(RndfBlock block) {
  constexpr std::array<std::string_view, 6> kNames{"file", "segment", "lane", "zone", "perimeter", "spot"};
  return kNames[static_cast<std::size_t>(block)];
}

}  // namespace

/// The blocks that may contain a keyword, whether it may repeat, and its effect. Keywords that start or end a block
/// close the open blocks inside its parent.
struct RndfReader::Rule {
  std::vector<RndfBlock> blocks;
  bool once = false;
  bool unwinds = false;
  void (*act)(RndfReader&) = nullptr;
};

const std::map<std::string_view, RndfReader::Rule>& RndfReader::rules() {
  using B = RndfBlock;
  using R = RndfReader;
  static const std::map<std::string_view, Rule> rules{
      {"RNDF_name", {{B::file}, true, false, [](R& r) { r.rndf_.name = r.now().rest; }}},
      {"format_version", {{B::file}, true, false, [](R& r) { r.rndf_.format_version = r.now().rest; }}},
      {"creation_date", {{B::file}, true, false, [](R& r) { r.rndf_.creation_date = r.now().rest; }}},
      {"num_segments", {{B::file}, true, false, [](R& r) { r.read_declared_count(1, "the number of segments"); }}},
      {"num_zones", {{B::file}, true, false, [](R& r) { r.read_declared_count(0, "the number of zones"); }}},
      {"segment", {{B::file}, false, true, [](R& r) { r.begin_segment(); }}},
      {"num_lanes", {{B::segment}, true, false, [](R& r) { r.read_declared_count(1, "the number of lanes"); }}},
      {"segment_name", {{B::segment}, true, false, [](R& r) { r.rndf_.segments.back().name = r.now().rest; }}},
      {"lane", {{B::segment}, false, true, [](R& r) { r.begin_lane(); }}},
      {"num_waypoints", {{B::lane}, true, false, [](R& r) { r.read_declared_count(1, "the number of way-points"); }}},
      {"lane_width", {{B::lane}, true, false, [](R& r) { r.read_width(r.lane().width_ft); }}},
      {"left_boundary", {{B::lane}, true, false, [](R& r) { r.read_boundary(r.lane().left); }}},
      {"right_boundary", {{B::lane}, true, false, [](R& r) { r.read_boundary(r.lane().right); }}},
      {"stop", {{B::lane}, false, false, [](R& r) { r.read_stop(); }}},
      {"exit", {{B::lane, B::perimeter}, false, false, [](R& r) { r.read_exit(); }}},
      {"checkpoint", {{B::lane, B::spot}, false, false, [](R& r) { r.read_checkpoint(); }}},
      {"end_lane", {{B::lane}, false, true, [](R& r) { r.end_block(B::lane); }}},
      {"end_segment", {{B::segment}, false, true, [](R& r) { r.end_block(B::segment); }}},
      {"zone", {{B::file}, false, true, [](R& r) { r.begin_zone(); }}},
      {"num_spots", {{B::zone}, true, false, [](R& r) { r.read_declared_count(0, "the number of spots"); }}},
      {"zone_name", {{B::zone}, true, false, [](R& r) { r.zone().name = r.now().rest; }}},
      {"perimeter", {{B::zone}, true, true, [](R& r) { r.begin_perimeter(); }}},
      {"num_perimeterpoints",
       {{B::perimeter}, true, false, [](R& r) { r.read_declared_count(1, "the number of perimeter points"); }}},
      {"end_perimeter", {{B::perimeter}, false, true, [](R& r) { r.end_block(B::perimeter); }}},
      {"spot", {{B::zone}, false, true, [](R& r) { r.begin_spot(); }}},
      {"spot_width", {{B::spot}, true, false, [](R& r) { r.read_width(r.spot().width_ft); }}},
      {"end_spot", {{B::spot}, false, true, [](R& r) { r.end_block(B::spot); }}},
      {"end_zone", {{B::zone}, false, true, [](R& r) { r.end_block(B::zone); }}},
      {"end_file", {{B::file}, false, true, [](R& r) { r.end_file(); }}}};
  return rules;
}

RndfReader::RndfReader(const std::string& file, std::string_view text, bool strict)
    : diagnostics_(file, strict, rndf_.warnings), statements_(file, text, diagnostics_) {
  rndf_.file = file;
  open_.push_back({RndfBlock::file, 1, "the file"});
}

void RndfReader::warn(int line, std::string message) {
  rndf_.warnings.push_back({statements_.file(), line, std::move(message)});
}

void RndfReader::warn_once(std::string_view keyword, std::string message) {
  if (unknown_.emplace(keyword).second) warn(now().line, std::move(message));
  if (unknown_.size() > kMaxUnknown)
    throw WrongFormatError(statements_.file(), now().line,
                           fmt::format("{} unknown keywords; is this an RNDF?", unknown_.size()));
}

/// Reads the next statement. Returns false at the end, or if no text follows.
bool RndfReader::next() {
  bool more = false;
  diagnostics_.attempt(statements_.line(), [&] { more = statements_.next(); });
  return more;
}

Rndf RndfReader::read() {
  while (!ended_ && next())
    if (!diagnostics_.attempt(now().line, [&] { statement(); })) skip(now().keyword);
  if (!ended_) {
    cut_ = true;
    check_name();
    while (open_.size() > 1) close_implied("at the end of the file");
    warn(statements_.line(), "'end_file' is missing at the end of the file");
    close();
  } else if (next()) {
    warn(now().line, fmt::format("{} follows 'end_file'; it and all later lines are ignored", quoted(now().keyword)));
  }
  check_references(rndf_, unread_, diagnostics_);
  diagnostics_.throw_errors();
  return std::move(rndf_);
}

/// Skips the content of a block whose first statement was rejected, up to the end of the block or the start of a
/// sibling block.
void RndfReader::skip(std::string_view keyword) {
  const int level = level_of(keyword);
  if (is_number(keyword)) ++open_.back().skipped["point"];
  if (level == kInner || keyword.starts_with("end_")) return;
  ++open_.back().skipped[std::string(keyword)];
  const std::string end = "end_" + std::string(keyword);
  while (next() && now().keyword != end) {
    if (const auto id = read_point_id(now().keyword)) unread_.insert(*id);
    if (level_of(now().keyword) > level) continue;
    if (!diagnostics_.attempt(now().line, [&] { statement(); })) skip(now().keyword);
    return;
  }
}

void RndfReader::statement() {
  const std::string_view keyword = now().keyword;
  if (is_number(keyword)) return waypoint();
  const auto rule = rules().find(keyword);
  if (rule == rules().end()) return unknown();
  apply(keyword, rule->second);
}

void RndfReader::unknown() {
  const std::string_view keyword = now().keyword;
  if (keyword == "MDF_name") throw WrongFormatError(statements_.file(), now().line, "this is an MDF; expected an RNDF");
  if (is_extension(keyword)) return warn_once(keyword, fmt::format("'{}' is known but not modelled; ignored", keyword));
  if (!is_word(keyword) || keyword.size() > 40) {
    const std::string message =
        fmt::format("{} is not a statement; expected an RNDF keyword such as 'segment' or 'exit'", quoted(keyword));
    if (rndf_.segments.empty()) throw WrongFormatError(statements_.file(), now().line, message);
    statements_.fail(message);
  }
  std::vector<std::string_view> known(kExtension.begin(), kExtension.end());
  for (const auto& [word, rule] : rules()) known.push_back(word);
  warn_once(keyword, fmt::format("unknown keyword '{}' is ignored{}", keyword, base::suggest(keyword, known)));
}

/// Returns true for a repeated keyword with the same text, and for a repeated count, since counts do not matter.
bool RndfReader::repeats(std::string_view keyword) {
  const auto [before, fresh] = open_.back().seen.emplace(keyword, now().rest);
  if (fresh) return false;
  const std::string what = fmt::format("'{}' is given twice in {}", keyword, open_.back().name);
  const bool clear = before->second == now().rest ? keyword != "perimeter" : keyword.starts_with("num_");
  if (!clear) statements_.fail(what + "; expected it once");
  diagnostics_.add_warning(now().line, what, "expected it once", "the first is used");
  return true;
}

void RndfReader::apply(std::string_view keyword, const Rule& rule) {
  const auto may = [&](const Open& open) {
    return std::find(rule.blocks.begin(), rule.blocks.end(), open.block) != rule.blocks.end();
  };
  if (!may(open_.back())) {
    const bool above = std::any_of(open_.begin(), open_.end(), may);
    if (!rule.unwinds || !above)
      statements_.fail(fmt::format(
          "'{}' is in {}; expected it in a {}{}", keyword, open_.back().name, rndf_block_name(rule.blocks[0]),
          rule.blocks.size() > 1 ? fmt::format(" or a {}", rndf_block_name(rule.blocks[1])) : ""));
    while (!may(open_.back())) close_implied(fmt::format("before '{}'", keyword));
  }
  if (rule.once && repeats(keyword)) return;
  rule.act(*this);
}

// ---------------------------------------------------------------------------------------------------- blocks

void RndfReader::open(RndfBlock block, std::string name) { open_.push_back({block, now().line, std::move(name)}); }

// Checks a declared count. Only the counts of zones and spots may be zero, and may then be missing. The actual number
// overrides the count, unless the file ends before that number was reached.
void RndfReader::check_declared(const Open& open, std::string_view keyword, std::string_view entry, std::size_t have) {
  have += open.refused(entry);
  const bool may_be_none = keyword == "num_zones" || keyword == "num_spots";
  const auto said = open.declared.find(keyword);
  if (said == open.declared.end()) {
    const std::string what = fmt::format("'{}' is missing in {}", keyword, open.name);
    const std::string remedy = fmt::format("expected '{} {}'", keyword, have);
    if (have > 0) return diagnostics_.add_warning(open.line, what, remedy, fmt::format("{} used", counted(have)));
    return may_be_none ? warn(open.line, what + "; " + remedy)
                       : diagnostics_.add_error(open.line, what + "; " + remedy);
  }
  const int count = said->second.count, line = said->second.line;
  if (static_cast<std::size_t>(count) == have || (count < 0 && have > 0)) return;
  const std::string what = fmt::format("'{}' is {}, but {} has {}", keyword, said->second.text, open.name, have);
  const char* remedy = "correct the number, or add or remove entries";
  if (have == 0 && !may_be_none) return diagnostics_.add_error(line, fmt::format("{}; {}", what, remedy));
  if (cut_ && static_cast<std::size_t>(std::max(count, 0)) > have)
    return diagnostics_.add_error(line, what + ": the file is truncated");
  diagnostics_.add_warning(line, what, remedy, fmt::format("{} used", counted(have)));
}

void RndfReader::check_name() {
  if (open_.front().seen.count("RNDF_name") > 0) return;
  const std::string what = "'RNDF_name' is missing", remedy = "expected a route network definition file";
  if (rndf_.segments.empty()) throw WrongFormatError(statements_.file(), 0, what + "; " + remedy);
  diagnostics_.add_warning(0, what, remedy, "it has no name");
}

// Closes the innermost block.
void RndfReader::close() {
  const Open& last = open_.back();
  switch (last.block) {
    case RndfBlock::file:
      check_declared(last, "num_segments", "segment", rndf_.segments.size());
      check_declared(last, "num_zones", "zone", rndf_.zones.size());
      break;
    case RndfBlock::segment:
      check_declared(last, "num_lanes", "lane", rndf_.segments.back().lanes.size());
      break;
    case RndfBlock::lane:
      check_declared(last, "num_waypoints", "point", lane().points.size());
      break;
    case RndfBlock::zone:
      check_declared(last, "num_spots", "spot", zone().spots.size());
      if (zone().perimeter.empty() && last.refused("perimeter") == 0)
        diagnostics_.add_error(last.line,
                               fmt::format("{} has no perimeter; expected 'perimeter {}.0'", last.name, zone().id));
      break;
    case RndfBlock::perimeter:
      check_declared(last, "num_perimeterpoints", "point", zone().perimeter.size());
      if (zone().perimeter.size() < 3)
        warn(last.line, fmt::format("{} has fewer than three points: no area", last.name));
      break;
    case RndfBlock::spot:
      if (spot().points.size() + last.refused("point") != 2)
        diagnostics_.add_error(last.line, fmt::format("{} has {} points; expected two: its entry and its end",
                                                      last.name, spot().points.size()));
      break;
  }
  open_.pop_back();
}

void RndfReader::close_implied(const std::string& because) {
  const Open& last = open_.back();
  warn(last.line, fmt::format("{} has no 'end_{}'; it ends {}", last.name, rndf_block_name(last.block), because));
  close();
}

void RndfReader::end_block(RndfBlock block) {
  statements_.expect_fields(0);
  SF_CHECK(open_.back().block == block, "a block ends that is not the innermost");
  close();
}

}  // namespace sf::world
