#pragma once
// Parser state for an RNDF: the open blocks, and the effect of each keyword in them.
//
//   file > segment > lane
//   file > zone > perimeter
//               > spot

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "world/roads/rndf.h"

namespace sf::world {

enum class RndfBlock : std::uint8_t { file, segment, lane, zone, perimeter, spot };

class RndfReader {
 public:
  RndfReader(const std::string& file, std::string_view text, bool strict);

  /// @throws base::InputError
  Rndf read();

 private:
  struct DeclaredCount {
    int count = 0;  ///< negative: unreadable
    int line = 0;
    std::string text;  ///< as written
  };
  /// An open block, with the declarations of its header.
  struct Open {
    RndfBlock block = RndfBlock::file;
    int line = 0;
    std::string name;                                            ///< `lane 1.2`
    std::map<std::string, DeclaredCount, std::less<>> declared;  ///< by keyword, e.g. `num_lanes`
    std::map<std::string, std::string, std::less<>> seen;        ///< keywords allowed once per block, with their text
    /// Number of rejected blocks in this block, by keyword, and of rejected points, as `point`.
    std::map<std::string, std::size_t, std::less<>> skipped;
    std::size_t refused(std::string_view what) const {
      const auto found = skipped.find(what);
      return found == skipped.end() ? 0 : found->second;
    }
  };
  struct Rule;
  static const std::map<std::string_view, Rule>& rules();

  // Statements
  bool next();
  void statement();
  bool repeats(std::string_view keyword);
  void skip(std::string_view keyword);
  void unknown();
  void apply(std::string_view keyword, const Rule& rule);
  void waypoint();

  // Blocks
  void open(RndfBlock block, std::string name);
  void close();
  void close_implied(const std::string& because);
  void end_block(RndfBlock block);
  void end_file();
  void check_declared(const Open& open, std::string_view keyword, std::string_view entry, std::size_t have);
  void check_name();

  // Effects of keywords
  void read_declared_count(int least, std::string_view what);
  void begin_segment();
  void begin_lane();
  void begin_zone();
  void begin_perimeter();
  void begin_spot();
  void read_boundary(Boundary& boundary);
  void read_width(std::optional<double>& width_ft);
  void read_exit();
  void read_stop();
  void read_checkpoint();

  const RoadStatement& now() const { return statements_.now(); }
  RndfLane& lane() { return rndf_.segments.back().lanes.back(); }
  RndfZone& zone() { return rndf_.zones.back(); }
  RndfSpot& spot() { return zone().spots.back(); }
  std::vector<RndfPoint>& points();
  PointId key_of_block() const;
  PointId own(PointId id, std::string_view what) const;
  PointId own_or_known(PointId id, std::string_view what);
  void claim(PointId id, std::string_view what);
  void warn(int line, std::string message);
  void warn_once(std::string_view keyword, std::string message);

  Rndf rndf_;
  Diagnostics diagnostics_;
  StatementReader statements_;
  std::vector<Open> open_;                     ///< from the file to the innermost block
  std::map<PointId, int> claimed_;             ///< line of each id in use: {segment, 0, 0}, {segment, lane, 0}, points
  std::map<int, RndfCheckpoint> checkpoints_;  ///< by id
  std::map<std::pair<PointId, PointId>, int> exits_;
  std::set<PointId> stops_;
  std::set<std::string, std::less<>> unknown_;  ///< unknown keywords already warned about
  std::set<PointId> unread_;                    ///< rejected points, which references may still use
  bool ended_ = false;
  bool cut_ = false;  ///< the file has no end_file, so it may be truncated
};

/// Checks that all points named by exits, stops and checkpoints exist.
/// @param unread rejected points; references to them are not reported
void check_references(const Rndf& rndf, const std::set<PointId>& unread, Diagnostics& diagnostics);

}  // namespace sf::world
