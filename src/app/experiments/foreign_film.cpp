#include "app/experiments/foreign_film.h"

#include <fmt/format.h>

#include <cctype>
#include <set>
#include <utility>

#include "app/loop/frame_source.h"
#include "app/options/output_kind.h"
#include "app/system/probes.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

/// "frames.0012.exr" as "frames.%04d.exr": the last number of its name; empty where there is none.
std::string pattern_of(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    std::size_t end = dot;
    while (end > 0 && std::isdigit(static_cast<unsigned char>(name[end - 1])) == 0) --end;
    std::size_t begin = end;
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0) --begin;
    if (begin == end) return {};
    // Without a leading zero a number may be of any length: %d.
    const std::string number =
        name[begin] == '0' && end - begin > 1 ? fmt::format("%0{}d", end - begin) : std::string("%d");
    return name.substr(0, begin) + number + name.substr(end);
}

/// Declared matrix; none: players take it by the height.
std::optional<perceptual::ColorMatrix> matrix_of(const std::filesystem::path& film, int declared) {
    switch (declared) {
        case 0:
            return std::nullopt;
        case 1:
            return perceptual::ColorMatrix::bt709;
        case 4:  // FCC: BT.601's weights to two digits
        case 5:  // BT.470 for 625 lines, and SMPTE 170M for 525: BT.601's weights
        case 6:
            return perceptual::ColorMatrix::bt601;
        default:
            throw core::Error("comparing", film.string(),
                              fmt::format("its luma is of matrix {}, neither BT.601 nor BT.709", declared));
    }
}

/// Whether BT.709's transfer function is declared [H262, table 6-8]; ffmpeg declares none and keeps code values.
bool is_bt709_curve(int declared) {
    return declared == 1 || declared == 6;
}

}  // namespace

std::filesystem::path image_sequence_in(const std::filesystem::path& place) {
    std::error_code error;
    if (!std::filesystem::is_directory(place, error)) return place;
    std::set<std::string> patterns;
    for (const auto& entry : std::filesystem::directory_iterator(place)) {
        const std::string ending = core::ending_of(entry.path());
        if (ending != ".exr" && ending != ".png") continue;
        if (std::string pattern = pattern_of(entry.path().filename().string()); !pattern.empty())
            patterns.insert(std::move(pattern));
    }
    // Numbers that outgrow their zeros (0999, 1000) belong to one sequence.
    for (auto p = patterns.begin(); p != patterns.end();) {
        const std::size_t at = p->find("%d");
        bool within = false;
        for (const std::string& other : patterns)
            within = within || (at != std::string::npos && other != *p && other.starts_with(p->substr(0, at) + "%0") &&
                                other.ends_with(p->substr(at + 1)));
        p = within ? patterns.erase(p) : std::next(p);
    }
    if (patterns.size() != 1)
        throw core::Error("reading", place.string(),
                          patterns.empty() ? "no numbered .exr or .png images are in it"
                                           : "images of several sequences are in it: give a pattern, e.g. " +
                                                 (place / *patterns.begin()).string());
    return place / *patterns.begin();
}

ForeignFilm look_at_foreign(const std::filesystem::path& film, const std::filesystem::path& reference, float exposure,
                            const core::View& view) {
    const std::filesystem::path pattern = image_sequence_in(reference);
    const bool linear = core::ending_of(pattern) == ".exr";
    if (scene::Probe::is_possible()) {
        const scene::ProbeLimits limits = film_limits(film);
        scene::text_of(scene::Probe(limits, {"film", film.string()}).end(), film.string(), limits);
    }
    const av::Inspection inspection = av::inspect(film);
    const std::unique_ptr<FrameSource> frames =
        open_frames(pattern, linear ? std::optional(exposure) : std::nullopt, std::nullopt,
                    {matrix_of(film, inspection.stream.matrix_coefficients),
                     !is_bt709_curve(inspection.stream.transfer_characteristics), view});
    ForeignFilm found;
    found.name = core::printable(film.filename().string());
    found.width = inspection.stream.width;
    found.height = inspection.stream.height;
    if (found.width != frames->size().width || found.height != frames->size().height)
        throw core::Error("comparing", film.string(),
                          fmt::format("it has {}x{} pixels, its reference {}x{}", found.width, found.height,
                                      frames->size().width, frames->size().height));
    for (const av::PictureFacts& picture : inspection.pictures) found.bytes += static_cast<double>(picture.bytes);
    found.pictures = static_cast<std::int64_t>(inspection.pictures.size());
    found.bytes = core::divide_or(found.bytes, static_cast<double>(found.pictures), 0.0);

    perceptual::FilmQuality quality;
    double masked = 0;
    av::decode(film, [&](const core::Picture& picture) {
        const std::int64_t frame = frames->frames().first + picture.number;
        if (frame > frames->frames().last) return;
        const core::Picture truth = frames->read(frame).value();
        quality.add(picture, truth);
        masked += perceptual::masked_error(picture.y, truth.y);
    });
    found.compared = quality.pictures();
    if (found.compared == 0) throw core::Error("comparing", film.string(), "it has no picture");
    found.psnr_y = quality.psnr_y();
    found.ssim_y = quality.ssim_y();
    found.psnr_hvs_m = perceptual::psnr(masked / static_cast<double>(found.compared));
    return found;
}

}  // namespace render2mpeg::app
