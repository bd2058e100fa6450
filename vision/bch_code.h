#pragma once
// The code of ARToolKitPlus's id-based markers with BCH (D. Wagner, D. Schmalstieg, "ARToolKitPlus for Pose Tracking on
// Mobile Devices", 2007): 12 bits of id in 6 x 6 cells.
//
// The binary code BCH(36, 12) has distance 9 and corrects 4 errors. It is the code of length 63 over GF(64), with the
// primitive polynomial x^6 + x + 1 and the roots alpha to alpha^8, shortened by 27 bits. The id is in the 12 highest
// coefficients. A mask inverts some cells, so that no tag is a single colour.

#include <cstdint>
#include <optional>

namespace sf::vision {

inline constexpr std::uint32_t kBchIds = 4096;  ///< ids are 0 to 4095
inline constexpr int kBchCells = 6;             ///< along a side, without the black border
inline constexpr int kBchMaxErrors = 4;         ///< wrong cells that are corrected if the orientation is known

/// Cells of a tag, row by row: bit 35 is the upper left one, bit 0 the lower right one; 1 is white.
using BchWord = std::uint64_t;

/// @param id below `kBchIds`
BchWord encode_bch(std::uint32_t id);

struct BchMatch {
  std::uint32_t id = 0;
  int errors = 0;  ///< corrected cells, at most `kBchMaxErrors`
  int turns = 0;   ///< quarter turns, clockwise, from the printed tag to the cells, 0 to 3
};

/// Returns the id whose upright cells differ least; nullopt if they differ by more than `kBchMaxErrors`.
std::optional<BchMatch> decode_upright_bch(BchWord cells);

/// Tries all four orientations. Returns the one with the fewest errors, or nullopt if it is not the only one: a few ids
/// differ by only 2 to 8 cells from another id in another orientation.
std::optional<BchMatch> decode_bch(BchWord cells);

/// Turns the cells clockwise by a quarter.
BchWord turn_bch(BchWord cells);

}  // namespace sf::vision
