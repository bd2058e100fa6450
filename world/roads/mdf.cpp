#include "world/roads/mdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"

namespace sf::world {

namespace {

enum class Block { file, checkpoints, speed_limits };

constexpr std::array<std::string_view, 12> kKeywords{"MDF_name",         "RNDF",
                                                     "RNDF_name",        "format_version",
                                                     "creation_date",    "checkpoints",
                                                     "num_checkpoints",  "end_checkpoints",
                                                     "speed_limits",     "num_speed_limits",
                                                     "end_speed_limits", "end_file"};

class MdfReader {
 public:
  MdfReader(const std::string& file, std::string_view text, bool strict)
      : diagnostics_(file, strict, mdf_.warnings), statements_(file, text, diagnostics_) {
    mdf_.file = file;
  }

  Mdf read() {
    while (!ended_ && next()) diagnostics_.attempt(now().line, [&] { statement(); });
    end_block("at the end of the file");
    check_name();
    if (!ended_) warn(statements_.line(), "'end_file' is missing at the end of the file");
    if (ended_ && next())
      warn(now().line, fmt::format("{} follows 'end_file'; it and all later lines are ignored", quoted(now().keyword)));
    check_count("num_checkpoints", mdf_.checkpoints.size());
    check_count("num_speed_limits", mdf_.speed_limits.size());
    diagnostics_.throw_errors();
    return std::move(mdf_);
  }

 private:
  const RoadStatement& now() const { return statements_.now(); }
  void warn(int line, std::string message) { mdf_.warnings.push_back({mdf_.file, line, std::move(message)}); }

  bool next() {
    bool more = false;
    diagnostics_.attempt(statements_.line(), [&] { more = statements_.next(); });
    return more;
  }

  void check_name() {
    if (seen_.count("MDF_name") > 0) return;
    const std::string what = "'MDF_name' is missing", remedy = "expected a mission data file";
    if (mdf_.checkpoints.empty()) throw WrongFormatError(mdf_.file, 0, what + "; " + remedy);
    diagnostics_.add_warning(0, what, remedy, "it has no name");
  }

  void statement() {
    const std::string_view word = now().keyword;
    if (is_number(word)) return row();
    if (std::find(kKeywords.begin(), kKeywords.end(), word) == kKeywords.end()) return unknown();
    if (repeats(word)) return;
    if (word == "MDF_name") mdf_.name = now().rest;
    if (word == "RNDF" || word == "RNDF_name") mdf_.rndf_name = now().rest;
    if (word == "format_version") mdf_.format_version = now().rest;
    if (word == "creation_date") mdf_.creation_date = now().rest;
    if (word.starts_with("num_")) return promise();
    if (word == "checkpoints") return begin(Block::checkpoints);
    if (word == "speed_limits") return begin(Block::speed_limits);
    if (word.starts_with("end_")) return end();
  }

  /// Returns true for a repeated keyword with the same text, and for a repeated count, since counts do not matter.
  bool repeats(std::string_view word) {
    const auto [before, fresh] = seen_.emplace(word == "RNDF_name" ? "RNDF" : word, now().rest);
    if (fresh) return false;
    const std::string what = fmt::format("'{}' is given twice", word);
    const bool is_block = word.ends_with("checkpoints") || word.ends_with("speed_limits");
    if (!word.starts_with("num_") && (is_block || before->second != now().rest))
      statements_.fail(what + "; expected it once");
    diagnostics_.add_warning(now().line, what, "expected it once", "the first is used");
    return true;
  }

  void unknown() {
    const std::string_view word = now().keyword;
    if (word == "num_segments" || word == "segment")
      throw WrongFormatError(mdf_.file, now().line, fmt::format("'{}' belongs in an RNDF; expected an MDF", word));
    const bool plain = word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") ==
                       std::string_view::npos;
    if (!plain || word.size() > 40 || unknown_.size() > 20) {
      const std::string message =
          fmt::format("{} is not a statement; expected an MDF keyword such as 'checkpoints'", quoted(word));
      if (seen_.empty()) throw WrongFormatError(mdf_.file, now().line, message);
      statements_.fail(message);
    }
    if (unknown_.emplace(word).second)
      warn(now().line, fmt::format("unknown keyword '{}' is ignored{}", word, base::suggest(word, kKeywords)));
  }

  void begin(Block block) {
    statements_.expect_fields(0);
    end_block(fmt::format("before '{}'", now().keyword));
    block_ = block;
    begun_ = now().line;
  }

  void end() {
    statements_.expect_fields(0);
    const std::string_view word = now().keyword;
    if (word == "end_file") {
      end_block("before 'end_file'");
      ended_ = true;
      return;
    }
    if (word.substr(4) != mdf_block_name(block_))
      statements_.fail(fmt::format("'{}' has no matching start; expected '{}' before it", word, word.substr(4)));
    block_ = Block::file;
  }

  static std::string_view mdf_block_name(Block block) {
    return block == Block::checkpoints ? "checkpoints" : block == Block::speed_limits ? "speed_limits" : "file";
  }

  // Ends the open block, even if its end statement is missing.
  void end_block(const std::string& because) {
    if (block_ == Block::file) return;
    warn(begun_, fmt::format("'{0}' has no 'end_{0}'; it ends {1}", mdf_block_name(block_), because));
    block_ = Block::file;
  }

