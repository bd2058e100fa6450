#pragma once
// Compression of the chunks of MCAP files (zstd).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/bytes.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace sf::record {

/// Single-threaded; keeps its memory between calls.
class ZstdCompressor {
 public:
  ZstdCompressor();
  /// Replaces `out` with one frame, which states the size of `in`. Equal bytes give equal frames.
  void compress(std::span<const std::uint8_t> in, base::Bytes& out);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
};

/// Single-threaded; keeps its memory between calls.
class ZstdDecompressor {
 public:
  /// Decompresses untrusted frames. @return false if they do not fill `out` exactly or are malformed
  bool decompress(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

}  // namespace sf::record
