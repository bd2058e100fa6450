#include "apps/commands/tag_sender.h"

#include <cmath>

#include "apps/options/address.h"
#include "netio/address_token.h"

namespace sf::apps {

netio::Tag object_state(const vision::TrackedTag& tag, const vision::TagMount& mount) {
  const double yaw = tag.X_WT.yaw - mount.X_OT.yaw;
  const glm::dvec2 arm = base::rotate(yaw, {mount.X_OT.x, mount.X_OT.y});  // from the object's origin to the tag
  netio::Tag state;
  state.position = {tag.X_WT.x - arm.x, tag.X_WT.y - arm.y, tag.X_WT.z};
  state.orientation = {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)};
  state.linear = {tag.velocity.x + tag.turn * arm.y, tag.velocity.y - tag.turn * arm.x, 0.0};
  state.angular = {0.0, 0.0, tag.turn};
  return state;
}

TagSender::TagSender(const vision::Testbed& testbed, const std::string& fallback, std::span<const netio::Peer> peers)
    : testbed_(testbed) {
  header_.session = netio::random_session();
  netio::AddressBook book;
  if (!testbed.tag.address.empty()) fallback_ = read_address(book, testbed.tag.address, "", testbed.file);
  if (!fallback.empty() && !fallback_) fallback_ = read_address(book, fallback, "--send");
  for (const auto& [id, mount] : testbed.tags)
    if (!mount.address.empty()) addresses_[id] = read_address(book, mount.address, "", testbed.file);
  for (const netio::Peer& peer : peers)
    if (peer.kind == netio::PeerKind::tag && peer.key) signers_.emplace(peer.id, *peer.key);
}

void TagSender::send(std::span<const vision::TrackedTag> tags, std::int64_t epoch) {
  for (const vision::TrackedTag& tag : tags) {
    const auto own = addresses_.find(tag.id);
    const auto to = own != addresses_.end() ? own->second : fallback_;
    if (!to || tag.id < netio::kMinTag) {
      ++unaddressed_;
      continue;
    }
    header_.robot = static_cast<std::uint16_t>(tag.id);
    header_.sequence = sequences_[tag.id]++;
    header_.time = epoch + std::llround(1e9 * tag.time);
    netio::encode(header_, object_state(tag, testbed_.mount(tag.id)), packet_);
    const auto signer = signers_.find(tag.id);
    if (signer != signers_.end()) signer->second.sign(packet_);
    outbox_.queue(*to, packet_);
  }
  outbox_.flush();
}

}  // namespace sf::apps
