#include "netio/player/protocol.h"

#include "netio/player/xdr.h"

namespace sf::netio::player {

std::string_view interface_name(Interface interf) {
  switch (interf) {
    case Interface::player:
      return "player";
    case Interface::power:
      return "power";
    case Interface::position2d:
      return "position2d";
    case Interface::sonar:
      return "sonar";
    case Interface::laser:
      return "laser";
    case Interface::fiducial:
      return "fiducial";
    case Interface::gps:
      return "gps";
    case Interface::bumper:
      return "bumper";
    case Interface::ir:
      return "ir";
    case Interface::simulation:
      return "simulation";
    case Interface::map:
      return "map";
    case Interface::opaque:
      return "opaque";
    case Interface::ranger:
      return "ranger";
  }
  return "";
}

void put_header(const Header& header, base::Bytes& out) {
  XdrWriter xdr(out);
  xdr.put_all({header.host, header.robot, static_cast<std::uint32_t>(header.address.interf), header.address.index,
               static_cast<std::uint32_t>(header.type), header.subtype});
  xdr.put(header.time);
  xdr.put_all({header.sequence, header.size});
}

Header read_header(std::span<const std::uint8_t> bytes) {
  XdrReader xdr(bytes);
  Header header;
  header.host = xdr.get();
  header.robot = xdr.get();
  header.address.interf = static_cast<Interface>(xdr.get());
  header.address.index = xdr.get();
  header.type = static_cast<MessageType>(xdr.get());
  header.subtype = xdr.get();
  header.time = xdr.get_double();
  header.sequence = xdr.get();
  header.size = xdr.get();
  return header;
}

}  // namespace sf::netio::player
