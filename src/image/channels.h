#pragma once
// Finds a file's red, green, blue and alpha.
#include <array>
#include <string>
#include <vector>

namespace render2mpeg::image {

/// Which of a file's channels become red, green, blue and alpha; -1: none. A grey image has red only.
struct ChannelChoice {
    std::array<int, 4> channel{-1, -1, -1, -1};

    bool is_grey() const { return channel[1] < 0; }
    int count() const;
    /// Whether they follow one another in the file in the order of their components, so that they are read at once.
    bool consecutive() const;
};

/// Takes R, G, B and A (also red, green, blue, alpha, in any case) of the unnamed layer, else of the first layer that
/// has colours
/// ("ViewLayer.Combined.R"); else Y, else the first three channels of at least three, else the first alone as grey.
/// `alpha_channel`: what the file calls its alpha, or -1. There is at least one channel.
ChannelChoice choose_channels(const std::vector<std::string>& names, int alpha_channel);

}  // namespace render2mpeg::image
