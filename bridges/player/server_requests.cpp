// Requests to the server itself: device lists, subscriptions and data modes.

#include "bridges/player/server.h"

namespace sf::bridges::player {

namespace {

Address get_address(XdrReader& xdr) {
  xdr.get(), xdr.get();  // host and port are those of the connection
  Address address;
  address.interf = static_cast<Interface>(xdr.get());
  address.index = xdr.get();
  return address;
}

}  // namespace

void Server::put_address(const Connection& connection, const Address& address, XdrWriter& xdr) const {
  const netio::Endpoint& local = ports_[connection.port()].endpoint;
  xdr.put_all({local.address, std::uint32_t{local.port}, static_cast<std::uint32_t>(address.interf), address.index});
}

std::string Server::driver_name(const Connection& connection, const Address& address) const {
  const auto& listing = ports_[connection.port()].listing.rows();
  const auto known = listing.find(address);
  return known == listing.end() ? "" : devices_.rows()[known->second].name.substr(0, kMostDriverName);
}

bool Server::handle_own(Connection& connection, const Header& header, std::span<const std::uint8_t> payload) {
  if (header.type != MessageType::request) return true;
  XdrReader xdr(payload);
  const auto acknowledge = [&] { connection.answer(header, MessageType::ack, {}, time()); };
  switch (header.subtype) {
    case server_request::device_list:
      return list(connection, header), true;
    case server_request::driver_info:
      return describe(connection, header, xdr);
    case server_request::device:
      return open_or_close(connection, header, xdr);
    case server_request::data:
      acknowledge();
      connection.ask_for_data();
      return true;
    case server_request::data_mode:
      connection.set_mode(static_cast<DataMode>(xdr.get()));
      acknowledge();
      return xdr.done();
    case server_request::replace_rule:  // newer data always replaces older data
      for (int i = 0; i < 5; ++i) xdr.get();
      acknowledge();
      return xdr.done();
    default:
      connection.answer(header, MessageType::nack, {}, time());
      return true;
  }
}

void Server::list(Connection& connection, const Header& header) {
  constexpr std::size_t kMostListed = 4096;  // capacity of clients
  const auto& listing = ports_[connection.port()].listing.rows();
  payload_.clear();
  XdrWriter xdr(payload_);
  std::size_t left = std::min(listing.size(), kMostListed);
  xdr.put_count(left);
  for (auto next = listing.begin(); left > 0; ++next, --left) put_address(connection, next->first, xdr);
  connection.answer(header, MessageType::ack, payload_, time());
}

bool Server::describe(Connection& connection, const Header& header, XdrReader& xdr) {
  const Address address = get_address(xdr);
  xdr.get_text(kMostDriverName + 1);
  if (!xdr.done()) return false;
  const std::string name = driver_name(connection, address);
  payload_.clear();
  if (!name.empty()) {
    XdrWriter out(payload_);
    put_address(connection, address, out);
    out.put_text(name);
  }
  connection.answer(header, name.empty() ? MessageType::nack : MessageType::ack, payload_, time());
  return true;
}

bool Server::open_or_close(Connection& connection, const Header& header, XdrReader& xdr) {
  const Address address = get_address(xdr);
  auto access = static_cast<Access>(xdr.get());
  xdr.get_text(kMostDriverName + 1);
  if (!xdr.done()) return false;
  const auto& listing = ports_[connection.port()].listing.rows();
  const auto known = listing.find(address);
  const bool is_open = connection.subscriptions().count(address) > 0;
  if (known == listing.end() || (access != Access::open && !(access == Access::close && is_open))) {
    access = Access::error;
  } else if (access == Access::open) {
    subscribe(connection, address, known->second);
  } else {
    unsubscribe(connection, address);
  }
  payload_.clear();
  XdrWriter out(payload_);
  put_address(connection, address, out);
  out.put(static_cast<std::uint32_t>(access));
  if (known == listing.end()) {
    out.put_count(0);
  } else {
    out.put_text(driver_name(connection, address));
  }
  connection.answer(header, known == listing.end() ? MessageType::nack : MessageType::ack, payload_, time());
  return true;
}

}  // namespace sf::bridges::player
