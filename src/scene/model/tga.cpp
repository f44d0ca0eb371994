#include "scene/model/tga.h"

#include <string_view>

#include "core/error.h"

namespace render2mpeg::scene {

std::vector<std::byte> encode_tga(int width, int height, std::span<const glm::u8vec4> texels) {
    EXPECTS(width > 0 && height > 0 && width <= 65'535 && height <= 65'535);
    EXPECTS(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<std::byte> tga;
    const auto put = [&](int byte) { tga.push_back(static_cast<std::byte>(byte & 0xff)); };
    // True colour, not packed, 32 bits of which 8 are alpha, from the upper left. [TGA2]
    for (const int byte : {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, width, width >> 8, height, height >> 8, 32, 0x28})
        put(byte);
    for (const glm::u8vec4& t : texels)
        for (const int channel : {2, 1, 0, 3}) put(t[channel]);
    for (int i = 0; i < 8; ++i) put(0);  // neither extensions nor a developer's area
    for (const char c : std::string_view("TRUEVISION-XFILE.\0", 18)) put(c);
    return tga;
}

}  // namespace render2mpeg::scene
