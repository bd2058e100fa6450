#pragma once
// Reads MCAP, complete or truncated, uncompressed or with chunks of zstd. It reads sequentially, without the summary,
// so a file truncated at any byte yields all records before that byte. It compares everything that the file states
// twice, so each flipped bit of a finished file counts as damage: all CRCs, and lengths, times, counts and indexes
// (record/mcap_index.h). A CRC of 0 means that there is none. Allocations are bounded by a small multiple of the size
// of the file and its chunks. At most `kMaxDecompressed` bytes per byte of the file, plus 1 GiB, are decompressed.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "record/mcap.h"

namespace sf::record {

/// [byte] Decompressed per byte of a file, beyond the first GiB. Readings compress to a half, maps and robots at rest
/// to 1/100.
inline constexpr std::uint64_t kMaxDecompressed = 256;

/// Views point into the input bytes and into `decompressed`, and are valid as long as both exist.
struct McapContents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, McapSchema> schemas;    ///< keyed by id
  std::map<std::uint16_t, McapChannel> channels;  ///< keyed by id
  std::vector<McapMessage> messages;              ///< in file order; `channels` has the channel of each
  std::vector<McapAttachment> attachments;        ///< attachments with a correct CRC
  std::vector<McapMetadata> metadata;
  std::vector<std::unique_ptr<std::uint8_t[]>> decompressed;  ///< records of compressed chunks
  std::optional<Compression> compression;                     ///< compression of the last whole chunk; nullopt: there
                                                              ///< is no chunk
  bool truncated = false;                                     ///< the file lacks the ending of a finished file
  std::vector<std::string> damage;  ///< byte and reason of each omission or contradiction, at most 100 lines
};

/// @param name of the file, for messages
/// @throws base::InputError if the bytes do not begin with the magic of MCAP
McapContents read_mcap(std::span<const std::uint8_t> file, const std::string& name);

}  // namespace sf::record
