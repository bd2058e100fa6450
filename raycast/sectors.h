#pragma once
// Sector lists: for one cell, what beams of each direction sector may meet.
//
// Needs: every segment that could matter. Gives: for each sector the segments that some point of the cell may see
// within range in that sector, near to far. A list may hold too much, never too little.
//
// A point p seen from anywhere in a disc of radius q around the cell's centre lies within asin(q / |p|) of its bearing
// from the centre. Along a segment outside of the disc the two tangent bearings move monotonically, so the ends bound
// them.
//
// Error band of the 32-bit search, with coordinates up to A and directions of unit length (u = 2^-24):
//   endpoints and offset round by u A each, directions by 4 u, products and differences by u A more each:
//   |error of w x d| < 10 u A, |error of e x d| < 7 u |e|, |error of e x w| < 7 u A |e|, all below SF_BAND A (|e|).

#include <cstdint>
#include <vector>

#include "raycast/records.h"
#include "raycast/sight.h"

namespace sf::raycast {

/// What all cells of one family share.
struct CellShape {
  double size = 0.25;   ///< [m] side of the square cell
  double range = 8.0;   ///< [m] of the sensors it serves
  double spread = 0.0;  ///< [rad] from the middle of a lane's beams to its outermost, and the search's own error

  double radius() const {
    return size * 0.70710678118654757 * (1.0 + 1e-6) + 1e-9;
  }                                                                              ///< [m] of the disc round the cell
  double reach() const { return range * (1.0 + 1e-6) + 2.0 * radius() + 1e-6; }  ///< [m] farthest useful coordinate
};

/// A segment that goes into a list, seen from its right.
struct Candidate {
  Vec2 a;  ///< [m] relative to the centre
  Vec2 b;
  double nearest = 0.0;  ///< [m] least distance to any viewpoint
  std::uint32_t id = 0;  ///< row of the exact segment
  bool facing = true;    ///< false: no viewpoint sees it from its right, it only decides ties at corners
};

/// The part of ab within `reach` of the origin; false when there is none.
bool clip(Vec2& a, Vec2& b, double reach);

/// Lists being collected, sector by sector. Keeps its memory between uses.
struct SectorLists {
  struct Item {
    std::uint32_t sector;
    std::uint32_t candidate;
  };
  std::vector<Candidate> candidates;
  std::vector<Item> items;
  std::vector<std::uint32_t> order;          ///< candidates by sector, then near to far
  std::uint32_t first[SF_SECTORS + 1] = {};  ///< range of each sector in `order`: what faces viewpoints comes first
  std::uint32_t behind[SF_SECTORS] = {};     ///< where in `order` it ends

  void clear();
  /// Puts the last candidate into every sector that [low, high] touches, angles in radians from the centre, low <=
  /// high.
  void add_interval(double low, double high);
  void add_everywhere();
  /// Puts `candidate` into every sector in which a disc of `radius` [m] round the origin may see it.
  void add_seen(const Candidate& candidate, double radius, double spread);
  /// Fills `order` and `first`.
  void sort();
  std::uint32_t chunks_facing(std::uint32_t sector) const { return chunks_of(behind[sector] - first[sector]); }
  std::uint32_t chunks(std::uint32_t sector) const {
    return chunks_facing(sector) + chunks_of(first[sector + 1] - behind[sector]);
  }
  static std::uint32_t chunks_of(std::uint32_t entries) { return (entries + SF_CHUNK - 1) / SF_CHUNK; }
  std::uint32_t all_chunks() const;
  std::uint32_t longest() const;  ///< [chunks] of one sector
};

/// Collects the lists of the cell around `centre`. With `both_sides`, viewpoints may lie inside solids.
void collect(const Sight& sight, const CellShape& shape, Vec2 centre, bool both_sides, Sight::Nearby& nearby,
             SectorLists& lists);

/// What a list calls segment `row`, of which others keep `clearance` [m] away.
std::uint32_t list_word(std::uint32_t row, float clearance);

/// Where finished lists are written: the device's tables.
struct ListTables {
  ListEntry* entries;          ///< SF_CHUNK per chunk
  std::uint32_t* ids;          ///< SF_CHUNK per chunk, as `words` gives them
  float* nearest;              ///< [m] one per chunk
  const std::uint32_t* words;  ///< `list_word` of every exact segment
};

/// Writes all lists from `first_chunk` on and their SF_SECTORS headers. Padding entries are never met.
void write_lists(const SectorLists& lists, std::uint32_t first_chunk, const ListTables& tables, ListHeader* headers);

}  // namespace sf::raycast
