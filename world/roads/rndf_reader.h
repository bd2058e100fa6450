#pragma once
// An RNDF while its statements are being read: which blocks are open, and what each keyword does in them.
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
    int count = 0;  ///< negative: it cannot be read
    int line = 0;
    std::string text;  ///< as written
  };
  /// A block that has begun and not ended, with what its header promised.
  struct Open {
    RndfBlock block = RndfBlock::file;
    int line = 0;
    std::string name;                                            ///< `lane 1.2`
    std::map<std::string, DeclaredCount, std::less<>> declared;  ///< by keyword, e.g. `num_lanes`
    std::map<std::string, std::string, std::less<>> seen;  ///< keywords that may stand here once, and what they say
    std::size_t skipped = 0;                               ///< blocks and points in it that were refused
  };
  struct Rule;
  static const std::map<std::string_view, Rule>& rules();

  // StatementReader
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
  void check_declared(const Open& open, std::string_view keyword, std::size_t have);
  void check_name();

  // What keywords do
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

  const AccuracyStatement& now() const { return statements_.now(); }
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
  std::vector<Open> open_;                     ///< from the file down to the innermost block
  std::map<PointId, int> claimed_;             ///< line of every id in use: {segment, 0, 0}, {segment, lane, 0}, points
  std::map<int, RndfCheckpoint> checkpoints_;  ///< by id
  std::map<std::pair<PointId, PointId>, int> exits_;
  std::set<PointId> stops_;
  std::set<std::string, std::less<>> unknown_;  ///< keywords warned about
  std::set<PointId> unread_;                    ///< of points that are named, and were refused
  bool ended_ = false;
  bool cut_ = false;  ///< the file has no end of its own: it may be a part of one
};

/// Whether all that exits, stops and checkpoints name is there. @param unread points that are no problem of theirs
void check_references(const Rndf& rndf, const std::set<PointId>& unread, Diagnostics& diagnostics);

}  // namespace sf::world
