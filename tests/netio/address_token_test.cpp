#include "netio/address_token.h"

#include <gtest/gtest.h>

#include <set>

namespace sf::netio {
namespace {

/// Published test values (appendix A of the paper, and vectors.h of its reference implementation): key 00 .. 0f, input
/// 00 01 02 ...
TEST(Token, SipHashMatchesPublishedValues) {
  const SipHashKey key{0x0706050403020100u, 0x0f0e0d0c0b0a0908u};
  std::array<std::uint8_t, 15> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  EXPECT_EQ(siphash(key, {}), 0x726fdb47dd0e0e31u);
  EXPECT_EQ(siphash(key, std::span(bytes).first(1)), 0x74f839c593dc67fdu);
  EXPECT_EQ(siphash(key, std::span(bytes).first(8)), 0x93f5f5799a932462u);  // one whole word
  EXPECT_EQ(siphash(key, bytes), 0xa129ca6149be45e5u);
}

TEST(Token, DiffersByAddressAndPort) {
  const AddressTokens tokens(SipHashKey{1, 2});
  const Endpoint one{kLoopback, 5001};
  EXPECT_EQ(tokens.of(one), AddressTokens(SipHashKey{1, 2}).of(one));
  EXPECT_NE(tokens.of(one), tokens.of({kLoopback, 5002}));
  EXPECT_NE(tokens.of(one), tokens.of({kLoopback + 1, 5001}));
  EXPECT_NE(tokens.of(one), AddressTokens(SipHashKey{1, 3}).of(one));  // a restarted farm
}

TEST(Token, SessionsAndKeysAreUnique) {
  std::set<std::uint32_t> sessions;
  for (int i = 0; i < 100; ++i) sessions.insert(random_session());
  EXPECT_GT(sessions.size(), 98u);  // two of 100 are equal once in a million runs
  EXPECT_EQ(sessions.count(0), 0u);
  EXPECT_NE(random_key(), random_key());
  EXPECT_NE(AddressTokens().of({}), AddressTokens().of({}));
}

}  // namespace
}  // namespace sf::netio
