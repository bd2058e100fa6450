#include "apps/commands/tag_sender.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "apps/options/address.h"
#include "netio/address_token.h"
#include "robots/estimation/state.h"

namespace sf::apps {

netio::Tag object_state(const vision::TrackedTag& tag, const vision::TagMount& mount) {
  const auto about = [](double angle, glm::dvec3 axis) { return glm::angleAxis(angle, axis); };
  const glm::dvec3 x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
  const glm::dquat R_WO = about(tag.X_WT.yaw, z) * about(tag.pitch, y) * about(tag.roll, x) * about(-mount.X_OT.yaw, z);
  const glm::dvec3 arm =
      R_WO * glm::dvec3{mount.X_OT.x, mount.X_OT.y, mount.X_OT.z};  // from the object's origin to the tag
  netio::Tag state;
  state.position = {tag.X_WT.x - arm.x, tag.X_WT.y - arm.y, tag.X_WT.z - arm.z};
  state.orientation = {R_WO.x, R_WO.y, R_WO.z, R_WO.w};
  state.linear = {tag.velocity.x + tag.turn * arm.y, tag.velocity.y - tag.turn * arm.x, 0.0};
  state.angular = {0.0, 0.0, tag.turn};
  return state;
}

std::array<float, 6> object_covariance(const vision::TrackedTag& tag, const vision::TagMount& mount) {
  constexpr double kPosition = 2e-3, kYaw = 2e-3;  // [m], [rad] errors of calibration and height
  const double xx = tag.position_sigma * tag.position_sigma + kPosition * kPosition;
  const double yaw = tag.yaw_sigma * tag.yaw_sigma + kYaw * kYaw;
  const glm::dvec2 arm = base::rotate(tag.X_WT.yaw - mount.X_OT.yaw, {-mount.X_OT.x, -mount.X_OT.y});
  const estimation::PoseCovariance object = estimation::moved({xx, 0.0, 0.0, xx, 0.0, yaw}, arm);
  std::array<float, 6> stated;
  std::transform(object.begin(), object.end(), stated.begin(), [](double v) { return static_cast<float>(v); });
  return stated;
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
    const vision::TagMount& mount = testbed_.mount(tag.id);
    header_.state = {.stated = true, .covariance = object_covariance(tag, mount)};
    netio::encode(header_, object_state(tag, mount), packet_);
    const auto signer = signers_.find(tag.id);
    if (signer != signers_.end()) signer->second.sign(packet_);
    outbox_.queue(*to, packet_);
  }
  outbox_.flush();
}

}  // namespace sf::apps
