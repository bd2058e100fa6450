#pragma once
// Tables and figures of the experiment `tree`: grids as sensors are switched off one by one.

#include <string>
#include <vector>

#include "scenarios/tree_runs.h"

namespace sf::scenarios {

/// Returns "front laser, sonar". @param sensors bit k: kTreeSensors[k]
std::string tree_sensor_names(unsigned sensors);

std::string tree_grid_csv(const std::vector<TreeGrid>& all);
std::string tree_grid_report(const std::vector<TreeGrid>& all);
void draw_tree_grids(const std::vector<TreeGrid>& all, const std::string& path);

}  // namespace sf::scenarios
