#pragma once
// Addresses in arguments and files.

#include <string>

#include "netio/address_book.h"

namespace sf::apps {

/// @param option of the address, such as "--send", for errors  @param file that has it instead; empty: none
/// @throws base::InputError for another form than HOST:PORT, and for unknown hosts
netio::Endpoint read_address(netio::AddressBook& book, const std::string& text, const std::string& option,
                             const std::string& file = "");

/// @param text [HOST:]PORT to listen at: of this machine only unless a host is named; 0: any free port
/// @throws base::InputError for another form, and for unknown hosts
netio::Endpoint read_own_address(const std::string& text, const std::string& option);

}  // namespace sf::apps
