// Any bytes as a recording: it is read or rejected, whatever its chunks and their compressed forms state.

#include "base/error.h"
#include "record/recording.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const sf::record::Recording recording = sf::record::read_recording({data, size}, "fuzz.mcap");
    sf::require(recording.states.size() == recording.info.movers.size());
    sf::require(recording.damage.size() <= 200);
  } catch (const sf::base::InputError&) {
  }
  return 0;
}