  void promise() {
    std::pair<int, int> said{-1, now().line};
    try {
      said.first = statements_.whole(0, 0, "the number");
      statements_.expect_fields(1);
    } catch (const base::InputError&) {
      if (diagnostics_.strict()) throw;
      warn(now().line,
           fmt::format("'{}' is {}, not a number; the actual entries are counted", now().keyword, quoted(now().rest)));
    }
    declared_[std::string(now().keyword)] = said;
  }

  // Checks a declared count. The actual number overrides it, unless the file ends before that number was reached.
  void check_count(const std::string& keyword, std::size_t have) {
    const std::string taken = have == 1 ? "1 is used" : fmt::format("{} are used", have);
    const auto said = declared_.find(keyword);
    if (said == declared_.end())
      return diagnostics_.add_warning(0, fmt::format("'{}' is missing", keyword),
                                      fmt::format("expected '{} {}'", keyword, have), taken);
    const auto [count, line] = said->second;
    if (count < 0 || static_cast<std::size_t>(count) == have) return;
    const std::string what = fmt::format("'{}' is {}, but there are {}", keyword, count, have);
    if (!ended_ && static_cast<std::size_t>(count) > have)
      return diagnostics_.add_error(line, what + ": the file is truncated");
    diagnostics_.add_warning(line, what, "correct the number, or add or remove entries", taken);
  }

  void row() {
    if (block_ == Block::checkpoints) return checkpoint();
    if (block_ == Block::speed_limits) return speed_limit();
    statements_.fail(
        fmt::format("{} is outside any list; expected numbers between 'checkpoints' and 'end_checkpoints' or "
                    "'speed_limits' and 'end_speed_limits'",
                    quoted(now().keyword)));
  }

  void checkpoint() {
    statements_.require_fields(0);
    mdf_.checkpoints.push_back({statements_.keyword_whole(1, "the checkpoint's id"), now().line});
  }

  void speed_limit() {
    const SpeedLimit limit{statements_.keyword_whole(1, "the id of the segment or zone"),
                           statements_.decimal(0, "the lowest speed"), statements_.decimal(1, "the highest speed"),
                           now().line};
    statements_.expect_fields(2);
    if (limit.least_mph < 0.0 || limit.most_mph < limit.least_mph || limit.most_mph > kMaxRoadNumber)
      statements_.fail(
          fmt::format("speeds from {} to {} miles per hour; expected the lowest (0: none), then the highest",
                      now().fields[0], now().fields[1]));
    const auto [old, fresh] = limited_.emplace(limit.id, limit);
    if (!fresh) {
      const std::string what = fmt::format("{} already has a speed limit in line {}", limit.id, old->second.line);
      const bool same = old->second.least_mph == limit.least_mph && old->second.most_mph == limit.most_mph;
      if (!same) statements_.fail(what + "; expected one for each segment or zone");
      return diagnostics_.add_warning(limit.line, what, "expected one for each segment or zone", "it is used once");
    }
    mdf_.speed_limits.push_back(limit);
  }

  Mdf mdf_;
  Diagnostics diagnostics_;
  StatementReader statements_;
  Block block_ = Block::file;
  int begun_ = 0;                                         ///< line where the block started
  std::map<std::string, std::string, std::less<>> seen_;  ///< keywords and their text
  std::set<std::string, std::less<>> unknown_;
  std::map<std::string, std::pair<int, int>> declared_;  ///< count (negative: unreadable) and line, by keyword
  std::map<int, SpeedLimit> limited_;                    ///< by segment or zone
  bool ended_ = false;
};

}  // namespace

Mdf parse_mdf(const std::string& file, std::string_view text, bool strict) {
  return MdfReader(file, text, strict).read();
}

Mdf read_mdf(const std::string& file, bool strict) { return parse_mdf(file, base::read_text(file), strict); }

std::vector<Warning> check_against(const Mdf& mdf, const Rndf& rndf) {
  std::set<int> checkpoints;
  std::set<int> places;
  for (const RndfSegment& segment : rndf.segments) {
    places.insert(segment.id);
    for (const RndfLane& lane : segment.lanes)
      for (const RndfCheckpoint& checkpoint : lane.checkpoints) checkpoints.insert(checkpoint.id);
  }
  for (const RndfZone& zone : rndf.zones) {
    places.insert(zone.id);
    for (const RndfSpot& spot : zone.spots)
      for (const RndfCheckpoint& checkpoint : spot.checkpoints) checkpoints.insert(checkpoint.id);
  }

  const std::string has =
      checkpoints.empty() ? "it has none" : fmt::format("expected one of its {}", checkpoints.size());
  std::vector<Warning> warnings;
  Diagnostics diagnostics(mdf.file, false, warnings);
  for (const MdfCheckpoint& wanted : mdf.checkpoints)
    if (checkpoints.count(wanted.id) == 0)
      diagnostics.add_error(wanted.line,
                            fmt::format("checkpoint {} does not exist in {}; {}", wanted.id, rndf.file, has));
  diagnostics.throw_errors();
  for (const SpeedLimit& limit : mdf.speed_limits)
    if (places.count(limit.id) == 0)
      warnings.push_back({mdf.file, limit.line,
                          fmt::format("speed limit for {}, but {} has no such segment or zone", limit.id, rndf.file)});
  return warnings;
}

}  // namespace sf::world
