#pragma once
// Reads uncompressed MCAP, complete or truncated: sequentially, without the summary, so that a file cut at any byte
// gives all records before the cut. Everything that the file states twice is compared, so that each flipped bit of a
// finished file is damage: all CRCs, and lengths, times, counts and indexes by record/mcap_index.h. A CRC of 0 is none.
// Allocations are bounded by a small multiple of the file's size.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "record/mcap.h"

namespace sf::record {

/// Views point into the input bytes and live as long as they do.
struct McapContents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, McapSchema> schemas;    ///< by id
  std::map<std::uint16_t, McapChannel> channels;  ///< by id
  std::vector<McapMessage> messages;              ///< in file order; `channels` has the channel of each
  std::vector<McapAttachment> attachments;        ///< attachments with a correct CRC
  std::vector<McapMetadata> metadata;
  bool truncated = false;           ///< the file lacks the end of a finished file
  std::vector<std::string> damage;  ///< per omission or contradiction: byte and reason, at most 100 lines
};

/// @param name of the file, for messages.
/// @throws base::InputError when the bytes do not begin with the magic of MCAP.
McapContents read_mcap(std::span<const std::uint8_t> file, const std::string& name);

}  // namespace sf::record
