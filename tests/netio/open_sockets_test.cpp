// Restricts the sockets of a library to this machine.

#include "netio/open_sockets.h"

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <sys/socket.h>

#include <array>

#include "netio/outbox.h"
#include "netio/socket.h"

namespace sf::netio {
namespace {

bool has_filter(const Socket& socket) {
  std::array<sock_filter, 16> steps{};
  socklen_t count = steps.size();
  EXPECT_EQ(getsockopt(socket.descriptor(), SOL_SOCKET, SO_GET_FILTER, steps.data(), &count), 0);
  return count > 0;
}

TEST(OpenSockets, RestrictsNewSocketsToLoopback) {
  const Socket old = open_udp({0, 0});
  const OpenSockets before;
  const Socket open_to_all = open_udp({0, 0}), kept = open_udp({kLoopback, 0});
  before.keep_new_ones_to_loopback();
  EXPECT_FALSE(has_filter(old)) << "opened before";
  EXPECT_FALSE(has_filter(kept)) << "bound to loopback already";
  ASSERT_TRUE(has_filter(open_to_all));
  // Datagrams to loopback still arrive.
  Outbox sender;
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  for (const std::uint32_t to : {kLoopback, kLoopback + 1}) sender.queue({to, bound_endpoint(open_to_all).port}, bytes);
  sender.flush();
  ReceiveBatch batch(4);
  std::size_t arrived = 0;
  for (int i = 0; i < 100 && arrived < 2; ++i) {
    wait_readable(open_to_all, open_to_all, 100);
    arrived += batch.drain(open_to_all, 4, [](std::span<const std::uint8_t>, const Endpoint&) {});
  }
  EXPECT_EQ(arrived, 2u);
}

TEST(OpenSockets, ReturnsAddressesOfNewSockets) {
  const Socket old = open_udp({kLoopback + 1, 0});
  const OpenSockets before;
  EXPECT_TRUE(before.addresses().empty());
  const Socket to_all = open_udp({0, 0});
  EXPECT_TRUE(before.addresses().empty()) << "0.0.0.0 is not an interface's address";
  const Socket one = open_udp({kLoopback + 2, 0}), again = open_udp({kLoopback + 2, 0}),
               other = open_udp({kLoopback + 3, 0});
  EXPECT_EQ(before.addresses(), (std::set<std::string>{"127.0.0.3", "127.0.0.4"}));
}

}  // namespace
}  // namespace sf::netio
