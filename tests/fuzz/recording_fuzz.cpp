// Any bytes as a recording, and as a message of another program: they are read or rejected, whatever the chunks and
// their compressed forms state.

#include "base/error.h"
#include "record/foreign_messages.h"
#include "record/recording.h"
#include "record/schemas.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const sf::record::Recording recording = sf::record::read_recording({data, size}, "fuzz.mcap");
    sf::require(recording.states.size() == recording.info.movers.size());
    sf::require(recording.damage.size() <= 200);
  } catch (const sf::base::InputError&) {
  }
  sf::record::ForeignMessage message;
  for (const auto type : {sf::record::kImu, sf::record::kOdometry, sf::record::kNavSatFix, sf::record::kLaserScan})
    if (sf::record::decode_foreign(type, {data, size}, message))
      sf::require(type == sf::record::kLaserScan || message.values.size() == sf::record::foreign_columns(type).size());
  return 0;
}
