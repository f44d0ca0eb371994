#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/text.h"
#include "image/channels.h"

namespace render2mpeg::image {
namespace {

struct Name {
    std::string layer;    ///< what stands before the last dot
    std::string channel;  ///< what stands behind it, in lower case
};

Name split(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) return {"", core::lower_case(name)};
    return {name.substr(0, dot), core::lower_case(name.substr(dot + 1))};
}

/// 0..3 for red, green, blue and alpha, 4 for luminance, -1 for all others.
int component_of(const std::string& channel) {
    static const std::map<std::string, int> components{
        {"r", 0}, {"red", 0},  {"g", 1},    {"green", 1}, {"b", 2}, {"blue", 2},     {"a", 3},
        {"y", 4}, {"grey", 4}, {"gray", 4}, {"alpha", 3}, {"i", 4}, {"luminance", 4}};
    const auto found = components.find(channel);
    return found == components.end() ? -1 : found->second;
}

}  // namespace

int ChannelChoice::count() const {
    return static_cast<int>(std::count_if(channel.begin(), channel.end(), [](int c) { return c >= 0; }));
}

bool ChannelChoice::consecutive() const {
    for (int i = 0; i < count(); ++i)
        if (channel[static_cast<std::size_t>(i)] != channel[0] + i) return false;
    return true;
}

ChannelChoice choose_channels(const std::vector<std::string>& names, int alpha_channel) {
    EXPECTS(!names.empty());

    // Gather each layer's colours, layers in the order of the file but the unnamed one first.
    std::vector<std::pair<std::string, std::array<int, 5>>> layers{{"", {-1, -1, -1, -1, -1}}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Name name = split(names[i]);
        const int component = component_of(name.channel);
        if (component < 0) continue;
        auto layer = std::find_if(layers.begin(), layers.end(), [&](const auto& l) { return l.first == name.layer; });
        if (layer == layers.end()) layer = layers.insert(layers.end(), {name.layer, {-1, -1, -1, -1, -1}});
        int& place = layer->second[static_cast<std::size_t>(component)];
        if (place < 0) place = static_cast<int>(i);
    }

    // Prefer colours over luminance, in whatever layer.
    for (const auto& [layer, c] : layers)
        if (c[0] >= 0 && c[1] >= 0 && c[2] >= 0)
            return {{c[0], c[1], c[2], c[3] >= 0 ? c[3] : layer.empty() ? alpha_channel : -1}};
    for (const auto& [layer, c] : layers)
        if (c[4] >= 0) return {{c[4], -1, -1, c[3] >= 0 ? c[3] : layer.empty() ? alpha_channel : -1}};

    // Take unnamed channels in their order, alpha apart.
    std::vector<int> others;
    for (int i = 0; i < static_cast<int>(names.size()); ++i)
        if (i != alpha_channel) others.push_back(i);
    if (others.size() >= 3) return {{others[0], others[1], others[2], alpha_channel}};
    return {{others.empty() ? 0 : others[0], -1, -1, others.empty() ? -1 : alpha_channel}};
}

}  // namespace render2mpeg::image
