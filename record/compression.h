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

/// For one thread; keeps its memory between calls.
class ZstdCompressor {
 public:
  ZstdCompressor();
  /// Replaces `out` by one frame, which states the size of `in`. The same bytes give the same frame.
  void compress(std::span<const std::uint8_t> in, base::Bytes& out);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
};

/// For one thread; keeps its memory between calls.
class ZstdDecompressor {
 public:
  /// Takes frames that anyone may have made. @return false where they do not fill `out` exactly, or are malformed
  bool decompress(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

}  // namespace sf::record
