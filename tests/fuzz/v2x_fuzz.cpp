// libFuzzer target: any bytes as a V2X message frame. A decoded message has an XML form and encodes to a frame with the
// same content.

#include <cstdint>

#include "tests/fuzz/require.h"
#include "v2x/xml.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  v2x::Frame frame;
  const v2x::DecodeResult result = v2x::decode({data, size}, frame);
  require(result.size <= size);
  if (!result.ok()) return 0;
  require(!v2x::xml_of(frame).empty());

  // Lengths in a longer form than necessary become short: the bytes may differ, but the content is equal and their
  // number does not grow.
  base::Bytes again;
  v2x::encode(frame, again);
  require(again.size() <= result.size);
  v2x::Frame other;
  require(v2x::decode(again, other).ok() && other == frame);
  return 0;
}
