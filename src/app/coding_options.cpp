#include "app/coding_options.h"

namespace render2mpeg::app {

void add_coding_options(CLI::App& command, CodingOptions& options) {
    const std::string coding = "MPEG-2";
    command.add_option("--quantiser", options.quantiser, "quantiser_scale_code: 1 is the finest, 31 the coarsest")
        ->check(CLI::Range(1, 31))
        ->capture_default_str()
        ->group(coding);
    command.add_option("--gop", options.gop, "Pictures per closed group of pictures")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str()
        ->group(coding);
    command.add_option("--b-pictures", options.b_pictures, "Most B pictures in a row")
        ->check(CLI::Range(0, 3))
        ->capture_default_str()
        ->group(coding);
    command.add_option("--encoder", options.encoder, "How much is tried: `fast`, or `quality` for fewer bits")
        ->check(CLI::IsMember({"fast", "quality"}))
        ->capture_default_str()
        ->group(coding);
}

}  // namespace render2mpeg::app
