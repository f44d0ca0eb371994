#include "app/film.h"

#include "perceptual/display.h"

namespace render2mpeg::app {

encoder::Settings coding_settings(const CodingOptions& options, Size size, const core::FrameRate& rate) {
    encoder::Settings coding;
    coding.width = size.width;
    coding.height = size.height;
    coding.rate = rate;
    coding.quantiser = options.quantiser;
    coding.gop = options.gop;
    coding.b_pictures = options.b_pictures;
    coding.effort = options.encoder == "fast" ? encoder::Effort::fast : encoder::Effort::quality;
    coding.matrix_coefficients = static_cast<int>(perceptual::matrix_for(size.height));
    return coding;
}

}  // namespace render2mpeg::app
