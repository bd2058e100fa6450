#pragma once
// Reads uncompressed MCAP, whole or not: front to back, never by the summary, so that a file cut at any byte gives
// everything that was whole before the cut. Nothing it allocates is larger than a small multiple of the file.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "record/mcap.h"

namespace sf::record {

/// Views point into the bytes that were read and live as long as they do.
struct McapContents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, McapSchema> schemas;    ///< by id
  std::map<std::uint16_t, McapChannel> channels;  ///< by id
  std::vector<McapMessage> messages;              ///< in file order; every one's channel is in `channels`
  std::vector<McapAttachment> attachments;        ///< those whose CRC holds
  std::vector<McapMetadata> metadata;
  bool truncated = false;           ///< the file does not end as a finished one does
  std::vector<std::string> damage;  ///< what was left out or does not fit its CRC: byte and reason, at most 100 lines
};

/// @param name of the file, for messages.
/// @throws base::InputError when the bytes do not start as an MCAP file does.
McapContents read_mcap(std::span<const std::uint8_t> file, const std::string& name);

}  // namespace sf::record
