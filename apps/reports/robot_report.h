#pragma once
// Prints the results of a robot's process.

#include <string>

#include "server/robot_client.h"

namespace sf::apps {

std::string robot_client_json(const server::RobotClientStats& facts);
std::string robot_client_text(const server::RobotClientStats& facts);

}  // namespace sf::apps
