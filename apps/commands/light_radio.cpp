#include "apps/commands/light_radio.h"

#include <fmt/format.h>

#include <utility>

#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "netio/address_book.h"
#include "netio/signature_trouble_log.h"
#include "server/wire_ids.h"

namespace sf::apps {

LightRadio::LightRadio(const world::World& world, const world::RoadNetwork* roads, const std::string& farm,
                       const std::vector<netio::Peer>& peers, std::uint32_t first)
    : messages_(world, roads, first) {
  const auto address = netio::AddressBook().find(farm);
  if (!address) throw base::InputError(fmt::format("--farm: expected HOST:PORT, got '{}'", farm));
  farm_ = netio::endpoint_text(*address);
  for (const server::Intersection& one : messages_.intersections()) {
    const netio::Peer* own = netio::find(peers, netio::PeerKind::light, one.id);
    sockets_.emplace_back(netio::V2vSocketOptions{.farm = *address,
                                                  .robot = one.id,
                                                  .others = server::ids_of(server::wire_names(world).robots),
                                                  .key = own != nullptr ? own->key : std::nullopt});
  }
}

void LightRadio::receive(std::int64_t now, const std::function<void(glm::dvec2)>& hear) {
  for (netio::V2vSocket& socket : sockets_)
    socket.receive([&](std::span<const std::uint8_t> bytes) {
      netio::Packet packet;
      if (socket.accept(bytes, now, packet) != netio::PacketStatus::accepted) return;
      answered_ = true;
      const auto* state = std::get_if<netio::V2v>(&packet.body);
      if (state == nullptr) return;
      hear({state->X_WR.x, state->X_WR.y});
      ++heard_;
    });
}

void LightRadio::report_trouble(std::int64_t now) {
  const netio::SignatureTrouble* last = nullptr;
  std::string who;
  std::uint64_t count = 0;
  for (std::size_t k = 0; k < sockets_.size(); ++k) {
    const netio::SignatureTrouble& trouble = sockets_[k].trouble();
    count += trouble.count;
    if (trouble.count > 0) last = &trouble, who = fmt::format("intersection {}", messages_.intersections()[k].id);
  }
  const bool is_new = count > std::exchange(troubles_, count);
  if (!is_new || (answered_ && !last->of_farm) || now < next_trouble_) return;
  next_trouble_ = now + 10'000'000'000;
  print_message("the farm at {} {}", farm_, netio::trouble_text(*last, who, base::unix_time()));
}

void LightRadio::send(std::span<const world::SignalForecast> forecasts, std::int64_t now) {
  for (std::size_t k = 0; k < sockets_.size(); ++k)
    messages_.for_each_packet(k, forecasts, now, [&](const base::Bytes& packet) { sockets_[k].send(packet); });
}

std::string LightRadio::summary() const {
  std::uint64_t sent = 0;
  for (const netio::V2vSocket& socket : sockets_) sent += socket.sent().sent;
  return fmt::format("V2I to {}: sent {}; {}received {}", farm_, counted(sent, "packet"),
                     answered_ ? "" : "no packets from there; ", counted(heard_, "state"));
}

}  // namespace sf::apps
