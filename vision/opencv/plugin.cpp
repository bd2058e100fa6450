// The plug-in's table.

#include "vision/opencv/calibration.h"
#include "vision/opencv/images.h"
#include "vision/opencv/markers.h"
#include "vision/opencv/sources.h"

extern "C" {
extern const sf::vision::OpenCv sensorfarm_opencv;
const sf::vision::OpenCv sensorfarm_opencv{sf::vision::tag_pattern, sf::vision::make_tag_finder, sf::vision::draw,
                                           sf::vision::open_source, sf::vision::find_board,      sf::vision::calibrate};
}
