#pragma once
// Reads MCAP, complete or truncated, uncompressed or with chunks of zstd: sequentially, without the summary, so that a
// file cut at any byte gives all records before the cut. Everything that the file states twice is compared, so that
// each flipped bit of a finished file is damage: all CRCs, and lengths, times, counts and indexes by
// record/mcap_index.h. A CRC of 0 is none. Allocations are bounded by a small multiple of the file's size and of its
// chunks', of which at most `kMaxDecompressed` bytes per byte of the file, and 1 GiB more, are decompressed.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "record/mcap.h"

namespace sf::record {

/// [byte] Decompressed per byte of a file, beyond the first GiB: readings compress to a half, maps and robots that
/// stand still to 1/100.
inline constexpr std::uint64_t kMaxDecompressed = 256;

/// Views point into the input bytes and into `decompressed`, and live as long as both do.
struct McapContents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, McapSchema> schemas;    ///< by id
  std::map<std::uint16_t, McapChannel> channels;  ///< by id
  std::vector<McapMessage> messages;              ///< in file order; `channels` has the channel of each
  std::vector<McapAttachment> attachments;        ///< attachments with a correct CRC
  std::vector<McapMetadata> metadata;
  std::vector<std::unique_ptr<std::uint8_t[]>> decompressed;  ///< records of compressed chunks
  std::optional<Compression> compression;                     ///< of the last whole chunk; none: there is no chunk
  bool truncated = false;                                     ///< the file lacks the end of a finished file
  std::vector<std::string> damage;  ///< per omission or contradiction: byte and reason, at most 100 lines
};

/// @param name of the file, for messages.
/// @throws base::InputError when the bytes do not begin with the magic of MCAP.
McapContents read_mcap(std::span<const std::uint8_t> file, const std::string& name);

}  // namespace sf::record
