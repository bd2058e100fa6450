#include "bridges/player/connection.h"

#include <utility>

namespace sf::bridges::player {

namespace {

constexpr std::size_t kAtOnce = 64u << 10;  // [byte] received per turn of a client
constexpr std::uint32_t kEndOfRound = 1;    // subtype: no data was lost

}  // namespace

Connection::Connection(netio::Socket socket, std::size_t port, const netio::Endpoint& local, std::uint32_t host)
    : socket_(std::move(socket)), port_(port), local_(local), host_(host), out_(kBanner.begin(), kBanner.end()) {
  out_.resize(kBannerBytes);
}

bool Connection::fill() {
  const std::size_t before = in_.size();
  in_.resize(before + kAtOnce);
  const auto received = netio::receive_some(socket_, std::span(in_).subspan(before));
  in_.resize(before + received.value_or(0));
  return received.has_value();
}

void Connection::add(const Header& header, std::span<const std::uint8_t> payload) {
  put_header(header, out_);
  out_.insert(out_.end(), payload.begin(), payload.end());
}

void Connection::answer(const Header& request, MessageType type, std::span<const std::uint8_t> payload, double time) {
  Header header = request;
  header.type = type;
  header.time = time;
  header.size = static_cast<std::uint32_t>(payload.size());
  add(header, payload);
}

void Connection::unsubscribe(const Address& address) {
  const auto open = subscriptions_.find(address);
  if (open == subscriptions_.end()) return;
  waiting_ -= open->second.waiting.size();
  subscriptions_.erase(open);
}

void Connection::put_data(const Address& address, Subscription& subscription, std::uint32_t subtype, double time,
                          std::span<const std::uint8_t> payload) {
  waiting_ -= subscription.waiting.size();
  subscription.waiting.clear();
  const std::size_t size = kHeaderBytes + payload.size();
  if (size > kMostPayload || waiting_ + size > kMostWaiting) return;
  put_header({local_.address, local_.port, address, MessageType::data, subtype, time, sequence_++,
              static_cast<std::uint32_t>(payload.size())},
             subscription.waiting);
  subscription.waiting.insert(subscription.waiting.end(), payload.begin(), payload.end());
  waiting_ += size;
}

void Connection::add_round(double time) {
  if (waiting_ == 0 || (pull_ && !asked_)) return;
  for (auto& [address, subscription] : subscriptions_) {
    if (subscription.waiting.empty()) continue;
    out_.insert(out_.end(), subscription.waiting.begin(), subscription.waiting.end());
    subscription.described = subscription.described || subscription.describes;
    subscription.waiting.clear();
  }
  waiting_ = 0;
  if (pull_) add({.type = MessageType::sync, .subtype = kEndOfRound, .time = time, .sequence = sequence_++}, {});
  asked_ = false;
}

bool Connection::send() {
  const auto taken = netio::send_some(socket_, std::span<const std::uint8_t>(out_).subspan(sent_));
  if (!taken) return false;
  sent_ += *taken;
  if (sent_ == out_.size()) out_.clear(), sent_ = 0;
  return out_.size() - sent_ <= kMostUnsent;
}

bool Connection::flush(double time) {
  if (!send()) return false;
  if (is_full()) return true;
  add_round(time);
  return send();
}

}  // namespace sf::bridges::player
