#include "encoder/av/file_size.h"

#include <algorithm>
#include <string>

#include "core/text.h"

namespace render2mpeg::av {
namespace {

struct Overhead {
    double file = 0;     ///< bytes
    double picture = 0;  ///< bytes for each
    double share = 0;    ///< of the pictures' bytes
};

/// Streams without a container.
bool is_bare(const std::string& ending) {
    return ending == ".m2v" || ending == ".gif";
}
/// Containers with a table of their pictures.
bool has_table(const std::string& ending) {
    return ending == ".mkv" || ending == ".webm" || ending == ".mp4" || ending == ".mov";
}

/// chosen: somewhat more than measured (docs/measurements.md#rates), and the share that headers have of full packs and
/// packets [H222]. A disc has two sectors of navigation more for each of its units, of some 12 pictures.
Overhead overhead_of(const std::string& ending, bool disc) {
    if (is_bare(ending)) return {16, 0, 0};
    if (ending == ".ts") return {800, 290, 0.024};
    if (has_table(ending)) return {1000, 24, 0.004};
    return {2048, disc ? 400.0 : 32.0, 0.018};
}

}  // namespace

double pictures_in_file(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc) {
    const Overhead overhead = overhead_of(core::ending_of(file), disc);
    // chosen: two passes come within 1 % of a rate, seldom 2 % (docs/measurements.md#rates).
    constexpr double aim = 0.98;
    const double fixed = overhead.file + overhead.picture * static_cast<double>(pictures);
    return std::max(1.0, aim * (bytes - fixed) / (1 + overhead.share));
}

double file_of_pictures(double bytes, std::int64_t pictures, const std::filesystem::path& file, bool disc) {
    const Overhead overhead = overhead_of(core::ending_of(file), disc);
    return overhead.file + overhead.picture * static_cast<double>(pictures) + bytes * (1 + overhead.share);
}

double likely_file(double bytes, double sound, std::int64_t pictures, const std::filesystem::path& file, bool disc) {
    const std::string ending = core::ending_of(file);
    const auto count = static_cast<double>(pictures);
    const auto as = [&](const Overhead& o) { return o.file + o.picture * count + (bytes + sound) * (1 + o.share); };
    // fit: docs/measurements.md#rates
    if (is_bare(ending)) return as({16, 0, 0});
    if (ending == ".ts") return as({800, 290, 0.024});
    if (has_table(ending)) return as({785, 13, 0.001});
    // Each stream fills packs of its own [H222, 2.5], the last of several by half.
    constexpr double pack = 2048, headers = 1.018;
    const auto packs = [](double stream) {
        const double full = headers * stream / pack;
        return stream <= 0 ? 0 : full <= 1 ? pack : pack * (full + 0.5);
    };
    return 4 + packs(bytes) + packs(sound) + (disc ? 2 * pack / 12 * count : 0);
}

}  // namespace render2mpeg::av
