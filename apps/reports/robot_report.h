#pragma once
// Prints the results of a robot's process.

#include <string>

#include "server/robot_client.h"

namespace sf::apps {

std::string json_of(const server::RobotClientStats& facts);
std::string text_of(const server::RobotClientStats& facts);

}  // namespace sf::apps
