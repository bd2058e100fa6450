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
  RndfReader(const std::string& file, std::string_view text);

  /// Everything but whether references lead somewhere. @throws base::InputError
  Rndf read();

 private:
  struct Promise {
    int count = 0;
    int line = 0;
  };
  /// A block that has begun and not ended, with what its header promised.
  struct Open {
    RndfBlock block = RndfBlock::file;
    int line = 0;
    std::string name;                                      ///< `lane 1.2`
    std::map<std::string, Promise, std::less<>> promises;  ///< by keyword, e.g. `num_lanes`
    std::set<std::string, std::less<>> seen;               ///< keywords that may stand here once
  };
  struct Rule;
  static const std::map<std::string_view, Rule>& rules();

  // Statements
  void statement();
  void unknown();
  void apply(std::string_view keyword, const Rule& rule);
  void waypoint();

  // Blocks
  void open(RndfBlock block, std::string name);
  void close();
  void close_implied(const std::string& because);
  void end_block(RndfBlock block);
  void end_file();
  void check_promise(const Open& open, std::string_view keyword, std::size_t have);
  void check_name() const;

  // What keywords do
  void promise(int least, std::string_view what);
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

  const Statement& now() const { return statements_.now(); }
  RndfLane& lane() { return rndf_.segments.back().lanes.back(); }
  RndfZone& zone() { return rndf_.zones.back(); }
  RndfSpot& spot() { return zone().spots.back(); }
  std::vector<RndfPoint>& points();
  PointId own(PointId id, std::string_view what) const;
  void claim(PointId id, std::string_view what);
  void warn(int line, std::string message);
  void warn_once(std::string_view keyword, std::string message);

  Statements statements_;
  Rndf rndf_;
  std::vector<Open> open_;          ///< from the file down to the innermost block
  std::map<PointId, int> claimed_;  ///< line of every id in use: {segment, 0, 0}, {segment, lane, 0}, points
  std::map<int, int> checkpoints_;  ///< line of every checkpoint id
  std::map<std::pair<PointId, PointId>, int> exits_;
  std::set<PointId> stops_;
  std::set<std::string, std::less<>> unknown_;  ///< keywords warned about
  bool ended_ = false;
};

}  // namespace sf::world
