#include "record/lights_message.h"

#include "base/error.h"
#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::record {

void encode_lights(std::int64_t time, std::span<const std::string> names, std::span<const base::LightStatus> lights,
                   base::Bytes& out) {
  SF_CHECK(names.size() == lights.size(), std::to_string(lights.size()) + " states of lights");
  CdrWriter cdr(out);
  put_header(cdr, time, "world");
  cdr.put_count(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    cdr.put(std::string_view(names[i]));
    cdr.put(lights[i].state);
    cdr.put(lights[i].left);
  }
}

bool decode_lights(std::span<const std::uint8_t> message, std::int64_t& time, std::vector<base::LightStatus>& lights) {
  constexpr std::size_t kLeastLight = 13;  // [byte]
  constexpr std::uint8_t kStates = 6;
  CdrReader cdr(message);
  get_header(cdr, time);
  lights.resize(cdr.get_count(kLeastLight));
  bool known = true;
  for (base::LightStatus& light : lights) {
    cdr.get_string();
    light.state = cdr.get<std::uint8_t>();
    light.left = cdr.get<double>();
    known = known && light.state < kStates;
  }
  return cdr.good() && known;
}

}  // namespace sf::record
