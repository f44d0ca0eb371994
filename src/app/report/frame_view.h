#pragma once
// Shows the middle of a frame in a page, with a slider.
#include <string>

#include "core/picture.h"
#include "core/plane.h"
#include "perceptual/display.h"
#include "perceptual/heatmap.h"

namespace render2mpeg::app {

/// Central crop of pictures of this size, for a report: pixel for pixel, since downscaling hides coding artefacts.
struct ViewBox {
    int left = 0, top = 0, width = 0, height = 0;  ///< left and top are even
};
ViewBox view_of(int width, int height);

/// The part of a plane or picture that a box shows. The picture's planes keep their siting.
core::Picture part_of(const core::Picture& picture, const ViewBox& box);
core::Plane<float> part_of(const core::Plane<float>& plane, const ViewBox& box);

/// A picture in a page, with its name.
struct ShownPicture {
    std::string name;
    core::Picture picture;
};

/// A picture as an HTML element, by that `id` if any. `name` is plain text.
std::string image_of(const std::string& name, const core::Picture& picture, perceptual::ColorMatrix matrix,
                     const std::string& id = "");

/// Two pictures of one size upon each other, with a slider that shows more of the one or of the other: by mouse, finger
/// or arrow keys; on paper half of each. Pictures are PNG files within the page. `title` is plain text.
std::string slider_figure(const std::string& title, const ShownPicture& left, const ShownPicture& right,
                          perceptual::ColorMatrix matrix);

/// The same with a switch to the difference of the two, amplified by difference_gain, on grey.
std::string difference_figure(const std::string& title, const ShownPicture& left, const ShownPicture& right,
                              perceptual::ColorMatrix matrix);

/// Values in false colours with their legend. `title` is plain text.
std::string heat_figure(const std::string& title, const core::Plane<float>& values, const perceptual::HeatScale& scale);

}  // namespace render2mpeg::app
