#include "netio/packet_forms.h"

#include <algorithm>
#include <iterator>

namespace sf::netio {

namespace {

constexpr PacketForm kForms[] = {{Type::v2v, "V2V", kV2vBytes, kTiltBytes},
                                 {Type::tag, "TAG", kHeaderBytes + kTagBytes},
                                 {Type::subscribe, "SUBSCRIBE", 0},
                                 {Type::start, "START", kHeaderBytes},
                                 {Type::leave, "LEAVE", kHeaderBytes},
                                 {Type::challenge, "CHALLENGE", kHeaderBytes + kChallengeBytes},
                                 {Type::command, "COMMAND", 0},
                                 {Type::step, "STEP", kHeaderBytes + kStepBytes},
                                 {Type::fetch, "FETCH", kHeaderBytes + kStepBytes},
                                 {Type::v2i, "V2I", 0},
                                 {Type::object, "OBJECT", 0},
                                 {Type::refusal, "REFUSAL", kHeaderBytes + kRefusalBytes},
                                 {Type::neighbours, "NEIGHBOURS", 0},
                                 {Type::state, "STATE", kHeaderBytes + kStateBytes, kTiltBytes},
                                 {Type::values, "VALUES", 0},
                                 {Type::drive, "DRIVE", kHeaderBytes + kDriveBytes},
                                 {Type::lane, "LANE", kHeaderBytes + kLaneBytes},
                                 {Type::team_map, "TEAM_MAP", 0},
                                 {Type::own_readings, "OWN_READINGS", 0},
                                 {Type::dropped, "DROPPED", kHeaderBytes + kDroppedBytes}};

}  // namespace

const PacketForm* find_packet_form(Type type) {
  const auto* const form =
      std::find_if(std::begin(kForms), std::end(kForms), [&](const PacketForm& f) { return f.type == type; });
  return form == std::end(kForms) ? nullptr : form;
}

}  // namespace sf::netio
