// Addresses in files and command lines.

#include "netio/address_book.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace sf::netio {

namespace {

int look_ups = 0;

std::uint32_t count_look_up(const std::string& host) {
  ++look_ups;
  return host == "robots" ? 0x0A000001u : 0x0A000002u;
}

}  // namespace

TEST(AddressBook, LooksUpEachHostOnce) {
  // A testbed file may list 65 536 tags, each with the address of the same few farms.
  AddressBook book(count_look_up);
  look_ups = 0;
  for (std::uint16_t port = 1; port <= 1000; ++port) {
    EXPECT_EQ(book.find("robots:" + std::to_string(port)), (Endpoint{0x0A000001u, port}));
    EXPECT_EQ(book.find("farm:9000"), (Endpoint{0x0A000002u, 9000}));
  }
  EXPECT_EQ(look_ups, 2);
}

TEST(AddressBook, RejectsOtherForms) {
  AddressBook book(count_look_up);
  look_ups = 0;
  for (const char* text :
       {"", ":", ":9000", "farm", "farm:", "farm:0", "farm:65536", "farm:9000x", "farm:-1", "farm: 9"})
    EXPECT_FALSE(book.find(text)) << text;
  EXPECT_EQ(look_ups, 0);
  EXPECT_EQ(book.find("farm:65535"), (Endpoint{0x0A000002u, 65535}));
}

TEST(AddressBook, NamesAnUnknownHost) { EXPECT_THROW(AddressBook().find("no host has a space:1"), base::InputError); }

}  // namespace sf::netio
