// The function table of the plug-in.

#include "vision/opencv/plugin.h"
#include "vision/opencv/images.h"
#include "vision/opencv/markers.h"

extern "C" {
extern const sf::vision::OpenCv sensorfarm_opencv;
const sf::vision::OpenCv sensorfarm_opencv{
    .tag_pattern = sf::vision::tag_pattern,
    .tag_count = sf::vision::tag_count,
    .make_tag_finder = sf::vision::make_tag_finder,
    .draw = sf::vision::draw,
    .encode_jpeg = sf::vision::encode_jpeg,
    .open_source = sf::vision::open_source,
    .open_video = sf::vision::open_video,
    .find_board = sf::vision::find_board,
    .calibrate = sf::vision::calibrate,
    .place = sf::vision::place,
    .make_paint_finder = sf::vision::make_paint_finder,
};
}
