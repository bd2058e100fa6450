#pragma once
// A world's tables as bytes, row by row. Shared by the hash and the snapshot.

#include <string>

#include "base/bytes.h"
#include "base/error.h"
#include "world/world.h"

namespace sf::world {

inline constexpr std::size_t kMagnetBytes = 44;
inline constexpr std::size_t kLaneMarkingBytes = 16;  ///< minimum, here and below
inline constexpr std::size_t kMoverBytes = 119;
inline constexpr std::size_t kPathBytes = 8;
inline constexpr std::size_t kLightBytes = 57;
inline constexpr std::size_t kEmitterBytes = 61;
inline constexpr std::size_t kFloorHoleBytes = 8;

/// The fields of a row to write: all of them, or those that a reading depends on (no colours).
enum class RowFields { all, physics };

void put(base::ByteWriter& out, const Pose& pose);
void put(base::ByteWriter& out, const Segment& segment);
void put(base::ByteWriter& out, const LaneMarking& marking, RowFields fields);
void put(base::ByteWriter& out, const Magnet& magnet);
void put(base::ByteWriter& out, const Model& model, RowFields fields);
void put(base::ByteWriter& out, const Mover& mover, RowFields fields);
/// With RowFields::physics an empty word writes nothing, so that the hashes of worlds without an accuracy stay the
/// same.
void put(base::ByteWriter& out, const Accuracy& accuracy, RowFields fields);
void put(base::ByteWriter& out, const Path& path);
void put(base::ByteWriter& out, const Light& light);
void put(base::ByteWriter& out, const Emitter& emitter);
void put(base::ByteWriter& out, const FloorHole& hole);

Pose get_pose(base::ByteReader& in);
Accuracy get_accuracy(base::ByteReader& in);
Segment get_segment(base::ByteReader& in);
Magnet get_magnet(base::ByteReader& in);
Model get_model(base::ByteReader& in);
/// @throws base::InputError when its count of points exceeds the bytes left.
LaneMarking get_lane_marking(base::ByteReader& in);
/// @throws base::InputError when one of its counts of rows exceeds the bytes left.
Mover get_mover(base::ByteReader& in);

Path get_path(base::ByteReader& in);
Light get_light(base::ByteReader& in);
Emitter get_emitter(base::ByteReader& in);
FloorHole get_floor_hole(base::ByteReader& in);

/// A value of an enumeration. @throws base::InputError for a value above `last`.
template <class Word>
Word get_enum(base::ByteReader& in, Word last, const char* what) {
  const auto word = in.get<std::uint8_t>();
  if (word > static_cast<std::uint8_t>(last))
    throw base::InputError(std::string("broken world snapshot: unknown ") + what);
  return static_cast<Word>(word);
}

/// A count of rows of at least `row_size` bytes each. @throws base::InputError when the bytes cannot hold them.
std::uint32_t get_count(base::ByteReader& in, std::size_t row_size);

}  // namespace sf::world
