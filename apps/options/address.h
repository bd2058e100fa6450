#pragma once
// Parsing of addresses in arguments and files.

#include <string>

#include "netio/address_book.h"

namespace sf::apps {

/// @param option of the address, such as "--send", for errors @param file file that contains the address instead;
/// empty: none
/// @throws base::InputError if it is not HOST:PORT or the host is unknown
netio::Endpoint read_address(netio::AddressBook& book, const std::string& text, const std::string& option,
                             const std::string& file = "");

/// @param text [HOST:]PORT to listen on: reachable from this machine only unless a host is given; port 0: any free port
/// @throws base::InputError for another form and unknown hosts
netio::Endpoint read_own_address(const std::string& text, const std::string& option);

}  // namespace sf::apps
