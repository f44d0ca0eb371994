#include "app/options/preset.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

constexpr core::Rational wide{16, 9}, narrow{4, 3};

/// DVD-Video [DVDVideo]: MPEG-2 at Main level as fields. A GOP has at most 36 fields at 525 lines, 30 at 625. Narrower
/// pictures than these fit too, but nobody renders a film for them.
/// chosen: 9 Mb/s of the 9.8 that video may take, since sound shares the 10.08 Mb/s of the disc (448 kb/s of AC-3 and
/// headers of 2 %).
Preset dvd(const char* name, int lines, const std::vector<const char*>& rates, int gop_fields) {
    Preset preset;
    preset.name = name;
    for (const int width : {720, 704}) preset.pictures.push_back({{width, lines}, {wide, narrow}, rates});
    preset.fields = true;
    preset.b_pictures = 2;
    preset.gop_fields = gop_fields;
    preset.gop_seconds = 0.6;
    preset.bit_rate = 9'800'000;
    preset.usual_rate = 9'000'000;
    preset.buffer_bits = 1'835'008;
    preset.disc = true;
    preset.endings = {".mpg", ".mpeg", ".vob", ".m2v"};
    return preset;
}

/// ATSC's compression formats [A53, table 6.2], those with progressive pictures.
/// chosen: 17.5 Mb/s of the 19.4 that bit_rate_value may say, for a channel of 19.39 Mb/s with sound, tables and
/// headers.
Preset atsc() {
    const std::vector<const char*> film{"23.976", "24", "29.97", "30"};
    std::vector<const char*> all = film;
    all.insert(all.end(), {"59.94", "60"});
    Preset preset;
    preset.name = "atsc";
    preset.pictures = {{{1280, 720}, {wide}, all},
                       {{1920, 1080}, {wide}, film},
                       {{704, 480}, {wide, narrow}, all},
                       {{640, 480}, {narrow}, all}};
    preset.bit_rate = 19'400'000;
    preset.usual_rate = 17'500'000;
    preset.buffer_bits = 7'995'392;
    preset.longest_delay = 0.5;  // vbv_delay <= 45000 [A53, 6.1.5]
    preset.endings = {".ts", ".m2v"};
    return preset;
}

const std::vector<Preset>& presets() {
    static const std::vector<Preset> all{dvd("dvd-ntsc", 480, {"23.976", "29.97"}, 36), dvd("dvd-pal", 576, {"25"}, 30),
                                         atsc()};
    return all;
}

/// Four pictures of 23.976 per second are shown as ten fields (encoder/cadence.h).
double fields_per_picture(const Preset& preset, const core::FrameRate& rate) {
    return preset.fields && rate.code == 1 ? 2.5 : 2;
}

}  // namespace

const PresetPicture* Preset::picture_of(Size size) const {
    const auto found = std::find_if(pictures.begin(), pictures.end(), [&](const PresetPicture& p) {
        return p.size.width == size.width && p.size.height == size.height;
    });
    return found == pictures.end() ? nullptr : &*found;
}

int Preset::longest_gop(const core::FrameRate& rate) const {
    return static_cast<int>(gop_fields / fields_per_picture(*this, rate));
}

int Preset::usual_gop(const core::FrameRate& rate) const {
    const int count = static_cast<int>(std::lround(gop_seconds * rate.hertz.value()));
    if (gop_fields == 0) return count;
    // Whole rounds of repeated fields, so that every GOP begins alike.
    const int longest = std::min(count, longest_gop(rate));
    return fields_per_picture(*this, rate) > 2 ? longest / 4 * 4 : longest;
}

void Preset::check_output(const std::filesystem::path& output) const {
    if (output.empty() || kind_of(output) != OutputKind::film) return;
    if (std::find(endings.begin(), endings.end(), core::ending_of(output)) == endings.end())
        throw UsageError(fmt::format("--output {}: {} takes {}", output.string(), option(), fmt::join(endings, ", ")));
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : presets()) names.emplace_back(preset.name);
    return names;
}

const Preset& preset_from(const std::string& name) {
    for (const Preset& preset : presets())
        if (preset.name == name) return preset;
    throw UsageError(fmt::format("--for {}: there are {}", name, fmt::join(preset_names(), ", ")));
}

}  // namespace render2mpeg::app
